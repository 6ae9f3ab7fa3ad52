"""What may enter a survey: every number an agent says is looked at here, and nowhere later.

A report that cannot be true is refused to its agent with the reason, and the survey goes on
without it. One that is only odd is kept, and flagged.
"""

from __future__ import annotations

from datetime import datetime, timedelta
from math import inf, isfinite

from subsoil.errors import BoundaryError, ReportError, brief, listed, printable
from subsoil.land.crs import named_crs, project
from subsoil.penetrometer import faults, flags_of
from subsoil.reports import Place, Report, Sampled
from subsoil.survey.state import NOWHERE, Survey, cell_of

OUTSIDE, CLOCK_OFF = "outside-the-field", "clock-off"
"""Flags of readings that lie in no cell, and of times that cannot be."""
_LONGEST_WAY_M, _LONGEST_TIME_S = 1e6, 30 * 86_400.0
"""More than any agent drives or spends between two reports."""
_FARTHEST_M = 1e8
"""More than any easting or northing on Earth."""
_LEAST_ACCURATE_M = 1e4
"""Standard deviation of a place that nobody who knows where he is reports."""
_LONGEST_NAME = 100
"""Letters of a name or an id; a UUID has 36."""
_AHEAD, _BEHIND = timedelta(hours=1), timedelta(days=3650)
"""How far a clock may be from the host's: readings are entered years later, not before."""


def admitted(survey: Survey, report: Report, now: datetime) -> Report:
    """The report as it is to be kept: in the field's frame, with its flags and a time.

    Parameters
    ----------
    survey
        State that it comes to.
    report
        What an agent says.
    now
        The host's time, for a report without one.

    Raises
    ------
    ReportError
        If it cannot be true, its agent never joined, or its place has no way to the field's frame.
    """
    _check_agent(survey, report)
    _check_ids(report)
    _check_numbers(report)
    if isinstance(report, Sampled):
        _check_further(report)
    report = report.model_copy(update={"at": _placed(survey, report), "frame": ""})
    if isinstance(report, Sampled):
        report = _flagged(survey, report, now)
    else:
        report = report.model_copy(update={"reason": printable(report.reason)})
    return report.stamped(now)


def check_name(name: str) -> None:
    """Check that an agent can be told from others by its name, wherever that is shown.

    Raises
    ------
    ReportError
        If it is empty or long, or has signs that cannot be seen or blanks that can be overlooked.
    """
    if fault := _unreadable(name):
        raise ReportError(
            f"the name {brief(name)!r} of an agent {fault}",
            where="agent",
            remedy="call it by letters, digits, signs and single blanks between them",
        )


def _unreadable(name: str) -> str:
    """Why a name cannot be read and told from others; empty if it can."""
    if not name:
        return "is empty"
    if len(name) > _LONGEST_NAME:
        return f"has {len(name)} letters, more than {_LONGEST_NAME}"
    if name != printable(name):
        return "has signs that cannot be printed, or blanks that cannot be seen"
    return ""


def _check_agent(survey: Survey, report: Report) -> None:
    names = [agent.name for agent in survey.agents]
    if report.agent not in names:
        raise ReportError(
            f"agent {brief(report.agent)!r} never joined the survey",
            where=survey.name,
            remedy=f"join first; there are {listed(names) or 'no agents'}",
        )
    if (report.source.kind == "simulator") != (survey.agent(report.agent).kind == "simulator"):
        raise ReportError(
            "simulated and real readings do not go into one survey",
            where=f"agent {report.agent}",
            remedy="start a survey of its own for the simulation",
        )


def _check_ids(report: Report) -> None:
    """Check what a report is told from others by; an assignment may be none."""
    if not report.id:
        raise ReportError(
            "it has no id, by which to tell it from the next",
            where=f"report of {report.agent}",
            remedy="give each report an id of its own",
        )
    for what, name in (("id", report.id), ("assignment", report.assignment)):
        if name and (fault := _unreadable(name)):
            raise ReportError(
                f"its {what} {brief(name)!r} {fault}",
                where=f"report of {report.agent}",
                remedy="give it as it was given out, or a UUID",
            )


def _check_numbers(report: Report) -> None:
    numbers = [
        ("a way", report.metres, 0.0, _LONGEST_WAY_M, "m"),
        ("a time", report.seconds, 0.0, _LONGEST_TIME_S, "s"),
        ("a number of tries", _float(report.tries), 0.0, 1e4, ""),
    ]
    if report.accuracy_m is not None:
        numbers.append(("an accuracy", report.accuracy_m, 0.0, _LEAST_ACCURATE_M, "m"))
    for name, value, least, most, unit in numbers:
        if not least <= value <= most:
            raise ReportError(
                f"{name} of {value:g} {unit}".rstrip() + " cannot be",
                where=f"report of {report.agent}",
                remedy="correct it, and report again",
            )


def _float(whole: int) -> float:
    """A whole number of any size."""
    try:
        return float(whole)
    except OverflowError:
        return inf if whole > 0 else -inf


def _check_further(report: Sampled) -> None:
    """Check what was measured beside resistance: it is kept, and one day mapped."""
    for quantity in report.reading.further:
        name, depth, values = quantity.name, quantity.depth_m, quantity.values
        if unreadable := _unreadable(name):
            fault = f"the name {brief(name)!r} of a quantity beside resistance {unreadable}"
        elif len(values) != (len(depth) or 1):
            fault = f"{len(values)} values of {name} do not pair with {len(depth) or 1} depths"
        elif not all(map(isfinite, (*depth, *values))):
            fault = f"values and depths of {name} are not all finite"
        else:
            continue
        raise ReportError(
            fault,
            where=f"report of {report.agent}",
            remedy="leave out values that were not taken",
        )


def _placed(survey: Survey, report: Report) -> Place:
    """Place of a report in the field's frame."""
    at = _projected(survey, report)
    if max(map(abs, at)) > _FARTHEST_M:
        raise ReportError(
            f"its place ({at[0]:g}, {at[1]:g}) is not on Earth",
            where=f"report of {report.agent}",
            remedy=f"give it in {survey.field.crs or 'metres'}, or name its frame",
        )
    return at


def _projected(survey: Survey, report: Report) -> Place:
    where = f"report of {report.agent}"
    east, north = report.at
    if not (isfinite(east) and isfinite(north)):
        raise ReportError(
            f"its place ({east:g}, {north:g}) is not finite",
            where=where,
            remedy="wait for a fix, and report again",
        )
    if report.frame in ("", survey.field.crs):
        return report.at
    try:
        if named_crs(report.frame, where).is_geographic and not (
            abs(east) <= 180 and abs(north) <= 90
        ):
            raise ReportError(f"longitude {east:g}, latitude {north:g} is no place", where=where)
        (moved,) = project(report.frame, survey.field.crs, [east], [north])
    except BoundaryError as error:
        raise ReportError(error.what, where=where, remedy=error.remedy) from error
    if not (isfinite(moved[0]) and isfinite(moved[1])):
        raise ReportError(
            f"({east:g}, {north:g}) in {brief(report.frame)} has no place in the field's frame",
            where=where,
        )
    return float(moved[0]), float(moved[1])


def _flagged(survey: Survey, report: Sampled, now: datetime) -> Sampled:
    """Sampled with what is odd about it among its flags."""
    if fault := faults(report.reading, survey.cone):
        raise ReportError(fault, where=f"report of {report.agent}", remedy="push again")
    flags = list(flags_of(report.reading))
    if cell_of(survey, report.at) == NOWHERE:
        flags.append(OUTSIDE)
    if report.time is not None and not now - _BEHIND <= report.time <= now + _AHEAD:
        flags.append(CLOCK_OFF)
    reading = report.reading.model_copy(
        update={"flags": tuple(dict.fromkeys(map(printable, flags)))}
    )
    return report.model_copy(update={"reading": reading})
