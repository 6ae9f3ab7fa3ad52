"""What results say: means with 95 % intervals over fields, and differences paired by field.

Intervals are Student's, of values of one field each; a single field has none (NaN). Fields are
drawn independently, surveys of one field are not: that is why entrants are compared by their
differences on the same fields.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import ArrayLike

from subsoil.arrays import Floats
from subsoil.bench.paper import RMSE_KPA
from subsoil.bench.task import Entrant, Result, Snapshot

ByField = Mapping[int, float]
"""A number for each field."""

REFERENCES = ("adaptive-greedy", "adaptive-monte-carlo", "area-split")
"""Strategies that others are set against."""


@dataclass(frozen=True)
class Mean:
    """Mean of a number of fields, and half of its 95 % interval."""

    mean: float
    half: float
    fields: int


@dataclass(frozen=True)
class Difference:
    """An entrant against a reference on the fields that both surveyed.

    Attributes
    ----------
    difference
        Entrant minus reference.
    percent
        The same in percent of the reference's mean.
    won
        Share of fields on which the entrant's value is lower; a tie counts half.
    """

    difference: Mean
    percent: Mean
    won: float


@dataclass(frozen=True)
class ResultTable:
    """Results of one benchmark by entrant and field."""

    samples: tuple[int, ...]
    by_entrant: Mapping[Entrant, Mapping[int, Result]]

    @property
    def entrants(self) -> tuple[Entrant, ...]:
        """Entrants: the paper's in its order, then others by name."""
        order = {name: k for k, name in enumerate(RMSE_KPA)}
        return tuple(sorted(self.by_entrant, key=lambda e: (order.get(e.strategy, len(order)), e)))

    @property
    def references(self) -> tuple[Entrant, ...]:
        """Entrants that others are set against."""
        return tuple(e for name in REFERENCES for e in self.entrants if e.strategy == name)

    def label(self, entrant: Entrant) -> str:
        """Name of an entrant, with its estimator where the strategy came with several."""
        several = sum(other.strategy == entrant.strategy for other in self.by_entrant) > 1
        name = entrant.strategy.rpartition(":")[2]
        return f"{name}, {entrant.estimator}" if several else name

    def at(self, entrant: Entrant, n: int, value: Callable[[Snapshot], float]) -> ByField:
        """Value of each field at one of the numbers of samples."""
        k = self.samples.index(n)
        return {field: value(r.marks[k]) for field, r in self.by_entrant[entrant].items()}


def result_table(results: Iterable[Result]) -> ResultTable:
    """Results of one benchmark, sorted."""
    table: dict[Entrant, dict[int, Result]] = {}
    samples: tuple[int, ...] = ()
    for result in results:
        table.setdefault(result.task.entrant, {})[result.task.field_number] = result
        samples = result.task.setting.samples
    return ResultTable(samples, table)


def mean_of(values: ArrayLike) -> Mean:
    """Mean of values and half its 95 % interval by Student's t; values that are NaN do not count.

    Examples
    --------
    >>> mean_of([1.0, 2.0, 3.0])
    Mean(mean=2.0, half=2.484..., fields=3)
    """
    x = np.asarray(values, dtype=float)
    x = x[~np.isnan(x)]
    if x.size < 2:
        return Mean(float(x[0]) if x.size else np.nan, np.nan, x.size)
    half = scipy.stats.t.ppf(0.975, x.size - 1) * x.std(ddof=1) / np.sqrt(x.size)
    return Mean(float(x.mean()), float(half), x.size)


def paired(entrant: ByField, reference: ByField) -> Difference:
    """Difference to a reference over the fields that both have a number for."""
    both = sorted(k for k in entrant.keys() & reference.keys() if np.isfinite(entrant[k]))
    both = [k for k in both if np.isfinite(reference[k])]
    ours = np.array([entrant[k] for k in both])
    theirs = np.array([reference[k] for k in both])
    difference = mean_of(ours - theirs)
    whole = float(theirs.mean()) if theirs.size else 0.0
    scale = 100.0 / whole if whole else np.nan
    percent = Mean(difference.mean * scale, difference.half * scale, difference.fields)
    won = (ours < theirs) + 0.5 * (ours == theirs)
    return Difference(difference, percent, float(won.mean()) if won.size else np.nan)


def by_minutes(result: Result, minutes: float) -> float:
    """Error in kPa of the map that a survey has by a time.

    Linear between the numbers of samples compared. Before the first there is none (NaN); after
    the last the map stays as it is.
    """
    marks = sorted(result.marks, key=lambda row: row.minutes)
    times, errors = [row.minutes for row in marks], [row.rmse_kpa for row in marks]
    return float(np.interp(minutes, times, errors, left=np.nan))


def ended_before(result: Result, minutes: float) -> bool:
    """Whether even the survey of most samples was over by a time."""
    return max(row.minutes for row in result.marks) < minutes


def correlation_over_samples(result: Result) -> float:
    """Correlation of mean kriging variance and squared error over the samples of the longest run.

    NaN if either does not vary.
    """
    kv = np.array([row.mean_kv for row in result.longest.snapshots])
    mse = np.array([row.rmse_kpa**2 for row in result.longest.snapshots])
    if len(kv) < 3 or np.ptp(kv) == 0.0 or np.ptp(mse) == 0.0:
        return np.nan
    return float(np.corrcoef(kv, mse)[0, 1])


def curves(results: Iterable[Result], value: Callable[[Snapshot], float]) -> tuple[Floats, Floats]:
    """(k,) numbers of samples and (fields, k) values over the longest surveys."""
    longest = [result.longest for result in results]
    n = np.array([row.n for row in longest[0].snapshots], dtype=float)
    return n, np.array([[value(row) for row in series.snapshots] for series in longest])
