"""Fields: outlines that are none, metric frames, keep-outs and the grid of cells."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from pyproj import Geod, Proj
from shapely.geometry import LineString, MultiPolygon, Polygon, box

from subsoil.errors import BoundaryError, ParameterError
from subsoil.land.crs import accuracy, check_metric, project, utm_crs
from subsoil.land.field import Field
from subsoil.land.swaps import looks_swapped

SQUARE = [(0, 0), (100, 0), (100, 100), (0, 100)]
LINCOLN = Polygon(
    [(-0.527775, 53.26245), (-0.527405, 53.260923), (-0.523088, 53.26075), (-0.522493, 53.26306)]
)

metres = st.floats(-5000.0, 5000.0)
sides = st.floats(20.0, 300.0)


def square(west: float, south: float, side: float) -> list[tuple[float, float]]:
    east, north = west + side, south + side
    return [(west, south), (east, south), (east, north), (west, north)]


# Grid and cells


def test_the_papers_rectangle_has_its_936_cells_of_5_m() -> None:
    field = Field.from_metres([(0, 0), (180, 0), (180, 130), (0, 130)])
    assert len(field.cells) == 936
    assert field.area_ha == pytest.approx(2.34)


def test_cells_run_row_by_row_from_the_south_west() -> None:
    field = Field.from_metres([(0, 0), (20, 0), (20, 10), (0, 10)], cell_size=10.0)
    assert field.cells.tolist() == [[5.0, 5.0], [15.0, 5.0]]
    assert field.grid.inside.shape == (1, 2)


@given(metres, metres, sides, st.sampled_from([1.0, 2.5, 5.0, 7.0]))
@settings(max_examples=40, deadline=None)
def test_edges_of_cells_lie_at_multiples_of_their_side_wherever_the_field_is(
    west: float, south: float, side: float, cell: float
) -> None:
    field = Field.from_metres(square(west, south, max(side, 3 * cell)), cell_size=cell)
    edges = field.cells / cell - 0.5
    np.testing.assert_allclose(edges, np.round(edges), atol=1e-6)


@given(metres, metres, sides)
@settings(max_examples=40, deadline=None)
def test_cells_are_exactly_the_centres_in_the_field_and_cover_its_area(
    west: float, south: float, side: float
) -> None:
    field = Field.from_metres(square(west, south, side))
    assert field.contains(field.cells).all()
    lost = abs(len(field.cells) * 25.0 - side**2)
    assert lost <= 4 * side * 2.5 + 4 * 25.0, "only cells on the edge can differ"


def test_two_fields_that_overlap_share_the_cells_of_their_overlap() -> None:
    one = Field.from_metres(square(3.3, -7.1, 60.0))
    other = Field.from_metres(square(21.7, 4.9, 60.0))
    both = shapely.intersection(one.boundary, other.boundary)
    shared = {tuple(c) for c in one.cells} & {tuple(c) for c in other.cells}
    expected = [c for c in one.cells if shapely.contains_xy(both, *c)]
    assert len(shared) == len(expected) > 0


def test_a_hole_in_the_field_has_no_cells() -> None:
    pond = box(40, 40, 60, 60)
    field = Field(Polygon(SQUARE, [pond.exterior.coords]))
    assert len(field.cells) == 400 - 16
    assert not field.contains((50, 50)).any()


def test_a_field_of_two_parts_is_one_field() -> None:
    field = Field(MultiPolygon([box(0, 0, 20, 20), box(50, 0, 70, 20)]))
    assert len(field.cells) == 32
    assert field.contains([(10, 10), (35, 10), (60, 10)]).tolist() == [True, False, True]


def test_an_image_puts_values_on_their_cells_and_nan_outside() -> None:
    field = Field.from_metres([(0, 0), (30, 0), (0, 30)], cell_size=10.0)
    values = np.arange(2 * len(field.cells), dtype=float).reshape(2, -1)
    picture = field.grid.image(values)
    assert picture.shape == (2, 3, 3)
    np.testing.assert_array_equal(picture[:, field.grid.inside], values)
    assert np.isnan(picture[:, ~field.grid.inside]).all()
    east = np.broadcast_to(field.grid.easting, (3, 3))[field.grid.inside]
    np.testing.assert_array_equal(east, field.cells[:, 0])


@given(metres, metres)
def test_the_nearest_cell_is_the_nearest_of_all(easting: float, northing: float) -> None:
    field = Field.from_metres(SQUARE)
    found = field.nearest_cell((easting, northing))
    away = [math.dist(cell, (easting, northing)) for cell in field.cells]
    assert away[found] == pytest.approx(min(away))


def test_every_cell_is_nearest_to_itself() -> None:
    field = Field.from_metres(SQUARE, cell_size=20.0)
    assert [field.nearest_cell(cell) for cell in field.cells] == list(range(25))


@pytest.mark.parametrize("at", [(math.nan, 5.0), (5.0, math.inf)])
def test_no_cell_is_nearest_to_no_place(at: tuple[float, float]) -> None:
    with pytest.raises(ParameterError, match=r"home, nearest cell: .* no place"):
        Field.from_metres(SQUARE, name="home").nearest_cell(at)


def test_the_edge_of_a_field_belongs_to_it() -> None:
    assert Field.from_metres(SQUARE).contains([(0, 50), (100, 100), (-0.01, 50)]).tolist() == [
        True,
        True,
        False,
    ]


def test_arrays_of_a_field_cannot_be_changed() -> None:
    field = Field.from_metres(SQUARE)
    for array in (field.cells, field.grid.easting, field.grid.northing, field.grid.inside):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0


# Keep-outs


def test_keep_outs_take_cells_and_area_away() -> None:
    field = Field.from_metres(SQUARE, keep_outs=[square(40, 40, 20), square(90, 90, 50)])
    assert len(field.cells) == 400 - 16 - 4
    assert field.area_ha == pytest.approx((10_000 - 400 - 100) / 10_000)
    assert field.contains([(50, 50), (95, 95), (10, 10)]).tolist() == [False, False, True]


def test_overlapping_keep_outs_count_once() -> None:
    field = Field.from_metres(SQUARE, keep_outs=[square(40, 40, 20), square(50, 40, 20)])
    assert field.area_ha == pytest.approx((10_000 - 600) / 10_000)


def test_a_keep_out_may_cut_the_field_in_two() -> None:
    strip = [(-5, 45), (105, 45), (105, 55), (-5, 55)]
    assert len(Field.from_metres(SQUARE, keep_outs=[strip]).cells) == 360


def test_keep_outs_over_the_whole_field_leave_nothing_to_survey() -> None:
    with pytest.raises(BoundaryError, match="home: keep-outs cover the whole field"):
        Field.from_metres(SQUARE, keep_outs=[square(-1, -1, 102)], name="home")


def test_a_wrong_keep_out_is_named_by_its_number() -> None:
    bow_tie = [(0, 0), (10, 10), (10, 0), (0, 10)]
    with pytest.raises(BoundaryError, match=r"home, keep-out 2: .*Self-intersection"):
        Field.from_metres(SQUARE, keep_outs=[square(1, 1, 5), bow_tie], name="home")


# Outlines that are none


@pytest.mark.parametrize(
    ("vertices", "message"),
    [
        ([], r"not an array \(0,\)"),
        ([(0, 0), (1, 1)], "three different corners, this has 2"),
        ([(0, 0), (1, 1), (0, 0)], "three different corners, this has 2"),
        ([(0, 0, 0), (1, 0, 0), (1, 1, 0)], r"not an array \(3, 3\)"),
        ([(0, 0), (1,), (1, 1)], "not a pair of numbers"),
        ([(0, 0), ("a", 1), (1, 1)], "not a pair of numbers"),
        ([(0, 0), (10, math.nan), (10, 10)], "vertex 2: a vertex is not a number"),
        ([(0, 0), (100, 100), (100, 0), (0, 100)], r"Self-intersection.*without crossing itself"),
        ([(0, 0), (50, 50), (100, 100)], "not valid"),
        ([(-0.5, 53.0), (-0.49, 53.0), (-0.49, 53.01)], "degrees, not metres.*GeoJSON"),
        ([(0, 0), (9e6, 0), (9e6, 9e6)], "9e.03 km wide.*check the coordinates"),
        ([(0, 0), (2, 0), (2, 2)], "no cell of 5 m.*smaller cells"),
    ],
)
def test_vertices_that_make_no_field_are_refused_by_name(
    vertices: list[tuple[float, ...]], message: str
) -> None:
    with pytest.raises(BoundaryError, match=f"^home.*{message}"):
        Field.from_metres(vertices, name="home")


@pytest.mark.parametrize("size", [0.0, -5.0, math.nan, math.inf])
def test_cells_need_a_side(size: float) -> None:
    with pytest.raises(ParameterError, match="cell size"):
        Field.from_metres(SQUARE, cell_size=size)


def test_cells_too_many_for_a_map_are_refused_before_they_are_made() -> None:
    with pytest.raises(BoundaryError, match=r"0\.1 km wide.*0\.001 m cells.*larger cells"):
        Field.from_metres(SQUARE, cell_size=0.001)


@pytest.mark.parametrize("shape", [Polygon(), LineString([(0, 50), (1, 51)])])
def test_a_shape_without_area_is_no_outline(shape: Polygon) -> None:
    with pytest.raises(BoundaryError, match=r"home: .*not a polygon.*one closed outline"):
        Field.from_lonlat(shape, name="home")


# Frames


def test_a_field_in_degrees_gets_the_utm_zone_of_its_centre_and_true_areas() -> None:
    field = Field.from_lonlat(LINCOLN)
    assert field.crs == "EPSG:32630"
    area, _ = Geod(ellps="WGS84").geometry_area_perimeter(LINCOLN)
    assert field.area_ha == pytest.approx(abs(area) / 10_000, rel=1e-3)


def test_metres_agree_with_the_utm_projection_itself() -> None:
    lonlat = np.array(LINCOLN.exterior.coords)
    peer = np.column_stack(Proj(proj="utm", zone=30, ellps="WGS84")(*lonlat.T))
    np.testing.assert_allclose(Field.from_lonlat(LINCOLN).to_metres(*lonlat.T), peer, atol=1e-6)


@given(st.floats(-0.53, -0.52), st.floats(53.26, 53.27))
@settings(deadline=None)
def test_degrees_to_metres_and_back_is_where_one_started(lon: float, lat: float) -> None:
    field = Field.from_lonlat(LINCOLN)
    back = field.to_lonlat(field.to_metres([lon], [lat]))
    np.testing.assert_allclose(back, [[lon, lat]], atol=1e-9)


def test_a_keep_out_in_degrees_lies_where_it_is() -> None:
    lon, lat = LINCOLN.centroid.coords[0]
    pond = Polygon(shapely.get_coordinates(shapely.Point(lon, lat).buffer(2e-4)))
    field = Field.from_lonlat(LINCOLN, keep_outs=[pond])
    assert not field.contains(field.to_metres([lon], [lat])).any()
    assert len(field.cells) < len(Field.from_lonlat(LINCOLN).cells)


@pytest.mark.parametrize(
    ("lon", "lat", "crs"),
    [
        (-180.0, 10.0, "EPSG:32601"),
        (180.0, -10.0, "EPSG:32760"),
        (0.0, 0.0, "EPSG:32631"),
        (-0.0001, 51.5, "EPSG:32630"),
        (151.2, -33.9, "EPSG:32756"),
    ],
)
def test_utm_zones_are_six_degrees_wide_from_180_west(lon: float, lat: float, crs: str) -> None:
    assert utm_crs(lon, lat) == crs


def swapped(outline: Polygon) -> Polygon:
    return Polygon([(lat, lon) for lon, lat in outline.exterior.coords])


@pytest.mark.parametrize(
    ("lon", "lat"), [(-0.53, 53.26), (-7.0, 53.3), (-93.6, 42.0), (151.0, -33.0)]
)
def test_swapped_latitude_and_longitude_are_noticed(lon: float, lat: float) -> None:
    outline = box(lon, lat, lon + 0.002, lat + 0.002)
    assert Field.from_lonlat(outline).area_ha > 1
    with pytest.raises(BoundaryError, match=r"home: .*swapped.*GeoJSON wants longitude first"):
        Field.from_lonlat(swapped(outline), name="home")


@pytest.mark.parametrize(
    "place",
    {
        "Nairobi": (36.8, -1.3),
        "Kampala": (32.6, 0.3),
        "Lusaka": (28.3, -15.4),
        "Bamako": (-8.0, 12.6),
        "Khartoum": (32.5, 15.6),
        "Addis Ababa": (38.7, 9.0),
        "Haiti": (-72.3, 18.6),
        "Reykjavik": (-21.0, 64.0),
        "Canaries": (-16.0, 28.0),
        "Rennes": (-1.7, 48.1),
        "Delhi": (77.0, 28.6),
    }.items(),
    ids=lambda place: place[0],
)
def test_no_field_on_land_is_taken_for_swapped(place: tuple[str, tuple[float, float]]) -> None:
    assert not looks_swapped(*place[1])


def test_metres_given_as_degrees_are_noticed() -> None:
    with pytest.raises(BoundaryError, match="look like metres: name their CRS"):
        Field.from_lonlat(box(664889, 5904149, 665042, 5904320))


def test_a_local_field_has_no_place_on_earth() -> None:
    field = Field.from_metres(SQUARE, name="home")
    with pytest.raises(ParameterError, match=r"home: .*local frame.*name its CRS"):
        field.to_lonlat(field.cells)
    with pytest.raises(ParameterError, match="local frame"):
        field.to_metres([0.0], [50.0])


@pytest.mark.parametrize(
    ("crs", "message"),
    [
        ("EPSG:99999", "there is no CRS 'EPSG:99999'.*EPSG:32630"),
        ("somewhere", "there is no CRS 'somewhere'"),
        ("EPSG:4326", ".*measures in degree.*UTM zone"),
        ("EPSG:2263", ".*measures in US survey foot"),
        ("EPSG:4978", ".*not on a plane in metres"),
    ],
)
def test_a_crs_that_is_unknown_or_not_in_metres_is_refused(crs: str, message: str) -> None:
    with pytest.raises(BoundaryError, match=f"^home: {message}"):
        Field.from_metres(SQUARE, crs=crs, name="home")


def test_a_crs_in_metres_is_accepted() -> None:
    for crs in ("EPSG:32630", "EPSG:27700", "EPSG:2154", "EPSG:25832"):
        check_metric(crs, "home")


def test_a_transformation_that_would_be_a_cell_off_is_refused() -> None:
    for old, place in (("EPSG:4301", (139.0, 36.0)), ("EPSG:26715", (500_000.0, 4_650_000.0))):
        with pytest.raises(BoundaryError, match=rf"exact transformation from {old} .*WGS84"):
            project(old, "EPSG:4326", *place)


def test_the_british_grid_is_reached_to_the_metres_that_its_registry_says() -> None:
    (found,) = project("EPSG:4326", "EPSG:27700", [1.716073973], [52.658007833])
    assert np.hypot(*(found - (651_409.804, 313_177.45))) < 4  # Caister, by OSTN15
    assert accuracy("EPSG:4326", "EPSG:27700", 1.7, 52.7) == 2


def test_nothing_leads_from_a_local_frame_to_another() -> None:
    with pytest.raises(BoundaryError, match=r"nothing leads from a local frame to EPSG:32630"):
        project("", "EPSG:32630", [0.0], [0.0])
