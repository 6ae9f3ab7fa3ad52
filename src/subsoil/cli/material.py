"""Readings to look at, from whatever file."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from subsoil.arrays import Floats
from subsoil.cli.field import (
    Crs,
    Edges,
    Fence,
    Mapped,
    OptionalConeArea,
    PositionsFile,
    ReaderName,
    ReadingsFile,
    ReadingUnit,
)
from subsoil.cli.options import (
    DEFAULT_EDGES,
    EstimatorName,
    EstimatorSettings,
    allowed_by,
    layers_of,
    numbers,
)
from subsoil.errors import ParameterError, brief
from subsoil.findings import left_out
from subsoil.io.read.readings import read_readings
from subsoil.io.read.strays import FENCE_M
from subsoil.journal import is_foreign, read_events
from subsoil.kriging.drift import NO_COVARIATE, Covariate
from subsoil.kriging.memory import check_memory
from subsoil.land.field import Field
from subsoil.layers import Layers
from subsoil.penetrometer import Cone
from subsoil.readings import Readings, finer_than_readings
from subsoil.survey import DEFAULT_ESTIMATOR, fold
from subsoil.survey.measured import readings_of
from subsoil.variogram import Estimator, estimator_named


@dataclass(frozen=True)
class Material:
    """Readings, and the layers to look at them in.

    Attributes
    ----------
    readings
        Of a file or a survey.
    layers
        Those asked for, or of the survey.
    field, covariate
        Of the survey, if it is one.
    """

    readings: Readings
    layers: Layers
    field: Field | None = None
    covariate: Covariate = NO_COVARIATE

    @cached_property
    def kpa(self) -> Floats:
        """(m, n) layer means in kPa, NaN where not measured."""
        return self.readings.layer_means(self.layers)

    def check_memory(self, *, alike: bool, cells: int = 0) -> None:
        """Check that kriging and leaving out fit into the memory of this machine.

        Parameters
        ----------
        alike
            Whether layers that the same readings reached share a system, or each has its own.
        cells
            Cells of the map, if there is one.

        Raises
        ------
        ReadingsError
            If they do not.
        """
        reached = np.isfinite(self.kpa)
        systems = np.unique(reached, axis=0) if alike else reached
        check_memory(
            len(self.readings),
            systems=[int(readings) for readings in systems.sum(axis=1)],
            cells=cells,
            layers=len(self.layers),
        )


@dataclass(frozen=True, kw_only=True)
class ReadingOptions:
    """How to read files of readings, as the command line says it.

    Attributes
    ----------
    cone_area, reading_unit, crs
        What they were taken with and in, where they do not say.
    map, reader, positions
        What headings mean, what reads them, and where pushes were, where they do not say.
    fence
        How far outside the field one still belongs to it, in m.
    """

    cone_area: OptionalConeArea = None
    reading_unit: ReadingUnit = None
    crs: Crs = None
    map: Mapped = None
    reader: ReaderName = ""
    positions: PositionsFile = None
    fence: Fence = FENCE_M

    def readings_in(self, path: Path, field: Field | None) -> Readings:
        """Readings of a file, those of a field if there is one."""
        cone = Cone(self.cone_area) if self.cone_area is not None else None
        allowed_by(None, self.reader)  # so that a reader of one's own is found in this folder
        return read_readings(
            path,
            field=field,
            crs=self.crs,
            cone=cone,
            units=self.reading_unit,
            meanings=meanings_of(self.map),
            reader=self.reader,
            positions=self.positions,
            fence_m=self.fence,
        )


@dataclass(frozen=True, kw_only=True)
class MaterialOptions(ReadingOptions):
    """Readings to look at, and how, as the command line says it.

    Attributes
    ----------
    readings, layers
        The file or survey, and in which layers to look at it.
    estimator, setting
        How variograms are estimated.
    """

    readings: ReadingsFile
    layers: Edges = DEFAULT_EDGES
    estimator: EstimatorName = DEFAULT_ESTIMATOR
    setting: EstimatorSettings = None

    def read(self, field: Field | None) -> Material:
        """Readings of the file or the survey, those of a field if there is one.

        Raises
        ------
        ParameterError
            If there are fewer than three.
        """
        may_be_survey = self.readings.suffix.lower() == ".gpkg" and not self.reader
        if may_be_survey and not is_foreign(self.readings):
            survey = fold(read_events(self.readings))
            readings = readings_of(survey)
            if field is not None:
                readings = replace(readings, extent_m=field.extent_m)
            known = survey.soil_map.covariate
            return _enough(Material(readings, survey.layers, survey.field, known), self.readings)
        readings = self.readings_in(self.readings, field)
        layers = layers_of(self.layers)
        fine = finer_than_readings(readings, layers)
        readings = replace(readings, findings=(*readings.findings, *fine))
        return _enough(Material(readings, layers), self.readings)

    def estimator_of(self, material: Material) -> Estimator:
        """What estimates the variograms.

        Raises
        ------
        ParameterError
            If there is none of that name, or with such settings.
        """
        extent_m = material.readings.extent_m
        return estimator_named(self.estimator, extent_m, numbers(self.setting))


def meanings_of(mapped: list[str] | None) -> dict[str, str]:
    """What headings mean, given as ``heading=meaning``.

    Raises
    ------
    ParameterError
        If one has no heading or no meaning.

    Examples
    --------
    >>> meanings_of(["pen1=kpa at 10 cm", "x=y=easting"])
    {'pen1': 'kpa at 10 cm', 'x=y': 'easting'}
    """
    found = {}
    for each in mapped or ():
        heading, _, meaning = each.rpartition("=")
        if not (heading.strip() and meaning.strip()):
            raise ParameterError(
                f"{brief(each)!r} is not heading=meaning",
                where="--map",
                remedy="for instance --map 'pen1=kpa at 10 cm'",
            )
        found[heading.strip()] = meaning.strip()
    return found


def _enough(material: Material, path: Path) -> Material:
    """Check that readings can be scored; returns them."""
    number, refused = len(material.readings), left_out(material.readings.findings)
    if number < 3:
        left = f", {len(refused)} were left out" if refused else ""
        first = f" (first {refused[0]})" if refused else ""
        raise ParameterError(
            f"{number} readings are too few to score a map{left}{first}",
            where=str(path),
            remedy="take three or more",
        )
    return material
