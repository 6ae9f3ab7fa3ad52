"""The simulated robot keeps the robot's contract, its budget and its determinism."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import binom

from subsoil.agent import Arrival, Assignment, Push, Refusal, Robot, Unreachable
from subsoil.errors import BatteryError
from subsoil.land.field import Field
from subsoil.layers import Layers
from subsoil.penetrometer import LARGE_CONE, SMALL_CONE, profile_of
from subsoil.simulation import Machine, SimulatedRobot, Soil, Truth

FIELD = Field.from_metres([(0, 0), (50, 0), (50, 40), (0, 40)])
LAYERS = Layers()
SOIL = Soil("spherical", 30.0, 0.2, 0.15, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0)
QUIET = Machine(SMALL_CONE, fix_sd_m=0.0, force_sd_n=0.0, stone_probability=0.0)
STOPS = [(2.5, 2.5), (12.5, 7.5), (47.5, 37.5), (2.5, 37.5), (22.5, 22.5)]


def _truth() -> Truth:
    rng = np.random.default_rng(0)
    mean = np.linspace(400.0, 1800.0, 8)[:, None]
    kpa = mean + rng.uniform(-100.0, 100.0, (8, len(FIELD.cells)))
    return Truth(FIELD, LAYERS, kpa, rng.uniform(-50.0, 50.0, kpa.shape), SOIL)


TRUTH = _truth()


def _robot(
    machine: Machine = QUIET, seed: int = 7, battery_s: float | None = None
) -> SimulatedRobot:
    return SimulatedRobot(TRUTH, machine, seed=seed, position=(0.0, 0.0), battery_s=battery_s)


def _to(robot: SimulatedRobot, at: tuple[float, float], number: int = 0) -> Arrival:
    """Drive to a stop of a number."""
    arrival = robot.go_to(Assignment(f"stop {number}", number, FIELD.nearest_cell(at), at))
    assert isinstance(arrival, Arrival)
    return arrival


def _at_stop(number: int, machine: Machine = QUIET) -> Push | Refusal:
    """Push where a robot starts, at the stop of a number."""
    robot = _robot(machine)
    _to(robot, (0.0, 0.0), number)
    return robot.probe()


def _survey(robot: SimulatedRobot) -> list[tuple[Arrival, Push | Refusal]]:
    return [(_to(robot, at, number), robot.probe()) for number, at in enumerate(STOPS)]


def test_it_is_a_robot() -> None:
    robot: Robot = _robot()
    assert isinstance(robot.go_to(Assignment("a", 0, 0, (1.0, 1.0))), Arrival)
    assert isinstance(robot.probe(), Push)
    robot.stop()
    assert robot.go_to(Assignment("b", 1, 0, (2.0, 2.0))) == Unreachable("stopped", (1.0, 1.0))
    assert robot.probe() == Refusal("stopped", 0.0, 0)


def test_the_odometer_and_the_clock_add_up() -> None:
    machine = replace(QUIET, speed_mps=0.5)
    robot = _robot(machine)
    records = _survey(robot)
    legs = np.hypot(*np.diff([(0.0, 0.0), *STOPS], axis=0).T)
    assert [arrival.metres for arrival, _ in records] == pytest.approx(legs)
    assert [arrival.seconds for arrival, _ in records] == pytest.approx(2 * legs)
    assert [outcome.seconds for _, outcome in records] == [50.0] * len(STOPS)
    spent = 2 * legs.sum() + 50.0 * len(STOPS)
    assert robot.battery_s == pytest.approx(machine.battery_s - spent)
    assert robot.position == STOPS[-1]


def test_a_quiet_push_gives_the_reading_of_the_nearest_cell() -> None:
    for at, (arrival, outcome) in zip(STOPS, _survey(_robot()), strict=True):
        assert arrival.at == at
        assert isinstance(outcome, Push)
        assert outcome.at == at
        sample = LAYERS.sample(profile_of(outcome.reading, SMALL_CONE), at)
        assert sample.kpa == pytest.approx(TRUTH.reading(FIELD.nearest_cell(at)), rel=1e-9)


@pytest.mark.parametrize("after", range(len(STOPS)))
def test_a_robot_resumed_after_a_stop_goes_on_bit_for_bit(after: int) -> None:
    machine = Machine(SMALL_CONE, stone_probability=0.6)
    whole = _survey(_robot(machine))
    first = _robot(machine)
    for number, at in enumerate(STOPS[:after]):
        _to(first, at, number)
        first.probe()
    second = SimulatedRobot(
        TRUTH, machine, seed=7, position=first.position, battery_s=first.battery_s
    )
    rest = zip(STOPS[after:], whole[after:], strict=True)
    for number, (at, (arrival, outcome)) in enumerate(rest, start=after):
        assert _to(second, at, number) == arrival
        assert second.probe() == outcome


def test_a_robot_resumed_between_drive_and_push_makes_the_same_push() -> None:
    machine = Machine(SMALL_CONE, stone_probability=0.6)
    whole = _robot(machine)
    _to(whole, STOPS[0])
    resumed = SimulatedRobot(
        TRUTH, machine, seed=7, position=whole.position, battery_s=whole.battery_s
    )
    assert _to(resumed, STOPS[0]).metres == 0.0
    assert whole.probe() == resumed.probe()


def test_another_seed_or_stop_meets_another_chance() -> None:
    machine = Machine(SMALL_CONE)
    fixes = {_to(_robot(machine, seed), (10.0, 10.0), k).at for seed in (1, 2) for k in (0, 1)}
    assert len(fixes) == 4


def test_reported_places_scatter_around_the_true_one_as_told() -> None:
    machine = replace(QUIET, fix_sd_m=0.3)
    n = 500
    robots = [_robot(machine) for _ in range(n)]
    fixes = [_to(robot, (10.0, 10.0), k).at for k, robot in enumerate(robots)]
    off = np.array(fixes) - 10.0
    assert off.std(axis=0) == pytest.approx(0.3, abs=4 * 0.3 / np.sqrt(2 * n))
    assert off.mean(axis=0) == pytest.approx(0.0, abs=4 * 0.3 / np.sqrt(n))
    assert {robot.position for robot in robots} == {(10.0, 10.0)}


def test_arrival_and_hole_share_the_error_of_the_receiver() -> None:
    robot = _robot(replace(QUIET, fix_sd_m=0.3))
    arrival, outcome = _to(robot, (10.0, 10.0)), robot.probe()
    assert isinstance(outcome, Push)
    assert outcome.at == arrival.at


def test_it_does_not_leave_for_a_stop_the_battery_cannot_carry() -> None:
    needed = 40.0 + QUIET.stop_s + (QUIET.tries - 1) * QUIET.retry_s
    robot = _robot(battery_s=needed - 0.5)
    with pytest.raises(BatteryError, match=r"2 minutes of battery are left.*fresh-battery"):
        _to(robot, (40.0, 0.0))
    assert (robot.position, robot.battery_s) == ((0.0, 0.0), needed - 0.5)
    assert _to(robot, (39.0, 0.0)).metres == 39.0
    assert isinstance(robot.probe(), Push)
    with pytest.raises(BatteryError):
        robot.probe()


def test_the_battery_never_runs_below_zero_whatever_the_stones() -> None:
    robot = _robot(Machine(SMALL_CONE, stone_probability=0.9), battery_s=3000.0)
    with pytest.raises(BatteryError):  # noqa: PT012
        for k in range(1000):
            _to(robot, STOPS[k % len(STOPS)], k)
            robot.probe()
    assert robot.battery_s >= 0.0


def test_stones_cost_retries_beside_the_first_hole() -> None:
    robot = _robot(replace(QUIET, stone_probability=0.5))
    seen = set()
    for k in range(60):
        _to(robot, STOPS[k % len(STOPS)], k)
        outcome = robot.probe()
        assert outcome.seconds == 50.0 + 28.0 * (outcome.tries - 1)
        seen.add(outcome.tries)
        if isinstance(outcome, Push):
            shift = np.hypot(*np.subtract(outcome.at, robot.position))
            assert shift == pytest.approx(0.2) or shift == 0.0
            if outcome.reading.ending == "stroke":
                assert (shift == 0.0) == (outcome.tries == 1)
    assert seen == {1, 2, 3}


def test_stops_are_retried_and_refused_as_often_as_stones_make_them() -> None:
    p, n, alpha = 0.6, 1000, 1e-4
    machine = replace(QUIET, stone_probability=p, usable_m=0.30)
    outcomes = [_at_stop(k, machine) for k in range(n)]
    refused = sum(isinstance(outcome, Refusal) for outcome in outcomes)
    first_through = sum(outcome.tries == 1 for outcome in outcomes)
    # A stone shallower than 0.30 m less the 3 mm it takes to stop the rod makes a push useless.
    for share in ((p * 0.297 / 0.50) ** 3, (p * 0.300 / 0.50) ** 3):
        assert binom.ppf(alpha, n, share) <= refused <= binom.isf(alpha, n, share)
    # One in the last 3 mm of the stroke does not end it.
    for share in (1 - p, 1 - p * 0.497 / 0.50):
        assert binom.ppf(alpha, n, share) <= first_through <= binom.isf(alpha, n, share)


def test_a_refusal_says_why_and_what_it_cost() -> None:
    machine = replace(QUIET, stone_probability=1.0, usable_m=0.49)
    refusals = [_at_stop(k, machine) for k in range(20)]
    refusal = next(each for each in refusals if isinstance(each, Refusal))
    assert refusal.reason.startswith("the rod got no deeper than 0.")
    assert (refusal.tries, refusal.seconds) == (3, 106.0)


def test_the_deepest_of_hard_pushes_is_kept() -> None:
    machine = replace(QUIET, stone_probability=1.0)
    for k in range(20):
        outcome = _at_stop(k, machine)
        rng = np.random.default_rng(np.random.SeedSequence(7, spawn_key=(1, k)))
        rng.standard_normal(2)
        stones = []
        for _ in range(outcome.tries):
            stones.append(rng.random(2)[1] * machine.stroke_m)
            rng.standard_normal(machine.readings)
        if isinstance(outcome, Push) and outcome.reading.ending == "force":
            assert outcome.reading.depth_m[-1] == pytest.approx(max(stones), abs=0.006)


def test_soil_too_hard_for_the_cone_is_kept_as_far_as_it_was_measured() -> None:
    outcome = _robot(replace(QUIET, cone=LARGE_CONE)).probe()
    hard = Truth(FIELD, LAYERS, TRUTH.kpa + 700.0, TRUTH.noise, SOIL)
    robot = SimulatedRobot(hard, replace(QUIET, cone=LARGE_CONE), seed=7, position=(22.5, 22.5))
    outcome = robot.probe()
    assert isinstance(outcome, Push)
    assert (outcome.tries, outcome.reading.ending) == (3, "force")
    assert outcome.reading.force_n[-1] == 600.0


def test_a_place_that_is_none_is_refused() -> None:
    nowhere = _robot().go_to(Assignment("a", 0, 0, (float("nan"), 0.0)))
    assert isinstance(nowhere, Unreachable)
    assert nowhere.reason == "(nan, 0) is no place"
