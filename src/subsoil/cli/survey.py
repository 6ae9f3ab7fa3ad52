"""Verbs that make a survey: set it up, run it, go on with it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Annotated, Literal

import typer

from subsoil.cli.covariate import Column, CovariateFile, covariate_of
from subsoil.cli.field import (
    Boundary,
    CellSize,
    ConeAngle,
    ConeArea,
    Crs,
    Edges,
    FieldName,
    KeepOuts,
)
from subsoil.cli.found import exit_for, said
from subsoil.cli.inspect import summary, tell_survey
from subsoil.cli.limits import LimitOptions
from subsoil.cli.options import (
    DEFAULT_EDGES,
    Allow,
    MethodOptions,
    SurveyFile,
    World,
    allowed_by,
    decided_anew,
    layers_of,
    settings_of,
)
from subsoil.cli.output import AsJson, Shown, progress, resumable, tell
from subsoil.cli.pace import PaceOptions
from subsoil.cli.parsing import ROBOT, grouped
from subsoil.io.read.boundary import read_field
from subsoil.journal import Journal, create, open_journal
from subsoil.penetrometer import Cone
from subsoil.registry import Allowed
from subsoil.reports import Refused, Sampled
from subsoil.simulation import Machine
from subsoil.survey import LocalDispatch, Settings, Survey, fold, opened, opening
from subsoil.survey.events import Configured, Event, Planned
from subsoil.survey.simulated import SIMULATED, work
from subsoil.units import SYSTEMS
from subsoil.worlds import soil_of, soil_to_survey

Faster = Annotated[
    float,
    typer.Option(
        metavar="TIMES",
        help="How many times faster than a real robot it works.",
        show_default="at once",
        min=0.001,
        rich_help_panel=ROBOT,
    ),
]


@dataclass(frozen=True)
class RobotOptions:
    """What carries the penetrometer, as the command line says it.

    Attributes
    ----------
    robot
        Which robot: there is the simulated one.
    world
        Soil that it probes: the survey's own if none is named.
    faster
        How many times faster than a real one it works.
    """

    robot: Annotated[
        Literal["sim"],
        typer.Option(help="What carries the penetrometer.", rich_help_panel=ROBOT),
    ] = "sim"
    world: Annotated[
        World | None,
        typer.Option(
            help="Soil that it probes.",
            show_default="the survey's own, else simulated",
            rich_help_panel=ROBOT,
        ),
    ] = None
    faster: Faster = math.inf


@grouped
def init(
    survey: SurveyFile,
    boundary: Boundary,
    method: MethodOptions,
    limits: LimitOptions,
    pace: PaceOptions,
    name: FieldName = "",
    cell: CellSize = 5.0,
    cone_area: ConeArea = 130.0,
    cone_angle: ConeAngle = 30.0,
    layers: Edges = DEFAULT_EDGES,
    keep_outs: KeepOuts = None,
    crs: Crs = None,
    covariate: CovariateFile = None,
    column: Column = None,
    units: Shown = "metric",
    as_json: AsJson = False,
) -> None:
    """Start a survey of a field."""
    field = read_field(boundary, crs=crs, cell_size=cell, keep_outs=keep_outs, name=name)
    known, odd = covariate_of(covariate, column, field, crs)
    findings = (*field.findings, *odd)
    cone = Cone(cone_area, cone_angle)
    settings = settings_of(Settings(start=field.entrance), field, method, limits, pace)
    first = opening(field, layers_of(layers), cone, known.values.tolist())
    with create(survey, first) as journal:
        LocalDispatch(opened(first), journal).record(Configured(settings=settings))
    result = {
        "survey": survey,
        "field": field.name,
        "area_ha": field.area_ha,
        "crs": field.crs or "local frame",
        "cells": len(field.cells),
        "cone_area_mm2": cone_area,
        "force_limit_kpa": cone.pressure_kpa(Machine(cone).force_limit_n),
        **said(findings, as_json=as_json),
    }
    tell(result, as_json, SYSTEMS[units])
    exit_for(findings)


@grouped
def run(
    survey: SurveyFile,
    method: MethodOptions,
    limits: LimitOptions,
    pace: PaceOptions,
    robot: RobotOptions,
    units: Shown = "metric",
    as_json: AsJson = False,
) -> None:
    """Survey: drive a robot from stop to stop until there is enough. Ctrl-C is safe."""
    allowed = method.allowed
    with open_journal(survey) as journal:
        state = fold(journal.events())
        settings = settings_of(state.settings, state.field, method, limits, pace)
        truth, simulation = soil_to_survey(state, robot.world, settings.seed)
        with _working(journal, state, settings.samples, allowed) as dispatch:
            if decided_anew(state, settings):
                dispatch.record(Configured(settings=settings))
            dispatch.join(SIMULATED, "simulator", simulation=simulation)
            work(dispatch, truth, robot.faster)
    notes = (*journal.notes, *dispatch.survey.notes)
    tell_survey({**summary(dispatch.survey), "notes": notes}, as_json, units)


def resume(
    survey: SurveyFile,
    fresh_battery: Annotated[
        bool,
        typer.Option("--fresh-battery", help="It got a full battery.", rich_help_panel=ROBOT),
    ] = False,
    faster: Faster = math.inf,
    allow: Allow = None,
    units: Shown = "metric",
    as_json: AsJson = False,
) -> None:
    """Go on with a survey that was stopped, exactly as if it had not been."""
    allowed = allowed_by(allow)
    with open_journal(survey) as journal:
        state = fold(journal.events())
        truth = soil_of(state)
        with _working(journal, state, state.settings.samples, allowed) as dispatch:
            if fresh_battery:
                dispatch.swap_battery(SIMULATED)
            work(dispatch, truth, faster)
    notes = (*journal.notes, *dispatch.survey.notes)
    tell_survey({**summary(dispatch.survey), "notes": notes}, as_json, units)


@contextmanager
def _working(
    journal: Journal, state: Survey, samples: int, allowed: Allowed
) -> Iterator[LocalDispatch]:
    """Dispatch of a survey that shows its progress."""
    with resumable(), progress("surveying", samples, first="planning") as advance:

        def show(survey: Survey, event: Event) -> None:
            if isinstance(event, Sampled | Refused | Planned):
                advance(survey.taken, _in_short(survey))

        yield LocalDispatch(state, journal, show, allowed=allowed)


def _in_short(survey: Survey) -> str:
    """Say how a survey stands on one line."""
    spread = math.sqrt(survey.mean_kv)
    return f"√KV {spread:.0f} kPa  {survey.metres:.0f} m  {survey.minutes:.0f} min"
