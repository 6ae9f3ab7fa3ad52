"""Verbs that look into a survey and change nothing."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated

import typer

from subsoil.cli.options import (
    DEFAULT_STRATEGY,
    Samples,
    StrategyName,
    SurveyFile,
    configured,
)
from subsoil.cli.output import AsJson, Seed, tell, tell_table
from subsoil.errors import ParameterError
from subsoil.events import Planned
from subsoil.field import Field
from subsoil.journal import read_events
from subsoil.routing import length
from subsoil.simulation import Machine
from subsoil.survey import Survey, fold, next_event
from subsoil.verification import verify as differences

_DEGREES = {"longitude", "latitude"}


def plan(
    survey: SurveyFile,
    strategy: StrategyName = DEFAULT_STRATEGY,
    samples: Samples = 30,
    seed: Seed = 0,
    as_json: AsJson = False,
) -> None:
    """Show where a survey would go next; changes nothing."""
    state = fold(read_events(survey))
    if not state.settings:
        state = fold((*read_events(survey), configured(state.field, strategy, samples, seed)))
    stops = state.plan
    due = next_event(state)
    if isinstance(due, Planned):
        stops = due.cells
    machine = Machine(state.cone)
    metres = length(state.position, state.field.cells[list(stops)])
    minutes = (metres / machine.speed_mps + len(stops) * machine.stop_s) / 60
    result: dict[str, object] = {
        "survey": survey,
        "strategy": state.configured.strategy,
        "stops": len(stops),
        "metres": metres,
        "minutes": minutes,
    }
    if as_json:
        tell({**result, "plan": [_stop(state.field, cell) for cell in stops]}, as_json)
        return
    tell(result, as_json)
    tell_table("Stops", *_stop_table(state.field, stops))


def status(survey: SurveyFile, as_json: AsJson = False) -> None:
    """Say how a survey stands, running or not."""
    tell(summary(fold(read_events(survey))), as_json)


def replay(
    survey: SurveyFile,
    at: Annotated[int, typer.Option(help="Event up to which to replay.", min=1, metavar="SEQ")],
    as_json: AsJson = False,
) -> None:
    """Rebuild a survey as it was after an event."""
    events = read_events(survey)
    if at > len(events):
        raise ParameterError(
            f"there are {len(events)} events", where="--at", remedy=f"1 to {len(events)}"
        )
    state = fold(events[:at])
    tell({"event": at, "kind": events[at - 1].kind, **summary(state)}, as_json)


def verify(survey: SurveyFile, as_json: AsJson = False) -> None:
    """Recompute everything from the events and compare; exit code 1 if anything differs."""
    findings = differences(survey)
    events = len(read_events(survey))
    tell({"events": events, "findings": findings or "none"}, as_json)
    if findings:
        raise typer.Exit(1)


def summary(survey: Survey) -> dict[str, object]:
    """Say how a survey stands."""
    result: dict[str, object] = {
        "field": survey.field.name,
        "area_ha": survey.field.area_ha,
        "samples": len(survey.visited),
        "refused": len(survey.refused),
        "metres": survey.metres,
        "minutes": survey.minutes,
        "mean_kv": survey.mean_kv,
        "std_dev_kpa": math.sqrt(survey.mean_kv),
        "planned": len(survey.plan),
        "next": _stop(survey.field, survey.plan[0]) if survey.plan else "none",
        "finished": survey.finished or "no",
        "notes": survey.soil_map.notes,
    }
    if survey.settings:
        settings = survey.configured
        result |= {
            "strategy": settings.strategy,
            "estimator": settings.estimator,
            "target_samples": settings.samples,
            "seed": settings.seed,
        }
    return result


def _stop(field: Field, cell: int) -> dict[str, float]:
    east, north = field.cells[cell].tolist()
    stop: dict[str, float] = {"cell": cell, "easting_m": east, "northing_m": north}
    if field.crs:
        longitude, latitude = field.to_lonlat([(east, north)])[0].tolist()
        stop |= {"longitude": round(longitude, 7), "latitude": round(latitude, 7)}
    return stop


def _stop_table(field: Field, cells: Sequence[int]) -> tuple[list[str], list[list[str]]]:
    """Columns and rows of stops, with degrees to a tenth of a metre."""
    stops = [_stop(field, cell) for cell in cells]
    rows = [
        [str(k + 1), *(f"{v:.6f}" if n in _DEGREES else f"{v:.8g}" for n, v in stop.items())]
        for k, stop in enumerate(stops)
    ]
    return ["stop", *_stop(field, 0)], rows
