"""Noise, stones and retries of the simulated machine are as likely and as large as it was told."""

from __future__ import annotations

from dataclasses import replace
from math import hypot, pi, sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import ArrayLike
from scipy.stats import binom, chi2, kstest

from subsoil.agent import Arrival, Assignment, Push, Refusal, Unreachable
from subsoil.arrays import Floats
from subsoil.errors import ParameterError
from subsoil.land.field import Field
from subsoil.layers import Layers, LayerState
from subsoil.penetrometer import SMALL_CONE, Cone
from subsoil.simulation import Machine, SimulatedRobot, Soil, Truth, push
from subsoil.ways.open_land import OpenLand

LAYERS = Layers()
SOIL = np.array([400.0, 800.0, 1200.0, 1500.0, 1600.0, 1700.0, 1800.0, 2000.0])
NOISY = Machine(SMALL_CONE, force_sd_n=2.0, stone_probability=0.0)
QUIET = replace(NOISY, force_sd_n=0.0)
PUSHES = 60
LEAST_P = 1e-4


@pytest.fixture(scope="module")
def noise() -> Floats:
    """(pushes, readings) what the load cell adds to the force, in its SD."""
    quiet = push(QUIET, LAYERS, SOIL, np.random.default_rng(0)).force_n
    rng = np.random.default_rng(9)
    return np.array([push(NOISY, LAYERS, SOIL, rng).force_n - quiet for _ in range(PUSHES)]) / 2.0


def test_noise_is_gaussian_and_none_on_average(noise: Floats) -> None:
    assert kstest(noise.ravel(), "norm").pvalue > LEAST_P


def test_noise_of_a_reading_knows_nothing_of_the_next_nor_of_the_next_push(noise: Floats) -> None:
    """A mean product of n pairs of independent unit normals has the standard error 1 / sqrt(n)."""
    for one, other in ((noise[:, 1:], noise[:, :-1]), (noise[1:], noise[:-1])):
        assert float(np.mean(one * other)) == pytest.approx(0.0, abs=4.5 / sqrt(one.size))


def test_a_layer_mean_is_off_by_the_noise_of_its_thirty_readings() -> None:
    """Each layer of 5 cm has 30 of 300 readings over half a metre: sums of squares are chi2."""
    rng = np.random.default_rng(4)
    quiet = LAYERS.sample(push(QUIET, LAYERS, SOIL, rng).profile(SMALL_CONE), (0.0, 0.0)).kpa
    off = (
        np.array(
            [
                LAYERS.sample(push(NOISY, LAYERS, SOIL, rng).profile(SMALL_CONE), (0.0, 0.0)).kpa
                for _ in range(PUSHES)
            ]
        )
        - quiet
    )
    spread = 2.0 * 1000.0 / SMALL_CONE.area_mm2 / sqrt(30)
    squares = ((off / spread) ** 2).sum(axis=0)
    assert squares.min() >= chi2.ppf(LEAST_P / 8, PUSHES)
    assert squares.max() <= chi2.isf(LEAST_P / 8, PUSHES)


def test_a_force_of_nothing_is_read_as_half_a_bell_and_never_below_zero() -> None:
    """The mean of max(0, e) is SD / sqrt(2 pi), its variance SD2 (1/2 - 1/(2 pi))."""
    rng = np.random.default_rng(5)
    force = np.concatenate([push(NOISY, LAYERS, np.zeros(8), rng).force_n for _ in range(20)])
    assert force.min() == 0.0
    spread = 2.0 * sqrt((0.5 - 0.5 / pi) / force.size)
    assert float(force.mean()) == pytest.approx(2.0 / sqrt(2 * pi), abs=4.5 * spread)
    zeros = int((force == 0.0).sum())
    assert binom.ppf(LEAST_P, force.size, 0.5) <= zeros <= binom.isf(LEAST_P, force.size, 0.5)


@pytest.mark.parametrize("probability", [0.0, 0.05, 0.3, 1.0])
def test_stones_are_met_as_often_as_told(probability: float) -> None:
    machine = replace(QUIET, stone_probability=probability, readings=50)
    rng = np.random.default_rng(6)
    n = 400
    met = sum(push(machine, LAYERS, SOIL, rng).ending == "force" for _ in range(n))
    # A stone within 3 mm of the end of the stroke, 3 of 500, does not stall the rod any more.
    least = probability * (1 - 3 / 500)
    assert binom.ppf(LEAST_P, n, least) <= met <= binom.isf(LEAST_P, n, probability)


def test_stones_lie_at_any_depth_alike() -> None:
    machine = replace(QUIET, stone_probability=1.0)
    rng = np.random.default_rng(7)
    ends = [push(machine, LAYERS, np.zeros(8), rng) for _ in range(400)]
    # Force rises by 600 N over 3 mm of stone, and readings are 1.7 mm apart.
    depths = np.array([each.depth_m[-1] for each in ends if each.ending == "force"]) - 0.003
    assert kstest(depths, "uniform", (0.0, 0.4985)).pvalue > LEAST_P


@given(
    st.integers(0, 2**32), st.sampled_from([0.0, 0.5, 1.0]), st.sampled_from([100.0, 900.0, 9e4])
)
def test_every_push_leaves_its_source_of_chance_where_any_other_would(
    seed: int, stones: float, kpa: float
) -> None:
    """Whatever the soil and its stones do, what is drawn next is the same."""
    one, other = np.random.default_rng(seed), np.random.default_rng(seed)
    push(replace(NOISY, stone_probability=stones), LAYERS, np.full(8, kpa), one)
    push(NOISY, LAYERS, SOIL, other)
    assert one.random() == other.random()


@given(st.floats(20.0, 6000.0), st.sampled_from([80.0, 130.0, 323.0]))
def test_a_push_ends_at_the_first_reading_that_asks_for_the_limit(kpa: float, area: float) -> None:
    machine = replace(QUIET, cone=Cone(area, 30.0))
    insertion = push(machine, LAYERS, np.full(8, kpa), np.random.default_rng(0))
    asked = kpa * area / 1000.0
    if asked >= 600.0 * (1 + 1e-9):
        assert (insertion.ending, len(insertion.depth_m)) == ("force", 1)
        assert insertion.force_n[-1] == 600.0
    elif asked < 600.0 * (1 - 1e-9):
        assert (insertion.ending, len(insertion.depth_m)) == ("stroke", 300)
        assert insertion.force_n == pytest.approx(np.full(300, asked))


def test_a_stone_makes_its_layer_a_bound_and_leaves_those_above_as_they_are() -> None:
    machine = replace(QUIET, stone_probability=1.0)
    seen = set()
    for seed in range(40):
        insertion = push(machine, LAYERS, SOIL, np.random.default_rng(seed))
        sample = LAYERS.sample(insertion.profile(SMALL_CONE), (0.0, 0.0))
        end = float(insertion.depth_m[-1])
        above = LAYERS.bottom_m < end - 0.006
        assert sample.kpa[above] == pytest.approx(SOIL[above], rel=0.01)
        if insertion.ending == "force" and 0.01 < end % 0.05 < 0.045 and end < 0.4:
            layer = int(np.searchsorted(LAYERS.bottom_m, end))
            assert sample.state[layer] == LayerState.AT_LEAST
            assert np.all(sample.state[layer + 1 :] == LayerState.UNREACHED)
            seen.add(layer)
    assert len(seen) >= 5


@pytest.mark.parametrize(
    ("name", "value", "need"),
    [
        ("speed_mps", 0.0, "greater than zero, not 0"),
        ("battery_s", np.inf, "greater than zero, not inf"),
        ("stroke_m", -0.5, "greater than zero, not -0.5"),
        ("load_cell_n", np.nan, "greater than zero, not nan"),
        ("fix_sd_m", -0.1, "zero or more, not -0.1"),
        ("retry_s", np.nan, "zero or more, not nan"),
        ("gantry_m", -1.0, "zero or more, not -1"),
        ("usable_m", -0.1, "zero or more, not -0.1"),
        ("force_sd_n", np.inf, "zero or more, not inf"),
        ("tries", 0, "one or more, not 0"),
        ("readings", 0, "one or more, not 0"),
        ("stone_probability", -0.01, "between 0 and 1, not -0.01"),
    ],
)
def test_each_number_of_a_machine_is_named_where_it_cannot_be(
    name: str, value: float, need: str
) -> None:
    with pytest.raises(ParameterError) as caught:
        Machine(SMALL_CONE, **{name: value})  # type: ignore[arg-type]
    assert str(caught.value) == f"machine: {name} must be {need}"


# At a stop

FIELD = Field.from_metres([(0, 0), (50, 0), (50, 40), (0, 40)])
TRUTH = Truth(
    FIELD, LAYERS, np.full((8, len(FIELD.cells)), 900.0), np.zeros((8, len(FIELD.cells))),
    Soil("spherical", 30.0, 0.2, 0.15, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0),
)  # fmt: skip


def robot_at(machine: Machine, number: int = 0, made: int = 0) -> SimulatedRobot:
    robot = SimulatedRobot(TRUTH, machine, seed=7, position=(22.5, 22.5))
    cell = FIELD.nearest_cell((22.5, 22.5))
    robot.go_to(Assignment(f"{number}", number, cell, (22.5, 22.5), made=made))
    return robot


def test_tries_at_a_stop_are_spent_on_stones_as_their_probability_says() -> None:
    """One more try after each stone, three at most: 0.6, 0.4 x 0.6 and 0.4 x 0.4 of all stops."""
    machine = replace(QUIET, stone_probability=0.4, fix_sd_m=0.0)
    n = 300
    tries = [robot_at(machine, number).probe().tries for number in range(n)]
    for k, share in ((1, 0.6), (2, 0.24), (3, 0.16)):
        # Of the stones 3 in 500 are so deep that they stall nothing.
        low = binom.ppf(LEAST_P, n, share * 0.98)
        assert low <= tries.count(k) <= binom.isf(LEAST_P, n, min(1.0, share * 1.02))


def test_holes_of_all_pushes_at_a_stop_lie_apart_and_within_reach() -> None:
    """Seven pushes of three tries each: no two holes nearer than the rod's own circle."""
    machine = replace(QUIET, fix_sd_m=0.0, stone_probability=1.0, usable_m=0.0)
    robot, holes = robot_at(machine), []
    for _ in range(7):
        outcome = robot.probe()
        assert isinstance(outcome, Push)
        holes.append((outcome.at[0] - 22.5, outcome.at[1] - 22.5))
    for k, one in enumerate(holes):
        assert hypot(*one) <= 3 * machine.gantry_m + 1e-9
        for other in holes[:k]:
            assert hypot(one[0] - other[0], one[1] - other[1]) > 0.9 * machine.gantry_m


def test_a_push_is_usable_from_the_depth_on_that_is_asked_for() -> None:
    machine = replace(QUIET, fix_sd_m=0.0, stone_probability=1.0, usable_m=0.25, tries=1)
    outcomes = [robot_at(machine, number).probe() for number in range(200)]
    refused = [each for each in outcomes if isinstance(each, Refusal)]
    kept = [each for each in outcomes if isinstance(each, Push)]
    assert all(each.reading.depth_m[-1] >= 0.25 for each in kept)
    depths = [float(each.reason.split()[-2]) for each in refused]
    assert max(depths) < 0.25
    # Stones are even over 0.5 m and stall the rod within 5 mm below.
    n, share = len(outcomes), 0.25 / 0.5
    assert binom.ppf(LEAST_P, n, share - 0.01) <= len(refused) <= binom.isf(LEAST_P, n, share)


class Ferry(OpenLand):
    """Open land cut in two at 25 m east, with no way across."""

    def between(self, a: ArrayLike, b: ArrayLike) -> Floats:
        east = [np.asarray(places, dtype=float).reshape(-1, 2)[:, 0] > 25.0 for places in (a, b)]
        return np.where(east[0][:, None] == east[1], super().between(a, b), np.inf)


def test_where_no_way_leads_it_does_not_go_and_spends_nothing() -> None:
    robot = SimulatedRobot(TRUTH, QUIET, seed=1, position=(2.5, 2.5), access=Ferry(FIELD))
    before = robot.battery_s
    there = robot.go_to(Assignment("far", 0, FIELD.nearest_cell((42.5, 7.5)), (42.5, 7.5)))
    assert there == Unreachable("no way leads there", (2.5, 2.5))
    assert robot.battery_s == before
    near = robot.go_to(Assignment("near", 1, FIELD.nearest_cell((12.5, 2.5)), (12.5, 2.5)))
    assert isinstance(near, Arrival)
    assert near.metres == 10.0
