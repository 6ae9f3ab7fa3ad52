"""Pictures as PNG files in a folder."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from subsoil.field import Field
from subsoil.plots.depth import profiles
from subsoil.plots.learning import learning_curves
from subsoil.plots.maps import depth_slices, std_dev
from subsoil.plots.semivariance import variograms
from subsoil.soilmap import SoilMap
from subsoil.survey import Survey
from subsoil.variogram import Fit

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from subsoil.report import Progress

DPI = 150


def readings_figures(
    soil_map: SoilMap, field: Field, fits: Sequence[Fit], folder: Path
) -> tuple[Path, ...]:
    """Save the pictures of a map of readings: slices, standard deviations, variograms, profiles.

    Parameters
    ----------
    soil_map
        Map of the readings.
    field
        The field that was mapped.
    fits
        How the variograms were come by, one a layer.
    folder
        Where to write to; it exists.

    Raises
    ------
    ReadingsError
        If no reading has measured a layer.
    ParameterError
        If there is not one fit a layer.
    MissingExtraError
        If matplotlib is not installed.
    """
    caption = _samples(len(soil_map.samples))
    figures = {
        "depth_slices": depth_slices(soil_map, field, caption=_on_land(caption, field)),
        "std_dev": std_dev(soil_map, field, caption=_on_land(caption, field)),
        "variograms": variograms(fits, soil_map, caption=caption),
        "profiles": profiles(soil_map, caption=caption),
    }
    return _save(figures, folder)


def survey_figures(
    survey: Survey, history: Sequence[Progress], fits: Sequence[Fit], folder: Path
) -> tuple[Path, ...]:
    """Save the pictures of a survey: those of its readings with the way, and learning curves.

    Parameters
    ----------
    survey
        Survey to draw.
    history
        Where it stood after its samples; without any there are no learning curves.
    fits
        How the variograms were come by, one a layer.
    folder
        Where to write to; it exists.

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
        f"{_samples(len(survey.visited))}, {survey.metres:.0f} m driven, {survey.minutes:.0f} min"
    )
    figures = {
        "depth_slices": depth_slices(
            soil_map,
            field,
            way=way(survey),
            refused=field.cells[list(survey.refused)],
            caption=_on_land(caption, field),
        ),
        "std_dev": std_dev(soil_map, field, caption=_on_land(caption, field)),
    }
    if history:
        figures["learning_curves"] = learning_curves(history, caption=caption)
    figures["variograms"] = variograms(fits, soil_map, caption=caption)
    figures["profiles"] = profiles(soil_map, caption=caption)
    return _save(figures, folder)


def way(survey: Survey) -> NDArray[np.float64]:
    """(k, 2) places in m: the start, where the survey was given one, and the samples in order."""
    start = [settings.start for settings in survey.settings[:1]]
    return np.array([*start, *survey.soil_map.at.tolist()]).reshape(-1, 2)


def _save(figures: dict[str, Figure], folder: Path) -> tuple[Path, ...]:
    paths = {name: Path(folder) / f"{name}.png" for name in figures}
    for name, figure in figures.items():
        figure.savefig(paths[name], dpi=DPI)
    return tuple(paths.values())


def _samples(number: int) -> str:
    return f"{number} sample{'' if number == 1 else 's'}"


def _on_land(caption: str, field: Field) -> str:
    return f"{caption}; {field.crs or 'local frame'}, cells of {field.cell_size:g} m"
