"""Readings to look at, from whatever file."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from subsoil.cli.options import layers_of
from subsoil.errors import ParameterError
from subsoil.io.readings import read_readings
from subsoil.journal import read_events
from subsoil.land.field import Field
from subsoil.layers import Layers
from subsoil.penetrometer import Cone
from subsoil.readings import Readings
from subsoil.survey import fold
from subsoil.survey.measured import readings_of


@dataclass(frozen=True)
class Material:
    """Readings, and the layers to look at them in.

    Attributes
    ----------
    readings
        Of a file or a survey.
    layers
        Those asked for, or of the survey.
    """

    readings: Readings
    layers: Layers

    @cached_property
    def kpa(self) -> NDArray[np.float64]:
        """(m, n) layer means in kPa, NaN where not measured."""
        return self.readings.layer_means(self.layers)

    def systems(self, alike: bool) -> list[int]:
        """Readings in each kriging system of a map: of each layer, or, alike, each set of them."""
        reached = np.isfinite(self.kpa)
        systems = np.unique(reached, axis=0) if alike else reached
        return [int(readings) for readings in systems.sum(axis=1)]


def material_of(
    path: Path,
    edges: str,
    field: Field | None,
    crs: str | None,
    cone_area: float | None,
    units: str | None,
) -> Material:
    """Readings of a file or a survey, in layers of some edges.

    Raises
    ------
    ParameterError
        If there are fewer than three.
    """
    if path.suffix.lower() == ".gpkg":
        survey = fold(read_events(path))
        material = Material(readings_of(survey), survey.layers)
    else:
        cone = Cone(cone_area) if cone_area is not None else None
        readings = read_readings(path, field=field, crs=crs, cone=cone, units=units)
        material = Material(readings, layers_of(edges))
    number, refused = len(material.readings), material.readings.refused
    if number < 3:
        left = f", {len(refused)} were left out" if refused else ""
        first = f" (first {refused[0]})" if refused else ""
        raise ParameterError(
            f"{number} readings are too few to score a map{left}{first}",
            where=str(path),
            remedy="take three or more",
        )
    return material
