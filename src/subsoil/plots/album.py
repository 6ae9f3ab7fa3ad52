"""All pictures of a survey, or of a map of readings, by name and as PNG files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from subsoil.arrays import Floats
from subsoil.io.write.whole import whole
from subsoil.land.field import Field
from subsoil.mapping.soilmap import SoilMap
from subsoil.plots.depth import profiles
from subsoil.plots.learning import learning_curves
from subsoil.plots.maps import depth_slices, std_dev
from subsoil.plots.semivariance import variograms
from subsoil.survey import Survey
from subsoil.variogram import Fit
from subsoil.ways import routing

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from subsoil.survey.progress import Progress

DPI = 150
"""Dots per inch of a PNG file."""


def readings_figures(soil_map: SoilMap, fits: Sequence[Fit], folder: Path) -> tuple[Path, ...]:
    """Save the pictures of :func:`draw_readings` as PNG files in a folder; returns their paths."""
    return _save(draw_readings(soil_map, fits), folder)


def survey_figures(
    survey: Survey, history: Sequence[Progress], fits: Sequence[Fit], folder: Path
) -> tuple[Path, ...]:
    """Save the pictures of :func:`draw_survey` as PNG files in a folder; returns their paths."""
    return _save(draw_survey(survey, history, fits), folder)


def draw_readings(soil_map: SoilMap, fits: Sequence[Fit]) -> dict[str, Figure]:
    """Depth slices, standard deviations, variograms and profiles of a map of readings, by name.

    Parameters
    ----------
    soil_map
        Map of the readings.
    fits
        How the variograms were come by, one a layer.

    Raises
    ------
    ReadingsError
        If no reading has measured a layer.
    ParameterError
        If there is not one fit a layer.
    MissingExtraError
        If matplotlib is not installed.
    """
    field, caption = soil_map.field, _samples(len(soil_map.samples)) + _origin(soil_map)
    return {
        "depth_slices": depth_slices(soil_map, caption=_on_land(caption, field)),
        "std_dev": std_dev(soil_map, caption=_on_land(caption, field)),
        "variograms": variograms(fits, soil_map, caption=caption),
        "profiles": profiles(soil_map, caption=caption),
    }


def draw_survey(
    survey: Survey, history: Sequence[Progress], fits: Sequence[Fit]
) -> dict[str, Figure]:
    """Pictures of a survey by name: as of its readings, with its way and learning curves.

    Parameters
    ----------
    survey
        Survey to draw.
    history
        Where it stood after its samples; without any there are no learning curves.
    fits
        How the variograms were come by, one a layer.

    Raises
    ------
    ReadingsError
        If no sample has measured a layer yet.
    ParameterError
        If there is not one fit a layer.
    MissingExtraError
        If matplotlib is not installed.
    """
    soil_map, field = survey.soil_map, survey.field
    caption = (
        f"{_samples(survey.taken)}, {survey.metres:.0f} m driven, {survey.minutes:.0f} min"
        f"{_origin(soil_map)}"
    )
    slices = depth_slices(
        soil_map,
        way=way(survey),
        refused=field.cells[list(survey.refused)],
        caption=_on_land(caption, field),
    )
    curves = {"learning_curves": learning_curves(history, caption=caption)} if history else {}
    return {
        "depth_slices": slices,
        "std_dev": std_dev(soil_map, caption=_on_land(caption, field)),
        **curves,
        "variograms": variograms(fits, soil_map, caption=caption),
        "profiles": profiles(soil_map, caption=caption),
    }


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


def _save(figures: Mapping[str, Figure], folder: Path) -> tuple[Path, ...]:
    paths = {name: Path(folder) / f"{name}.png" for name in figures}
    for name, figure in figures.items():
        with whole(paths[name]) as unfinished:
            figure.savefig(unfinished, dpi=DPI)
    return tuple(paths.values())


def _samples(number: int) -> str:
    return f"{number} sample{'' if number == 1 else 's'}"


def _origin(soil_map: SoilMap) -> str:
    return ", simulated" if soil_map.simulated else ""


def _on_land(caption: str, field: Field) -> str:
    return f"{caption}; {field.crs or 'local frame'}, cells of {field.cell_size:g} m"
