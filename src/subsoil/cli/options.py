"""Options that verbs share, and what they are when not given."""

from __future__ import annotations

import math
import os
import sys
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Annotated

import numpy as np
import typer
from numpy.typing import NDArray

from subsoil.cli.parsing import STRATEGY, one_of
from subsoil.errors import ParameterError, brief
from subsoil.land.field import Field
from subsoil.layers import Layers
from subsoil.mapping.drift_choice import DriftRule
from subsoil.registry import NOBODY, imported, module_of
from subsoil.stopping import Goal, Rates
from subsoil.strategies import STRATEGIES, strategy_named
from subsoil.survey import DEFAULT_ESTIMATOR, DEFAULT_STRATEGY, Settings, checked
from subsoil.variogram import ESTIMATORS, estimator_named

SurveyFile = Annotated[
    Path, typer.Argument(help="Survey file, a GeoPackage.", metavar="SURVEY.gpkg")
]
Boundary = Annotated[
    Path, typer.Option(help="Outline of the field: GeoJSON, .coords, GeoPackage, shapefile, KML.")
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
Samples = Annotated[int, typer.Option(help="Readings to take.", min=1)]
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
    ),
]
StrategySettings = Annotated[
    list[str] | None,
    typer.Option(
        "--strategy-setting",
        metavar="NAME=VALUE",
        help="Parameter of the strategy, such as way=0.8; may be repeated.",
    ),
]
Allow = Annotated[
    list[str] | None,
    typer.Option(
        metavar="MODULE",
        help="Module whose strategies a survey file may name and run; may be repeated.",
    ),
]
CellSize = Annotated[float, typer.Option(help="Side of a cell in m.")]
ConeArea = Annotated[
    float, typer.Option(help="Base area of the cone in mm2: 130 or 323 as a rule.")
]

Edges = Annotated[str, typer.Option(help="Edges of the depth layers in m, comma-separated.")]

_FREE = Rates()
_NONE: Mapping[str, float] = MappingProxyType({})
DEFAULT_EDGES = "0,0.05,0.1,0.15,0.2,0.25,0.3,0.35,0.4"


def settings_of(
    field: Field,
    strategy: str,
    samples: int,
    seed: int,
    *,
    estimator: str = DEFAULT_ESTIMATOR,
    refit_every: int = 1,
    metres: float = math.inf,
    minutes: float = math.inf,
    mean_kv: float = 0.0,
    money: float = math.inf,
    rates: Rates = _FREE,
    goals: tuple[Goal, ...] = (),
    strategy_settings: Mapping[str, float | str] = _NONE,
    estimator_settings: Mapping[str, float] = _NONE,
    drift: DriftRule = "auto",
    allowed: frozenset[str] = NOBODY,
) -> Settings:
    """How to survey a field, as options say.

    Raises
    ------
    ParameterError
        If strategy or estimator are unknown, there are fewer cells than samples, or the limits
        leave no room for one stop.
    """
    strategy_named(strategy, dict(strategy_settings), allowed)
    estimator_named(estimator, field.extent_m, estimator_settings, allowed)
    settings = Settings(
        start=field.entrance,
        strategy=strategy,
        strategy_settings=dict(strategy_settings),
        estimator=estimator,
        estimator_settings=dict(estimator_settings),
        refit_every=refit_every,
        seed=seed,
        samples=samples,
        metres=metres,
        minutes=minutes,
        mean_kv=mean_kv,
        money=money,
        rates=rates,
        goals=goals,
        drift=drift,
    )
    return checked(settings, field)


def allowed_by(modules: list[str] | None, *typed: str) -> frozenset[str]:
    """Modules whose code may be run: those allowed, and those of names that the user typed.

    For these the current folder is searched too, after everything else.

    Raises
    ------
    ParameterError
        If one that is allowed cannot be imported.
    """
    allowed = frozenset(name.partition(":")[0] for name in modules or ())
    own = allowed.union(*(module_of(name) for name in typed))
    if own and os.getcwd() not in sys.path:
        sys.path.append(os.getcwd())
    for module in sorted(allowed):
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


def extent_of(at: NDArray[np.float64]) -> float:
    """Diagonal in m of the box around (n, 2) places, one metre at least."""
    return max(float(np.hypot(*np.ptp(at, axis=0))), 1.0)


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


__all__ = ["DEFAULT_ESTIMATOR", "DEFAULT_STRATEGY"]
