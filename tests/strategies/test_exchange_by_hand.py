"""Stops and way exchanged together, against every design of tiny fields written out by hand."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations, pairwise, permutations
from math import inf

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.spatial.distance import cdist
from scipy.stats import chi2

from subsoil.arrays import Floats
from subsoil.kriging.designs import Designs
from subsoil.land.field import Field
from subsoil.layers import Layers
from subsoil.mapping.soilmap import SoilMap
from subsoil.stopping import Pace
from subsoil.strategies import View
from subsoil.strategies.joint.detours import Detours
from subsoil.strategies.joint.exchange import Exchange
from subsoil.strategies.joint.options import drawn
from subsoil.strategies.joint.plans import TimeLeft, designs_for, joint
from subsoil.strategies.joint.price import Price, SweepOptions
from subsoil.variogram import Exponential, Nested, Structure
from subsoil.ways.open_land import OpenLand

BED = Field.from_metres([(0, 0), (40, 0), (40, 30), (0, 30)], cell_size=10.0)
LAND = OpenLand(BED)
N = len(BED.cells)
START = (0.0, 0.0)
SHAPE = Nested(1.0, (Structure(0.8, Exponential, 30.0),))
DESIGNS = Designs(BED, SHAPE, np.ones(N))
cells = st.lists(st.integers(0, N - 1), min_size=2, max_size=6, unique=True)


def metres(route: list[int]) -> float:
    at = [np.array(START), *BED.cells[route]]
    return float(sum(np.hypot(*(b - a)) for a, b in pairwise(at)))


def mean_variance(design: list[int]) -> float:
    """Textbook kriging variance of every cell from a design, averaged."""
    n = len(design)
    system = np.ones((n + 1, n + 1))
    away = cdist(BED.cells[design], BED.cells[design])
    system[:n, :n] = 0.8 * np.exp(-3 * away / 30.0) + 0.2 * np.eye(n)
    system[n, n] = 0.0
    right = np.ones((n + 1, N))
    right[:n] = 0.8 * np.exp(-3 * cdist(BED.cells[design], BED.cells) / 30.0)
    return float((0.8 - (right * np.linalg.solve(system, right)).sum(axis=0)).mean())


def gaps(route: list[int], cell: int) -> list[list[int]]:
    return [[*route[:gap], cell, *route[gap:]] for gap in range(len(route) + 1)]


def search(route: list[int], price: Price, fixed: tuple[int, ...] = ()) -> Exchange:
    return Exchange(DESIGNS, LAND, START, fixed, route, np.ones(N, dtype=bool), price)


# --- one step at a time ---------------------------------------------------------------------------


@given(cells, st.sampled_from([0.0, 1e-4, 5e-3, 0.1]))
@settings(max_examples=25, deadline=None)
def test_the_cell_put_in_is_worth_most_of_all_cells_and_gaps(
    chosen: list[int], per_m: float
) -> None:
    fixed, route = tuple(chosen[:1]), chosen[1:]
    found = search(route, Price(per_m=per_m), fixed)
    found.insert()
    assert len({*fixed, *found.route}) == len(chosen) + 1

    def cost(order: list[int]) -> float:
        return mean_variance([*fixed, *order]) + per_m * metres(order)

    least = min(cost(o) for k in set(range(N)) - set(chosen) for o in gaps(route, k))
    assert found.cost == pytest.approx(cost(list(found.route)), rel=1e-9)
    assert found.cost == pytest.approx(least, rel=1e-9)


@given(cells.filter(lambda each: len(each) > 2), st.floats(0.0, 1e-2))
@settings(max_examples=25, deadline=None)
def test_the_stop_taken_out_is_worth_least(chosen: list[int], per_m: float) -> None:
    found = search(chosen, Price(per_m=per_m))
    found.drop()
    rest = [[*chosen[:k], *chosen[k + 1 :]] for k in range(len(chosen))]
    least = min(mean_variance(order) + per_m * metres(order) for order in rest)
    assert list(found.route) in rest
    assert found.cost == pytest.approx(least, rel=1e-9)


@given(cells, st.integers(0, 99))
@settings(max_examples=25, deadline=None)
def test_what_is_within_reach_moves_no_farther_than_that_in_a_sweep(
    chosen: list[int], seed: int
) -> None:
    found = search(chosen, Price())
    found.descend(1, SweepOptions(reach_m=10.0), np.random.default_rng(seed))
    away = cdist(BED.cells[list(found.route)], BED.cells[chosen])
    near = away <= 10.0 + 1e-9
    # Every stop came from one within reach, each from another: a perfect matching.
    assert any(
        all(near[k, p[k]] for k in range(len(chosen))) for p in permutations(range(len(chosen)))
    )


# --- whole searches -------------------------------------------------------------------------------


@pytest.mark.parametrize("per_m", [1e-5, 1e-3, 4e-3])
@pytest.mark.parametrize("stops", [2, 3])
def test_a_plan_at_a_price_is_the_best_of_all_designs_and_orders(stops: int, per_m: float) -> None:
    view = View(
        BED, LAND, SoilMap(BED, Layers()), START, (), (), (), stops, True,
        np.random.default_rng(1),
    )  # fmt: skip
    judge = designs_for(view)
    way = {c: min(metres(list(o)) for o in permutations(c)) for c in combinations(range(N), stops)}
    costs = {c: judge.mean_variance(c) + per_m * way[c] for c in way}
    plan = joint(view, price_per_m=per_m)
    found = judge.mean_variance(plan.cells) + per_m * metres(list(plan.cells))
    assert found == pytest.approx(min(costs.values()), rel=1e-9)


def test_a_plan_of_few_metres_is_the_best_of_all_that_keep_to_them() -> None:
    limit = 45.0
    view = View(
        BED, LAND, SoilMap(BED, Layers()), START, (), (), (), 3, True, np.random.default_rng(1)
    )
    judge = designs_for(view)
    within = [c for c in permutations(range(N), 3) if metres(list(c)) <= limit]
    best = min(judge.mean_variance(c) for c in within)
    plan = joint(replace(view, metres_left=limit), way=9.0)
    assert metres(list(plan.cells)) <= limit
    assert judge.mean_variance(plan.cells) <= 1.02 * best


# --- what it is made of ---------------------------------------------------------------------------


@given(cells, st.data())
@settings(max_examples=25, deadline=None)
def test_detours_are_those_of_the_best_gap_while_slots_come_go_and_change(
    chosen: list[int], data: st.DataObject
) -> None:
    detours, held = Detours(LAND, chosen, START), list(chosen)
    for _ in range(data.draw(st.integers(0, 4))):
        slot, cell = data.draw(st.integers(0, len(held) - 1)), data.draw(st.integers(0, N - 1))
        match data.draw(st.sampled_from(["put", "insert", "delete"])):
            case "put":
                detours.put(slot, cell)
                held[slot] = cell
            case "insert":
                detours.insert(slot, cell)
                held.insert(slot, cell)
            case _ if len(held) > 1:
                detours.delete(slot)
                del held[slot]
    order = data.draw(st.permutations(range(len(held))))
    route = [held[slot] for slot in order]
    legs = detours.legs(order, route)
    assert_allclose(legs, [metres(route[: k + 1]) - metres(route[:k]) for k in range(len(route))])
    grown, gap = detours.of(order, legs, slice(None))
    for cell in range(N):
        by_gap = [metres(each) - metres(route) for each in gaps(route, cell)]
        assert grown[cell] == pytest.approx(min(by_gap), abs=1e-9)
        assert by_gap[gap[cell]] == pytest.approx(min(by_gap), abs=1e-9)
    near = detours.near(order[0], 15.0).tolist()
    assert near == np.flatnonzero(cdist(BED.cells[route[:1]], BED.cells)[0] <= 15.0).tolist()


@pytest.mark.parametrize("price", [Price(per_m=2e-4), Price(elasticity=0.14), Price()])
@given(st.floats(0.05, 1.0), st.floats(5.0, 2000.0))
def test_a_metre_costs_what_the_cost_changes_by_with_the_way_over_with_the_variance(
    price: Price, variance: float, way: float
) -> None:
    step = 1e-5
    by_way = (price.cost(variance, way + step) - price.cost(variance, way - step)) / (2 * step)
    by_variance = price.cost(variance + 0.5, way) - price.cost(variance - 0.5, way)
    assert price.at(variance, way) == pytest.approx(by_way / by_variance, rel=1e-4, abs=1e-12)


def test_without_a_metre_to_go_the_price_is_that_of_one() -> None:
    price = Price(elasticity=0.14)
    assert price.at(0.5, 0.0) == price.at(0.5, 1.0) == pytest.approx(0.07)
    assert price.cost(0.5, 0.0) == 0.5


@pytest.mark.parametrize("temperature", [0.05, 0.3, 5.0])
def test_a_draw_has_the_weights_of_boltzmann(temperature: float) -> None:
    objective = np.array([0.3, -0.2, inf, 0.05, -0.1])
    rng = np.random.default_rng(4)
    counts = np.bincount([drawn(objective, temperature, rng) for _ in range(4000)], minlength=5)
    likely = np.exp(-objective / temperature)
    expected = 4000 * likely / likely.sum()
    assert counts[2] == 0
    often = expected > 5
    # Chi-square of the cells that are expected often; passed by chance once in a million times.
    off = ((counts - expected)[often] ** 2 / expected[often]).sum()
    assert off < chi2.ppf(1 - 1e-6, often.sum() - 1)


@given(st.lists(st.floats(-1, 1), min_size=1, max_size=9))
def test_at_no_temperature_the_first_of_the_lowest_is_drawn_and_chance_is_left_alone(
    objective: list[float],
) -> None:
    rng = np.random.default_rng(1)
    before = rng.bit_generator.state
    assert drawn(np.array(objective), 0.0, rng) == objective.index(min(objective))
    assert rng.bit_generator.state == before


@pytest.mark.parametrize(
    ("metres_left", "minutes_left", "ticking", "way_of_3", "most"),
    [
        (inf, inf, False, inf, 50),
        (300.0, inf, True, 300.0, 50),
        (inf, 10.0, True, (600 - 3 * 60) * 2.0, 10),
        (300.0, 10.0, True, 300.0, 10),
        (inf, 2.5, True, -60.0, 2),
        (inf, 0.0, True, -360.0, 0),
    ],
)
def test_what_is_left_for_driving_is_what_stops_leave_of_the_limits(
    metres_left: float, minutes_left: float, ticking: bool, way_of_3: float, most: int
) -> None:  # fmt: skip
    view = View(
        BED, LAND, SoilMap(BED, Layers()), START, (), (), (), 50, True, np.random.default_rng(1),
        pace=Pace(speed_mps=2.0, stop_s=60.0), metres_left=metres_left, minutes_left=minutes_left,
    )  # fmt: skip
    left = TimeLeft(view)
    assert (left.is_ticking, left.counts_minutes) == (ticking, minutes_left < inf)
    assert left.metres_for(3) == pytest.approx(way_of_3)
    assert left.most_stops(50) == most
    route = [1, 5, 9]
    found = search(route, Price())
    assert left.late(found) == (metres(route) > way_of_3)


def test_a_weighted_design_counts_the_cells_that_matter() -> None:
    weights: Floats = np.where(BED.cells[:, 0] < 20.0, 1.0, 0.0)
    judge = Designs(BED, SHAPE, weights)
    pairs = list(combinations(range(N), 2))
    best = min(pairs, key=judge.mean_variance)
    assert (BED.cells[list(best), 0] < 30.0).all()
    assert judge.mean_variance(best) < judge.mean_variance(min(pairs, key=DESIGNS.mean_variance))
