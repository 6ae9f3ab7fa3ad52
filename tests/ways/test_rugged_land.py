"""Ways through land with bays, holes and spits, against a fine graph of what sees what."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import cast

import numpy as np
import pytest
import shapely
from numpy.testing import assert_allclose
from scipy.sparse.csgraph import shortest_path
from scipy.spatial.distance import cdist

from subsoil.arrays import Floats
from subsoil.land.field import Field
from subsoil.ways.open_land import OpenLand

RuggedField = Callable[..., Field]
SEEDS = range(10)


def free_of(field: Field) -> shapely.Polygon:
    free = shapely.difference(field.boundary, shapely.union_all(list(field.keep_outs)))
    return cast("shapely.Polygon", free)


def some_places(field: Field, k: int, seed: int) -> Floats:
    rng = np.random.default_rng(seed)
    return np.asarray(field.cells[rng.choice(len(field.cells), k, replace=False)])


def by_graph(field: Field, places: Floats, step_m: float = 12.0) -> Floats:
    """(k, k) lengths on the graph of places, all corners, and points along all edges, by scipy."""
    free = free_of(field)
    edges = shapely.get_coordinates(shapely.segmentize(free, step_m))
    nodes = np.concatenate([places, np.unique(edges, axis=0)])
    one, other = np.triu_indices(len(nodes), 1)
    lines = np.asarray(shapely.linestrings(np.stack([nodes[one], nodes[other]], axis=1)))
    wide = shapely.buffer(free, 1e-6, join_style="mitre")
    shapely.prepare(wide)
    seen = shapely.covers(wide, lines)
    step = np.full((len(nodes),) * 2, np.inf)
    step[one[seen], other[seen]] = shapely.length(lines[seen])
    found: Floats = shortest_path(step, directed=False, indices=range(len(places)))
    return found[:, : len(places)]


@pytest.mark.parametrize("seed", SEEDS)
def test_ways_are_as_long_as_on_a_fine_graph_of_what_sees_what(
    rugged_field: RuggedField, seed: int
) -> None:
    field = rugged_field(seed)
    places = some_places(field, 12, seed)
    found, expected = OpenLand(field).between(places, places), by_graph(field, places)
    assert_allclose(found, expected, atol=1e-4)


def test_something_is_in_the_way_in_these_tests(rugged_field: RuggedField) -> None:
    bent = 0
    for seed in SEEDS:
        field = rugged_field(seed)
        places = some_places(field, 40, seed)
        straight = cdist(places[::2], places[1::2])
        detour = OpenLand(field).between(places[::2], places[1::2]) - straight
        bent += int((detour.diagonal() > 0.1).sum())
    assert bent >= 40


@pytest.mark.parametrize("seed", SEEDS)
def test_a_way_bends_at_corners_only_and_nowhere_without_need(
    rugged_field: RuggedField, seed: int
) -> None:
    field = rugged_field(seed)
    land, free = OpenLand(field), free_of(field)
    wide = shapely.buffer(free, 3e-6, join_style="mitre")
    tight = shapely.buffer(free, -1e-4)
    corners = shapely.get_coordinates(free)
    places = some_places(field, 40, seed)
    for a, b in zip(places[::2], places[1::2], strict=True):
        way = land.way(a, b)
        assert wide.covers(shapely.LineString(way)) or (a == b).all()
        assert_allclose(land.way(b, a)[::-1], way, atol=1e-6)
        for k in range(1, len(way) - 1):
            assert cdist(way[k : k + 1], corners).min() < 1e-6
            shortcut = shapely.LineString(way[[k - 1, k + 1]])
            assert not tight.covers(shortcut)
            assert not wide.covers(shortcut) or shortcut.distance(shapely.Point(way[k])) < 1e-4


@pytest.mark.parametrize("seed", SEEDS)
def test_a_further_keep_out_shortens_no_way(rugged_field: RuggedField, seed: int) -> None:
    field = rugged_field(seed)
    places = some_places(field, 30, seed)
    more = shapely.box(*(places[0] + (6.0, 6.0)), *(places[0] + (16.0, 16.0)))
    fewer = replace(field, keep_outs=field.keep_outs[1:])
    further = replace(field, keep_outs=(*field.keep_outs, more))
    if not isinstance(free_of(further), shapely.Polygon):
        further = field
    open_to_all = places[further.contains(places)]
    lengths = [OpenLand(each).between(open_to_all, open_to_all) for each in (fewer, field, further)]
    assert (lengths[0] <= lengths[1] + 1e-5).all()
    assert (lengths[1] <= lengths[2] + 1e-5).all()


@pytest.mark.parametrize("seed", [0, 1, 2])
@pytest.mark.parametrize(
    ("turn", "scale", "shift"),
    [(0.7, 1.0, (0.0, 0.0)), (0.0, 3.0, (0.0, 0.0)), (2.1, 1.0, (431_000.0, 5_780_000.0))],
)
def test_land_that_is_turned_stretched_or_moved_has_its_ways_so_too(
    rugged_field: RuggedField, seed: int, turn: float, scale: float, shift: tuple[float, float]
) -> None:
    field = rugged_field(seed)
    spin = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])

    def moved(at: Floats) -> Floats:
        return np.asarray(scale * at @ spin + np.array(shift))

    other = Field(
        shapely.transform(field.boundary, moved), "",
        tuple(shapely.transform(each, moved) for each in field.keep_outs), 5.0,
    )  # fmt: skip
    places = some_places(field, 25, seed)
    here, there = OpenLand(field).between(places, places), OpenLand(other)
    assert_allclose(there.between(moved(places), moved(places)), scale * here, atol=1e-4)


@pytest.mark.parametrize("seed", SEEDS)
def test_ways_are_a_metric_on_connected_land(rugged_field: RuggedField, seed: int) -> None:
    field = rugged_field(seed)
    places = some_places(field, 40, seed)
    length = OpenLand(field).between(places, places)
    assert_allclose(length, length.T, atol=1e-9)
    assert (length == 0.0).tolist() == (cdist(places, places) == 0.0).tolist()
    assert (length <= (length[:, :, None] + length[None]).min(axis=1) + 1e-5).all()


@pytest.mark.parametrize("seed", SEEDS)
def test_from_where_it_is_not_allowed_one_goes_straight_to_the_nearest_allowed_place(
    rugged_field: RuggedField, seed: int
) -> None:
    field = rugged_field(seed)
    rng, free = np.random.default_rng(seed), free_of(field)
    lost = rng.uniform(-20, 220, (60, 2))
    lost = lost[~shapely.contains_xy(free, *lost.T)]
    places = some_places(field, 5, seed)
    land = OpenLand(field)
    for at in lost[:12]:
        line = shapely.shortest_line(shapely.Point(at), free)
        enters = shapely.get_coordinates(line)[1:]
        found = land.between(at, places)[0]
        over = line.length + land.between(enters, places)[0]
        straight = cdist(at[None], places)[0]
        assert_allclose(found, np.maximum(over, straight), atol=1e-4)


def test_land_of_two_parts_is_driven_within_each_and_crossed_straight_between() -> None:
    left = shapely.Polygon(
        [(0, 0), (40, 0), (40, 40), (30, 40), (30, 10), (10, 10), (10, 40), (0, 40)]
    )
    right = shapely.affinity.translate(left, 60.0)
    field = Field(shapely.MultiPolygon([left, right]))
    land = OpenLand(field)
    inside = (field.cells[:, 0] < 50.0).astype(int)
    length = land.between(field.cells, field.cells)
    same = np.equal.outer(inside, inside)
    straight = cdist(field.cells, field.cells)
    assert_allclose(length[~same], straight[~same])
    alone = OpenLand(Field(left))
    part = field.cells[inside == 1]
    assert_allclose(length[np.ix_(inside == 1, inside == 1)], alone.between(part, part))
    assert (length[same] > straight[same] + 1.0).any()
