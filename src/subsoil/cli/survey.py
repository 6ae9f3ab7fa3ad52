"""Verbs that make a survey: set it up, run it, go on with it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

from subsoil.cli import limits as enough
from subsoil.cli.covariate import Column, CovariateFile, Drift, covariate_of, rule_named
from subsoil.cli.inspect import summary
from subsoil.cli.options import (
    DEFAULT_EDGES,
    DEFAULT_ESTIMATOR,
    DEFAULT_STRATEGY,
    Allow,
    Boundary,
    CellSize,
    ConeArea,
    Edges,
    EstimatorName,
    EstimatorSettings,
    Samples,
    StrategyName,
    StrategySettings,
    SurveyFile,
    allowed_by,
    layers_of,
    numbers,
    settings_of,
    values,
)
from subsoil.cli.output import AsJson, Seed, progress, tell
from subsoil.errors import JournalError, ParameterError, brief
from subsoil.io.boundary import read_field
from subsoil.journal import Journal, create, open_journal
from subsoil.penetrometer import Cone
from subsoil.registry import Allowed
from subsoil.reports import Refused, Sampled
from subsoil.simulation import Machine, Truth
from subsoil.stopping import Rates
from subsoil.survey import LocalDispatch, Survey, fold, opening
from subsoil.survey.events import Configured, Event, Planned, Simulation
from subsoil.survey.simulated import SIMULATED, simulation_of, work
from subsoil.worlds import soil_of, truth_of

Faster = Annotated[
    float,
    typer.Option(help="Times faster than a real robot the simulated one works.", min=0.001),
]


def init(
    survey: SurveyFile,
    boundary: Boundary,
    cell: CellSize = 5.0,
    cone_area: ConeArea = 130.0,
    cone_angle: Annotated[float, typer.Option(help="Apex angle of the cone in degrees.")] = 30.0,
    layers: Edges = DEFAULT_EDGES,
    keep_outs: Annotated[
        Path | None, typer.Option(help="Areas not to probe, in the same formats.")
    ] = None,
    crs: Annotated[
        str | None, typer.Option(help="Frame of a boundary that does not name one.")
    ] = None,
    covariate: CovariateFile = None,
    column: Column = None,
    as_json: AsJson = False,
) -> None:
    """Start a survey of a field."""
    field = read_field(boundary, crs=crs, cell_size=cell, keep_outs=keep_outs)
    known = covariate_of(covariate, column, field, crs)
    cone = Cone(cone_area, cone_angle)
    opened = opening(field, layers_of(layers), cone, known.values.tolist())
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
        "notes": field.notes,
    }
    tell(result, as_json)


def run(
    survey: SurveyFile,
    robot: Annotated[str, typer.Option(help="What carries the penetrometer: sim.")] = "sim",
    strategy: StrategyName = DEFAULT_STRATEGY,
    samples: Samples = 30,
    seed: Seed = 0,
    estimator: EstimatorName = DEFAULT_ESTIMATOR,
    strategy_setting: StrategySettings = None,
    estimator_setting: EstimatorSettings = None,
    refit_every: Annotated[int, typer.Option(help="Samples between refits.", min=1)] = 1,
    world: Annotated[
        str | None,
        typer.Option(
            help="Soil of the simulated robot: simulated or riseholme.",
            show_default="the survey's own, else simulated",
        ),
    ] = None,
    metres: enough.Metres = math.inf,
    minutes: enough.Minutes = math.inf,
    money: enough.Money = math.inf,
    rate_hour: enough.RateHour = 0.0,
    rate_km: enough.RateKm = 0.0,
    rate_sample: enough.RateSample = 0.0,
    call_out: enough.CallOut = 0.0,
    currency: enough.Currency = "EUR",
    target_rmse: enough.Target = None,
    probability: enough.Probability = None,
    threshold_kpa: enough.Threshold = None,
    decided: enough.Decided = None,
    confidence: enough.Confidence = None,
    min_gain: enough.MinGain = None,
    kv: enough.MeanKv = 0.0,
    drift: Drift = "auto",
    faster: Faster = math.inf,
    allow: Allow = None,
    as_json: AsJson = False,
) -> None:
    """Survey: drive a robot from stop to stop until there is enough. Ctrl-C is safe."""
    if robot != "sim":
        raise ParameterError(f"there is no robot {robot!r}", where="--robot", remedy="sim")
    goals = enough.goals(target_rmse, probability, threshold_kpa, decided, confidence, min_gain)
    rule = rule_named(drift)
    allowed = allowed_by(allow, strategy, estimator)
    with open_journal(survey) as journal:
        state = fold(journal.events())
        settings = settings_of(
            state.field, strategy, samples, seed,
            estimator=estimator, refit_every=refit_every,
            metres=metres, minutes=minutes, mean_kv=kv, money=money, goals=goals,
            rates=Rates(rate_hour, rate_km, rate_sample, call_out, currency),
            strategy_settings=values(strategy_setting),
            estimator_settings=numbers(estimator_setting),
            drift=rule, allowed=allowed,
        )  # fmt: skip
        truth, simulation = _soil(state, world, seed)
        with _working(journal, state, settings.samples, allowed) as dispatch:
            dispatch.record(Configured(settings=settings))
            dispatch.join(SIMULATED, "simulator", simulation=simulation)
            work(dispatch, truth, faster)
    tell({**summary(dispatch.survey), "notes": (*journal.notes, *dispatch.survey.notes)}, as_json)


def resume(
    survey: SurveyFile,
    fresh_battery: Annotated[
        bool, typer.Option("--fresh-battery", help="The robot got a full battery.")
    ] = False,
    faster: Faster = math.inf,
    allow: Allow = None,
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
    tell({**summary(dispatch.survey), "notes": (*journal.notes, *dispatch.survey.notes)}, as_json)


@contextmanager
def _working(
    journal: Journal, state: Survey, samples: int, allowed: Allowed
) -> Iterator[LocalDispatch]:
    """Dispatch of a survey that shows its progress."""
    with progress("surveying", samples) as advance:

        def show(survey: Survey, event: Event) -> None:
            if isinstance(event, Sampled | Refused | Planned):
                advance(survey.taken, _in_short(survey))

        yield LocalDispatch(state, journal, show, allowed=allowed)


def _soil(survey: Survey, world: str | None, seed: int) -> tuple[Truth, Simulation]:
    """The soil to survey, and its record: its own for a survey that was begun.

    Raises
    ------
    JournalError
        If the survey was begun in another one, or on real land.
    """
    if not survey.agents:
        world = world or "simulated"
        truth = truth_of(world, survey.field, survey.layers, seed)
        return truth, simulation_of(truth, world, seed)
    truth, begun = soil_of(survey), survey.simulation[0]
    if world not in (None, begun.world):
        raise JournalError(
            f"it was begun in the soil {brief(begun.world)!r} and does not go on in {world!r}",
            where=survey.name,
            remedy=f"give --world {brief(begun.world)}, or start another survey",
        )
    return truth, begun


def _in_short(survey: Survey) -> str:
    """Say how a survey stands on one line."""
    spread = math.sqrt(survey.mean_kv)
    return f"√KV {spread:.0f} kPa  {survey.metres:.0f} m  {survey.minutes:.0f} min"
