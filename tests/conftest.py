"""Small surveys that many tests start from."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, Protocol

import numpy as np
import pytest

from subsoil.agent import drive
from subsoil.land.field import Field
from subsoil.layers import Layers
from subsoil.penetrometer import SMALL_CONE
from subsoil.registry import Allowed
from subsoil.reports import Source
from subsoil.simulation import Truth, draw_truth
from subsoil.survey import LocalDispatch, Memory, Settings, Survey, opened, opening
from subsoil.survey.events import Configured, Event, Opened, Simulation
from subsoil.survey.simulated import robot_of


@pytest.fixture(scope="session")
def plot() -> Field:
    """A field of 60 x 40 m, 96 cells."""
    return Field.from_metres([(0, 0), (60, 0), (60, 40), (0, 40)], name="plot")


@pytest.fixture(scope="session")
def plot_opened(plot: Field) -> Opened:
    return opening(plot, Layers(), SMALL_CONE)


@pytest.fixture(scope="session")
def plot_truth(plot: Field) -> Truth:
    return draw_truth(plot, np.random.default_rng(1))


class Configure(Protocol):
    """How to survey the plot, some settings changed."""

    def __call__(
        self, strategy: str = ..., samples: int = ..., seed: int = ..., **changes: Any
    ) -> Configured: ...


@pytest.fixture(scope="session")
def configured() -> Configure:
    """How to survey the plot."""

    def configure(
        strategy: str = "adaptive-monte-carlo", samples: int = 8, seed: int = 3, **changes: Any
    ) -> Configured:
        settings = Settings(
            start=(0.0, 0.0), strategy=strategy, estimator="paper-10", seed=seed, samples=samples
        )
        return Configured(settings=settings.model_copy(update=changes))

    return configure


Work = Callable[[LocalDispatch, Truth], str]


@pytest.fixture(scope="session")
def work() -> Work:
    """Let a simulated robot work on a survey to its end."""

    def work_on(dispatch: LocalDispatch, truth: Truth) -> str:
        seed = dispatch.survey.settings.seed
        dispatch.join("robot", "simulator", simulation=Simulation(world="simulated", seed=seed))
        robot = robot_of(dispatch.survey, truth, name="robot")
        return drive("robot", robot, dispatch, source=Source(kind="simulator"))

    return work_on


SurveyPlot = Callable[..., tuple[Survey, list[Event]]]


@pytest.fixture
def survey_plot(plot_opened: Opened, plot_truth: Truth, work: Work) -> SurveyPlot:
    """Survey the plot, or go on with its survey; the state it ends in, and its events."""

    def survey(settings: Configured, start: Survey | None = None) -> tuple[Survey, list[Event]]:
        memory = Memory()
        allowed = Allowed.by_name(settings.settings.strategy)
        dispatch = LocalDispatch(start or opened(plot_opened), memory, allowed=allowed)
        dispatch.record(settings)
        work(dispatch, plot_truth)
        return dispatch.survey, [plot_opened, *memory.events]

    return survey


@pytest.fixture(scope="session")
def real_data() -> Path:
    """Folder of real data; tests that need it are skipped without."""
    folder = os.environ.get("SUBSOIL_DATA")
    if not folder:
        pytest.skip("SUBSOIL_DATA names no folder of real data")
    return Path(folder)
