"""The report of a survey: its pictures, and one page that says what they are worth."""

from __future__ import annotations

import base64
import math
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import import_module, resources
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

import numpy as np

from subsoil.errors import MissingExtraError
from subsoil.layers import LayerState
from subsoil.plots.album import DPI, survey_figures
from subsoil.plots.semivariance import kriged_with, remark
from subsoil.soilmap import SoilMap
from subsoil.survey import Survey
from subsoil.uncertainty import standard_deviation
from subsoil.variogram import Fit, name_of

if TYPE_CHECKING:
    from collections.abc import Iterator

_TEMPLATE = "report.html.j2"
_SCREEN_DPI = 96
_CAPTIONS = {
    "depth_slices": "Kriged mean of every layer, all on one colour scale. The line joins the "
    "samples in the order they were taken.",
    "std_dev": "Kriging standard deviation: how far the soil may be from the mean, if the "
    "variograms are right.",
    "learning_curves": "Error and kriging variance after every sample. The variance may rise when "
    "the variograms are fitted anew.",
    "variograms": "Half the mean squared difference of two samples by their distance, with the "
    "number of pairs in each bin, and the curve fitted to it.",
    "profiles": "Layer means of every sample. An arrow stands where the force limit ended the "
    "push: the soil resists that or more. Roots hardly grow beyond 2 MPa.",
}


@dataclass(frozen=True)
class Progress:
    """Where a survey stood after one of its samples.

    Attributes
    ----------
    samples
        Readings taken.
    metres, minutes
        Way driven in m and time spent in min.
    mean_kv
        Field average of the kriging variance in kPa2.
    rmse
        Root mean square error of the map against the simulated truth in kPa; NaN without one.
    """

    samples: int
    metres: float
    minutes: float
    mean_kv: float
    rmse: float


@dataclass(frozen=True)
class Picture:
    """A picture of the page.

    Attributes
    ----------
    file
        Name of its file.
    caption
        What it shows.
    source
        The picture itself, as a ``data:`` address.
    width
        Its width on a screen in pixels.
    """

    file: str
    caption: str
    source: str
    width: int


@dataclass(frozen=True)
class _Row:
    """A layer in the table of layers, as text."""

    name: str
    numbers: tuple[str, ...]
    model: str
    parameters: tuple[str, ...]
    why: str
    remark: str


def write_report(
    survey: Survey,
    history: Sequence[Progress],
    fits: Sequence[Fit],
    folder: Path,
    *,
    title: str = "",
) -> Path:
    """Write ``report.html`` and the pictures in it as PNG files; returns the path of the page.

    The page holds its pictures and needs nothing else, neither files nor a network.

    Parameters
    ----------
    survey
        Survey to report on, finished or not.
    history
        Where it stood after its samples; without any there are no learning curves.
    fits
        How the variograms were come by, one a layer.
    folder
        Where to write to; it exists.
    title
        Heading of the page. Default: the name of the survey.

    Raises
    ------
    ReadingsError
        If no sample has measured a layer yet.
    ParameterError
        If there is not one fit a layer.
    MissingExtraError
        If matplotlib or jinja2 is not installed.
    """
    paths = survey_figures(survey, history, fits, folder)
    text = page(survey, history, fits, [_picture(path) for path in paths], title=title)
    path = Path(folder) / "report.html"
    path.write_text(text, encoding="utf-8")
    return path


def page(
    survey: Survey,
    history: Sequence[Progress],
    fits: Sequence[Fit],
    pictures: Sequence[Picture],
    *,
    title: str = "",
) -> str:
    """Return the HTML of a report.

    Parameters
    ----------
    survey, history, fits, title
        As in :func:`write_report`.
    pictures
        What to show, in order.

    Raises
    ------
    MissingExtraError
        If jinja2 is not installed.
    """
    jinja2 = _jinja2()
    environment = jinja2.Environment(
        autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    source = resources.files("subsoil").joinpath(_TEMPLATE).read_text(encoding="utf-8")
    text: str = environment.from_string(source).render(
        title=title or survey.name,
        headline=dict(_headline(survey, history)),
        layers=_rows(survey, fits),
        notes=tuple(_notes(survey, history, fits)),
        pictures=pictures,
        finished=survey.finished,
    )
    return text


def _headline(survey: Survey, history: Sequence[Progress]) -> Iterator[tuple[str, str]]:
    """Names and values of the first table."""
    field = survey.field
    yield "Field", field.name
    yield "Area", f"{field.area_ha:.2f} ha, {len(field.cells)} cells of {field.cell_size:g} m"
    yield "CRS", field.crs or "none: a local frame"
    yield "Samples", str(len(survey.visited))
    yield "Stops without a reading", str(len(survey.refused))
    yield "Way driven", f"{survey.metres:.0f} m"
    yield "Time", f"{survey.minutes:.0f} min"
    yield "Mean kriging variance", _variance(survey.mean_kv)
    if history and math.isfinite(history[-1].rmse):
        last = history[-1]
        after = _count(last.samples, "sample", "samples")
        yield "RMSE", f"{last.rmse:.0f} kPa against the simulated truth after {after}"
    for settings in survey.settings[-1:]:
        yield "Strategy", settings.strategy
        every = f"{settings.refit_every} samples" if settings.refit_every > 1 else "sample"
        yield "Estimator", f"{settings.estimator}, fitted anew every {every}"
        yield "Seed", str(settings.seed)
        yield "World", settings.world
    yield "Cone", f"{survey.cone.area_mm2:g} mm², {survey.cone.angle_deg:g}°"
    yield (
        "State",
        survey.finished or f"under way, {_count(len(survey.plan), 'stop', 'stops')} planned",
    )


def _variance(kpa2: float) -> str:
    if math.isnan(kpa2):
        return "unknown: one sample tells no variance"
    return f"{kpa2:,.0f} kPa², a standard deviation of {float(standard_deviation(kpa2)):.0f} kPa"


def _rows(survey: Survey, fits: Sequence[Fit]) -> tuple[_Row, ...]:
    """Table of layers: mean and spread of the map, its standard deviation, and its variogram."""
    soil_map = survey.soil_map
    deviation = standard_deviation(soil_map.variance)
    used = kriged_with(soil_map)
    return tuple(
        _Row(
            name,
            _whole(
                np.isfinite(soil_map.kpa[k]).sum(),
                soil_map.mean[k].mean(),
                soil_map.mean[k].std(),
                deviation[k].mean(),
            ),
            name_of(fit.variogram),
            _whole(fit.variogram.nugget, fit.variogram.sill, fit.variogram.range),
            fit.why,
            remark(fit, used[k]),
        )
        for k, (name, fit) in enumerate(zip(soil_map.layers.names, fits, strict=True))
    )


def _whole(*numbers: float) -> tuple[str, ...]:
    """Whole numbers as text, with a dash where there is none."""
    return tuple(f"{number:,.0f}" if math.isfinite(number) else "–" for number in numbers)


def _notes(survey: Survey, history: Sequence[Progress], fits: Sequence[Fit]) -> Iterator[str]:
    """What a reader has to know before trusting the map."""
    soil_map = survey.soil_map
    yield (
        "The standard deviation takes the variograms for known. They were estimated from these "
        "samples, so the true uncertainty is larger, most of all with few samples."
    )
    if len(soil_map.samples) == 1:
        yield "One sample tells no variance: standard deviations follow from an assumed sill."
    if priors := sum(fit.is_prior for fit in fits):
        yield (
            f"In {priors} of {_count(len(fits), 'layer', 'layers')} there is too little to fit a "
            "variogram to: it is a prior, and the standard deviation follows from it."
        )
    if bounds := _pushes(soil_map, LayerState.AT_LEAST):
        yield (
            f"The force limit ended {_count(bounds, 'push', 'pushes')} inside a layer. Such lower "
            "bounds are shown but not kriged: where soil is hardest the map is likely too soft."
        )
    if short := _pushes(soil_map, LayerState.UNREACHED):
        pushes = _count(short, "push", "pushes")
        yield f"{pushes} did not reach the deepest layer: deeper layers have fewer samples."
    if survey.refused:
        yield (
            f"{_count(len(survey.refused), 'stop', 'stops')} gave no reading: a cross on the map, "
            "not on the line, though metres and minutes count."
        )
    if history and math.isfinite(history[-1].rmse):
        yield (
            "The truth is simulated, and its error says how the survey did on that soil. It does "
            "not say how it would do on another field."
        )
    yield from soil_map.notes


def _pushes(soil_map: SoilMap, state: LayerState) -> int:
    """Count the samples with a layer in a state."""
    return sum(bool((sample.state == state).any()) for sample in soil_map.samples)


def _picture(path: Path) -> Picture:
    png = path.read_bytes()
    pixels = int.from_bytes(png[16:20], "big")
    source = "data:image/png;base64," + base64.b64encode(png).decode("ascii")
    return Picture(path.name, _CAPTIONS[path.stem], source, pixels * _SCREEN_DPI // DPI)


def _count(number: int, one: str, several: str) -> str:
    return f"{number} {one if number == 1 else several}"


def _jinja2() -> ModuleType:
    try:
        return import_module("jinja2")
    except ImportError as error:
        raise MissingExtraError(
            "the report needs jinja2, which is not installed", remedy="pip install 'subsoil[plot]'"
        ) from error
