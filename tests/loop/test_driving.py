"""However work on a survey ends, the robot is stopped and nothing reported is lost."""

from __future__ import annotations

import errno
from collections.abc import Callable

import numpy as np
import pytest

from subsoil.agent import Arrival, Assignment, Push, Refusal, Robot, Unreachable, drive
from subsoil.errors import RobotError
from subsoil.land.field import Field
from subsoil.penetrometer import SMALL_CONE
from subsoil.reports import STOPPED, Source
from subsoil.simulation import Machine, SimulatedRobot, draw_truth
from subsoil.survey import LocalDispatch, Memory, Survey, opened
from subsoil.survey.events import Configured, Event, Opened

FIELD = Field.from_metres([(0, 0), (60, 0), (60, 40), (0, 40)])
TRUTH = draw_truth(FIELD, np.random.default_rng(1))


def simulated() -> Robot:
    quiet = Machine(SMALL_CONE, stone_probability=0.0)
    return SimulatedRobot(TRUTH, quiet, seed=1, position=(0.0, 0.0))


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
