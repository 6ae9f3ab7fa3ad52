"""Who goes where next: a survey in this process, and the agents that work on it.

What follows from a survey alone is decided outside any lock, and kept only if nothing came
between: reports are acknowledged meanwhile. A decision that was overtaken twice is made with the
reports waiting.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from threading import RLock

from subsoil.agent import Assignment, Done, Wait
from subsoil.errors import ReportError
from subsoil.registry import NOBODY, Allowed
from subsoil.reports import Kind, Refused, Report, Sampled, Source
from subsoil.survey.admission import admitted, check_name
from subsoil.survey.decide import settled
from subsoil.survey.events import (
    Amended,
    Assigned,
    BatterySwapped,
    Event,
    Joined,
    Left,
    Released,
    Simulation,
    Withdrawn,
)
from subsoil.survey.fold import apply
from subsoil.survey.recorder import Observer, Recorder
from subsoil.survey.requests import (
    assignment_of,
    check_decided,
    check_here,
    check_own,
    reading_that_counts,
)
from subsoil.survey.state import Survey

_OVERTAKEN = 2
"""Decisions made while reports come in, before one is made with them waiting."""


def utc_now() -> datetime:
    """Time of this machine."""
    return datetime.now(UTC)


class LocalDispatch:
    """Dispatch of a survey in this process; safe to call from several threads.

    Parameters
    ----------
    survey
        State to go on from.
    recorder
        Where events go before anything else happens.
    observe
        Told of every event once it is kept.
    allowed
        Modules whose strategies may be run, beside the registered ones.
    patience
        Time after which a stop that nothing was heard of is handed out again. Default: never.
    now
        What time it is.
    """

    def __init__(
        self,
        survey: Survey,
        recorder: Recorder,
        observe: Observer = lambda *_: None,
        *,
        allowed: Allowed = NOBODY,
        patience: timedelta | None = None,
        now: Callable[[], datetime] = utc_now,
    ) -> None:
        self.survey = survey
        self._recorder = recorder
        self._observe = observe
        self._allowed = allowed
        self._patience = patience
        self._now = now
        self._since: dict[str, datetime] = {}
        self._lock = RLock()
        self._deciding = RLock()

    def record(self, event: Event) -> None:
        """Take an event into account: keep it first, then tell."""
        with self._lock:
            stamped = event.stamped(self._now())
            survey = apply(self.survey, stamped)
            if survey is self.survey and event.id in survey.known:
                return
            self._recorder.append(stamped, survey)
            self.survey = survey
            self._observe(survey, stamped)

    def join(
        self, agent: str, kind: Kind = "robot", *, simulation: Simulation | None = None
    ) -> None:
        """Let an agent work on the survey; nothing happens if it does already.

        Raises
        ------
        ReportError
            If its name cannot be told from others, or it is simulated and the others are not, or
            the other way round.
        """
        check_name(agent)
        with self._lock:
            if any(each.kind != kind for each in self.survey.agents if each.name == agent):
                raise ReportError(f"{agent!r} is another kind of agent", where=self.survey.name)
            kinds = {each.kind for each in self.survey.agents} | {kind}
            if len(kinds) > 1 and "simulator" in kinds:
                raise ReportError(
                    "simulated and real agents do not work on one survey",
                    where=self.survey.name,
                    remedy="start a survey of its own for the simulation",
                )
            if not any(each.name == agent and each.here for each in self.survey.agents):
                self.record(Joined(agent=agent, source=kind, simulation=simulation))

    def leave(self, agent: str, reason: str = "") -> None:
        """Let an agent go; what it was to do is open again."""
        with self._lock:
            check_here(self.survey, agent)
            self.record(Left(agent=agent, reason=reason))

    def swap_battery(self, agent: str) -> None:
        """Note that an agent got a full battery."""
        with self._lock:
            check_here(self.survey, agent)
            self.record(BatterySwapped(agent=agent))

    def assign(self, agent: str, ahead: int = 1) -> Assignment | Wait | Done:
        """Next stop of an agent: what it was to do already, or the next of the plan.

        Whatever is due in the survey happens first. A stop that was left before all its pushes
        were made is handed out again for the rest.

        Raises
        ------
        ReportError
            If the agent never joined, or left, or asks for less than one stop, or nobody decided
            how to survey.
        """
        if ahead < 1:
            raise ReportError(
                f"{ahead} stops cannot be handed out",
                where=f"agent {agent}",
                remedy="ask for one or more",
            )
        if answer := self._known(agent, ahead):
            return answer
        with self._deciding:
            for _ in range(_OVERTAKEN):
                if answer := self._known(agent, ahead):
                    return answer
                before = self.survey
                _, events = settled(before, self._allowed)
                with self._lock:
                    if self.survey is before:
                        return self._decided(agent, ahead, events)
            with self._lock:
                _, events = settled(self.survey, self._allowed)
                return self._decided(agent, ahead, events)

    def _known(self, agent: str, ahead: int) -> Assignment | Done | None:
        """What an agent is to do, where nothing has to be decided for it."""
        with self._lock:
            check_here(self.survey, agent)
            check_decided(self.survey)
            self._release_lapsed()
            if self.survey.finished:
                return Done(self.survey.finished)
            return self._handed(agent) if self._has(agent, ahead) else None

    def report(self, report: Report) -> None:
        """Take what an agent did; one that came before is not taken twice.

        Raises
        ------
        ReportError
            If it cannot be true; nothing is kept of it.
        """
        with self._lock:
            if report.id not in self.survey.known:
                now = self._now()
                self.record(admitted(self.survey, report, now))
                self._since[report.assignment] = now

    def release(self, agent: str, assignment: str, reason: str) -> None:
        """Give a stop back; it is handed out again.

        Raises
        ------
        ReportError
            If it is not this agent's.
        """
        with self._lock:
            check_own(self.survey, agent, assignment)
            self.record(Released(agent=agent, assignment=assignment, reason=reason))

    def skip(self, agent: str, assignment: str, reason: str) -> None:
        """Leave a stop out; nobody is sent there again.

        Raises
        ------
        ReportError
            If it is not this agent's.
        """
        with self._lock:
            check_own(self.survey, agent, assignment)
            position = self.survey.agent(agent).position
            kind = self.survey.agent(agent).kind
            self.report(
                Refused(
                    agent=agent, assignment=assignment, source=Source(kind=kind), at=position,
                    tries=0, reason=reason, cause="skipped",
                )
            )  # fmt: skip

    def withdraw(self, report: str, reason: str) -> Sampled:
        """Let a reading count no more; returns it.

        Raises
        ------
        ReportError
            If there is no such reading.
        """
        with self._lock:
            reading = reading_that_counts(self.survey, report)
            self.record(Withdrawn(report=report, reason=reason))
            return reading

    def amend(self, report: str, by: Sampled, reason: str) -> None:
        """Put another report in the place of a reading.

        Raises
        ------
        ReportError
            If there is no such reading, or the other cannot be true.
        """
        with self._lock:
            reading_that_counts(self.survey, report)
            checked = admitted(self.survey, by, self._now())
            assert isinstance(checked, Sampled)
            self.record(Amended(report=report, reason=reason, by=checked))

    def _has(self, agent: str, ahead: int) -> bool:
        """Whether an agent has stops enough."""
        return len(self.survey.agent(agent).leases) >= ahead

    def _decided(
        self, agent: str, ahead: int, events: tuple[Event, ...]
    ) -> Assignment | Wait | Done:
        """Keep what was decided, and hand out stops to an agent that is still there."""
        check_here(self.survey, agent)
        for event in events:
            self.record(event)
        while not self.survey.finished and self.survey.plan.cells and not self._has(agent, ahead):
            plan = self.survey.plan
            pushes = plan.pushes[0] if plan.pushes else 1
            self.record(Assigned(agent=agent, cell=plan.cells[0], pushes=pushes))
        if self.survey.finished:
            return Done(self.survey.finished)
        if self.survey.agent(agent).leases:
            return self._handed(agent)
        return Wait("other agents are on their way to the last stops of the plan")

    def _handed(self, agent: str) -> Assignment:
        now = self._now()
        leases = self.survey.agent(agent).leases
        for lease in leases:
            self._since.setdefault(lease.id, now)
        first, *others = (assignment_of(self.survey, lease) for lease in leases)
        return replace(first, ahead=tuple(others))

    def _release_lapsed(self) -> None:
        """Release stops that nothing was heard of for too long."""
        if self._patience is None:
            return
        now = self._now()
        for each in self.survey.agents:
            for lease in each.leases:
                since = self._since.setdefault(lease.id, now)
                if now - since > self._patience:
                    reason = f"nothing was heard of it for {self._patience.total_seconds():g} s"
                    self.record(
                        Released(
                            agent=each.name, assignment=lease.id, reason=reason, cause="lapsed"
                        )
                    )
