"""Options that verbs share, and what they are when not given."""

from __future__ import annotations

import os
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from subsoil.cli.covariate import drift_option
from subsoil.cli.limits import LimitOptions, only_given
from subsoil.cli.pace import PaceOptions
from subsoil.cli.parsing import STRATEGY, one_of
from subsoil.errors import ParameterError, brief
from subsoil.land.field import Field
from subsoil.layers import Layers
from subsoil.mapping.drift_choice import DriftRule
from subsoil.registry import Allowed, imported
from subsoil.strategies import STRATEGIES, strategy_named
from subsoil.survey import DEFAULT_ESTIMATOR, DEFAULT_STRATEGY, Settings, Survey, checked
from subsoil.survey.events import METHOD
from subsoil.variogram import ESTIMATORS, estimator_named

SurveyFile = Annotated[
    Path, typer.Argument(help="Survey file, a GeoPackage.", metavar="SURVEY.gpkg")
]


def _strategy(default: str | bool = True) -> Any:
    return typer.Option(
        metavar="NAME",
        help=f"Where to probe: {', '.join(STRATEGIES)}, or your own as module:attribute.",
        autocompletion=one_of(STRATEGIES),
        show_default=default,
        rich_help_panel=STRATEGY,
    )


def _estimator(default: str | bool = True) -> Any:
    return typer.Option(
        metavar="NAME",
        help=f"How variograms are estimated: {', '.join(ESTIMATORS)}, or module:attribute.",
        autocompletion=one_of(ESTIMATORS),
        show_default=default,
        rich_help_panel=STRATEGY,
    )


StrategyName = Annotated[str, _strategy()]
EstimatorName = Annotated[str, _estimator()]
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


def _seed(default: str | bool = True) -> Any:
    return typer.Option(
        help="Seed of all chance.", metavar="N", min=0, show_default=default,
        rich_help_panel=STRATEGY,
    )  # fmt: skip


Seed = Annotated[int, _seed()]
World = Literal["simulated", "riseholme"]
"""Soils of a simulated robot, by name."""
DEFAULT_EDGES = "0,0.05,0.1,0.15,0.2,0.25,0.3,0.35,0.4"


@dataclass(frozen=True)
class MethodOptions:
    """By which methods to survey, as the command line says it; ``None`` where it does not.

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

    strategy: Annotated[str | None, _strategy(f"as before, else {DEFAULT_STRATEGY}")] = None
    strategy_setting: StrategySettings = None
    estimator: Annotated[str | None, _estimator(f"as before, else {DEFAULT_ESTIMATOR}")] = None
    estimator_setting: EstimatorSettings = None
    refit_every: Annotated[
        int | None,
        typer.Option(
            metavar="N", help="Samples between refits.", min=1, show_default="as before, else 1",
            rich_help_panel=STRATEGY,
        ),
    ] = None  # fmt: skip
    drift: Annotated[DriftRule | None, drift_option("as before, else auto")] = None
    seed: Annotated[int | None, _seed("as before, else 0")] = None
    allow: Allow = None

    @property
    def allowed(self) -> Allowed:
        """Modules whose code may be run: see :func:`allowed_by`."""
        return allowed_by(self.allow, self.strategy or "", self.estimator or "")

    @property
    def given(self) -> dict[str, object]:
        """Fields of the settings that are given; another method begins without parameters."""
        own = values(self.strategy_setting) if self.strategy or self.strategy_setting else None
        known = numbers(self.estimator_setting)
        return only_given(
            strategy=self.strategy,
            strategy_settings=own,
            estimator=self.estimator,
            estimator_settings=known if self.estimator or known else None,
            refit_every=self.refit_every,
            drift=self.drift,
            seed=self.seed,
        )


def settings_of(
    before: Settings,
    field: Field,
    method: MethodOptions,
    limits: LimitOptions,
    pace: PaceOptions | None = None,
) -> Settings:
    """How to survey a field: as options say, and as it was decided before where they do not.

    Where nobody says how many samples to take, there are no more than cells.

    Raises
    ------
    ParameterError
        If strategy or estimator are unknown, there are fewer cells than samples, the limits
        leave no room for one stop, or the start is far from the field.
    """
    allowed = method.allowed
    fewest = {"samples": min(before.samples, len(field.cells))}
    given = {**fewest, **method.given, **limits.given(before.rates)}
    if pace is not None:
        given |= pace.given(before.pace, field)
    settings = Settings(**{**dict(before), **given})
    strategy_named(settings.strategy, settings.strategy_settings, allowed)
    estimator_named(settings.estimator, field.extent_m, settings.estimator_settings, allowed)
    return checked(settings, field)


def decided_anew(survey: Survey, settings: Settings) -> bool:
    """Whether settings are others than a survey already goes by."""
    return (settings, METHOD) != (survey.settings, survey.method)


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
