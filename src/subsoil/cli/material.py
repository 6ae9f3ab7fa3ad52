"""Readings to look at, from whatever file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from subsoil.cli.options import layers_of
from subsoil.errors import ParameterError
from subsoil.field import Field
from subsoil.io.readings import read_readings
from subsoil.journal import read_events
from subsoil.layers import Layers, Sample
from subsoil.penetrometer import Cone
from subsoil.survey import fold


@dataclass(frozen=True)
class Material:
    """Readings to look at, from whatever file.

    Attributes
    ----------
    samples
        Layer values by place.
    layers
        Depth bands.
    refused
        What was left out, a line each.
    notes
        What to know of the file and of the field as wholes, a line each.
    simulated
        Whether they are of a soil that was drawn.
    """

    samples: tuple[Sample, ...]
    layers: Layers
    refused: tuple[str, ...]
    notes: tuple[str, ...] = ()
    simulated: bool = False

    @property
    def at(self) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
        """(n, 2) places in m."""
        return np.array([sample.at for sample in self.samples], dtype=float).reshape(-1, 2)

    @property
    def kpa(self) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
        """(m, n) measured kPa, NaN where not measured."""
        return np.array([sample.measured_kpa for sample in self.samples]).T

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
        material = Material(
            survey.soil_map.samples, survey.layers, (), survey.notes, survey.simulated
        )
    else:
        cone = Cone(cone_area) if cone_area is not None else None
        readings = read_readings(path, field=field, crs=crs, cone=cone, units=units)
        layers = layers_of(edges)
        samples = tuple(
            layers.sample(profile, at)
            for profile, at in zip(readings.profiles, readings.at, strict=True)
        )
        refused = tuple(str(finding) for finding in readings.refused)
        of_field = field.notes if field else ()
        material = Material(samples, layers, refused, (*of_field, *readings.notes))
    if len(material.samples) < 3:
        left = f", {len(material.refused)} were left out" if material.refused else ""
        first = f" (first {material.refused[0]})" if material.refused else ""
        raise ParameterError(
            f"{len(material.samples)} readings are too few to score a map{left}{first}",
            where=str(path),
            remedy="take three or more",
        )
    return material
