"""When a survey has had enough."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, isnan

from subsoil.errors import ParameterError

FEWEST_FOR_KV = 12
"""Samples before which no kriging variance is a reason to stop."""


@dataclass(frozen=True)
class Spent:
    """What a survey has cost so far, and what it has to show.

    Attributes
    ----------
    samples
        Readings taken.
    metres
        Way driven in m.
    minutes
        Time in the field in min.
    mean_kv
        Field average of the kriging variance in kPa2; NaN before the first sample.
    """

    samples: int
    metres: float
    minutes: float
    mean_kv: float


@dataclass(frozen=True)
class Limits:
    """The survey stops at whichever of these it comes to first.

    Parameters
    ----------
    samples
        Number of readings.
    metres, minutes
        Way in m and time in min.
    mean_kv
        Mean kriging variance in kPa2 at or below which the map is good enough, from the twelfth
        sample on: variograms of fewer say little. It does not depend on how well the variograms
        fit the soil: a target, not a promise.

    Raises
    ------
    ParameterError
        If a limit is not positive, or the target for the variance is negative.

    Examples
    --------
    >>> Limits(samples=30, minutes=60).reached(Spent(12, 300.0, 61.5, 900.0))
    '60 minutes spent'
    """

    samples: int = 30
    metres: float = inf
    minutes: float = inf
    mean_kv: float = 0.0

    def __post_init__(self) -> None:
        for name in ("samples", "metres", "minutes"):
            value = getattr(self, name)
            if not value > 0:
                raise ParameterError(f"must be greater than zero, not {value:g}", where=name)
        if isnan(self.mean_kv) or self.mean_kv < 0:
            raise ParameterError(f"must be zero or more, not {self.mean_kv:g}", where="KV target")

    def reached(self, spent: Spent) -> str:
        """Why to stop now; empty to go on."""
        if spent.samples >= self.samples:
            return f"{self.samples} samples taken"
        if spent.metres >= self.metres:
            return f"{self.metres:g} metres driven"
        if spent.minutes >= self.minutes:
            return f"{self.minutes:g} minutes spent"
        if spent.samples >= FEWEST_FOR_KV and spent.mean_kv <= self.mean_kv:
            return f"mean kriging variance at {self.mean_kv:g} kPa2"
        return ""
