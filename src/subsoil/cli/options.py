"""Options that verbs share, and what they are when not given."""

from __future__ import annotations

import os
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import typer

from subsoil.cli.covariate import Drift
from subsoil.cli.limits import LimitOptions
from subsoil.cli.parsing import STRATEGY, one_of
from subsoil.errors import ParameterError, brief
from subsoil.land.field import Field
from subsoil.layers import Layers
from subsoil.registry import Allowed, imported
from subsoil.strategies import STRATEGIES, strategy_named
from subsoil.survey import DEFAULT_ESTIMATOR, DEFAULT_STRATEGY, Settings, checked
from subsoil.variogram import ESTIMATORS, estimator_named

SurveyFile = Annotated[
    Path, typer.Argument(help="Survey file, a GeoPackage.", metavar="SURVEY.gpkg")
]
StrategyName = Annotated[
    str,
    typer.Option(
        metavar="NAME",
        help=f"Where to probe: {', '.join(STRATEGIES)}, or your own as module:attribute.",
        autocompletion=one_of(STRATEGIES),
        rich_help_panel=STRATEGY,
    ),
]
EstimatorName = Annotated[
    str,
    typer.Option(
        metavar="NAME",
        help=f"How variograms are estimated: {', '.join(ESTIMATORS)}, or module:attribute.",
        autocompletion=one_of(ESTIMATORS),
        rich_help_panel=STRATEGY,
    ),
]
EstimatorSettings = Annotated[
    list[str] | None,
    typer.Option(
        "--estimator-setting",
        metavar="NAME=NUMBER",
        help="Parameter of the estimator, such as median_range=60; may be repeated.",
        rich_help_panel=STRATEGY,
    ),
]
StrategySettings = Annotated[
    list[str] | None,
    typer.Option(
        "--strategy-setting",
        metavar="NAME=VALUE",
        help="Parameter of the strategy, such as way=0.8; may be repeated.",
        rich_help_panel=STRATEGY,
    ),
]
Allow = Annotated[
    list[str] | None,
    typer.Option(
        metavar="MODULE",
        help="Module whose strategies a survey file may name and run; may be repeated.",
        rich_help_panel=STRATEGY,
    ),
]
Seed = Annotated[
    int,
    typer.Option(help="Seed of all chance.", metavar="N", min=0, rich_help_panel=STRATEGY),
]
World = Literal["simulated", "riseholme"]
"""Soils of a simulated robot, by name."""
DEFAULT_EDGES = "0,0.05,0.1,0.15,0.2,0.25,0.3,0.35,0.4"


@dataclass(frozen=True)
class MethodOptions:
    """By which methods to survey, as the command line says it.

    Attributes
    ----------
    strategy, strategy_setting
        Where to probe.
    estimator, estimator_setting, refit_every, drift
        How variograms are estimated, and which layers follow the covariate.
    seed
        Seed of the strategy's chance, and of a simulated soil.
    allow
        Modules whose code a survey file may name.
    """

    strategy: StrategyName = DEFAULT_STRATEGY
    strategy_setting: StrategySettings = None
    estimator: EstimatorName = DEFAULT_ESTIMATOR
    estimator_setting: EstimatorSettings = None
    refit_every: Annotated[
        int,
        typer.Option(metavar="N", help="Samples between refits.", min=1, rich_help_panel=STRATEGY),
    ] = 1
    drift: Drift = "auto"
    seed: Seed = 0
    allow: Allow = None

    @property
    def allowed(self) -> Allowed:
        """Modules whose code may be run: see :func:`allowed_by`."""
        return allowed_by(self.allow, self.strategy, self.estimator)


def settings_of(field: Field, method: MethodOptions, limits: LimitOptions) -> Settings:
    """How to survey a field, as options say.

    Raises
    ------
    ParameterError
        If strategy or estimator are unknown, there are fewer cells than samples, or the limits
        leave no room for one stop.
    """
    goals, allowed = limits.goals, method.allowed
    own, known = values(method.strategy_setting), numbers(method.estimator_setting)
    strategy_named(method.strategy, own, allowed)
    estimator_named(method.estimator, field.extent_m, known, allowed)
    settings = Settings(
        start=field.entrance,
        strategy=method.strategy,
        strategy_settings=own,
        estimator=method.estimator,
        estimator_settings=known,
        refit_every=method.refit_every,
        seed=method.seed,
        samples=limits.samples,
        metres=limits.metres,
        minutes=limits.minutes,
        mean_kv=limits.kv,
        money=limits.money,
        rates=limits.rates,
        goals=goals,
        drift=method.drift,
    )
    return checked(settings, field)


def allowed_by(modules: list[str] | None, *typed: str) -> Allowed:
    """Modules whose code may be run: those allowed, and those of names that the user typed.

    For these the current folder is searched too, after everything else.

    Raises
    ------
    ParameterError
        If one that is allowed cannot be imported.
    """
    allowed = Allowed(frozenset(name.partition(":")[0] for name in modules or ()))
    own = allowed | Allowed.by_name(*typed)
    if own.modules and os.getcwd() not in sys.path:
        sys.path.append(os.getcwd())
    for module in sorted(allowed.modules):
        imported(module, "--allow")
    return own


def values(settings: list[str] | None) -> dict[str, float | str]:
    """Parameters given as NAME=VALUE, numbers as such.

    Raises
    ------
    ParameterError
        If one has no name or no value.
    """
    found: dict[str, float | str] = {}
    for text in settings or []:
        name, _, value = text.partition("=")
        if not (name and value):
            raise ParameterError(f"{text!r} is not NAME=VALUE", where="setting")
        try:
            found[name] = float(value)
        except ValueError:
            found[name] = value
    return found


def numbers(settings: list[str] | None) -> dict[str, float]:
    """Parameters given as NAME=NUMBER.

    Raises
    ------
    ParameterError
        If one has no name or no number.
    """
    found = {}
    for name, value in values(settings).items():
        if isinstance(value, str):
            raise ParameterError(f"{name} needs a number, not {value!r}", where="setting")
        found[name] = value
    return found


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
            f"{brief(text)!r} is not a list of numbers",
            where="--layers",
            remedy="edges in metres, such as 0,0.1,0.2,0.4",
        ) from None
