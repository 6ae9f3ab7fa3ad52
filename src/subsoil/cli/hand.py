"""Verbs of a survey by hand: where next, what was read there, and what was not."""

from __future__ import annotations

from collections.abc import Mapping
from math import hypot, isnan, sqrt
from pathlib import Path
from typing import Annotated, Any

import typer

from subsoil.agent import Assignment, Done, Wait
from subsoil.cli.at_work import HAND, AgentName, at_work, lease_of
from subsoil.cli.found import said
from subsoil.cli.limits import LimitOptions
from subsoil.cli.options import Allow, MethodOptions, SurveyFile
from subsoil.cli.output import AsJson, Shown, say, tell, working
from subsoil.cli.pace import PaceOptions
from subsoil.cli.parsing import FIELD, WAY, grouped
from subsoil.cli.places import bearing, check_on_field, in_words, place_of, way_in_words
from subsoil.cli.stops import Write, ahead_of, row_of, stop_of, written
from subsoil.cli.typed import TypedOptions, depth_m, typing_doubts
from subsoil.io.write.stops import check_stops_file
from subsoil.penetrometer import profile_of
from subsoil.report.wording import in_units
from subsoil.reports import Place, Sampled
from subsoil.survey import LocalDispatch, Survey, sample_of
from subsoil.survey.by_hand import stone as stone_at
from subsoil.survey.by_hand import taken
from subsoil.survey.outlook import in_words as outlook_in_words
from subsoil.survey.outlook import outlook
from subsoil.units import SYSTEMS, System


def at_option(default: str) -> Any:
    """Option of where a reading was taken."""
    return typer.Option(
        "--at",
        metavar="LAT,LON",
        help="Where it was; easting,northing in a local frame.",
        show_default=default,
        rich_help_panel=FIELD,
    )


@grouped
def next_stop(
    survey: SurveyFile,
    method: MethodOptions,
    limits: LimitOptions,
    pace: PaceOptions,
    agent: AgentName = HAND,
    here: Annotated[
        str | None,
        typer.Option(
            "--from",
            metavar="LAT,LON",
            help="Where you are.",
            show_default="where you were last",
            rich_help_panel=WAY,
        ),
    ] = None,
    write: Write = None,
    units: Shown = "metric",
    as_json: AsJson = False,
) -> None:
    """Say where to push next, how to get there and why, or that there is enough."""
    at_the_stop = at_work(survey, agent, method, limits, pace, decide=False)
    with at_the_stop as dispatch, working("planning"):
        at = place_of(here, dispatch.survey.field, "--from") if here else None
        if write is not None:
            check_stops_file(write, dispatch.survey.field)
        answer = dispatch.assign(agent)
    state = dispatch.survey
    result: dict[str, object] = {"survey": survey, "agent": agent}
    if isinstance(answer, Assignment):
        result |= _way(state, answer, at or state.agent(agent).position)
    if write is not None and not isinstance(answer, Done):
        result["written"] = written(write, state, ahead_of(state, agent))
    result |= {"finished": state.finished or "no", **_standing(state)}
    if as_json:
        tell(result, as_json)
        return
    _say_next(survey, state, answer, at or state.agent(agent).position, units)


def _way(survey: Survey, stop: Assignment, here: Place) -> dict[str, object]:
    """A stop to make, as JSON says it."""
    return {
        "stop": {"number": stop.number + 1, **row_of(survey.field, stop.cell, stop.at)},
        "pushes": stop.pushes - stop.made,
        "metres": hypot(stop.at[0] - here[0], stop.at[1] - here[1]),
        "bearing_deg": bearing(here, stop.at),
        "why": _why(survey, stop.cell, "metric"),
    }


def _say_next(
    path: Path, survey: Survey, answer: Assignment | Wait | Done, here: Place, units: System
) -> None:
    """Say in sentences what to do."""
    enough = in_units(survey, outlook(survey), SYSTEMS[units])
    if isinstance(answer, Done):
        if len(survey.visited) + len(survey.refused) >= len(survey.field.cells):
            say(f"There is nothing left to do: {answer.reason}. {enough}")
            return
        say(f"There is enough: {answer.reason}. {enough}")
        say(f"To go on all the same: subsoil next {path} --samples {survey.taken + 6}")
    elif isinstance(answer, Wait):
        say(f"Nothing for you now: {answer.reason}.")
    else:
        place = in_words(answer.at, survey.field)
        say(f"Stop {answer.number + 1}: {place}, {way_in_words(here, answer.at, SYSTEMS[units])}.")
        if (pushes := answer.pushes - answer.made) > 1:
            say(f"Push {pushes} times there, a step apart.")
        say(f"Why there: {_why(survey, answer.cell, units)}.")
        say(f"Is it enough? {enough}")


def _why(survey: Survey, cell: int, units: System) -> str:
    """Why to go to a cell: what the map does not know there, and what the plan says."""
    reason = survey.plan.reason or "it is what is left of the plan"
    if survey.taken < 2:
        return f"nothing is known there yet; {reason}"
    unit = SYSTEMS[units].pressure
    there, everywhere = sqrt(survey.soil_map.kv[cell]), sqrt(survey.mean_kv)
    spread = f"{unit.text(there)} there and {unit.text(everywhere)} over the field"
    return f"the map's standard deviation is {spread}; {reason}"


@grouped
def add(
    survey: SurveyFile,
    typed: TypedOptions,
    at: Annotated[str | None, at_option("the planned stop")] = None,
    agent: AgentName = HAND,
    allow: Allow = None,
    units: Shown = "metric",
    as_json: AsJson = False,
) -> None:
    """Type a reading in: what was read at the planned stop, or at another place."""
    with at_work(survey, agent, MethodOptions(allow=allow)) as dispatch:
        state = dispatch.survey
        reading = typed.reading(state.cone)
        report = taken(state, agent, reading, _place(state, agent, at))
        dispatch.report(report)
    tell_reading(dispatch.survey, dispatch.survey.reading(report.id), units, as_json)


def _place(survey: Survey, agent: str, at: str | None) -> Place:
    """Where a reading was taken: on the field, at the planned stop where nobody says."""
    if at is not None:
        place = place_of(at, survey.field, "--at")
        check_on_field(place, survey.field, "--at")
        return place
    east, north = survey.access.at[lease_of(survey, agent).cell].tolist()
    return east, north


def tell_reading(survey: Survey, report: Sampled, units: System, as_json: bool) -> None:
    """Print what was taken of a reading, and how the survey stands with it."""
    sample = sample_of(survey, report)
    layers = SYSTEMS[units].layers(survey.layers)
    kpa = dict(zip(layers, sample.kpa.tolist(), strict=True))
    result: dict[str, object] = {"report": report.id, "agent": report.agent}
    if as_json:
        result |= {**row_of(survey.field, None, report.at), "kpa": sample.kpa.tolist()}
    else:
        unit = SYSTEMS[units].pressure
        result["place"] = in_words(report.at, survey.field)
        result["layers"] = tuple(
            f"{name}: {'not read' if isnan(value) else unit.text(value)}"
            for name, value in kpa.items()
        )
    doubts = typing_doubts(profile_of(report.reading, survey.cone))
    result |= {"flags": report.reading.flags, **said(doubts, as_json=as_json)}
    result |= {**_after(survey, units, as_json)}
    tell(result, as_json, SYSTEMS[units])


def _after(survey: Survey, units: System, as_json: bool) -> Mapping[str, object]:
    """How a survey stands after something was reported."""
    finished = survey.finished or ("no" if as_json else "")
    words = {} if as_json else {"outlook": in_units(survey, outlook(survey), SYSTEMS[units])}
    return {**(_standing(survey) if as_json else words), "finished": finished}


def _standing(survey: Survey) -> dict[str, object]:
    """How many samples there are, and whether that is enough."""
    return {"samples": survey.taken, "outlook": outlook_in_words(survey, outlook(survey))}


@grouped
def stone(
    survey: SurveyFile,
    depth: Annotated[
        str | None,
        typer.Option(
            metavar="CM", help="How deep it is, in cm or with a unit.", rich_help_panel=FIELD
        ),
    ] = None,
    agent: AgentName = HAND,
    allow: Allow = None,
    units: Shown = "metric",
    as_json: AsJson = False,
) -> None:
    """Note that a stone keeps the rod out at the planned stop; the plan goes on elsewhere."""
    deep = depth_m(depth, "--depth") if depth else None
    with at_work(survey, agent, MethodOptions(allow=allow)) as dispatch:
        lease = lease_of(dispatch.survey, agent)
        report = stone_at(dispatch.survey, agent, lease, deep)
        dispatch.report(report)
    _tell_refused(dispatch, lease.cell, report.reason, units, as_json)


@grouped
def skip(
    survey: SurveyFile,
    reason: Annotated[
        str, typer.Option(metavar="WORDS", help="Why nobody goes there.", rich_help_panel=FIELD)
    ],
    agent: AgentName = HAND,
    allow: Allow = None,
    units: Shown = "metric",
    as_json: AsJson = False,
) -> None:
    """Leave the planned stop out; nobody is sent there again."""
    with at_work(survey, agent, MethodOptions(allow=allow)) as dispatch:
        lease = lease_of(dispatch.survey, agent)
        dispatch.skip(agent, lease.id, reason)
    _tell_refused(dispatch, lease.cell, reason, units, as_json)


def _tell_refused(
    dispatch: LocalDispatch, cell: int, reason: str, units: System, as_json: bool
) -> None:
    """Print which stop is left out, and how the survey stands."""
    survey = dispatch.survey
    east, north = survey.access.at[cell].tolist()
    place = {"place": in_words((east, north), survey.field)}
    where = stop_of(survey, cell) if as_json else place
    result = {"left_out": reason, **where, **_after(survey, units, as_json)}
    tell(result, as_json, SYSTEMS[units])
