"""What an agent may ask of a survey, and the stop that it gets."""

from __future__ import annotations

from subsoil.errors import ReportError, brief, listed
from subsoil.outcomes import Assignment
from subsoil.reports import Sampled
from subsoil.survey.agents import Lease
from subsoil.survey.state import Survey


def check_here(survey: Survey, agent: str) -> None:
    """Check that an agent is at work.

    Raises
    ------
    ReportError
        If it never joined, or left.
    """
    here = [each.name for each in survey.agents if each.here]
    if agent not in here:
        raise ReportError(
            f"agent {brief(agent)!r} is not at work on the survey",
            where=survey.name,
            remedy=f"join first; there are {listed(here) or 'no agents'}",
        )


def check_own(survey: Survey, agent: str, assignment: str) -> None:
    """Check that an assignment is an agent's.

    Raises
    ------
    ReportError
        If it is not, or the agent is not at work.
    """
    check_here(survey, agent)
    if not any(lease.id == assignment for lease in survey.agent(agent).leases):
        raise ReportError(
            f"{brief(agent)!r} does not hold the assignment {brief(assignment)!r}",
            where=survey.name,
            remedy="only the agent that holds a stop gives it back or leaves it out",
        )


def check_decided(survey: Survey) -> None:
    """Check that stops can be handed out.

    Raises
    ------
    ReportError
        If nobody decided how to survey.
    """
    if not survey.method:
        raise ReportError(
            "nobody decided how to survey: with which strategy, and how far",
            where=survey.name,
            remedy="record a Configured first, as subsoil run does",
        )


def reading_that_counts(survey: Survey, report: str) -> Sampled:
    """The reading of a report's id.

    Raises
    ------
    ReportError
        If there is no such reading.
    """
    try:
        return survey.reading(report)
    except KeyError:
        raise ReportError(
            f"there is no reading {brief(report)!r} that counts",
            where=survey.name,
            remedy="give the id of a row of the layer samples",
        ) from None


def assignment_of(survey: Survey, lease: Lease) -> Assignment:
    """What an agent is told of a stop that is its to make."""
    field = survey.field
    east, north = survey.access.at[lease.cell].tolist()
    lonlat = None
    if field.crs:
        ((longitude, latitude),) = field.to_lonlat((east, north)).tolist()
        lonlat = (longitude, latitude)
    return Assignment(
        lease.id, lease.number, lease.cell, (east, north), field.crs, lonlat,
        lease.pushes, lease.made,
    )  # fmt: skip
