"""Verbs that make a survey: set it up, run it, go on with it."""

from __future__ import annotations

import math
from functools import reduce
from pathlib import Path
from typing import Annotated

import typer

from subsoil.cli import enough
from subsoil.cli.known import Column, CovariateFile, Drift, covariate_of, rule_named
from subsoil.cli.looking import summary
from subsoil.cli.options import (
    DEFAULT_EDGES,
    DEFAULT_ESTIMATOR,
    DEFAULT_STRATEGY,
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
    configured,
    layers_of,
    numbers,
    values,
)
from subsoil.cli.output import AsJson, Seed, progress, tell
from subsoil.cli.worlds import robot_of, truth_of
from subsoil.dispatch import LocalDispatch, drive
from subsoil.errors import ParameterError
from subsoil.events import BatterySwapped, Event, Planned, Refused, Sampled
from subsoil.io.boundary import read_field
from subsoil.journal import Journal, create, open_journal
from subsoil.penetrometer import Cone
from subsoil.simulation import Machine
from subsoil.stopping import Rates
from subsoil.survey import Survey, apply, fold, opening

_AGENT = "simulated robot"


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
        str, typer.Option(help="Soil of the simulated robot: simulated or riseholme.")
    ] = "simulated",
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
    as_json: AsJson = False,
) -> None:
    """Survey: drive a robot from stop to stop until there is enough. Ctrl-C is safe."""
    if robot != "sim":
        raise ParameterError(f"there is no robot {robot!r}", where="--robot", remedy="sim")
    goals = enough.goals(target_rmse, probability, threshold_kpa, decided, confidence, min_gain)
    rule = rule_named(drift)
    with open_journal(survey) as journal:
        state = fold(journal.events())
        settings = configured(
            state.field, strategy, samples, seed,
            estimator=estimator, refit_every=refit_every, world=world,
            metres=metres, minutes=minutes, mean_kv=kv, money=money, goals=goals,
            rates=Rates(rate_hour, rate_km, rate_sample, call_out, currency),
            strategy_settings=values(strategy_setting),
            estimator_settings=numbers(estimator_setting),
        )  # fmt: skip
        settings = settings.model_copy(update={"drift": rule})
        state = _work(journal, state, (settings,))
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
        state = _work(journal, state, (BatterySwapped(),) if fresh_battery else ())
    tell(summary(state), as_json)


def _work(journal: Journal, state: Survey, first: tuple[Event, ...]) -> Survey:
    """Drive the simulated robot through a survey with progress; returns the state it ends in."""
    planned = reduce(apply, first, state).configured
    with progress("surveying", planned.samples) as advance:

        def show(survey: Survey, event: Event) -> None:
            if isinstance(event, Sampled | Refused | Planned):
                advance(len(survey.visited), _in_short(survey))

        dispatch = LocalDispatch(state, journal, show)
        for event in first:
            dispatch.record(event)
        truth = truth_of(planned.world, state.field, state.layers, planned.seed)
        drive(_AGENT, robot_of(dispatch.survey, truth), dispatch)
    return dispatch.survey


def _in_short(survey: Survey) -> str:
    """Say how a survey stands on one line."""
    spread = math.sqrt(survey.mean_kv)
    return f"√KV {spread:.0f} kPa  {survey.metres:.0f} m  {survey.minutes:.0f} min"
