"""Verbs that make a survey and look into it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import numpy as np
import shapely
import typer

from subsoil.cli.output import AsJson, Seed, progress, tell, tell_table
from subsoil.cli.worlds import check_world, robot_of, truth_of
from subsoil.dispatch import LocalDispatch, drive
from subsoil.errors import ParameterError
from subsoil.events import BatterySwapped, Configured, Event, Planned, Refused, Sampled
from subsoil.field import Field
from subsoil.io.boundary import read_field
from subsoil.journal import Journal, create, open_journal, read_events
from subsoil.layers import Layers
from subsoil.penetrometer import Cone
from subsoil.robot import Robot
from subsoil.routing import length
from subsoil.simulation import Machine
from subsoil.strategies import strategy_named
from subsoil.survey import Survey, fold, next_event, opening
from subsoil.variogram import estimator_named
from subsoil.verification import verify as differences

SurveyFile = Annotated[
    Path, typer.Argument(help="Survey file, a GeoPackage.", metavar="SURVEY.gpkg")
]
Boundary = Annotated[
    Path, typer.Option(help="Outline of the field: GeoJSON, .coords, GeoPackage, shapefile, KML.")
]
StrategyName = Annotated[str, typer.Option(help="Strategy by name, or module:attribute.")]
Samples = Annotated[int, typer.Option(help="Readings to take.", min=1)]
EstimatorName = Annotated[str, typer.Option(help="How variograms are estimated.")]
CellSize = Annotated[float, typer.Option(help="Side of a cell in m.")]
ConeArea = Annotated[
    float, typer.Option(help="Base area of the cone in mm2: 130 or 323 as a rule.")
]

DEFAULT_STRATEGY = "adaptive-monte-carlo"
DEFAULT_ESTIMATOR = "paper-10"
_AGENT = "simulated robot"
_DEGREES = {"longitude", "latitude"}


def init(
    survey: SurveyFile,
    boundary: Boundary,
    cell: CellSize = 5.0,
    cone_area: ConeArea = 130.0,
    cone_angle: Annotated[float, typer.Option(help="Apex angle of the cone in degrees.")] = 30.0,
    layers: Annotated[
        str, typer.Option(help="Edges of the depth layers in m, comma-separated.")
    ] = "0,0.05,0.1,0.15,0.2,0.25,0.3,0.35,0.4",
    keep_outs: Annotated[
        Path | None, typer.Option(help="Areas not to probe, in the same formats.")
    ] = None,
    crs: Annotated[
        str | None, typer.Option(help="Frame of a boundary that does not name one.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Start a survey of a field."""
    field = read_field(boundary, crs=crs, cell_size=cell, keep_outs=keep_outs)
    opened = opening(field, layers_of(layers), Cone(cone_area, cone_angle))
    with create(survey, opened):
        pass
    machine = Machine(Cone(cone_area, cone_angle))
    result = {
        "survey": survey,
        "field": field.name,
        "area_ha": field.area_ha,
        "crs": field.crs or "local frame",
        "cells": len(field.cells),
        "cone_area_mm2": cone_area,
        "force_limit_kpa": machine.cone.pressure_kpa(machine.force_limit_n),
    }
    tell(result, as_json)


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


def run(
    survey: SurveyFile,
    robot: Annotated[str, typer.Option(help="What carries the penetrometer: sim.")] = "sim",
    strategy: StrategyName = DEFAULT_STRATEGY,
    samples: Samples = 30,
    seed: Seed = 0,
    estimator: EstimatorName = DEFAULT_ESTIMATOR,
    refit_every: Annotated[int, typer.Option(help="Samples between refits.", min=1)] = 1,
    world: Annotated[
        str, typer.Option(help="Soil of the simulated robot: simulated or riseholme.")
    ] = "simulated",
    metres: Annotated[float, typer.Option(help="Stop after this way in m.")] = math.inf,
    minutes: Annotated[float, typer.Option(help="Stop after this time in min.")] = math.inf,
    kv: Annotated[float, typer.Option(help="Stop at this mean kriging variance in kPa2.")] = 0.0,
    as_json: AsJson = False,
) -> None:
    """Survey: drive a robot from stop to stop until there is enough. Ctrl-C is safe."""
    if robot != "sim":
        raise ParameterError(f"there is no robot {robot!r}", where="--robot", remedy="sim")
    with open_journal(survey) as journal:
        state = fold(journal.events())
        settings = configured(
            state.field, strategy, samples, seed,
            estimator=estimator, refit_every=refit_every, world=world,
            metres=metres, minutes=minutes, mean_kv=kv,
        )  # fmt: skip
        state = work(journal, state, (settings,))
    tell(summary(state), as_json)


def resume(
    survey: SurveyFile,
    fresh_battery: Annotated[
        bool, typer.Option("--fresh-battery", help="The robot got a full battery.")
    ] = False,
    as_json: AsJson = False,
) -> None:
    """Go on with a survey that was stopped, exactly as if it had not been."""
    with open_journal(survey) as journal:
        state = fold(journal.events())
        state = work(journal, state, (BatterySwapped(),) if fresh_battery else ())
    tell(summary(state), as_json)


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


def work(journal: Journal, state: Survey, first: tuple[Event, ...]) -> Survey:
    """Drive the simulated robot through a survey with progress; returns the state it ends in."""
    with progress("surveying", first_limit(state, first)) as advance:

        def show(survey: Survey, event: Event) -> None:
            if isinstance(event, Sampled | Refused | Planned):
                advance(len(survey.visited), in_short(survey))

        dispatch = LocalDispatch(state, journal, show)
        for event in first:
            dispatch.record(event)
        go(dispatch)
    return dispatch.survey


def go(dispatch: LocalDispatch) -> None:
    """Let the simulated robot work on a survey until it is over."""
    survey = dispatch.survey
    settings = survey.configured
    truth = truth_of(settings.world, survey.field, survey.layers, settings.seed)
    robot: Robot = robot_of(survey, truth)
    drive(_AGENT, robot, dispatch)


def first_limit(state: Survey, first: tuple[Event, ...]) -> int:
    """Samples that a survey is to take."""
    chosen = [event for event in (*state.settings, *first) if isinstance(event, Configured)]
    return chosen[-1].samples if chosen else 0


def in_short(survey: Survey) -> str:
    """Say how a survey stands on one line."""
    spread = math.sqrt(survey.mean_kv)
    return f"√KV {spread:.0f} kPa  {survey.metres:.0f} m  {survey.minutes:.0f} min"


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


def start_of(field: Field) -> tuple[float, float]:
    """Where an agent enters a field: the corner of its outline nearest to the south-west."""
    west, south, _, _ = field.boundary.bounds
    corners = shapely.get_coordinates(field.boundary)
    gate = np.argmin(np.hypot(corners[:, 0] - west, corners[:, 1] - south))
    return (float(corners[gate, 0]), float(corners[gate, 1]))


def configured(
    field: Field,
    strategy: str,
    samples: int,
    seed: int,
    *,
    estimator: str = DEFAULT_ESTIMATOR,
    refit_every: int = 1,
    world: str = "simulated",
    metres: float = math.inf,
    minutes: float = math.inf,
    mean_kv: float = 0.0,
) -> Configured:
    """Event that decides how to survey a field.

    Raises
    ------
    ParameterError
        If strategy, estimator or world are unknown, or there are fewer cells than samples.
    """
    strategy_named(strategy)
    estimator_named(estimator)
    check_world(world)
    if samples > len(field.cells):
        raise ParameterError(
            f"{samples} samples are more than the field's {len(field.cells)} cells",
            where="--samples",
            remedy="take fewer, or start a survey with smaller cells",
        )
    return Configured(
        strategy=strategy,
        estimator=estimator,
        refit_every=refit_every,
        seed=seed,
        start=start_of(field),
        world=world,
        samples=samples,
        metres=metres,
        minutes=minutes,
        mean_kv=mean_kv,
    )


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


def layers_of(text: str) -> Layers:
    """Layers of comma-separated edges in m.

    Raises
    ------
    ParameterError
        If they are not numbers, or make no layers.
    """
    try:
        return Layers(tuple(float(edge) for edge in text.split(",")))
    except ValueError:
        raise ParameterError(
            f"{text!r} is not a list of numbers",
            where="--layers",
            remedy="edges in metres, such as 0,0.1,0.2,0.4",
        ) from None
