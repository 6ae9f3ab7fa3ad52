"""Work of a person on a survey: what is typed in, with way and time by the survey's pace."""

from __future__ import annotations

from math import hypot

from subsoil.registry import NOBODY, Allowed
from subsoil.reports import Place, Reading, Refused, Sampled, Source
from subsoil.survey.agents import Lease
from subsoil.survey.decide import settled
from subsoil.survey.dispatch import LocalDispatch
from subsoil.survey.state import Survey
from subsoil.survey.stops import far

PERSON = Source(kind="person")


def taken(survey: Survey, agent: str, reading: Reading, at: Place) -> Sampled:
    """Report of a push that a person made at a place in the field's frame.

    It is of the stop that the person was sent to if it is near that, and of none elsewhere.
    """
    lease = lease_near(survey, agent, at)
    metres, seconds = spent(survey, agent, at, further=lease is not None and lease.made > 0)
    return Sampled(
        agent=agent, assignment=lease.id if lease else "", source=PERSON, at=at,
        metres=metres, seconds=seconds, reading=reading,
    )  # fmt: skip


def stone(survey: Survey, agent: str, lease: Lease, depth_m: float | None = None) -> Refused:
    """Report that a stone keeps the rod out at a stop."""
    east, north = survey.access.at[lease.cell].tolist()
    metres, seconds = spent(survey, agent, (east, north), further=lease.made > 0)
    reason = "a stone" if depth_m is None else f"a stone at {100 * depth_m:g} cm"
    return Refused(
        agent=agent, assignment=lease.id, source=PERSON, at=(east, north),
        metres=metres, seconds=seconds, reason=reason,
    )  # fmt: skip


def lease_near(survey: Survey, agent: str, at: Place) -> Lease | None:
    """The stop that an agent was sent to and that a place is near enough to count for."""
    for lease in survey.agent(agent).leases:
        if not far(survey, at, None, lease.cell):
            return lease
    return None


def spent(survey: Survey, agent: str, at: Place, *, further: bool) -> tuple[float, float]:
    """Way in m and time in s from where an agent was, and of a push there."""
    here, pace = survey.agent(agent).position, survey.settings.pace
    metres = hypot(at[0] - here[0], at[1] - here[1])
    return metres, metres / pace.speed_mps + (pace.push_s if further else pace.stop_s)


def settle(dispatch: LocalDispatch, allowed: Allowed = NOBODY) -> None:
    """Record what follows from a survey as it is: fits, the plan, whether there is enough."""
    for event in settled(dispatch.survey, allowed)[1]:
        dispatch.record(event)
