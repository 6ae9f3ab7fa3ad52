"""A small survey, done in memory, to draw and to report on."""

from __future__ import annotations

from collections.abc import Callable

import pytest

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
