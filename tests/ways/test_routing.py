"""Routes are permutations, short, and the same every time."""

from __future__ import annotations

from itertools import pairwise, permutations, product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from subsoil.arrays import Floats
from subsoil.land.field import Field
from subsoil.ways.moves import PER_METRE, shorten
from subsoil.ways.open_land import OpenLand
from subsoil.ways.routing import length, reroute, tour, way

OPEN = OpenLand(Field.from_metres([(0, 0), (310, 0), (310, 200), (0, 200)]))
HEDGE = [(49, 0), (51, 0), (51, 90), (49, 90)]
HEDGED = OpenLand(Field.from_metres([(0, 0), (100, 0), (100, 100), (0, 100)], keep_outs=[HEDGE]))
"""Two meadows of 49 x 100 m, joined by a gap of 10 m in the north."""

metres = st.integers(0, 30).map(lambda k: 5.0 * k) | st.floats(0, 200, allow_subnormal=False)
place = st.tuples(metres, metres)


def places(least: int, most: int) -> st.SearchStrategy[Floats]:
    return st.lists(place, min_size=least, max_size=most).map(
        lambda found: np.array(found, dtype=float).reshape(-1, 2)
    )


def cells(n: int, seed: int) -> Floats:
    """Different cells of a 36 x 26 grid, which is full of equally short routes."""
    index = np.random.default_rng(seed).choice(36 * 26, n, replace=False)
    return np.asarray(np.column_stack([index % 36, index // 36]) * 5.0 + 2.5)


def shortest(start: tuple[float, float], at: Floats) -> float:
    return min(length(OPEN, start, at[list(order)]) for order in permutations(range(len(at))))


def nearest_neighbour(start: tuple[float, float], at: Floats) -> float:
    left, here, total = list(range(len(at))), np.array(start), 0.0
    while left:
        steps = np.hypot(*(at[left] - here).T)
        nearest = left.pop(int(np.argmin(steps)))
        total, here = total + float(steps.min()), at[nearest]
    return total


def cheapest_insertion(at: Floats, start: tuple[float, float], route: list[int], new: int) -> float:
    orders = ([*route[:k], new, *route[k:]] for k in range(len(route) + 1))
    return min(length(OPEN, start, at[order]) for order in orders)


def way_length(distance: Floats, order: tuple[int, ...]) -> float:
    nodes = (0, *order)
    return sum(float(distance[a, b]) for a, b in pairwise(nodes))


def neighbours(order: tuple[int, ...]) -> set[tuple[int, ...]]:
    """Orders that one reversal or one move of up to three stops leads to."""
    k = len(order)
    reversals = {
        (*order[:i], *order[i:j][::-1], *order[j:]) for i, j in product(range(k), range(2, k + 1))
        if j - i > 1
    }  # fmt: skip
    moves = set()
    for size, first in product((1, 2, 3), range(k)):
        segment, rest = order[first : first + size], (*order[:first], *order[first + size :])
        for gap, turned in product(range(len(rest) + 1), (segment, segment[::-1])):
            moves.add((*rest[:gap], *turned, *rest[gap:]))
    return reversals | moves


def test_a_length_counts_the_way_to_the_first_stop_and_none_back() -> None:
    assert length(OPEN, (0, 0), [(3, 4), (3, 10)]) == 11.0
    assert length(OPEN, (7, 7), []) == 0.0


@given(start=place, at=places(0, 6))
@settings(max_examples=150, deadline=None)
def test_a_tour_of_few_stops_is_the_shortest_open_way(
    start: tuple[float, float], at: Floats
) -> None:
    order = tour(OPEN, start, at)
    assert sorted(order) == list(range(len(at)))
    assert length(OPEN, start, at[list(order)]) <= shortest(start, at) + len(at) / PER_METRE


def test_a_tour_of_eight_stops_is_the_shortest_open_way() -> None:
    for seed in range(3):
        at = np.random.default_rng(seed).uniform(0, 180, (8, 2))
        found = length(OPEN, (0, 0), at[list(tour(OPEN, (0, 0), at))])
        assert found == pytest.approx(shortest((0, 0), at), abs=1e-9)


@pytest.mark.parametrize("n", [12, 18, 19, 40, 90])
def test_a_tour_is_a_permutation_and_never_longer_than_going_to_the_nearest(n: int) -> None:
    at = cells(n, seed=n)
    order = tour(OPEN, (0, 0), at)
    assert sorted(order) == list(range(n))
    assert length(OPEN, (0, 0), at[list(order)]) <= nearest_neighbour((0, 0), at)


@pytest.mark.parametrize("n", [18, 30, 50, 60])
def test_a_tour_of_grid_cells_is_the_same_every_time(n: int) -> None:
    at = cells(n, seed=2)
    assert len({tour(OPEN, (0, 0), at) for _ in range(4)}) == 1


def test_a_tour_is_no_longer_than_the_way_on_which_the_stops_lie() -> None:
    along = np.column_stack([np.linspace(5, 300, 60), np.zeros(60)])
    order = tour(OPEN, (0, 0), along[::-1])
    assert order == tuple(range(59, -1, -1))


def test_nothing_to_visit_is_an_empty_tour() -> None:
    assert tour(OPEN, (3, 3), []) == ()
    assert tour(OPEN, (3, 3), [(9, 9)]) == (0,)
    assert reroute(OPEN, np.zeros((4, 2)), (3, 3), ()) == ()
    assert shorten(np.zeros((1, 1))) == ()


@pytest.mark.parametrize("n", [1, 2, 5, 25])
def test_stops_that_coincide_are_all_in_the_tour(n: int) -> None:
    assert sorted(tour(OPEN, (0, 0), np.zeros((n, 2)))) == list(range(n))
    twice = np.repeat(cells(n, seed=1), 2, axis=0)
    order = tour(OPEN, tuple(twice[0]), twice)
    assert sorted(order) == list(range(2 * n))
    once = twice[::2]
    alone = length(OPEN, twice[0], once[list(tour(OPEN, tuple(twice[0]), once))])
    assert length(OPEN, twice[0], twice[list(order)]) == pytest.approx(alone, rel=1e-3)


@given(at=places(1, 12), start=place, data=st.data())
@settings(max_examples=150, deadline=None)
def test_a_new_stop_is_put_in_no_worse_than_where_it_costs_least(
    at: Floats, start: tuple[float, float], data: st.DataObject
) -> None:
    route = data.draw(st.permutations(range(len(at))))
    new, rest = route[0], route[1:]
    order = reroute(OPEN, at, start, rest, [new])
    assert sorted(order) == sorted(route)
    least = cheapest_insertion(at, start, rest, new)
    assert length(OPEN, start, at[list(order)]) <= least + 2 * len(at) / PER_METRE
    assert reroute(OPEN, at, start, rest, [new]) == order


@given(at=places(1, 9))
@settings(max_examples=60, deadline=None)
def test_no_reversal_and_no_move_of_three_shortens_a_shortened_way(at: Floats) -> None:
    distance = np.hypot(*(at[:, None] - at[None]).transpose(2, 0, 1))
    order = shorten(distance)
    assert sorted(order) == list(range(1, len(at)))
    found = way_length(distance, order)
    told_apart = 2 * len(at) / PER_METRE
    assert found <= way_length(distance, tuple(range(1, len(at)))) + told_apart
    assert all(way_length(distance, other) >= found - told_apart for other in neighbours(order))


def test_a_route_that_cannot_be_shortened_keeps_its_order() -> None:
    at = np.array([(0.0, 10.0), (0.0, 20.0), (10.0, 20.0), (10.0, 10.0), (10.0, 0.0)])
    assert reroute(OPEN, at, (0, 0), [0, 1, 2, 3]) == (0, 1, 2, 3)
    assert reroute(OPEN, at, (0, 0), [0, 1, 2, 3], [4]) == (0, 1, 2, 3, 4)


def test_a_route_with_stops_put_in_is_close_to_a_tour_from_scratch() -> None:
    at = cells(50, seed=5)
    kept = tour(OPEN, (0, 0), at[:40])
    warm = length(OPEN, (0, 0), at[list(reroute(OPEN, at, (0, 0), kept, range(40, 50)))])
    assert warm <= 1.1 * length(OPEN, (0, 0), at[list(tour(OPEN, (0, 0), at))])


@pytest.mark.parametrize("seed", range(3))
def test_a_route_over_grid_cells_does_not_hang_on_rounding_noise(seed: int) -> None:
    at = cells(30, seed)
    shaken = at + np.random.default_rng(seed).uniform(-1e-9, 1e-9, at.shape)
    route = reroute(OPEN, at, (0, 0), range(20), range(20, 30))
    assert reroute(OPEN, shaken, (0, 0), range(20), range(20, 30)) == route


def test_a_tour_around_keep_outs_of_many_stops_is_the_same_every_time() -> None:
    at = np.random.default_rng(8).uniform(0, 100, (60, 2))
    order = tour(HEDGED, (0, 0), at)
    assert sorted(order) == list(range(60))
    assert tour(HEDGED, (0, 0), at) == order


def test_a_tour_finishes_one_side_of_a_hedge_before_the_other() -> None:
    west, east = [(45, 10), (45, 30), (45, 50)], [(55, 10), (55, 30), (55, 50)]
    at = np.array([*west, *east])
    order = tour(HEDGED, (40, 0), at)
    assert order == (0, 1, 2, 5, 4, 3)
    over = 2 * np.hypot(4, 40) + 2.0
    assert length(HEDGED, (40, 0), at[list(order)]) == pytest.approx(
        np.hypot(5, 10) + 40 + over + 40
    )
    straight = tour(OPEN, (40, 0), at)
    assert length(HEDGED, (40, 0), at[list(straight)]) > 1.5 * length(
        HEDGED, (40, 0), at[list(order)]
    )


def test_a_stop_behind_a_hedge_is_put_in_on_its_own_side() -> None:
    at = np.array([(45.0, 10.0), (45.0, 80.0), (55.0, 80.0), (55.0, 12.0), (60.0, 10.0)])
    assert reroute(HEDGED, at, (45, 0), (0, 1, 2, 4), (3,)) == (0, 1, 2, 3, 4)


@pytest.mark.parametrize("seed", range(4))
def test_a_tour_around_a_hedge_is_the_shortest_of_all(seed: int) -> None:
    at = np.random.default_rng(seed).uniform(0, 100, (6, 2))
    found = length(HEDGED, (0, 0), at[list(tour(HEDGED, (0, 0), at))])
    ways = (length(HEDGED, (0, 0), at[list(order)]) for order in permutations(range(6)))
    assert found == pytest.approx(min(ways), rel=1e-4)


def test_the_way_of_a_route_bends_where_it_must_and_is_as_long_as_it_says() -> None:
    stops = [(30.0, 10.0), (60.0, 10.0), (60.0, 40.0)]
    line = way(HEDGED, (0, 0), stops)
    assert line.tolist() == [[0, 0], [30, 10], [49, 90], [51, 90], [60, 10], [60, 40]]
    steps = np.hypot(*np.diff(line, axis=0).T)
    assert steps.sum() == pytest.approx(length(HEDGED, (0, 0), stops))
    assert way(HEDGED, (3, 4), []).tolist() == [[3, 4]]
    assert way(HEDGED, (3, 4), [(3, 4)]).tolist() == [[3, 4], [3, 4]]
