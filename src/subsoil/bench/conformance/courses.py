"""Whole surveys of make-believe fields, for rules to look at; the loop is the real one."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from functools import cache
from math import hypot, nan
from types import MappingProxyType
from typing import Literal

import numpy as np

from subsoil.agent import Arrival, Assignment, Push, Refusal, drive
from subsoil.arrays import Floats
from subsoil.bench.timing import Stopwatch, TimedDispatch
from subsoil.errors import ParameterError
from subsoil.land.field import Field
from subsoil.layers import Layers
from subsoil.penetrometer import LARGE_CONE
from subsoil.registry import NOBODY, Allowed
from subsoil.reports import Place, Reading
from subsoil.survey import LocalDispatch, Settings, Survey, opened, opening
from subsoil.survey.events import Configured, Event, Planned

LAYERS = Layers((0.0, 0.2, 0.4))
START = (0.0, 0.0)

Soil = Callable[[float, float], Floats]
"""From easting and northing in m to the kPa of each layer."""
Ground = Literal["soft", "hard"]


@cache
def fields() -> Mapping[str, Field]:
    """Fields of several shapes by name."""
    square = [(20, 20), (60, 20), (60, 50), (20, 50)]
    return MappingProxyType(
        {
            "test bed": Field.from_metres([(0, 0), (180, 0), (180, 130), (0, 130)]),
            "L": Field.from_metres([(0, 0), (90, 0), (90, 30), (30, 30), (30, 80), (0, 80)]),
            "keep-out": Field.from_metres([(0, 0), (80, 0), (80, 70), (0, 70)], keep_outs=[square]),
            "tiny": Field.from_metres([(0, 0), (15, 0), (15, 10), (0, 10)]),
            "thin": Field.from_metres([(0, 0), (200, 0), (200, 5), (0, 5)]),
        }
    )


def waves(east: float, north: float) -> Floats:
    """KPa of two layers: waves of 40 to 90 m, and a ripple from cell to cell."""
    wave = np.sin(east / 14.0) * np.cos(north / 9.0) + 0.6 * np.sin((east + 2 * north) / 11.0)
    ripple = 0.3 * np.sin(1.7 * east + 0.9 * north)
    return np.array([900.0 + 150.0 * (wave + ripple), 1700.0 + 250.0 * (wave - ripple)])


@dataclass
class Reader:
    """Robot that reads the soil straight and refuses in stony cells."""

    field: Field
    position: Place = START
    soil: Soil = waves
    stony: Collection[int] = ()
    ground: Ground = "soft"

    def go_to(self, stop: Assignment) -> Arrival:
        """Drive to a stop the straight way."""
        metres = hypot(stop.at[0] - self.position[0], stop.at[1] - self.position[1])
        self.position = stop.at
        return Arrival(stop.at, metres, metres)

    def probe(self) -> Push | Refusal:
        """Read the soil where it stands; 2 cm of it where the ground is hard."""
        if self.field.nearest_cell(self.position) in self.stony:
            return Refusal("a stone", 50.0, 4)
        if self.ground == "hard":
            shallow = Reading(depth_m=(0.01, 0.02), force_n=(300.0, 600.0), ending="force")
            return Push(self.position, shallow, 50.0)
        depth, force = LAYERS.bottom_m, self.soil(*self.position) * LARGE_CONE.area_mm2 / 1000.0
        reading = Reading(depth_m=tuple(depth.tolist()), force_n=tuple(force.tolist()))
        return Push(self.position, reading, 50.0)

    def stop(self) -> None:
        """Stay."""


@dataclass
class Course:
    """Recorder that keeps each event with the state before it.

    Attributes
    ----------
    state
        The survey by now.
    steps
        States, each with the event that followed.
    decision_s
        Mean processor time of a decision in s; NaN while it is under way.
    """

    state: Survey
    steps: list[tuple[Survey, Event]] = field(default_factory=list)
    decision_s: float = nan

    def append(self, event: Event, survey: Survey) -> None:
        """Keep an event.

        Raises
        ------
        ParameterError
            If there are more than twenty, and three a cell: the survey has no end.
        """
        if len(self.steps) >= 20 + 3 * len(survey.field.cells):
            raise ParameterError(
                f"the survey goes round in circles: {len(self.steps)} events and no end",
                where=f"strategy {survey.settings.strategy}",
                remedy="plan cells that are free, and nothing once there are none",
            )
        self.steps.append((self.state, event))
        self.state = survey

    @property
    def plans(self) -> list[tuple[Survey, Planned]]:
        """Plans, each with the state that it was made in."""
        return [(before, event) for before, event in self.steps if isinstance(event, Planned)]


def laid_down(before: Survey, event: Planned) -> tuple[int, ...]:
    """Cells of a plan: those of the last one where it was kept."""
    return before.plan.cells if event.kept else event.cells


def how(
    strategy: str,
    samples: int,
    seed: int = 1,
    settings: dict[str, float | str] | None = None,
    estimator: str = "paper-10",
) -> Configured:
    """Decision on how to survey."""
    decided = Settings(
        strategy=strategy, strategy_settings=settings or {}, estimator=estimator, seed=seed,
        start=START, samples=samples,
    )  # fmt: skip
    return Configured(settings=decided)


def driven(
    land: Field,
    *configured: Configured,
    allowed: Allowed = NOBODY,
    soil: Soil = waves,
    stony: Collection[int] = (),
    ground: Ground = "soft",
) -> Course:
    """A whole survey; with several configurations, one after the other."""
    course = Course(opened(opening(land, LAYERS, LARGE_CONE)))
    dispatch = LocalDispatch(course.state, course, allowed=allowed)
    dispatch.join("reader")
    timed = TimedDispatch(dispatch, aside=Stopwatch())
    for event in configured:
        dispatch.record(event)
        robot = Reader(land, dispatch.survey.position, soil, stony, ground)
        drive("reader", robot, timed)
    course.decision_s = timed.decision_s
    return course
