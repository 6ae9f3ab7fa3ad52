"""All pictures of a survey, or of a map of readings, by name."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from subsoil.mapping.soilmap import SoilMap
from subsoil.plots.depth import profiles
from subsoil.plots.learning import learning_curves
from subsoil.plots.maps import depth_slices, std_dev
from subsoil.plots.semivariance import variograms
from subsoil.plots.subject import subject
from subsoil.survey import Survey
from subsoil.variogram import Fit

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from subsoil.survey.progress import Progress


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
    return {
        "depth_slices": depth_slices(soil_map),
        "std_dev": std_dev(soil_map),
        "variograms": variograms(fits, soil_map),
        "profiles": profiles(soil_map),
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
    cost = subject(survey).cost
    curves = {"learning_curves": learning_curves(history, caption=cost)} if history else {}
    return {
        "depth_slices": depth_slices(survey),
        "std_dev": std_dev(survey),
        **curves,
        "variograms": variograms(fits, survey),
        "profiles": profiles(survey),
    }
