"""Verbs that look into a survey and change nothing."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated

import typer

from subsoil.cli.crew import crew, last_reading
from subsoil.cli.figures import FigureFormat
from subsoil.cli.limits import LimitOptions
from subsoil.cli.options import (
    Allow,
    MethodOptions,
    SurveyFile,
    allowed_by,
    decided_anew,
    settings_of,
)
from subsoil.cli.output import (
    AsJson,
    Shown,
    folder,
    progress,
    say,
    tell,
    tell_table,
    working,
)
from subsoil.cli.pace import PaceOptions
from subsoil.cli.parsing import OUTPUT, grouped
from subsoil.cli.stops import Write, ahead_of, stop_of, written
from subsoil.errors import ParameterError
from subsoil.io.write.stops import check_stops_file
from subsoil.journal import fingerprint, last_event, read_survey
from subsoil.journal import verify as verdict_on
from subsoil.optional import FIGURES, require
from subsoil.plots import outlook_curve, save
from subsoil.report.wording import in_units
from subsoil.survey import Survey, apply, fold, settled
from subsoil.survey.events import Configured, Event, Opened
from subsoil.survey.outlook import (
    SURE,
    Outlook,
    Prospect,
    in_words,
    out_of_reach,
    outlook,
    too_sure,
)
from subsoil.survey.progress import progress_of
from subsoil.units import METRIC, SYSTEMS, System, Units
from subsoil.ways.routing import length

_ROWS = {1, 2, 3, 5, 10, 15, 20, 30, 40}


@grouped
def plan(
    survey: SurveyFile,
    method: MethodOptions,
    limits: LimitOptions,
    pace: PaceOptions,
    write: Write = None,
    units: Shown = "metric",
    as_json: AsJson = False,
) -> None:
    """Show where a survey would go next; changes nothing."""
    state, allowed = fold(read_survey(survey).events), method.allowed
    if write is not None:
        check_stops_file(write, state.field)
    settings = settings_of(state.settings, state.field, method, limits, pace)
    if decided_anew(state, settings):
        state = apply(state, Configured(settings=settings))
    with working("planning"):
        state, _ = settled(state, allowed)
    stops, result = ahead_of(state), {"survey": survey, **_ahead(state)}
    if write is not None:
        result["written"] = written(write, state, stops)
    rows = [stop_of(state, cell) for cell in stops]
    if as_json:
        tell({**result, "plan": rows}, as_json)
        return
    tell(result, as_json, SYSTEMS[units])
    numbered = [(k, *row.values()) for k, row in enumerate(rows, start=1)]
    tell_table("Stops", ("stop", *stop_of(state, 0)), numbered, SYSTEMS[units])


PictureFolder = Annotated[
    Path | None,
    typer.Option(
        metavar="DIR",
        help="Folder for a picture of what more would buy.",
        rich_help_panel=OUTPUT,
    ),
]


def status(
    survey: SurveyFile,
    out: PictureFolder = None,
    figures: FigureFormat = "png",
    units: Shown = "metric",
    as_json: AsJson = False,
) -> None:
    """Say how a survey stands, running or not: how good its map is, what more would buy."""
    if out:
        require(FIGURES)
    content = read_survey(survey)
    events, state = content.events, fold(content.events)
    prospects = outlook(state)
    words = in_words(state, prospects)
    notes = (*content.notes, *state.notes, *too_sure(state), *out_of_reach(state, prospects))
    shown = METRIC if as_json else SYSTEMS[units]
    result = {
        **summary(state, shown),
        "last_reading": last_reading(state),
        "notes": notes,
        "fingerprint": content.fingerprint,
    }
    if out:
        result["picture"] = _draw(events, prospects, folder(out) / f"outlook.{figures}")
    if as_json:
        numbers = {
            "outlook": words,
            "rmse_kpa": prospects.rmse,
            "rmse_80_kpa": prospects.error.rmse(SURE),
            "forecast": [_prospect(state, entry) for entry in prospects.ahead],
        }
        tell({**result, **numbers}, as_json)
        return
    say(in_units(state, prospects, SYSTEMS[units]))
    tell_survey(result, as_json, units)
    tell_table("What more would buy", *_forecast_table(prospects), SYSTEMS[units])


def replay(
    survey: SurveyFile,
    at: Annotated[
        int,
        typer.Option(
            metavar="SEQ", help="Event up to which to replay.", min=1, rich_help_panel=OUTPUT
        ),
    ],
    units: Shown = "metric",
    as_json: AsJson = False,
) -> None:
    """Rebuild a survey as it was after an event."""
    content = read_survey(survey)
    events = [event for seq, event in content.numbered if seq <= at]
    if at > (last := content.last[0]):
        raise ParameterError(f"there are {last} events", where="--at", remedy=f"1 to {last}")
    result = {"event": at, "kind": events[-1].kind, **summary(fold(events))}
    tell_survey(result, as_json, units)


def verify(survey: SurveyFile, allow: Allow = None, as_json: AsJson = False) -> None:
    """Decide everything anew from the events and compare; exit code 1 if anything differs."""
    allowed, (seq, digest) = allowed_by(allow), last_event(survey)
    with progress("verifying", seq) as advance:
        verdict = verdict_on(survey, allowed, lambda done: advance(done, ""))
    result = {
        "events": seq,
        "fingerprint": fingerprint(digest),
        "findings": verdict.findings or "none",
        "notes": verdict.notes,
    }
    tell(result, as_json)
    if verdict.findings:
        raise typer.Exit(1)


def summary(survey: Survey, units: Units = METRIC) -> dict[str, object]:
    """Say how a survey stands."""
    result: dict[str, object] = {
        "field": survey.field.name,
        "area_ha": survey.field.area_ha,
        "samples": survey.taken,
        "refused": len(survey.refused),
        "metres": survey.metres,
        "minutes": survey.minutes,
        "mean_kv": survey.mean_kv,
        "std_dev_kpa": math.sqrt(survey.mean_kv),
        "planned": len(survey.plan.cells),
        "next": stop_of(survey, ahead_of(survey)[0]) if ahead_of(survey) else "none",
        "finished": survey.finished or "no",
        "simulated": "yes" if survey.simulated else "no",
        "agents": crew(survey, units),
        "notes": survey.notes,
    }
    if survey.method:
        settings = survey.settings
        result |= {
            "strategy": settings.strategy,
            "estimator": settings.estimator,
            "target_samples": settings.samples,
            "seed": settings.seed,
        }
        if survey.goal_progress.measures:
            pairs = zip(settings.goals, survey.goal_progress.measures, strict=True)
            result["goals"] = tuple(goal.words(measure) for goal, measure in pairs)
        if not settings.rates.free:
            result |= {"money": survey.spent.money, "currency": settings.rates.currency}
    return result


def tell_survey(result: Mapping[str, object], as_json: bool, units: System = "metric") -> None:
    """Print how a survey stands, for people without a next stop where there is none."""
    nothing = {"planned": 0, "refused": 0, "next": "none"}
    shown = {k: v for k, v in result.items() if as_json or v != nothing.get(k, nothing)}
    tell(shown, as_json, SYSTEMS[units])


def _ahead(survey: Survey) -> dict[str, object]:
    """What is still planned, and what it takes."""
    stops = ahead_of(survey)
    way = length(survey.access, survey.position, survey.access.at[list(stops)])
    return {
        "strategy": survey.settings.strategy,
        "stops": len(stops),
        "metres": way,
        "minutes": survey.settings.pace.minutes(way, len(stops)),
        "reason": survey.finished or survey.plan.reason,
    }


def _draw(events: Sequence[Event], prospects: Outlook, path: Path) -> Path:
    first, *later = events
    assert isinstance(first, Opened)
    return save(outlook_curve(progress_of(first, later), prospects, caption=first.name), path)


def _prospect(survey: Survey, entry: Prospect) -> dict[str, float]:
    """Where more samples would bring a survey, in all."""
    spent = survey.spent
    return {
        "samples": spent.samples + entry.more,
        "minutes": spent.minutes + entry.minutes,
        "money": spent.money + entry.money,
        "rmse_kpa": entry.rmse,
    }


def _forecast_table(prospects: Outlook) -> tuple[list[str], list[tuple[int, float, float]]]:
    """Columns and rows of what more would buy."""
    rows = [
        (entry.more, entry.minutes, entry.rmse)
        for entry in prospects.ahead
        if entry.more in _ROWS or entry in prospects.milestones
    ]
    return ["more samples", "minutes", "predicted_rmse_kpa"], rows
