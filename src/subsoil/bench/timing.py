"""Processor time of a survey's decisions."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from math import nan
from time import process_time

from subsoil.agent import Assignment, Dispatch, Done, Wait
from subsoil.reports import Report


@dataclass
class Stopwatch:
    """Processor time of this process in s, summed over the stretches that it ran.

    What other processes do on the same cores does not count, as it would on a clock.
    """

    seconds: float = 0.0

    @contextmanager
    def running(self) -> Iterator[None]:
        """Let it run."""
        begun = process_time()
        try:
            yield
        finally:
            self.seconds += process_time() - begun


@dataclass
class TimedDispatch:
    """Dispatch that measures how long it takes from a report to the next stop.

    Attributes
    ----------
    dispatch
        What decides.
    aside
        Watch of work in between that is not deciding, such as scoring.
    """

    dispatch: Dispatch
    aside: Stopwatch
    watch: Stopwatch = field(default_factory=Stopwatch)
    decisions: int = 0

    def assign(self, agent: str, ahead: int = 1) -> Assignment | Wait | Done:
        """Next stop of an agent."""
        self.decisions += 1
        with self.watch.running():
            return self.dispatch.assign(agent, ahead)

    def report(self, report: Report) -> None:
        """Take what an agent did."""
        with self.watch.running():
            self.dispatch.report(report)

    @property
    def decision_s(self) -> float:
        """Mean processor time of a decision in s; NaN before the first."""
        if not self.decisions:
            return nan
        return (self.watch.seconds - self.aside.seconds) / self.decisions
