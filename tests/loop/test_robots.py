"""What holds of every robot: it goes where it is sent, says what it did, and stops when told.

A robot is added by a line in ``ROBOTS``.
"""

from __future__ import annotations

import errno
import math
import signal
import threading
import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from subsoil.agent import Arrival, Assignment, Push, Refusal, Robot, Unreachable, drive
from subsoil.bench.world import TruthReader
from subsoil.errors import RobotError
from subsoil.field import Field
from subsoil.penetrometer import LARGE_CONE, SMALL_CONE, faults
from subsoil.reports import STOPPED, Source
from subsoil.simulation import Machine, SimulatedRobot, simulate
from subsoil.survey import LocalDispatch, Memory, Survey, opened
from subsoil.survey.events import Configured, Event, Opened

FIELD = Field.from_metres([(0, 0), (60, 0), (60, 40), (0, 40)])
TRUTH = simulate(FIELD, np.random.default_rng(1))
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
    return TruthReader(TRUTH, (0.0, 0.0))


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


class Watched:
    """A robot, and how often it was stopped; it may fail, or stop itself, at its third push."""

    def __init__(self, robot: Robot, fails: Callable[[], object] = lambda: None) -> None:
        self.robot, self.fails = robot, fails
        self.stops = self.pushes = 0

    def go_to(self, stop: Assignment) -> Arrival | Unreachable:
        return self.robot.go_to(stop)

    def probe(self) -> Push | Refusal:
        self.pushes += 1
        if self.pushes == 3:
            self.fails()
        return self.robot.probe()

    def stop(self) -> None:
        self.stops += 1
        self.robot.stop()


class FullDisk(Memory):
    """Recorder whose disk is full after some events."""

    def append(self, event: Event, survey: Survey) -> None:
        if len(self.events) > 6:
            raise OSError(errno.ENOSPC, "No space left on device")
        super().append(event, survey)


def begun(opening: Opened, settings: Configured, recorder: Memory | None = None) -> LocalDispatch:
    dispatch = LocalDispatch(opened(opening), recorder or Memory())
    dispatch.record(settings)
    dispatch.join("robot", "simulator")
    return dispatch


def driven(robot: Watched, dispatch: LocalDispatch) -> str:
    return drive("robot", robot, dispatch, source=Source(kind="simulator"))


def failing(error: BaseException) -> Callable[[], object]:
    def fail() -> None:
        raise error

    return fail


@pytest.mark.parametrize(
    "error", [KeyboardInterrupt(), RobotError("a wheel is off"), RuntimeError("a bug")], ids=repr
)
def test_it_is_stopped_when_the_loop_fails_and_nothing_reported_is_lost(
    plot_opened: Opened, configured: Callable[..., Configured], error: BaseException
) -> None:
    dispatch = begun(plot_opened, configured())
    robot = Watched(simulated(), failing(error))
    with pytest.raises(type(error)):
        driven(robot, dispatch)
    assert robot.stops == 1
    assert dispatch.survey.taken == 2


def test_it_is_stopped_when_the_disk_is_full(
    plot_opened: Opened, configured: Callable[..., Configured]
) -> None:
    robot = Watched(simulated())
    with pytest.raises(OSError, match="No space left"):
        driven(robot, begun(plot_opened, configured(), FullDisk()))
    assert robot.stops == 1


def test_it_is_stopped_when_there_is_nothing_left_to_do(
    plot_opened: Opened, configured: Callable[..., Configured]
) -> None:
    robot = Watched(simulated())
    assert driven(robot, begun(plot_opened, configured())) == "8 samples taken"
    assert robot.stops == 1


def test_a_stop_that_it_was_stopped_on_the_way_to_is_its_own_when_it_asks_again(
    plot_opened: Opened, configured: Callable[..., Configured]
) -> None:
    dispatch = begun(plot_opened, configured())
    robot = Watched(simulated())
    robot.fails = robot.stop
    assert driven(robot, dispatch) == STOPPED
    (lease,) = dispatch.survey.leases
    assert dispatch.survey.taken == 2
    stop = dispatch.assign("robot")
    assert isinstance(stop, Assignment)
    assert stop.id == lease.id
    assert driven(Watched(simulated()), dispatch) == "8 samples taken"
    assert dispatch.survey.refused == ()


class Fenced:
    """A robot that cannot get to the east of a fence."""

    def __init__(self, fence: float) -> None:
        self.fence, self.robot = fence, simulated()

    def go_to(self, stop: Assignment) -> Arrival | Unreachable:
        if stop.at[0] > self.fence:
            return Unreachable("a fence", (self.fence, stop.at[1]), 5.0, 9.0)
        return self.robot.go_to(stop)

    def probe(self) -> Push | Refusal:
        return self.robot.probe()

    def stop(self) -> None:
        self.robot.stop()


@pytest.mark.parametrize("strategy", ["area-split", "greedy", "joint-adaptive"])
def test_a_stop_out_of_reach_is_recorded_and_another_takes_its_place(
    plot_opened: Opened, configured: Callable[..., Configured], strategy: str
) -> None:
    memory = Memory()
    dispatch = begun(plot_opened, configured(strategy, estimator="pmc"), memory)
    drive("robot", Fenced(30.0), dispatch, source=Source(kind="simulator"))
    survey = dispatch.survey
    assert survey.finished == "8 samples taken"
    assert survey.refused
    assert all(FIELD.cells[cell][0] > 30.0 for cell in survey.refused)
    assert all(FIELD.cells[cell][0] < 30.0 for cell in survey.visited)
    handed_out = [event.cell for event in memory.events if event.kind == "assigned"]
    assert len(set(handed_out)) == len(handed_out)
    for stop in survey.stops:
        if stop.refusal:
            assert (stop.refusal.cause, stop.refusal.reason) == ("unreachable", "a fence")
