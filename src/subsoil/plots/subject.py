"""What a picture is of: a soil map, or the survey it comes from, which also knows its way."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from subsoil.arrays import Floats
from subsoil.mapping.soilmap import SoilMap
from subsoil.survey import Survey
from subsoil.ways import routing

Soil = SoilMap | Survey
"""A soil map, or a survey, whose map is drawn with its way and its refusals."""
_NOWHERE = np.empty((0, 2))


@dataclass(frozen=True)
class Subject:
    """What is known of what is drawn.

    Attributes
    ----------
    soil_map
        The map.
    way
        (p, 2) places in m along the way, from the start on; none where it is not known.
    refused
        (k, 2) places in m where no push gave a reading.
    cost
        What it took, in words.
    """

    soil_map: SoilMap
    way: Floats
    refused: Floats
    cost: str

    @property
    def on_land(self) -> str:
        """What it took, and how the land is cut into cells."""
        field = self.soil_map.field
        return f"{self.cost}; {field.crs or 'local frame'}, cells of {field.cell_size:g} m"


def subject(soil: Soil) -> Subject:
    """What is known of a soil map or a survey."""
    if isinstance(soil, SoilMap):
        return Subject(soil, _NOWHERE, _NOWHERE, _samples(len(soil.samples)) + _origin(soil))
    soil_map = soil.soil_map
    cost = f"{_samples(soil.taken)}, {soil.metres:.0f} m driven, {soil.minutes:.0f} min"
    refused = soil.field.cells[list(soil.refused)]
    return Subject(soil_map, way(soil), refused, cost + _origin(soil_map))


def way(survey: Survey) -> Floats:
    """(p, 2) places in m along the way of a survey.

    It leads from the start, where that was decided, through the samples in order, around
    what lies between them.
    """
    start = [survey.settings.start] if survey.method else []
    places = np.array([*start, *survey.soil_map.at.tolist()]).reshape(-1, 2)
    if not len(places):
        return places
    return routing.way(survey.access, places[0], places[1:])


def _samples(number: int) -> str:
    return f"{number} sample{'' if number == 1 else 's'}"


def _origin(soil_map: SoilMap) -> str:
    return ", simulated" if soil_map.simulated else ""
