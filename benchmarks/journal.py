"""Workloads of the survey file: recording readings into it, and verifying it."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable
from functools import cache
from math import dist
from pathlib import Path

import numpy as np

from benchmarks.workloads import Result
from subsoil.agent import Arrival, Assignment, Push, drive
from subsoil.journal import create, verify
from subsoil.land.field import Field
from subsoil.layers import Layers
from subsoil.penetrometer import SMALL_CONE
from subsoil.reports import Place, Reading
from subsoil.survey import LocalDispatch, Settings, Survey, fold, opening
from subsoil.survey.events import Configured, Event

FOLDER = tempfile.TemporaryDirectory()
"""Goes with the process."""
FIELD = Field.from_metres([(0, 0), (240, 0), (240, 240), (0, 240)])


class Reader:
    """Robot that reads 300 forces at every stop."""

    def __init__(self) -> None:
        self.at: Place = (0.0, 0.0)
        self.depth = tuple(np.linspace(0.001, 0.4, 300).tolist())

    def go_to(self, stop: Assignment) -> Arrival:
        """Drive straight."""
        metres = dist(self.at, stop.at)
        self.at = stop.at
        return Arrival(stop.at, metres, metres)

    def probe(self) -> Push:
        """Read a soil that hardens with depth and to the east."""
        force = tuple(100 + self.at[0] + 400 * depth for depth in self.depth)
        return Push(self.at, Reading(depth_m=self.depth, force_n=force), 50.0)

    def stop(self) -> None:
        """Stay."""


def surveyed(readings: int, path: Path, record: Callable[[float], object]) -> Survey:
    """Survey into a file; told the processor time that keeping each event takes."""
    opened = opening(FIELD, Layers((0.0, 0.2, 0.4)), SMALL_CONE)
    settings = Settings(start=(0.0, 0.0), strategy="random", samples=readings, refit_every=100_000)
    with create(path, opened) as journal:
        dispatch = LocalDispatch(fold(journal.events()), Timed(journal.append, record))
        dispatch.record(Configured(settings=settings))
        dispatch.join("reader")
        drive("reader", Reader(), dispatch)
    return dispatch.survey


class Timed:
    """Recorder that says what keeping an event took."""

    def __init__(
        self, keep: Callable[[Event, Survey], None], record: Callable[[float], object]
    ) -> None:
        self._keep, self._record = keep, record

    def append(self, event: Event, survey: Survey) -> None:
        """Keep an event."""
        before = time.process_time()
        self._keep(event, survey)
        self._record(time.process_time() - before)


@cache
def _survey_of(readings: int) -> tuple[Path, float, float]:
    """A survey file, the time it took to make, and that of keeping an event at its end."""
    path = Path(FOLDER.name) / "survey.gpkg"
    times: list[float] = []
    before = time.process_time()
    surveyed(readings, path, times.append)
    return path, time.process_time() - before, float(np.median(times[-200:]))


def build(readings: int) -> Result:
    """Survey with so many readings, into a file."""
    _, seconds, _ = _survey_of(readings)
    return Result(seconds, note="kriging, planning and the file; processor time")


def event(readings: int) -> Result:
    """Keep one event when there are so many readings."""
    _, _, seconds = _survey_of(readings)
    return Result(seconds, goal="<= 0.005 s", note="median of the last 200; processor time")


def check(readings: int) -> Result:
    """Verify a file of so many readings."""
    path, _, _ = _survey_of(readings)
    before = time.process_time()
    assert verify(path).findings == ()
    return Result(time.process_time() - before, note="processor time")
