"""Agents: what a survey asks of a robot or a person, and what they ask of a survey.

A robot is three methods: go to a stop, push the rod, stop. A dispatch hands out stops and takes
reports. Everything a robot does leaves as a value; a place it cannot reach and a push it cannot
make are values too, not exceptions. :func:`drive` joins the two; the same few lines drive a
simulated robot, a real one or a person.

Importing this module loads neither numpy nor any geometry, so that it runs beside ROS.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Protocol

from pydantic import ValidationError

from subsoil.errors import ReportError
from subsoil.outcomes import Arrival, Assignment, Done, Push, Refusal, Unreachable, Wait
from subsoil.reports import STOPPED, Refused, Report, Sampled, Source

__all__ = [
    "Arrival",
    "Assignment",
    "Dispatch",
    "Done",
    "Push",
    "Refusal",
    "Robot",
    "Unreachable",
    "Wait",
    "drive",
]


class Robot(Protocol):
    """A carrier of a penetrometer."""

    def go_to(self, stop: Assignment) -> Arrival | Unreachable:
        """Drive to a stop.

        Raises
        ------
        RobotError
            If it cannot go on at all.
        """

    def probe(self) -> Push | Refusal:
        """Push the rod in here, with as many retries as it takes or the machine allows.

        Called again before driving elsewhere, it makes a further push beside the holes so far.
        """

    def stop(self) -> None:
        """Come to rest and stay.

        May be called from another thread, or a signal, while the robot drives or probes: that
        call then returns within a second, ``Unreachable`` or ``Refusal`` with the reason
        :data:`subsoil.reports.STOPPED`.
        """


class Dispatch(Protocol):
    """Hands out stops and takes reports."""

    def assign(self, agent: str, ahead: int = 1) -> Assignment | Wait | Done:
        """Next stop of an agent, and as many after it as to have some ahead in all."""

    def report(self, report: Report) -> None:
        """Take what an agent did; returns when it cannot be lost any more.

        Raises
        ------
        ReportError
            If it cannot be true; nothing is kept of it.
        """


def drive(
    agent: str,
    robot: Robot,
    dispatch: Dispatch,
    *,
    source: Source | None = None,
    sleep: Callable[[float], None] = time.sleep,
) -> str:
    """Work on a survey until there is nothing left to do; returns why.

    Every push is reported before the next is made. A refusal ends its stop, as does a report that
    is not taken: the survey then goes on elsewhere. However this ends, the robot is stopped.

    Parameters
    ----------
    agent
        Name of the agent.
    robot
        What carries the penetrometer.
    dispatch
        Who says where to go and takes the reports.
    source
        What its reports are said to come from. Default: a robot.
    sleep
        How to wait.

    Raises
    ------
    RobotError
        If the robot cannot go on; everything reported before is kept.
    """
    work = _Work(agent, robot, dispatch, source or Source())
    try:
        while not isinstance(answer := dispatch.assign(agent), Done):
            if isinstance(answer, Wait):
                sleep(answer.seconds)
            elif not work.do(answer):
                return STOPPED
        return answer.reason
    finally:
        robot.stop()


@dataclass(frozen=True)
class _Work:
    """An agent at work."""

    agent: str
    robot: Robot
    dispatch: Dispatch
    source: Source

    def do(self, stop: Assignment) -> bool:
        """Make a stop and report on it; whether to go on."""
        arrival = self.robot.go_to(stop)
        if isinstance(arrival, Unreachable):
            if arrival.reason == STOPPED:
                return False
            self._tell(stop, partial(self.unreached, stop, arrival))
            return True
        for _ in range(stop.made, stop.pushes):
            outcome = self.robot.probe()
            if isinstance(outcome, Refusal) and outcome.reason == STOPPED:
                return False
            taken = self._tell(stop, partial(self.outcome, stop, arrival, outcome))
            if isinstance(outcome, Refusal) or not taken:
                break
            arrival = replace(arrival, metres=0.0, seconds=0.0)
        return True

    def _tell(self, stop: Assignment, report: Callable[[], Report]) -> bool:
        """Report; if that is not taken, report so, and say that it was not."""
        try:
            self.dispatch.report(report())
        except ReportError as error:
            why = error.what
        except ValidationError as error:
            first = error.errors()[0]
            why = f"{'.'.join(map(str, first['loc']))}: {first['msg']}"
        else:
            return True
        self.dispatch.report(self._untaken(stop, why))
        return False

    def outcome(self, stop: Assignment, arrival: Arrival, outcome: Push | Refusal) -> Report:
        """What happened at a stop."""
        seconds = arrival.seconds + outcome.seconds
        if isinstance(outcome, Push):
            return Sampled(
                agent=self.agent, assignment=stop.id, source=self.source, at=outcome.at,
                frame=arrival.frame, accuracy_m=arrival.accuracy_m, metres=arrival.metres,
                seconds=seconds, tries=outcome.tries, reading=outcome.reading,
            )  # fmt: skip
        return Refused(
            agent=self.agent, assignment=stop.id, source=self.source, at=arrival.at,
            frame=arrival.frame, accuracy_m=arrival.accuracy_m, metres=arrival.metres,
            seconds=seconds, tries=outcome.tries, reason=outcome.reason,
        )  # fmt: skip

    def unreached(self, stop: Assignment, arrival: Unreachable) -> Report:
        """A stop that the robot did not get to."""
        return Refused(
            agent=self.agent, assignment=stop.id, source=self.source, at=arrival.at,
            frame=arrival.frame, metres=arrival.metres, seconds=arrival.seconds, tries=0,
            reason=arrival.reason, cause="unreachable",
        )  # fmt: skip

    def _untaken(self, stop: Assignment, why: str) -> Report:
        """A stop whose report could not be true: of its numbers none is believed."""
        return Refused(
            agent=self.agent, assignment=stop.id, source=self.source, at=stop.at,
            reason=f"its report was not taken: {why}", cause="report",
        )  # fmt: skip
