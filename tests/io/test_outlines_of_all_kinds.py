"""Outlines as farm programs, phones and offices write them, and what is said of each."""

from __future__ import annotations

import json
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from shapely.geometry import (
    GeometryCollection,
    LineString,
    MultiPolygon,
    Point,
    Polygon,
    box,
    mapping,
)

from subsoil.errors import BoundaryError
from subsoil.findings import left_out
from subsoil.io.read.boundary import read_field
from subsoil.land.crs import project
from subsoil.land.field import Field

CORNERS = [(-0.5278, 53.2624), (-0.5274, 53.2609), (-0.5231, 53.2607), (-0.5225, 53.2631)]
OUTLINE = Polygon(CORNERS)
TRUTH = Field.from_lonlat(OUTLINE)
ROUND = [*CORNERS, CORNERS[0]]


def saved(path: Path, content: Any) -> Path:
    path.write_text(content if isinstance(content, str) else json.dumps(content), encoding="utf-8")
    return path


def drawn(*shapes: Any, crs: str = "") -> dict[str, Any]:
    """A FeatureCollection of shapes, named a, b, c."""
    features = [
        {"type": "Feature", "geometry": shape and mapping(shape), "properties": {"name": name}}
        for shape, name in zip(shapes, "abcdefgh", strict=False)
    ]
    member = {"crs": {"type": "name", "properties": {"name": crs}}} if crs else {}
    return {"type": "FeatureCollection", "features": features, **member}


def kml(body: str) -> str:
    space = 'xmlns="http://www.opengis.net/kml/2.2" xmlns:gx="http://www.google.com/kml/ext/2.2"'
    return f"<kml {space}><Document>{body}</Document></kml>"


def placemark(shape: str, name: str = "home") -> str:
    return f"<Placemark><name>{name}</name>{shape}</Placemark>"


def line(corners: list[tuple[float, float]], kind: str = "LineString") -> str:
    text = " ".join(f"{x},{y},12.5" for x, y in corners)
    return f"<{kind}><coordinates>{text}</coordinates></{kind}>"


def track(corners: list[tuple[float, float]]) -> str:
    return "".join(
        ("<gx:Track>", *(f"<gx:coord>{x} {y} 9</gx:coord>" for x, y in corners), "</gx:Track>")
    )


def gpx(corners: list[tuple[float, float]]) -> str:
    points = "".join(f'<trkpt lat="{y}" lon="{x}"><ele>9</ele></trkpt>' for x, y in corners)
    way = '<wpt lat="53" lon="0"><name>gate</name></wpt>'
    return f"<gpx xmlns='x'>{way}<trk><name>round</name><trkseg>{points}</trkseg></trk></gpx>"


CLOSED = {
    "ring.kml": kml(placemark(line(ROUND, "LinearRing"))),
    "line.kml": kml(f"<Folder><Folder>{placemark(line(ROUND))}</Folder></Folder>"),
    "track.kml": kml(placemark(track(ROUND))),
    "line.geojson": drawn(None, Point(1, 2), LineString(ROUND)),
    "track.gpx": gpx(ROUND),
}


@pytest.mark.parametrize("name", CLOSED)
def test_the_only_closed_line_is_the_outline_and_said_to_be_one(tmp_path: Path, name: str) -> None:
    field = read_field(saved(tmp_path / name, CLOSED[name]))
    assert field.area_ha == pytest.approx(TRUTH.area_ha, rel=1e-9)
    assert "is a closed line, no polygon; taken as an outline" in str(field.findings[0])
    assert left_out(field.findings) == ()


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("ring.kml", kml(placemark(line(CORNERS, "LinearRing")))),
        ("track.kml", kml(placemark(track(CORNERS)))),
        ("line.geojson", drawn(LineString(CORNERS))),
        ("track.gpx", gpx(CORNERS)),
    ],
)
def test_an_open_line_is_refused_with_the_gap_in_metres(
    tmp_path: Path, name: str, content: Any
) -> None:
    with pytest.raises(BoundaryError, match=r"is open, its ends are 361\.\d m apart.*polygon"):
        read_field(saved(tmp_path / name, content))


def test_a_walked_line_may_end_a_few_metres_from_its_start(tmp_path: Path) -> None:
    end = (CORNERS[0][0] + 1e-4, CORNERS[0][1])
    field = read_field(saved(tmp_path / "walk.geojson", drawn(LineString([*CORNERS, end]))))
    assert "its ends 6.7 m apart" in str(field.findings[0])


def test_the_loop_of_somebody_who_stood_still_is_cut_off(tmp_path: Path) -> None:
    x, y = CORNERS[2]
    loop = [(x, y), (x + 2e-5, y + 2e-5), (x + 2e-5, y), (x, y + 2e-5)]
    walk = [*CORNERS[:2], *loop, CORNERS[3], CORNERS[0]]
    field = read_field(saved(tmp_path / "walk.geojson", drawn(LineString(walk))))
    assert field.area_ha == pytest.approx(TRUTH.area_ha, rel=0.01)


def test_a_bow_tie_is_refused_with_the_place(tmp_path: Path) -> None:
    tie = Polygon([CORNERS[0], CORNERS[2], CORNERS[1], CORNERS[3]])
    with pytest.raises(BoundaryError, match=r"Self-intersection\[-0\.5257\d* 53\.261"):
        read_field(saved(tmp_path / "tie.geojson", drawn(tie)))


def test_winding_heights_and_measures_do_not_matter(tmp_path: Path) -> None:
    rings = [
        [[x, y, z, 5] for (x, y), z in zip(CORNERS[::-1], (1, None, float("nan"), 2), strict=True)]
    ]
    field = read_field(saved(tmp_path / "home.geojson", {"type": "Polygon", "coordinates": rings}))
    assert field.boundary.equals(TRUTH.boundary)


def test_the_polygon_in_a_collection_of_shapes_is_the_outline(tmp_path: Path) -> None:
    both = drawn(GeometryCollection([OUTLINE, Point(1, 2)]))
    field = read_field(saved(tmp_path / "home.geojson", both))
    assert field.name == "a"
    assert field.area_ha == pytest.approx(TRUTH.area_ha)
    assert "left alone: Point of feature 1 (a)" in str(field.findings[0])


def test_a_hole_is_kept_out_and_said(tmp_path: Path) -> None:
    pond = box(-0.5260, 53.2615, -0.5255, 53.2618)
    field = read_field(saved(tmp_path / "home.geojson", drawn(OUTLINE - pond)))
    assert "a hole of 0.11 ha; nothing is probed there" in str(field.findings[0])


def test_a_sliver_beside_the_outline_is_left_out_and_counted(tmp_path: Path) -> None:
    sliver = Polygon([(-0.53, 53.26), (-0.5299, 53.26), (-0.5298, 53.26)])
    field = read_field(saved(tmp_path / "home.geojson", drawn(MultiPolygon([OUTLINE, sliver]))))
    assert "1 of 2 pieces of feature 1 (a) are slivers" in str(left_out(field.findings)[0])


def strip(metres_apart: float, width: float = 100.0) -> Polygon:
    """A parcel east of one that ends at easting 665 100 in zone 30."""
    west = 665_100 + metres_apart
    return box(west, 5_904_000, west + width, 5_904_100)


@pytest.mark.parametrize("apart", [-0.5, 0.0, 0.3, 12.0, 29.0])
def test_parcels_that_adjoin_are_one_field_and_said(tmp_path: Path, apart: float) -> None:
    parcels = drawn(strip(-100), strip(apart), crs="EPSG:32630")
    field = read_field(saved(tmp_path / "home.geojson", parcels))
    assert field.area_ha == pytest.approx(2.0 + min(apart, 0) / 100)
    assert field.name == "a and b"
    assert "2 outlines that adjoin: a, b; joined into one field" in str(field.findings[0])


def test_parcels_far_apart_are_listed_and_one_is_chosen_by_name(tmp_path: Path) -> None:
    path = saved(
        tmp_path / "farm.geojson", drawn(strip(-100), strip(40), strip(900), crs="EPSG:32630")
    )
    with pytest.raises(BoundaryError, match=r"holds 3 outlines.* lie apart: a, b, c .*--name"):
        read_field(path)
    with pytest.raises(BoundaryError, match=r"no outline is called 'x' .*--name one of: a, b, c"):
        read_field(path, name="x")
    field = read_field(path, name="B")
    assert field.name == "b"
    assert field.area_ha == pytest.approx(1.0)
    assert "outlines not asked for: a, c" in str(field.findings[0])


def test_a_parcel_drawn_twice_counts_once(tmp_path: Path) -> None:
    field = read_field(saved(tmp_path / "home.geojson", drawn(OUTLINE, OUTLINE)))
    assert field.area_ha == pytest.approx(TRUTH.area_ha)
    assert "1 of its outlines repeat another" in str(field.findings[0])


def test_a_parcel_over_or_in_another_is_a_question_and_refused(tmp_path: Path) -> None:
    path = saved(tmp_path / "home.geojson", drawn(strip(-100), strip(-80, 20), crs="EPSG:32630"))
    with pytest.raises(BoundaryError, match=r'b lies inside a .*"role": "keep-out".*--name'):
        read_field(path)
    over = drawn(strip(-100), strip(-50), crs="EPSG:32630")
    with pytest.raises(BoundaryError, match=r". shares 0\.50 ha with"):
        read_field(saved(path, over))


# Archives


def packed(path: Path, **members: bytes | str) -> Path:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    return path


def shapefile(folder: Path, stem: str, *shapes: Any, name: str = "Long Acre") -> dict[str, bytes]:
    raw = pytest.importorskip("pyogrio").raw
    raw.write(
        folder / f"{stem}.shp", np.array([shapely.to_wkb(s) for s in shapes], dtype=object),
        [np.array([name] * len(shapes), dtype=object)], ["NAME"],
        geometry_type=shapes[0].geom_type, crs="EPSG:4326",
    )  # fmt: skip
    return {f"export/{each.name}": each.read_bytes() for each in folder.glob(f"{stem}.*")}


def test_a_kmz_is_its_kml(tmp_path: Path) -> None:
    inner = kml(
        placemark(
            f"<Polygon><outerBoundaryIs>{line(ROUND, 'LinearRing')}</outerBoundaryIs></Polygon>"
        )
    )
    field = read_field(packed(tmp_path / "home.kmz", **{"doc.kml": inner, "files/icon.png": "x"}))
    assert field.name == "home"
    assert field.area_ha == pytest.approx(TRUTH.area_ha)


def test_a_zipped_shapefile_is_read_with_its_name_and_points_beside_it_noted(
    tmp_path: Path,
) -> None:
    members = {**shapefile(tmp_path, "land", OUTLINE), **shapefile(tmp_path, "pins", Point(1, 2))}
    field = read_field(packed(tmp_path / "export.zip", **members))
    assert field.name == "Long Acre"
    assert field.area_ha == pytest.approx(TRUTH.area_ha)
    assert "left alone: file pins.shp" in str(field.findings[-1])


def test_of_two_shapefiles_in_a_zip_one_is_chosen_by_its_own_or_its_fields_name(
    tmp_path: Path,
) -> None:
    other = shapely.affinity.translate(OUTLINE, 0.1)
    members = shapefile(tmp_path, "alpha", OUTLINE) | shapefile(tmp_path, "beta", other, name="Lea")
    path = packed(tmp_path / "farm.zip", **members)
    with pytest.raises(
        BoundaryError, match=r"farm\.zip: .*2 files of outlines: alpha, beta .*--name"
    ):
        read_field(path)
    assert read_field(path, name="Beta").name == "Beta"
    assert (
        read_field(path, name="lea").boundary.bounds
        == read_field(path, name="beta").boundary.bounds
    )


@pytest.mark.parametrize(
    ("members", "message"),
    [
        ({"a.geojson": b"0" * 250_000_000}, r"bomb\.zip: it unpacks to more than 200 MB"),
        ({"../evil.geojson": "{}"}, "holds no file of outlines"),
        ({"inner.zip": b"PK", "a.vrt": "<OGRVRTDataSource/>"}, "holds no file of outlines"),
        ({"a.geojson": "{}"}, r"bomb\.zip, a\.geojson: a feature without geometry"),
    ],
)
def test_archives_that_are_no_outline_are_refused(
    tmp_path: Path, members: dict[str, Any], message: str
) -> None:
    with pytest.raises(BoundaryError, match=message):
        read_field(packed(tmp_path / "bomb.zip", **members))
    assert not (tmp_path.parent / "evil.geojson").exists()


def test_a_damaged_archive_is_one_line(tmp_path: Path) -> None:
    path = packed(tmp_path / "home.zip", **{"a.geojson": "{}" * 1000})
    data = path.read_bytes()
    for broken in (data[:40], b"PK\x03\x04" + bytes(60), data[:30] + b"xxxx" + data[34:]):
        path.write_bytes(broken)
        with pytest.raises(BoundaryError, match=r"^home\.zip[^\n]*$"):
            read_field(path)


# Frames


@pytest.mark.parametrize(
    ("crs", "west", "south", "words"),
    [
        ("EPSG:4258", 5.6, 52.1, "ETRS89, under a metre off WGS84"),
        ("EPSG:4937", 5.6, 52.1, "ETRS89, under a metre off WGS84"),
        ("EPSG:4674", -50.0, -15.0, "SIRGAS 2000, under a metre off WGS84"),
        ("EPSG:4269", -93.0, 42.0, "NAD83, tied to WGS84 to about 4 m"),
        ("EPSG:4283", 147.0, -35.0, "GDA94, tied to WGS84 to about 3 m"),
        ("EPSG:7844", 147.0, -35.0, "GDA2020, tied to WGS84 to about 3 m"),
        ("EPSG:4277", -1.0, 52.0, "OSGB36, tied to WGS84 to about 2 m"),
        ("EPSG:4979", 5.6, 52.1, ""),
    ],
)
def test_degrees_of_another_datum_are_taken_with_their_offset_noted(
    tmp_path: Path, crs: str, west: float, south: float, words: str
) -> None:
    shape = box(west, south, west + 0.002, south + 0.002)
    field = read_field(saved(tmp_path / "home.geojson", drawn(shape, crs=crs)))
    assert field.area_ha == pytest.approx(Field.from_lonlat(shape).area_ha, rel=1e-3)
    assert words in " ".join(map(str, field.findings))
    assert bool(field.findings) == bool(words)


@pytest.mark.parametrize(
    ("crs", "west", "south", "home", "words"),
    [
        ("EPSG:2263", -73.9, 40.7, "EPSG:32618", "US survey foot, so it is kept in EPSG:32618"),
        ("EPSG:2154", 2.0, 50.9, "EPSG:32631", "0.21 % off here"),
        ("EPSG:3067", 20.0, 60.0, "EPSG:32634", "0.15 % off here"),
        ("EPSG:2193", 167.0, -46.0, "EPSG:32758", "0.22 % off here"),
        ("EPSG:32630", 8.0, 53.0, "EPSG:32632", "0.62 % off here"),
        ("EPSG:27700", -1.0, 52.0, "EPSG:27700", "to within about 2 m"),
        ("EPSG:26715", -93.0, 42.0, "EPSG:26715", "nothing exact leads"),
        ("EPSG:32631", 0.001, 0.001, "EPSG:32631", ""),
    ],
)
def test_frames_on_a_plane_stay_or_move_and_are_never_refused(
    tmp_path: Path, crs: str, west: float, south: float, home: str, words: str
) -> None:
    from pyproj import Transformer

    there = Transformer.from_crs("EPSG:4326", crs, always_xy=True)
    shape = box(west, south, west + 0.002, south + 0.002)
    moved = shapely.transform(shape, lambda xy: np.column_stack(there.transform(*xy.T)))
    field = read_field(saved(tmp_path / "home.geojson", drawn(moved, crs=crs)))
    assert field.crs == home
    assert field.area_ha == pytest.approx(Field.from_lonlat(shape).area_ha, rel=0.003)
    assert words in " ".join(map(str, field.findings))


def test_an_outline_over_the_antimeridian_is_one_field(tmp_path: Path) -> None:
    east, west = box(179.999, -16.802, 180, -16.8), box(-180, -16.802, -179.999, -16.8)
    ring = Polygon([(179.999, -16.8), (-179.999, -16.8), (-179.999, -16.802), (179.999, -16.802)])
    for shape in (MultiPolygon([east, west]), ring):
        field = read_field(saved(tmp_path / "home.geojson", drawn(shape)))
        assert field.area_ha == pytest.approx(4.727, abs=0.001)
        assert field.crs == "EPSG:32760"


def test_eastings_in_the_place_of_northings_and_kilometres_are_named(tmp_path: Path) -> None:
    corners = project("EPSG:4326", "EPSG:32630", *np.transpose(CORNERS))
    swapped = drawn(Polygon(corners[:, ::-1]), crs="EPSG:32630")
    with pytest.raises(BoundaryError, match="far from where EPSG:32630 is used: they look swapped"):
        read_field(saved(tmp_path / "home.geojson", swapped))
    rows = "".join(f"{x / 1000},{y / 1000}\n" for x, y in corners.tolist())
    with pytest.raises(BoundaryError, match="these look like kilometres, not metres"):
        read_field(saved(tmp_path / "home.csv", "easting,northing\n" + rows), crs="EPSG:32630")


def test_coordinates_beyond_all_frames_are_refused(tmp_path: Path) -> None:
    for crs in ("", "EPSG:32631", "EPSG:3857"):
        shape = Polygon([(1e300, 1e300), (1e308, 0), (0, 1e308)])
        with pytest.raises(BoundaryError, match="vertex 1: a vertex is no place on Earth"):
            read_field(saved(tmp_path / "home.geojson", drawn(shape, crs=crs)))


def test_a_scribble_of_many_corners_is_refused_at_once(tmp_path: Path) -> None:
    corners = np.random.default_rng(1).uniform((-0.52, 53.26), (-0.519, 53.261), (100_000, 2))
    line = [*corners.tolist(), corners[0].tolist()]
    for shape in ({"type": "Polygon", "coordinates": [corners.tolist()]},
                  {"type": "LineString", "coordinates": line}):  # fmt: skip
        with pytest.raises(BoundaryError, match="Self-intersection"):
            read_field(saved(tmp_path / "home.geojson", shape))
