"""Routes are permutations, short, and the same every time."""

from __future__ import annotations

from itertools import pairwise, permutations, product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from subsoil.routing import length, reroute, shorten, tour

Floats = NDArray[np.float64]

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
    return min(length(start, at[list(order)]) for order in permutations(range(len(at))))


def nearest_neighbour(start: tuple[float, float], at: Floats) -> float:
    left, here, total = list(range(len(at))), np.array(start), 0.0
    while left:
        steps = np.hypot(*(at[left] - here).T)
        nearest = left.pop(int(np.argmin(steps)))
        total, here = total + float(steps.min()), at[nearest]
    return total


def cheapest_insertion(at: Floats, start: tuple[float, float], route: list[int], new: int) -> float:
    ways = ([*route[:k], new, *route[k:]] for k in range(len(route) + 1))
    return min(length(start, at[way]) for way in ways)


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
    assert length((0, 0), [(3, 4), (3, 10)]) == 11.0
    assert length((7, 7), []) == 0.0


@given(start=place, at=places(0, 6))
@settings(max_examples=150, deadline=None)
def test_a_tour_of_few_stops_is_the_shortest_open_way(
    start: tuple[float, float], at: Floats
) -> None:
    order = tour(start, at)
    assert sorted(order) == list(range(len(at)))
    farthest = max((length(a, [b]) for a, b in product([start, *at], repeat=2)), default=0.0)
    rounding = len(at) * farthest * 1.1 / 65_000
    assert length(start, at[list(order)]) <= shortest(start, at) + rounding + 1e-9


def test_a_tour_of_eight_stops_is_the_shortest_open_way() -> None:
    for seed in range(3):
        at = np.random.default_rng(seed).uniform(0, 180, (8, 2))
        found = length((0, 0), at[list(tour((0, 0), at))])
        assert found == pytest.approx(shortest((0, 0), at), abs=1e-9)


@pytest.mark.parametrize("n", [12, 18, 19, 40, 90])
def test_a_tour_is_a_permutation_and_never_longer_than_going_to_the_nearest(n: int) -> None:
    at = cells(n, seed=n)
    order = tour((0, 0), at)
    assert sorted(order) == list(range(n))
    assert length((0, 0), at[list(order)]) <= nearest_neighbour((0, 0), at)


@pytest.mark.parametrize("n", [18, 30, 50, 60])
def test_a_tour_of_grid_cells_is_the_same_every_time(n: int) -> None:
    at = cells(n, seed=2)
    assert len({tour((0, 0), at) for _ in range(4)}) == 1


def test_a_tour_is_no_longer_than_the_way_on_which_the_stops_lie() -> None:
    along = np.column_stack([np.linspace(5, 300, 60), np.zeros(60)])
    order = tour((0, 0), along[::-1])
    assert order == tuple(range(59, -1, -1))


def test_nothing_to_visit_is_an_empty_tour() -> None:
    assert tour((3, 3), []) == ()
    assert tour((3, 3), [(9, 9)]) == (0,)
    assert reroute(np.zeros((4, 2)), (3, 3), ()) == ()
    assert shorten(np.zeros((1, 1))) == ()


@pytest.mark.parametrize("n", [1, 2, 5, 25])
def test_stops_that_coincide_are_all_in_the_tour(n: int) -> None:
    assert sorted(tour((0, 0), np.zeros((n, 2)))) == list(range(n))
    twice = np.repeat(cells(n, seed=1), 2, axis=0)
    order = tour(tuple(twice[0]), twice)
    assert sorted(order) == list(range(2 * n))
    once = twice[::2]
    way = length(twice[0], once[list(tour(tuple(twice[0]), once))])
    assert length(twice[0], twice[list(order)]) == pytest.approx(way, rel=1e-3)


@given(at=places(1, 12), start=place, data=st.data())
@settings(max_examples=150, deadline=None)
def test_a_new_stop_is_put_in_no_worse_than_where_it_costs_least(
    at: Floats, start: tuple[float, float], data: st.DataObject
) -> None:
    route = data.draw(st.permutations(range(len(at))))
    new, rest = route[0], route[1:]
    order = reroute(at, start, rest, [new])
    assert sorted(order) == sorted(route)
    assert length(start, at[list(order)]) <= cheapest_insertion(at, start, rest, new) + 1e-6
    assert reroute(at, start, rest, [new]) == order


@given(at=places(1, 9))
@settings(max_examples=60, deadline=None)
def test_no_reversal_and_no_move_of_three_shortens_a_shortened_way(at: Floats) -> None:
    distance = np.hypot(*(at[:, None] - at[None]).transpose(2, 0, 1))
    order = shorten(distance)
    assert sorted(order) == list(range(1, len(at)))
    found = way_length(distance, order)
    assert found <= way_length(distance, tuple(range(1, len(at)))) + 1e-9
    assert all(way_length(distance, other) >= found - 1e-6 for other in neighbours(order))


def test_a_route_that_cannot_be_shortened_keeps_its_order() -> None:
    at = np.array([(0.0, 10.0), (0.0, 20.0), (10.0, 20.0), (10.0, 10.0), (10.0, 0.0)])
    assert reroute(at, (0, 0), [0, 1, 2, 3]) == (0, 1, 2, 3)
    assert reroute(at, (0, 0), [0, 1, 2, 3], [4]) == (0, 1, 2, 3, 4)


def test_a_route_with_stops_put_in_is_close_to_a_tour_from_scratch() -> None:
    at = cells(50, seed=5)
    kept = tour((0, 0), at[:40])
    warm = length((0, 0), at[list(reroute(at, (0, 0), kept, range(40, 50)))])
    assert warm <= 1.1 * length((0, 0), at[list(tour((0, 0), at))])
