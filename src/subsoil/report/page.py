"""The page of a report, and its files."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING

from subsoil.errors import printable
from subsoil.io.write.whole import whole
from subsoil.optional import REPORT, load
from subsoil.plots.album import draw_survey
from subsoil.plots.saving import DPI, Format, as_png, save_all
from subsoil.report.wording import headline, notes, rows
from subsoil.survey import Survey
from subsoil.survey.progress import Progress
from subsoil.units import METRIC, Units
from subsoil.variogram import Fit

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_TEMPLATE = "page.html.j2"
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


def write_report(
    survey: Survey,
    history: Sequence[Progress],
    fits: Sequence[Fit],
    folder: Path,
    *,
    title: str = "",
    fingerprint: str = "",
    units: Units = METRIC,
    figures: Format = "png",
) -> Path:
    """Write ``report.html`` and the pictures in it as files; returns the path of the page.

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
    fingerprint
        Of the survey file's events, as ``subsoil status`` prints it; shown if given.
    units
        What its tables and its outlook are in. Pictures and notes are metric.
    figures
        Format of the files; the page itself holds pixels.

    Raises
    ------
    ReadingsError
        If no sample has measured a layer yet.
    ParameterError
        If there is not one fit a layer.
    MissingExtraError
        If matplotlib or jinja2 is not installed.
    """
    drawn = draw_survey(survey, history, fits)
    pictures = [_picture(name, figure, figures) for name, figure in drawn.items()]
    text = render(
        survey, history, fits, pictures, title=title, fingerprint=fingerprint, units=units
    )
    save_all(drawn, folder, figures)
    path = Path(folder) / "report.html"
    with whole(path) as unfinished:
        unfinished.write_text(text, encoding="utf-8")
    return path


def render(
    survey: Survey,
    history: Sequence[Progress],
    fits: Sequence[Fit],
    pictures: Sequence[Picture],
    *,
    title: str = "",
    fingerprint: str = "",
    units: Units = METRIC,
) -> str:
    """Return the HTML of a report.

    Parameters
    ----------
    survey, history, fits, title, fingerprint, units
        As in :func:`write_report`.
    pictures
        What to show, in order.

    Raises
    ------
    MissingExtraError
        If jinja2 is not installed.
    """
    jinja2 = load(*REPORT)
    environment = jinja2.Environment(
        autoescape=True,
        finalize=lambda value: printable(value) if isinstance(value, str) else value,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    source = resources.files("subsoil.report").joinpath(_TEMPLATE).read_text(encoding="utf-8")
    text: str = environment.from_string(source).render(
        title=title or survey.name,
        headline=dict(headline(survey, history, units)),
        layers=rows(survey, fits, units),
        units=units,
        notes=tuple(notes(survey, history, fits)),
        pictures=pictures,
        finished=survey.finished,
        fingerprint=fingerprint,
    )
    return text


def _picture(name: str, figure: Figure, form: Format) -> Picture:
    png = as_png(figure)
    pixels = int.from_bytes(png[16:20], "big")
    source = "data:image/png;base64," + base64.b64encode(png).decode("ascii")
    return Picture(f"{name}.{form}", _CAPTIONS[name], source, pixels * _SCREEN_DPI // DPI)
