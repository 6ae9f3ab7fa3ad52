"""What holds of every robot: it goes where it is sent, says what it did, and stops when told.

A robot is added by a line in ``ROBOTS``.
"""

from __future__ import annotations

import math
import signal
import threading
import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from subsoil.agent import Arrival, Assignment, Refusal, Robot, Unreachable
from subsoil.bench.truths import TruthReader
from subsoil.land.field import Field
from subsoil.penetrometer import LARGE_CONE, SMALL_CONE, faults
from subsoil.reports import STOPPED
from subsoil.simulation import Machine, SimulatedRobot, draw_truth
from subsoil.ways.open_land import OpenLand

FIELD = Field.from_metres([(0, 0), (60, 0), (60, 40), (0, 40)])
TRUTH = draw_truth(FIELD, np.random.default_rng(1))
QUIET = Machine(SMALL_CONE, stone_probability=0.0)


def simulated() -> Robot:
    return SimulatedRobot(TRUTH, QUIET, seed=1, position=(0.0, 0.0))


def simulated_with_stones() -> Robot:
    stony = replace(QUIET, stone_probability=0.4)
    return SimulatedRobot(TRUTH, stony, seed=1, position=(0.0, 0.0))


def simulated_in_time() -> Robot:
    """A robot that takes its time: a hundredth of what a real one takes."""
    return SimulatedRobot(TRUTH, QUIET, seed=1, position=(0.0, 0.0), faster=1000.0)


def reader() -> Robot:
    return TruthReader(TRUTH, OpenLand(FIELD), (0.0, 0.0))


ROBOTS = [simulated, simulated_with_stones, simulated_in_time, reader]
every_robot = pytest.mark.parametrize("make", ROBOTS, ids=lambda make: make.__name__)


def stop_at(number: int, east: float, north: float) -> Assignment:
    at = (east, north)
    return Assignment(f"stop {number}", number, FIELD.nearest_cell(at), at)


STOPS = [stop_at(k, 7.5 + 15 * (k % 4), 7.5 + 25 * (k // 4)) for k in range(8)]


@every_robot
def test_it_arrives_where_it_was_sent_and_its_odometer_and_clock_go_on(
    make: Callable[[], Robot],
) -> None:
    robot, here = make(), (0.0, 0.0)
    for stop in STOPS:
        arrival = robot.go_to(stop)
        assert isinstance(arrival, Arrival)
        assert math.dist(arrival.at, stop.at) < 2.0
        assert arrival.metres == pytest.approx(math.dist(here, stop.at))
        assert 0 < arrival.seconds < 1000
        here = stop.at


@every_robot
def test_its_pushes_are_readings_that_can_be_true_or_refusals_with_a_reason(
    make: Callable[[], Robot],
) -> None:
    robot = make()
    for stop in STOPS:
        robot.go_to(stop)
        outcome = robot.probe()
        assert outcome.seconds > 0
        assert outcome.tries >= 1
        if isinstance(outcome, Refusal):
            assert outcome.reason
            continue
        assert faults(outcome.reading, LARGE_CONE) == ""
        assert len(outcome.reading.depth_m) > 5
        assert math.dist(outcome.at, stop.at) < 2.0


@every_robot
def test_it_stays_at_a_stop_it_is_sent_to_again_and_pushes_once_more(
    make: Callable[[], Robot],
) -> None:
    robot = make()
    robot.go_to(STOPS[0])
    robot.probe()
    again = robot.go_to(replace(STOPS[0], pushes=2, made=1))
    assert isinstance(again, Arrival)
    assert again.metres == 0.0
    assert robot.probe().seconds > 0


@every_robot
def test_once_stopped_it_goes_nowhere_and_pushes_nothing(make: Callable[[], Robot]) -> None:
    robot = make()
    robot.go_to(STOPS[0])
    robot.stop()
    robot.stop()
    gone, pushed = robot.go_to(STOPS[1]), robot.probe()
    assert isinstance(gone, Unreachable)
    assert isinstance(pushed, Refusal)
    assert gone.reason == pushed.reason == STOPPED
    assert math.dist(gone.at, STOPS[0].at) < 2.0
    assert (gone.metres, gone.seconds, pushed.seconds) == (0.0, 0.0, 0.0)


def test_once_stopped_an_empty_battery_is_no_error() -> None:
    robot = SimulatedRobot(TRUTH, QUIET, seed=1, position=(0.0, 0.0), battery_s=1.0)
    robot.stop()
    for move in (lambda: robot.go_to(STOPS[7]), robot.probe):
        outcome = move()
        assert isinstance(outcome, Unreachable | Refusal)
        assert outcome.reason == STOPPED


def simulated_as_slow_as_real() -> Robot:
    slow = replace(QUIET, speed_mps=0.1)
    return SimulatedRobot(TRUTH, slow, seed=1, position=(0.0, 0.0), faster=1.0)


SLOW = [simulated_as_slow_as_real]
"""Robots that take minutes for a drive and most of one for a push."""


@pytest.mark.parametrize("make", SLOW)
@pytest.mark.parametrize("busy", ["driving", "probing"])
def test_told_to_stop_from_another_thread_it_is_at_rest_within_a_second(
    make: Callable[[], Robot], busy: str
) -> None:
    robot = make()
    began = told(robot, busy, lambda: threading.Timer(0.2, robot.stop).start())
    assert time.monotonic() - began < 1.2


@pytest.mark.parametrize("make", SLOW)
@pytest.mark.parametrize("busy", ["driving", "probing"])
def test_told_to_stop_by_a_signal_it_is_at_rest_within_a_second(
    make: Callable[[], Robot], busy: str
) -> None:
    robot = make()
    before = signal.signal(signal.SIGALRM, lambda *_: robot.stop())
    try:
        began = told(robot, busy, lambda: signal.setitimer(signal.ITIMER_REAL, 0.2))
    finally:
        signal.signal(signal.SIGALRM, before)
    assert time.monotonic() - began < 1.2


def told(robot: Robot, busy: str, tell: Callable[[], object]) -> float:
    """Tell a busy robot to stop; when it was told. It says that it was stopped, and stays."""
    if busy == "probing":
        robot.go_to(stop_at(0, 0.0, 0.0))
    began = time.monotonic()
    tell()
    outcome = robot.go_to(STOPS[7]) if busy == "driving" else robot.probe()
    ended = time.monotonic()
    assert isinstance(outcome, Unreachable | Refusal)
    assert outcome.reason == STOPPED
    for move in (lambda: robot.go_to(STOPS[1]), robot.probe):
        after = move()
        assert isinstance(after, Unreachable | Refusal)
        assert after.reason == STOPPED
    assert time.monotonic() - ended < 0.5
    return began
