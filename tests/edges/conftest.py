"""A small survey, done in memory, to draw and to report on."""

from __future__ import annotations

from collections.abc import Callable
from itertools import combinations

import pytest
from matplotlib.artist import Artist
from matplotlib.figure import Figure, SubFigure
from matplotlib.text import Text

from subsoil.mapping.scores import rmse
from subsoil.report import Progress
from subsoil.simulation import Truth
from subsoil.survey import LocalDispatch, Memory, Survey, fits_of, opened
from subsoil.survey.events import Configured, Event, Opened, Planned
from subsoil.variogram import Fit

SAMPLES = 8


@pytest.fixture(scope="session")
def done(
    plot_opened: Opened,
    plot_truth: Truth,
    configured: Callable[..., Configured],
    work: Callable[[LocalDispatch, Truth], str],
) -> tuple[Survey, tuple[Progress, ...]]:
    """Eight samples on the plot, and how that went."""
    history: list[Progress] = []

    def follow(survey: Survey, event: Event) -> None:
        if isinstance(event, Planned) and survey.taken:
            history.append(_progress(survey, plot_truth))

    dispatch = LocalDispatch(opened(plot_opened), Memory(), follow)
    dispatch.record(configured(samples=SAMPLES))
    work(dispatch, plot_truth)
    history.append(_progress(dispatch.survey, plot_truth))
    return dispatch.survey, tuple(history)


@pytest.fixture(scope="session")
def survey(done: tuple[Survey, tuple[Progress, ...]]) -> Survey:
    """A survey of eight samples on the plot."""
    return done[0]


@pytest.fixture(scope="session")
def history(done: tuple[Survey, tuple[Progress, ...]]) -> tuple[Progress, ...]:
    """Where that survey stood after its samples."""
    return done[1]


@pytest.fixture(scope="session")
def fits(survey: Survey) -> tuple[Fit, ...]:
    """Fits of its variograms."""
    return fits_of(survey)


def _progress(survey: Survey, truth: Truth) -> Progress:
    spent, error = survey.spent, rmse(survey.soil_map.mean, truth.kpa)
    return Progress(spent.samples, spent.metres, spent.minutes, spent.mean_kv, error)


@pytest.fixture(scope="session")
def assert_legible() -> Callable[[Figure | SubFigure], None]:
    """All that is drawn lies on the figure or the part of one, and no two texts on each other."""
    return _assert_legible


def _assert_legible(figure: Figure | SubFigure) -> None:
    figure.figure.draw_without_rendering()
    found = [text for text in _shown(figure) if text.get_text().strip()]
    boxes = {text: text.get_window_extent() for text in found}
    drawn = [(axes, axes.get_tightbbox()) for axes in figure.axes]
    legends = [(legend, legend.get_window_extent()) for legend in figure.legends]
    for artist, box in (*boxes.items(), *drawn, *legends):
        assert box is not None
        assert figure.bbox.x0 <= box.x0, artist
        assert box.x1 <= figure.bbox.x1, artist
        assert figure.bbox.y0 <= box.y0, artist
        assert box.y1 <= figure.bbox.y1, artist
    for one, other in combinations(found, 2):
        assert not boxes[one].overlaps(boxes[other]), (one, other)


def _shown(figure: Figure | SubFigure) -> list[Text]:
    """Texts that are drawn: not those of axes that are off, nor labels of ticks out of sight."""
    hidden: set[Artist] = set()
    for axes in figure.axes:
        for axis in (axes.xaxis, axes.yaxis):
            low, high = sorted(axis.get_view_interval())
            near = [t for t in axis.get_major_ticks() if low <= t.get_loc() <= high]
            drawn = {axis.label, *(t.label1 for t in near), *(t.label2 for t in near)}
            hidden |= set(axis.findobj(Text)) - (drawn if axes.axison else set())
    texts = [text for text in figure.findobj(Text) if isinstance(text, Text)]
    return [text for text in texts if text.get_visible() and text not in hidden]
