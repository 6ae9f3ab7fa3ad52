"""Options that verbs share, and what they are when not given."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated

import numpy as np
import shapely
import typer

from subsoil.cli.worlds import check_world
from subsoil.errors import ParameterError
from subsoil.events import Configured
from subsoil.field import Field
from subsoil.layers import Layers
from subsoil.strategies import strategy_named
from subsoil.variogram import estimator_named

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

Edges = Annotated[str, typer.Option(help="Edges of the depth layers in m, comma-separated.")]

DEFAULT_STRATEGY = "adaptive-monte-carlo"
DEFAULT_ESTIMATOR = "paper-10"
DEFAULT_EDGES = "0,0.05,0.1,0.15,0.2,0.25,0.3,0.35,0.4"


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
        start=_start_of(field),
        world=world,
        samples=samples,
        metres=metres,
        minutes=minutes,
        mean_kv=mean_kv,
    )


def _start_of(field: Field) -> tuple[float, float]:
    """Where an agent enters a field: the corner of its outline nearest to the south-west."""
    west, south, _, _ = field.boundary.bounds
    corners = shapely.get_coordinates(field.boundary)
    gate = np.argmin(np.hypot(corners[:, 0] - west, corners[:, 1] - south))
    return (float(corners[gate, 0]), float(corners[gate, 1]))


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
