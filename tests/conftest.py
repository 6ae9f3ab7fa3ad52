"""Small surveys that many tests start from."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from subsoil.events import Configured, Opened
from subsoil.field import Field
from subsoil.layers import Layers
from subsoil.penetrometer import SMALL_CONE
from subsoil.simulation import Machine, SimulatedRobot, Truth, simulate
from subsoil.survey import Survey, opening


@pytest.fixture(scope="session")
def plot() -> Field:
    """A field of 60 x 40 m, 96 cells."""
    return Field.from_metres([(0, 0), (60, 0), (60, 40), (0, 40)], name="plot")


@pytest.fixture(scope="session")
def plot_opened(plot: Field) -> Opened:
    return opening(plot, Layers(), SMALL_CONE)


@pytest.fixture(scope="session")
def plot_truth(plot: Field) -> Truth:
    return simulate(plot, np.random.default_rng(1))


Configure = Callable[..., Configured]


@pytest.fixture(scope="session")
def configured() -> Configure:
    """How to survey the plot."""

    def configure(
        strategy: str = "adaptive-monte-carlo", samples: int = 8, seed: int = 3
    ) -> Configured:
        return Configured(
            strategy=strategy, estimator="paper-10", refit_every=1, seed=seed, start=(0.0, 0.0),
            world="simulated", samples=samples, metres=math.inf, minutes=math.inf, mean_kv=0.0,
        )  # fmt: skip

    return configure


@pytest.fixture(scope="session")
def robot_at() -> Callable[[Survey, Truth], SimulatedRobot]:
    """Simulated robot that goes on where a survey stands."""

    def make(survey: Survey, truth: Truth) -> SimulatedRobot:
        machine = Machine(survey.cone)
        return SimulatedRobot(
            truth, machine, seed=survey.configured.seed, position=survey.position,
            stop=survey.step, pushed=survey.pushed, battery_s=machine.battery_s - survey.seconds,
        )  # fmt: skip

    return make


@pytest.fixture(scope="session")
def real_data() -> Path:
    """Folder of real data; tests that need it are skipped without."""
    folder = os.environ.get("SUBSOIL_DATA")
    if not folder:
        pytest.skip("SUBSOIL_DATA names no folder of real data")
    return Path(folder)
