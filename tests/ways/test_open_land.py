"""Ways through a field are the shortest that stay in it and out of its keep-outs."""

from __future__ import annotations

import sqlite3
from collections.abc import Callable
from contextlib import closing
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.spatial.distance import cdist

from subsoil.agent import Arrival, Assignment
from subsoil.arrays import Floats
from subsoil.journal.ahead import NOTHING_DRAWN
from subsoil.journal.geopackage import geometry_of, initialise
from subsoil.journal.gis import create, draw_targets
from subsoil.land.field import Field
from subsoil.land.outline import Area
from subsoil.layers import Layers, Sample
from subsoil.mapping.soilmap import SoilMap
from subsoil.penetrometer import SMALL_CONE
from subsoil.plots.subject import way as drawn_way
from subsoil.simulation import Machine, SimulatedRobot, draw_truth
from subsoil.survey import apply, opened, opening, view
from subsoil.survey.events import Configured, Planned
from subsoil.variogram import Spherical
from subsoil.ways.open_land import OpenLand

Place = tuple[float, float]

MEADOW = [(0, 0), (100, 0), (100, 60), (0, 60)]
L_SHAPE = Field.from_metres([(0, 0), (100, 0), (100, 40), (40, 40), (40, 100), (0, 100)])
SHED = Field.from_metres(MEADOW, keep_outs=[[(40, 20), (60, 20), (60, 40), (40, 40)]])
SPLIT = Field.from_metres(MEADOW, keep_outs=[[(45, -10), (55, -10), (55, 70), (45, 70)]])
TWO_PONDS = Field.from_metres(
    [(0, 0), (180, 0), (180, 130), (0, 130)],
    keep_outs=[
        [(40, 30), (70, 30), (70, 80), (40, 80)],
        [(110, 60), (140, 60), (150, 100), (100, 100)],
    ],
)


def metres(way: Floats) -> float:
    return float(np.hypot(*np.diff(way, axis=0).T).sum())


def free_of(field: Field) -> Area:
    free = shapely.difference(field.boundary, shapely.union_all(list(field.keep_outs)))
    assert isinstance(free, shapely.Polygon | shapely.MultiPolygon)
    return free


def peer(field: Field, a: Place, b: Place) -> float:
    """Shortest way on the graph of all vertices, seen by shapely, by relaxing until it rests."""
    free = free_of(field)
    wide = shapely.buffer(free, 1e-6, join_style="mitre")
    nodes = np.unique(np.vstack([a, b, shapely.get_coordinates(free)]), axis=0)
    pairs = list(product(range(len(nodes)), repeat=2))
    lines = shapely.linestrings([nodes[list(pair)] for pair in pairs])
    shapely.prepare(wide)
    seen = shapely.covers(wide, lines).reshape(len(nodes), -1)
    length = np.where(seen, cdist(nodes, nodes), np.inf)
    for k in range(len(nodes)):
        length = np.minimum(length, length[:, k, None] + length[k])
    i, j = (int(np.flatnonzero((nodes == end).all(axis=1))[0]) for end in (a, b))
    return float(length[i, j])


corner = st.tuples(
    st.integers(-2, 22).map(lambda k: 5 * k), st.integers(-2, 14).map(lambda k: 5 * k)
)
rectangle = st.tuples(corner, corner).filter(lambda c: c[0][0] != c[1][0] and c[0][1] != c[1][1])
triangle = st.tuples(corner, corner, corner).filter(lambda c: shapely.Polygon(c).area > 1)
keep_out = rectangle.map(
    lambda c: list(
        shapely.box(
            min(c[0][0], c[1][0]),
            min(c[0][1], c[1][1]),
            max(c[0][0], c[1][0]),
            max(c[0][1], c[1][1]),
        ).exterior.coords
    )
) | triangle.map(list)
inside = st.tuples(
    st.integers(0, 20).map(lambda k: 5.0 * k) | st.floats(0, 100),
    st.integers(0, 12).map(lambda k: 5.0 * k) | st.floats(0, 60),
)


@st.composite
def fields(draw: st.DrawFn) -> Field:
    barred = [shapely.Polygon(ring) for ring in draw(st.lists(keep_out, max_size=3))]
    free = shapely.difference(shapely.Polygon(MEADOW), shapely.union_all(barred))
    cells = Field.from_metres(MEADOW).cells
    assume(shapely.contains_xy(free, *cells.T).any())
    return replace(Field.from_metres(MEADOW), keep_outs=tuple(barred))


def allowed(field: Field, at: list[Place]) -> Floats:
    places = np.array(at).reshape(-1, 2)
    return places[field.contains(places)]


def test_ways_in_an_l_turn_at_its_inner_corner() -> None:
    travel = OpenLand(L_SHAPE)
    assert travel.corners.tolist() == [[40, 40]]
    found = travel.between([(20, 90), (10, 10)], [(90, 20), (40, 100), (80, 40)])
    over = np.hypot(20, 50)
    assert found[0] == pytest.approx([over + np.hypot(50, 20), np.hypot(20, 10), over + 40])
    assert found[1] == pytest.approx(
        [np.hypot(80, 10), np.hypot(30, 90), np.hypot(70, 30)], rel=1e-15
    )
    assert travel.way((20, 90), (90, 20)).tolist() == [[20, 90], [40, 40], [90, 20]]
    assert travel.way((10, 10), (90, 20)).tolist() == [[10, 10], [90, 20]]


def test_ways_go_around_a_shed_on_its_shorter_side() -> None:
    travel = OpenLand(SHED)
    ((found,),) = travel.between([(20, 25)], [(80, 25)]).tolist()
    assert found == pytest.approx(2 * np.hypot(20, 5) + 20)
    assert travel.way((20, 25), (80, 25)).tolist() == [[20, 25], [40, 20], [60, 20], [80, 25]]
    assert travel.between([(20, 20)], [(80, 20)])[0, 0] == 60.0, "along its wall"
    assert travel.between([(30, 30)], [(50, 10)])[0, 0] == pytest.approx(np.hypot(20, 20))


def test_a_way_from_a_place_that_is_not_allowed_first_leaves_it_straight() -> None:
    travel = OpenLand(SHED)
    within, beyond, target = (58.0, 30.0), (110.0, 30.0), (20.0, 30.0)
    assert travel.between([(60, 30)], [target])[0, 0] == pytest.approx(10 + 20 + np.hypot(20, 10))
    assert travel.between([within], [target])[0, 0] == pytest.approx(2 + 10 + 20 + np.hypot(20, 10))
    assert travel.way(within, target)[:2].tolist() == [[58, 30], [60, 30]]
    from_edge = travel.between([(100, 30)], [target])[0, 0]
    assert from_edge == pytest.approx(np.hypot(40, 10) + 20 + np.hypot(20, 10))
    assert travel.between([beyond], [target])[0, 0] == pytest.approx(10 + from_edge)
    assert travel.between([within, beyond], [within, beyond]).diagonal().tolist() == [0, 0]


def test_between_parts_of_a_field_the_way_is_the_straight_line() -> None:
    travel = OpenLand(SPLIT)
    assert travel.between([(20, 30)], [(80, 40)])[0, 0] == pytest.approx(np.hypot(60, 10))
    assert travel.way((20, 30), (80, 40)).tolist() == [[20, 30], [80, 40]]
    apart = Field(shapely.MultiPolygon([shapely.box(0, 0, 40, 40), shapely.box(60, 0, 100, 40)]))
    assert OpenLand(apart).between([(10, 10)], [(90, 20)])[0, 0] == np.hypot(80, 10)


def test_a_hole_in_the_outline_is_gone_around_like_a_keep_out() -> None:
    hole = shapely.Polygon(MEADOW, [[(40, 20), (60, 20), (60, 40), (40, 40)]])
    at = SHED.cells[::7]
    holed = OpenLand(Field(hole)).between(at, at)
    assert holed == pytest.approx(OpenLand(SHED).between(at, at), rel=1e-12)


def test_in_a_convex_field_every_way_is_exactly_the_straight_line() -> None:
    convex = Field.from_metres([(4, 10), (60, 2), (126, 6), (178, 22), (186, 74), (2, 66)])
    rng = np.random.default_rng(1)
    a, b = rng.uniform(-50, 250, (40, 2)), convex.cells
    assert np.array_equal(OpenLand(convex).between(a, b), cdist(a, b))
    assert OpenLand(convex).way(a[0], a[1]).tolist() == a[:2].tolist()


def test_far_from_the_origin_ways_are_the_same() -> None:
    shift = np.array([389_123.456, 5_901_234.567])
    moved = Field.from_metres(
        np.array(MEADOW) + shift, keep_outs=[shapely.get_coordinates(SHED.keep_outs[0]) + shift]
    )
    at = SHED.cells[::5]
    there = OpenLand(moved).between(at + shift, at + shift)
    assert there == pytest.approx(OpenLand(SHED).between(at, at), abs=1e-6)


def test_ways_of_all_cells_are_those_of_some_and_finite() -> None:
    travel, cells = OpenLand(TWO_PONDS), TWO_PONDS.cells
    everything = travel.between(cells, cells)
    some = np.random.default_rng(3).choice(len(cells), 30, replace=False)
    assert np.array_equal(travel.between(cells[some], cells), everything[some])
    assert np.isfinite(everything).all()
    assert (everything > cdist(cells, cells) + 1.0).mean() > 0.05


def test_what_is_found_once_is_kept_with_the_value() -> None:
    land = OpenLand(SHED)
    assert land == OpenLand(replace(SHED))
    assert land.walls is land.walls
    assert not land.corners.flags.writeable


@given(field=fields(), at=st.lists(inside, min_size=2, max_size=4))
@settings(max_examples=100, deadline=None)
def test_a_way_is_as_long_as_an_independent_search_finds(field: Field, at: list[Place]) -> None:
    places = allowed(field, at)
    assume(len(places) >= 2 and len(shapely.get_parts(free_of(field))) == 1)
    (a, b) = ((east, north) for east, north in places[:2].tolist())
    assert OpenLand(field).between(a, b)[0, 0] == pytest.approx(peer(field, a, b), abs=1e-4)


@given(field=fields(), at=st.lists(inside, min_size=3, max_size=8))
@settings(max_examples=150, deadline=None)
def test_ways_are_distances_and_never_shorter_than_straight(field: Field, at: list[Place]) -> None:
    places = np.array(at)
    length = OpenLand(field).between(places, places)
    assert length == pytest.approx(length.T, abs=1e-5)
    assert (length >= cdist(places, places)).all()
    assert not length.diagonal().any()
    if len(shapely.get_parts(free_of(field))) == 1:
        over = (length[:, :, None] + length[None]).min(axis=1)
        assert (length <= over + 1e-5).all()


@given(field=fields(), a=inside, b=inside)
@settings(max_examples=150, deadline=None)
def test_a_way_is_as_long_as_between_says_and_stays_on_allowed_land(
    field: Field, a: Place, b: Place
) -> None:
    travel: OpenLand = OpenLand(field)
    way = travel.way(a, b)
    assert way[[0, -1]].tolist() == [list(a), list(b)]
    assert metres(way) == pytest.approx(travel.between(a, b)[0, 0], abs=1e-5)
    free = free_of(field)
    one_part = len(shapely.get_parts(free)) == 1
    if one_part and field.contains([a, b]).all():
        assert shapely.buffer(free, 3e-6, join_style="mitre").covers(shapely.LineString(way))


def test_the_simulated_robot_drives_around_a_keep_out_and_its_battery_and_clock_know() -> None:
    soil = draw_truth(SHED, np.random.default_rng(1))
    machine = Machine(SMALL_CONE, speed_mps=0.5)
    robot = SimulatedRobot(soil, machine, seed=1, position=(20.0, 25.0))
    arrival = robot.go_to(Assignment("a", 0, 0, (80.0, 25.0)))
    assert isinstance(arrival, Arrival)
    around = 2 * np.hypot(20, 5) + 20
    assert (arrival.metres, arrival.seconds) == pytest.approx((around, 2 * around))
    assert robot.battery_s == pytest.approx(machine.battery_s - 2 * around)
    north = robot.go_to(Assignment("b", 1, 0, (80.0, 55.0)))
    assert isinstance(north, Arrival)
    assert north.metres == 30.0


def test_the_route_in_the_survey_file_goes_around_a_keep_out(
    configured: Callable[[], Configured],
) -> None:
    state = apply(opened(opening(SHED, Layers((0.0, 0.4)), SMALL_CONE)), configured())
    stops = (SHED.nearest_cell((27.5, 27.5)), SHED.nearest_cell((82.5, 27.5)))
    planned = Planned(step=0, cells=stops, reason="", mean_kv=1.0)
    state = apply(state, planned)
    with closing(sqlite3.connect(":memory:")) as database:
        srs = initialise(database, "")
        create(database, srs, state)
        draw_targets(database, srs, state, NOTHING_DRAWN)
        legs = database.execute("SELECT geom, metres FROM route ORDER BY stop").fetchall()
    first, second = (shapely.get_coordinates(geometry_of(blob)) for blob, _ in legs)
    assert first.tolist() == [[0, 0], [27.5, 27.5]]
    assert second.tolist() == [[27.5, 27.5], [40, 20], [60, 20], [82.5, 27.5]]
    assert legs[1][1] == pytest.approx(metres(second))


def test_the_way_in_a_figure_goes_around_a_keep_out() -> None:
    layers, reached = Layers((0.0, 0.4)), np.zeros(1, dtype=np.int8)
    samples = [Sample(at, np.array([900.0]), reached) for at in ((20.0, 25.0), (80.0, 25.0))]
    model = Spherical(100.0, 40.0, 900.0)
    state = replace(
        opened(opening(SHED, layers, SMALL_CONE)),
        soil_map=SoilMap(SHED, layers, (model,), tuple(samples)),
    )
    assert drawn_way(state).tolist() == [[20, 25], [40, 20], [60, 20], [80, 25]]


def test_a_view_knows_the_ways_through_its_field(configured: Callable[[], Configured]) -> None:
    state = apply(opened(opening(SHED, Layers((0.0, 0.4)), SMALL_CONE)), configured())
    assert view(state).access is state.access
