"""A small survey, done in memory, to draw and to report on."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from subsoil.dispatch import LocalDispatch, drive
from subsoil.events import Configured, Event, Opened, Planned
from subsoil.report import Progress
from subsoil.scores import rmse
from subsoil.simulation import SimulatedRobot, Truth
from subsoil.survey import Survey, apply, estimator_of, opened
from subsoil.variogram import Fit

SAMPLES = 8


class Forgetful:
    """Recorder that keeps nothing."""

    def append(self, event: Event, survey: Survey) -> None:
        pass


@pytest.fixture(scope="session")
def done(
    plot_opened: Opened,
    plot_truth: Truth,
    configured: Callable[..., Configured],
    robot_at: Callable[[Survey, Truth], SimulatedRobot],
) -> tuple[Survey, tuple[Progress, ...]]:
    """Eight samples on the plot, and how that went."""
    history: list[Progress] = []

    def follow(survey: Survey, event: Event) -> None:
        if isinstance(event, Planned) and survey.visited:
            history.append(_progress(survey, plot_truth))

    begun = apply(opened(plot_opened), configured(samples=SAMPLES))
    dispatch = LocalDispatch(begun, Forgetful(), follow)
    drive("robot", robot_at(begun, plot_truth), dispatch)
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
    return estimator_of(survey)(survey.soil_map.at, survey.soil_map.kpa)


def _progress(survey: Survey, truth: Truth) -> Progress:
    spent, error = survey.spent, rmse(survey.soil_map.mean, truth.kpa)
    return Progress(spent.samples, spent.metres, spent.minutes, spent.mean_kv, error)
