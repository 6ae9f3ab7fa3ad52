"""Tasks of a benchmark and their results, as values.

Chance is a function of the benchmark's seed S and the number k of a field alone: its soil is drawn
from ``SeedSequence(S, spawn_key=(k, 0))`` and its surveys are seeded with the first word of
``SeedSequence(S, spawn_key=(k, 1))``. All entrants so meet the same fields with the same seeds,
whatever else runs beside them.
"""

from __future__ import annotations

import hashlib
import json
import re
from dataclasses import asdict, dataclass, field
from math import nan, sqrt
from typing import Any

import numpy as np

from subsoil.bench.paper import RMSE_KPA
from subsoil.errors import ParameterError
from subsoil.registry import Allowed
from subsoil.strategies import strategy_named
from subsoil.variogram import estimator_named

PAPER_STRATEGIES = tuple(RMSE_KPA)
PROTOCOLS = ("surrogate", "signal", "riseholme")
"""The two of :func:`subsoil.simulation.draw_field`, and soils conditional on real readings."""

_SOIL, _SURVEY, _HAND = 0, 1, 2


@dataclass(frozen=True, order=True)
class Entrant:
    """A strategy and the estimator of variograms that it works with."""

    strategy: str
    estimator: str


@dataclass(frozen=True)
class Setting:
    """What all tasks of a benchmark share.

    Parameters
    ----------
    protocol
        How soils are drawn and read: one of :data:`PROTOCOLS`.
    seed
        Seed of everything random.
    samples
        Numbers of samples at which maps are compared, increasing, two or more.
    boundary_wkt, crs
        Outline of the field and its frame; empty for the protocol's own.

    Raises
    ------
    ParameterError
        If there is no such protocol, or samples do not increase from two on.
    """

    protocol: str
    seed: int
    samples: tuple[int, ...]
    boundary_wkt: str = ""
    crs: str = ""

    def __post_init__(self) -> None:
        if self.protocol not in PROTOCOLS:
            raise ParameterError(
                f"there is no protocol {self.protocol!r}",
                where="--protocol",
                remedy=f"one of {', '.join(PROTOCOLS)}",
            )
        steps = np.diff([1, *self.samples])
        if not self.samples or (steps < 1).any():
            raise ParameterError(
                f"{','.join(map(str, self.samples))!r} is not an increasing list of 2 or more",
                where="--samples",
                remedy="numbers such as 15,20,30,50",
            )


@dataclass(frozen=True)
class Task:
    """All surveys of one entrant on one field.

    Attributes
    ----------
    setting
        What it shares with others.
    field_number
        Which field, from 0.
    entrant
        Who surveys.
    """

    setting: Setting
    field_number: int
    entrant: Entrant

    @property
    def record(self) -> dict[str, Any]:
        """What is kept of it."""
        return {
            "setting": asdict(self.setting),
            "field": self.field_number,
            "entrant": asdict(self.entrant),
        }

    @property
    def name(self) -> str:
        """Name that no other task has: its field and entrant, and a digest of all of it."""
        digest = hashlib.sha256(json.dumps(self.record, sort_keys=True).encode()).hexdigest()
        who = re.sub(r"[^A-Za-z0-9._-]+", "-", f"{self.entrant.strategy}-{self.entrant.estimator}")
        return f"{self.field_number:04d}-{who}-{digest[:12]}"


@dataclass(frozen=True)
class Snapshot:
    """Where a survey stood after a number of samples.

    Attributes
    ----------
    n
        Samples taken.
    rmse_kpa
        Error of the map over all layers and cells.
    path_m, minutes
        Way driven, and time for it and for the stops.
    mean_kv
        Field mean of the kriging variance averaged over layers, in kPa2.
    kv_error_correlation
        Correlation over cells of the kriging variance and the squared error, both averaged over
        layers; NaN if either does not vary.
    """

    n: int
    rmse_kpa: float
    path_m: float
    minutes: float
    mean_kv: float
    kv_error_correlation: float

    @property
    def predicted_rmse_kpa(self) -> float:
        """Error that the map itself expects: the root of the mean kriging variance."""
        return sqrt(self.mean_kv)


@dataclass(frozen=True)
class Series:
    """A survey that was given a number of samples.

    Attributes
    ----------
    budget
        The samples it was given.
    snapshots
        Where it stood after each sample, from its second on.
    decision_s
        Processor time in s from a report to the next stop, mean over the survey; NaN where it was
        not measured. It differs from run to run, and equal surveys may differ in it.
    """

    budget: int
    snapshots: tuple[Snapshot, ...]
    decision_s: float = field(default=nan, compare=False)

    def at(self, n: int) -> Snapshot:
        """Where it stood after a number of samples."""
        return next(each for each in self.snapshots if each.n == n)


@dataclass(frozen=True)
class Result:
    """What became of a task: one survey, or one for each number of samples, ascending."""

    task: Task
    series: tuple[Series, ...]

    @property
    def longest(self) -> Series:
        """The survey of most samples."""
        return self.series[-1]

    @property
    def marks(self) -> tuple[Snapshot, ...]:
        """Where surveys stood at the setting's numbers of samples."""
        numbers = self.task.setting.samples
        return tuple(s.at(n) for s, n in zip(self._marked, numbers, strict=True))

    @property
    def decision_s(self) -> tuple[float, ...]:
        """Processor time a decision in s, of the survey of each of :attr:`marks`."""
        return tuple(series.decision_s for series in self._marked)

    @property
    def _marked(self) -> tuple[Series, ...]:
        """Of each number of samples, the survey that was given it, or else the longest.

        An agent that knows its budget goes elsewhere with another.
        """
        own = {series.budget: series for series in self.series}
        return tuple(own.get(n, self.longest) for n in self.task.setting.samples)


def soil_rng(seed: int, number: int) -> np.random.Generator:
    """Source of the soil of a field."""
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(number, _SOIL)))


def hand_rng(seed: int, number: int) -> np.random.Generator:
    """Source of where a survey by hand probes a field."""
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(number, _HAND)))


def survey_seed(seed: int, number: int) -> int:
    """Seed of the surveys of a field."""
    sequence = np.random.SeedSequence(seed, spawn_key=(number, _SURVEY))
    return int(sequence.generate_state(1)[0])


def tasks_of(setting: Setting, fields: int, entrants: tuple[Entrant, ...]) -> tuple[Task, ...]:
    """All tasks of a benchmark, field by field."""
    return tuple(Task(setting, k, entrant) for k in range(fields) for entrant in entrants)


def entrants_of(strategies: tuple[str, ...], estimators: tuple[str, ...]) -> tuple[Entrant, ...]:
    """Strategies with each of the estimators; without any, each with its own.

    The paper's strategies then work with ``paper-10`` and all others with ``pmc``.

    Raises
    ------
    ParameterError
        If a strategy or estimator is unknown, or a pair comes twice.

    Examples
    --------
    >>> entrants_of(("random", "greedy"), ())[0]
    Entrant(strategy='random', estimator='paper-10')
    """
    entrants = tuple(
        Entrant(strategy, estimator)
        for strategy in strategies
        for estimator in estimators or (_own_estimator(strategy),)
    )
    for k, entrant in enumerate(entrants):
        strategy_named(entrant.strategy, allowed=Allowed.by_name(entrant.strategy))
        estimator_named(entrant.estimator, allowed=Allowed.by_name(entrant.estimator))
        if entrant in entrants[:k]:
            raise ParameterError(
                f"{entrant.strategy} with {entrant.estimator} comes twice",
                where="--strategies",
                remedy="name each once",
            )
    return entrants


def _own_estimator(strategy: str) -> str:
    return "paper-10" if strategy in PAPER_STRATEGIES else "pmc"
