"""Surveys by a simulated robot, in a soil that is drawn or known."""

from __future__ import annotations

import math

import numpy as np

from subsoil.agent import drive
from subsoil.land.field import Field
from subsoil.layers import Layers
from subsoil.penetrometer import SMALL_CONE
from subsoil.registry import handed_over
from subsoil.reports import Source
from subsoil.simulation import Machine, SimulatedRobot, Truth, draw_truth
from subsoil.strategies import Strategy
from subsoil.survey.dispatch import LocalDispatch
from subsoil.survey.events import Configured, Simulation
from subsoil.survey.fold import opened, opening
from subsoil.survey.recorder import Memory
from subsoil.survey.settings import DEFAULT_ESTIMATOR, DEFAULT_STRATEGY, Settings, checked
from subsoil.survey.state import Survey
from subsoil.variogram import Estimator, Own

SIMULATED = "simulated robot"
"""Name of the agent that a simulation is."""
DRAWN = "simulated"
"""Name of the world whose soil is drawn from the seed of the survey."""
_TRUTH_STREAM = 0
_CHECKED_CELLS = 3
_LAYERS = Layers()


def simulate(
    field: Field,
    strategy: str | Strategy = DEFAULT_STRATEGY,
    *,
    samples: int = 30,
    seed: int = 0,
    truth: Truth | None = None,
    layers: Layers = _LAYERS,
    estimator: str | Estimator | Own = DEFAULT_ESTIMATOR,
    metres: float = math.inf,
    minutes: float = math.inf,
) -> Survey:
    """Survey a field with a simulated robot.

    Parameters
    ----------
    field
        The field.
    strategy
        Name of a strategy, ``module:attribute``, or a callable from a
        :class:`~subsoil.strategies.View` to a :class:`~subsoil.strategies.Plan`.
    samples
        Samples to take.
    seed
        Seed of the soil, the robot and the strategy, each with a stream of its own.
    truth
        The soil. Default: drawn from the seed.
    layers
        Depth bands of the map; those of the soil if one is given.
    estimator
        Name of an estimator, ``module:attribute``, or a callable.
    metres, minutes
        Longest way in m and time in min.

    Returns
    -------
    Survey
        The survey at its end: ``soil_map``, ``metres``, ``minutes``, ``stops`` ...

    Raises
    ------
    ParameterError
        If there is no such strategy or estimator, one fails, or a limit is impossible.

    Examples
    --------
    >>> field = Field.from_metres([(0, 0), (60, 0), (60, 40), (0, 40)])
    >>> run = simulate(field, "area-split", samples=5, seed=1)
    >>> len(run.soil_map.samples), run.finished
    (5, '5 samples taken')
    """
    if truth is None:
        truth = soil_drawn(field, layers, seed)
    name, allowed = handed_over(strategy)
    estimated_by, of_estimator = handed_over(estimator)
    settings = Settings(
        start=field.entrance,
        strategy=name,
        estimator=estimated_by,
        seed=seed,
        samples=samples,
        metres=metres,
        minutes=minutes,
    )
    survey = opened(opening(field, truth.layers, SMALL_CONE))
    dispatch = LocalDispatch(survey, Memory(), allowed=allowed | of_estimator)
    dispatch.record(Configured(settings=checked(settings, field)))
    dispatch.join(SIMULATED, "simulator", simulation=simulation_of(truth, DRAWN, seed))
    work(dispatch, truth)
    return dispatch.survey


def work(dispatch: LocalDispatch, truth: Truth, faster: float = math.inf) -> None:
    """Let the simulated robot do what is left of a survey.

    Parameters
    ----------
    dispatch
        Of the survey, which the robot has joined.
    truth
        The soil.
    faster
        How many times faster than a real one the robot works. Default: at once.
    """
    robot = robot_of(dispatch.survey, truth, faster)
    drive(SIMULATED, robot, dispatch, source=Source(kind="simulator"))


def soil_drawn(field: Field, layers: Layers, seed: int) -> Truth:
    """Soil of a field that is drawn from the seed of a survey."""
    stream = np.random.SeedSequence(seed, spawn_key=(_TRUTH_STREAM,))
    return draw_truth(field, np.random.default_rng(stream), layers)


def simulation_of(truth: Truth, world: str, seed: int) -> Simulation:
    """Record of a soil, by which to tell whether it is the same again."""
    cells = np.linspace(0, len(truth.field.cells) - 1, _CHECKED_CELLS).round().astype(int)
    values = truth.kpa[:, cells].ravel()
    return Simulation(world=world, seed=seed, check_kpa=tuple(values.tolist()))


def robot_of(
    survey: Survey, truth: Truth, faster: float = math.inf, name: str = SIMULATED
) -> SimulatedRobot:
    """Simulated robot that goes on where it stands in a survey."""
    machine = Machine(survey.cone)
    agent = survey.agent(name)
    made = [stop.cell for stop in survey.stops if stop.agent == name]
    position = survey.access.at[made[-1]].tolist() if made else agent.position
    return SimulatedRobot(
        truth,
        machine,
        seed=survey.simulation[0].seed,
        position=position,
        battery_s=machine.battery_s - (agent.seconds - agent.charged_at),
        access=survey.access,
        faster=faster,
    )
