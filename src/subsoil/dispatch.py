"""Who goes where next: the seam between a survey and the agents that work on it.

An agent asks, goes, probes and reports; the same few lines drive a simulated robot, a real one or
a person.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Protocol

from subsoil.errors import CorruptJournalError
from subsoil.events import Event, Refused, Report, Sampled
from subsoil.robot import Arrival, Push, Refusal, Robot
from subsoil.sequel import next_event
from subsoil.survey import Survey, apply


@dataclass(frozen=True)
class Assignment:
    """The next stop of an agent.

    Attributes
    ----------
    cell
        Index of the cell to probe.
    at
        Its centre, easting and northing in m.
    step
        Number of stops the survey had when it was assigned.
    pushes
        How often to push the rod there.
    """

    cell: int
    at: tuple[float, float]
    step: int
    pushes: int = 1


@dataclass(frozen=True)
class Over:
    """There is nothing left to do, and why."""

    reason: str


class Dispatch(Protocol):
    """Hands out stops and takes reports."""

    def assign(self, agent: str) -> Assignment | Over:
        """Next stop of an agent."""

    def report(self, report: Report) -> None:
        """Take what an agent did; returns when it cannot be lost any more."""


class Recorder(Protocol):
    """Keeps events."""

    def append(self, event: Event, survey: Survey) -> None:
        """Keep an event, with the state after it; returns when it cannot be lost any more."""


Observer = Callable[[Survey, Event], None]
"""Told of every event and the state after it."""


class LocalDispatch:
    """Dispatch of a survey in this process.

    Parameters
    ----------
    survey
        State to go on from.
    recorder
        Where events go before anything else happens.
    observe
        Told of every event once it is kept.
    """

    def __init__(
        self, survey: Survey, recorder: Recorder, observe: Observer = lambda *_: None
    ) -> None:
        self.survey = survey
        self._recorder = recorder
        self._observe = observe

    def record(self, event: Event) -> None:
        """Take an event into account: keep it first, then tell."""
        survey = apply(self.survey, event)
        if survey is self.survey:
            return
        self._recorder.append(event, survey)
        self.survey = survey
        self._observe(survey, event)

    def assign(self, agent: str) -> Assignment | Over:  # noqa: ARG002 - one agent, so far
        """Next stop: whatever is due in the survey happens first.

        A stop that was left before all its pushes were made is handed out again for the rest.
        """
        while (event := next_event(self.survey)) is not None:
            self.record(event)
        if self.survey.finished:
            return Over(self.survey.finished)
        cell, pushes = self.survey.next_stop
        east, north = self.survey.field.cells[cell].tolist()
        return Assignment(cell, (east, north), self.survey.step, pushes)

    def report(self, report: Report) -> None:
        """Take what an agent did; a report that came before is not taken twice."""
        if not 0 <= report.cell < len(self.survey.field.cells):
            raise CorruptJournalError(f"a report on cell {report.cell}, which does not exist")
        self.record(report)


def drive(agent: str, robot: Robot, dispatch: Dispatch) -> str:
    """Work on a survey until there is nothing left to do; returns why.

    Every push is reported before the next is made. A refusal ends its stop.

    Parameters
    ----------
    agent
        Name of the agent.
    robot
        What carries the penetrometer.
    dispatch
        Who says where to go and takes the reports.

    Raises
    ------
    RobotError
        If the robot cannot go on; everything reported before is kept.
    """
    while isinstance(assignment := dispatch.assign(agent), Assignment):
        arrival = robot.go_to(assignment.at)
        for _ in range(assignment.pushes):
            outcome = robot.probe()
            dispatch.report(report_of(agent, assignment, arrival, outcome))
            if isinstance(outcome, Refusal):
                break
            arrival = replace(arrival, metres=0.0, seconds=0.0)
    robot.stop()
    return assignment.reason


def report_of(
    agent: str, assignment: Assignment, arrival: Arrival, outcome: Push | Refusal
) -> Report:
    """What happened at a stop, as the event to report."""
    seconds = arrival.seconds + outcome.seconds
    match outcome:
        case Push():
            return Sampled(
                agent=agent,
                cell=assignment.cell,
                at=outcome.at,
                depth_m=tuple(outcome.insertion.depth_m.tolist()),
                force_n=tuple(outcome.insertion.force_n.tolist()),
                ending=outcome.insertion.ending,
                metres=arrival.metres,
                seconds=seconds,
                tries=outcome.tries,
            )
        case Refusal():
            return Refused(
                agent=agent,
                cell=assignment.cell,
                at=arrival.at,
                reason=outcome.reason,
                metres=arrival.metres,
                seconds=seconds,
                tries=outcome.tries,
            )
