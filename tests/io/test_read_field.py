"""Field outlines from files: every format, and every way in which one can be wrong."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from pyproj import Proj
from shapely.geometry import GeometryCollection, LineString, Point, Polygon, box, mapping

from subsoil.errors import BoundaryError, MissingExtraError, ParameterError
from subsoil.findings import others
from subsoil.io.read.boundary import READERS, read_field
from subsoil.land.crs import project, stretch
from subsoil.land.field import Field

CORNERS = [(-0.5278, 53.2624), (-0.5274, 53.2609), (-0.5231, 53.2607), (-0.5225, 53.2631)]
OUTLINE = Polygon(CORNERS)
POND = box(-0.5260, 53.2615, -0.5255, 53.2618)
COORDS = "".join(f"{lat}, {lon}\n" for lon, lat in CORNERS)
METRES = np.array([(665000.0, 5904000.0), (665100, 5904000), (665100, 5904050), (665000, 5904050)])

Save = Callable[[str, Any], Path]


@pytest.fixture
def save(tmp_path: Path) -> Save:
    def write(name: str, content: Any) -> Path:
        path = tmp_path / name
        if isinstance(content, bytes):
            path.write_bytes(content)
        else:
            text = content if isinstance(content, str) else json.dumps(content)
            path.write_text(text, encoding="utf-8")
        return path

    return write


def feature(shape: shapely.geometry.base.BaseGeometry, **properties: str) -> dict[str, Any]:
    return {"type": "Feature", "geometry": mapping(shape), "properties": properties}


def collection(*features: dict[str, Any]) -> dict[str, Any]:
    return {"type": "FeatureCollection", "features": list(features)}


def same_place(field: Field, other: Field) -> bool:
    return field.crs == other.crs and field.boundary.equals_exact(other.boundary, 1e-3)


TRUTH = Field.from_lonlat(OUTLINE)


# GeoJSON


@pytest.mark.parametrize(
    "document",
    [
        mapping(OUTLINE),
        mapping(shapely.MultiPolygon([OUTLINE])),
        feature(OUTLINE),
        collection(feature(OUTLINE)),
    ],
    ids=["Polygon", "MultiPolygon", "Feature", "FeatureCollection"],
)
def test_geojson_is_wgs84_longitude_first_in_any_wrapping(save: Save, document: Any) -> None:
    path = save("home.geojson", document)
    field = read_field(path, cell_size=10.0)
    assert field.crs == "EPSG:32630"
    assert field.boundary.symmetric_difference(TRUTH.boundary).area < 1e-3
    assert (field.name, field.cell_size) == ("home.geojson", 10.0)


def test_polygons_with_the_role_keep_out_are_kept_out(save: Save) -> None:
    path = save("home.json", collection(feature(POND, role="keep-out"), feature(OUTLINE)))
    field = read_field(path)
    assert len(field.keep_outs) == 1
    lon, lat = POND.centroid.coords[0]
    assert not field.contains(field.to_metres([lon], [lat])).any()


def test_heights_and_unclosed_rings_do_not_matter(save: Save) -> None:
    rings = [[[lon, lat, 12.5] for lon, lat in CORNERS]]
    path = save("home.geojson", {"type": "Polygon", "coordinates": rings})
    assert same_place(read_field(path), TRUTH)


def test_a_hole_in_a_polygon_stays_one(save: Save) -> None:
    path = save("home.geojson", mapping(Polygon(CORNERS, [POND.exterior.coords])))
    assert read_field(path).area_ha < TRUTH.area_ha


@pytest.mark.parametrize("name", ["urn:ogc:def:crs:EPSG::32630", "EPSG:32630"])
def test_an_old_crs_member_in_metres_is_honoured(save: Save, name: str) -> None:
    document = mapping(Polygon(METRES)) | {"crs": {"type": "name", "properties": {"name": name}}}
    field = read_field(save("home.geojson", document))
    assert (field.crs, round(field.area_ha, 3)) == ("EPSG:32630", 0.5)


@pytest.mark.parametrize("name", ["urn:ogc:def:crs:OGC:1.3:CRS84", "EPSG:4326"])
def test_a_crs_member_that_says_wgs84_changes_nothing(save: Save, name: str) -> None:
    document = mapping(OUTLINE) | {"crs": {"type": "name", "properties": {"name": name}}}
    assert same_place(read_field(save("home.geojson", document)), TRUTH)


def test_the_callers_crs_is_for_files_that_name_none(save: Save) -> None:
    path = save("home.geojson", mapping(Polygon(METRES)))
    assert read_field(path, crs="EPSG:32630").crs == "EPSG:32630"


@pytest.mark.parametrize(
    ("document", "message"),
    [
        ("{\n  'type': 1}", r"home.geojson, line 2, column 3: this is not JSON.*export it again"),
        ('{"type": "Polygon",\n', r"line 2, column 1: this is not JSON"),
        ("[1, 2]", "home.geojson: this is JSON, but not GeoJSON"),
        ("[" * 100_000, "home.geojson: its lists are nested too deeply"),
        ({"type": "Topology"}, "home.geojson: this is TopoJSON, not GeoJSON.*as GeoJSON"),
        ({"rings": [], "geometryType": "x"}, "home.geojson: this is Esri JSON, not GeoJSON"),
        ({"type": "Feature", "geometry": None}, "a feature without geometry is not an outline"),
        (mapping(Point(1, 2)), "home.geojson: a Point is not an outline.*as a polygon"),
        (
            collection(feature(LineString(CORNERS), name="gate"), feature(Point(1, 2))),
            r"home.geojson, feature 1 \(gate\): a LineString is not an outline: it is open",
        ),
        (
            collection(feature(OUTLINE), feature(LineString(CORNERS), role="keep-out")),
            "home.geojson, feature 2: a LineString is not an outline",
        ),
        (
            collection(feature(OUTLINE), feature(GeometryCollection([POND]))),
            r"holds 2 outlines.*feature 2 lies inside feature 1.*\"role\": \"keep-out\"",
        ),
        (collection(feature(OUTLINE), {"type": "x"}), "feature 2: this is not a Feature"),
        (collection(), "home.geojson: it holds 0 outlines, not one"),
        (collection(feature(OUTLINE), feature(POND)), 'holds 2 outlines.*"role": "keep-out"'),
        ({"type": "Polygon", "coordinates": []}, "home.geojson: it has no coordinates"),
        ({"type": "MultiPolygon", "coordinates": [[]]}, "home.geojson: a polygon has no ring"),
        ({"type": "Polygon", "coordinates": [[1, 2, 3]]}, "home.geojson: a ring is not a list"),
        (
            {"type": "Polygon", "coordinates": [[["a", 2], [3, 4], [5, 6]]]},
            "home.geojson: a vertex is not a pair of numbers",
        ),
        (
            {"type": "Polygon", "coordinates": [[[1, 2], [3, float("nan")], [5, 6]]]},
            "home.geojson, vertex 2: a vertex is not a number",
        ),
        ('{"type":"Polygon","coordinates":[[[1,2],[3,1e999],[5,6]]]}', "home.geojson, vertex 2"),
        (
            collection(feature(Polygon([(0, 50), (1, 51), (1, 50), (0, 51)]), name="bow tie")),
            r"home.geojson, feature 1 \(bow tie\): .*Self-intersection.*without crossing itself",
        ),
        (mapping(Polygon([(y, x) for x, y in CORNERS])), "home.geojson: .*look swapped"),
        (mapping(Polygon(METRES)), "home.geojson: .*look like metres: name their CRS"),
        (
            mapping(OUTLINE) | {"crs": {"properties": {"name": "EPSG:32630"}}},
            "home.geojson: .*look like degrees, not metres",
        ),
        (mapping(OUTLINE) | {"crs": {"type": "link"}}, "home.geojson: its crs member names no"),
        (
            mapping(OUTLINE) | {"crs": {"properties": {"name": "EPSG:4301"}}},
            "home.geojson: the exact transformation from EPSG:4301 .*in WGS84",
        ),
        (
            mapping(OUTLINE) | {"crs": {"properties": {"name": "EPSG:1"}}},
            "home.geojson: there is no CRS 'EPSG:1'",
        ),
    ],
)
def test_geojson_that_is_no_field_is_refused_by_file_and_feature(
    save: Save, document: Any, message: str
) -> None:
    with pytest.raises(BoundaryError, match=message):
        read_field(save("home.geojson", document))


@given(
    st.recursive(
        st.none() | st.booleans() | st.floats() | st.text(),
        lambda x: (
            st.lists(x)
            | st.dictionaries(
                st.sampled_from(
                    ["type", "coordinates", "features", "geometry", "properties", "crs"]
                ),
                x | st.sampled_from(["Polygon", "Feature", "FeatureCollection", "MultiPolygon"]),
            )
        ),
    )
)
@settings(deadline=None)
def test_no_json_whatever_makes_anything_but_a_boundary_error(
    tmp_path_factory: pytest.TempPathFactory, document: Any
) -> None:
    path = tmp_path_factory.mktemp("any") / "any.geojson"
    path.write_text(json.dumps(document), encoding="utf-8")
    with pytest.raises(BoundaryError, match=r"any\.geojson"):
        read_field(path)


# Lists of corners


def test_a_coords_file_is_latitude_first(save: Save) -> None:
    assert same_place(read_field(save("home.coords", COORDS)), TRUTH)


@pytest.mark.parametrize(
    "text",
    [
        "# the outline\n\n" + COORDS.replace("\n", "  # corner\n"),
        "\ufeff" + COORDS,
        COORDS.replace("\n", "\r\n"),
        COORDS.replace(",", ";"),
        COORDS.replace(",", " "),
        COORDS.replace(", ", "\t"),
        COORDS + COORDS.splitlines()[0],
    ],
    ids=["comments", "byte order mark", "CRLF", "semicolons", "blanks", "tabs", "closed"],
)
def test_coords_files_may_be_written_in_many_ways(save: Save, text: str) -> None:
    assert read_field(save("home.coords", text)).boundary.equals(TRUTH.boundary)


def test_a_file_in_utf_16_is_read(save: Save) -> None:
    assert same_place(read_field(save("home.coords", COORDS.encode("utf-16"))), TRUTH)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "home.coords: the file is empty"),
        ("\n \n", "home.coords: the file is empty"),
        ("# nothing\n", "home.coords: there are only comments"),
        ("1, 2\n3, 4\n", "home.coords: an outline needs three different corners, this has 2"),
        (
            COORDS + "53,2624; -0,5277\n",
            r"home.coords, row 5: .*decimal commas \(remedy: write 53.2624, -0.5277\)",
        ),
        ("#\n53,2624, -0,5277\n", r"row 2: .*decimal commas .*53.2624, -0.5277"),
        (COORDS + "nan, 5\n", "home.coords, row 5: 'nan' is not a finite number"),
        (COORDS + "53.2, inf\n", "home.coords, row 5: 'inf' is not a finite number"),
        ("lat, lon\n" + COORDS, "home.coords, row 1: 'lat' is not a number"),
        (COORDS + "53.2\n", "home.coords, row 5: '53.2' is not two numbers"),
        (COORDS + "53.2, -0.5, 12\n", "home.coords, row 5: .* is not two numbers"),
        ("53°15', -0°31'\n", "home.coords, row 1: .*is not a number.*52.1, -0.5"),
        ("1_0, 5\n", "home.coords, row 1: '1_0' is not a number"),
        ("-33.5, 151.1\n151.1, -33.5\n", "row 2: latitude 151.1.*want latitude first"),
        ("5904000, 665000\n", "row 1: .*no place on Earth.*header easting,northing"),
        (
            "".join(f"{lon}, {lat}\n" for lon, lat in CORNERS),
            "home.coords: .*look swapped.*.coords files want latitude first",
        ),
        ("53.1,0\n53.2,0.1\n53.2,0\n53.1,0.1\n", "home.coords: .*Self-intersection"),
    ],
)
def test_a_coords_file_that_is_no_field_is_refused_by_file_and_row(
    save: Save, text: str, message: str
) -> None:
    with pytest.raises(BoundaryError, match=message):
        read_field(save("home.coords", text))


@pytest.mark.parametrize(
    ("text", "crs", "frame"),
    [
        ("easting,northing\n665000,5904000\n665100,5904000\n665000,5904050\n", None, ""),
        (
            "Easting;Northing\n665000;5904000\n665100;5904000\n665000;5904050\n",
            "EPSG:32630",
            "EPSG:32630",
        ),
        ("northing,easting\n5904000,665000\n5904000,665100\n5904050,665000\n", None, ""),
        ("665000 5904000\n665100 5904000\n665000 5904050\n", "EPSG:32630", "EPSG:32630"),
    ],
)
def test_two_columns_in_metres_are_easting_and_northing(
    save: Save, text: str, crs: str | None, frame: str
) -> None:
    for name in ("home.csv", "home.txt"):
        field = read_field(save(name, text), crs=crs)
        assert field.crs == frame
        assert field.boundary.bounds == (665000.0, 5904000.0, 665100.0, 5904050.0)


def test_two_columns_may_be_degrees_in_either_order_if_the_header_says_so(save: Save) -> None:
    lat_first = read_field(save("a.csv", "lat,lon\n" + COORDS))
    lon_first = read_field(
        save("b.csv", "longitude,latitude\n" + "".join(f"{x},{y}\n" for x, y in CORNERS))
    )
    assert same_place(lat_first, TRUTH)
    assert same_place(lon_first, TRUTH)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("0,0\n100,0\n100,100\n", "home.csv: nothing says what its columns are.*easting,northing"),
        ("x,y\n0,0\n", "home.csv, row 1: columns 'x,y' are not known.*easting,northing"),
        ("easting,northing\n", "home.csv: there is no corner below the header"),
        ("easting,northing\n1,2\n3,x\n", "home.csv, row 3: 'x' is not a number"),
        (
            "easting,northing\n" + "".join(f"{x},{y}\n" for x, y in CORNERS),
            "home.csv: .*look like degrees, not metres",
        ),
        ("easting;northing\n665000,5;5904000,2\n", "home.csv, row 2: .*665000.5, 5904000.2"),
    ],
)
def test_two_columns_that_are_no_field_are_refused_by_file_and_row(
    save: Save, text: str, message: str
) -> None:
    with pytest.raises(BoundaryError, match=message):
        read_field(save("home.csv", text))


@given(
    st.text(),
    st.sampled_from(["", COORDS, "easting,northing\n", "lat,lon\n"]),
    st.sampled_from([".coords", ".csv"]),
)
@settings(deadline=None, max_examples=200)
def test_no_text_whatever_makes_anything_but_a_field_or_a_boundary_error(
    tmp_path_factory: pytest.TempPathFactory, text: str, start: str, suffix: str
) -> None:
    path = tmp_path_factory.mktemp("any") / f"any{suffix}"
    path.write_bytes((start + text).encode("utf-8", "surrogatepass"))
    try:
        assert len(read_field(path).cells) > 0
    except BoundaryError as error:
        complaint = str(error)
    else:
        return
    assert path.name in complaint


# Keep-outs from a file of their own


def test_keep_outs_may_come_from_another_file_in_degrees(save: Save) -> None:
    pond = save("ponds.geojson", mapping(POND))
    home = save("home.coords", COORDS)
    field = read_field(home, keep_outs=pond)
    assert field.area_ha == pytest.approx(TRUTH.area_ha - field.keep_outs[0].area / 10_000)


def test_keep_outs_in_degrees_fit_a_field_in_metres(save: Save) -> None:
    home = save("home.geojson", mapping(Polygon(METRES)))
    centre = Field(Polygon(METRES), "EPSG:32630").to_lonlat(METRES.mean(axis=0))
    pond = Point(*centre[0]).buffer(1e-4).exterior.coords
    ponds = save("ponds.coords", "".join(f"{lat}, {lon}\n" for lon, lat in pond))
    field = read_field(home, crs="EPSG:32630", keep_outs=ponds)
    assert not field.contains(METRES.mean(axis=0)).any()


def test_several_keep_outs_may_share_a_file_and_add_to_those_of_the_field(save: Save) -> None:
    other = shapely.affinity.translate(POND, 0.001, 0.0005)
    home = save("home.geojson", collection(feature(OUTLINE), feature(POND, role="keep-out")))
    ponds = save("ponds.geojson", collection(feature(other), feature(POND, role="keep-out")))
    assert len(read_field(home, keep_outs=ponds).keep_outs) == 3


@pytest.mark.parametrize(
    ("keep_outs", "message"),
    [
        (mapping(shapely.affinity.translate(POND, 1.0)), "ponds.geojson: no keep-out touches"),
        (mapping(Polygon([(y, x) for x, y in CORNERS])), "ponds.geojson: no keep-out.*order of"),
        (
            {"type": "Polygon", "coordinates": [[[0, 50], [1, 51], [1, 50], [0, 51]]]},
            "ponds.geojson: .*Self-inter",
        ),
    ],
)
def test_keep_outs_that_cannot_be_meant_are_refused_by_their_file(
    save: Save, keep_outs: Any, message: str
) -> None:
    with pytest.raises(BoundaryError, match=message):
        read_field(save("home.coords", COORDS), keep_outs=save("ponds.geojson", keep_outs))


def test_keep_outs_in_degrees_do_not_fit_a_local_frame(save: Save) -> None:
    home = save("home.csv", "easting,northing\n0,0\n100,0\n100,100\n")
    with pytest.raises(BoundaryError, match=r"ponds.geojson: nothing leads from EPSG:4326 to a"):
        read_field(home, keep_outs=save("ponds.geojson", mapping(POND)))


# Files


def test_a_missing_file_is_named_with_its_path(tmp_path: Path) -> None:
    with pytest.raises(BoundaryError, match=r"home\.coords: there is no such file"):
        read_field(tmp_path / "home.coords")


def test_a_folder_is_no_file(tmp_path: Path) -> None:
    with pytest.raises(BoundaryError, match="this is a folder"):
        read_field(tmp_path)


def test_an_unknown_suffix_is_answered_with_the_known_ones(save: Save) -> None:
    with pytest.raises(BoundaryError, match=rf"home\.pdf: .*{' '.join(READERS)}"):
        read_field(save("home.pdf", "%PDF"))


def test_bytes_that_are_no_text_are_refused(save: Save) -> None:
    with pytest.raises(BoundaryError, match=r"home\.coords: byte 3 is not text.*UTF-8"):
        read_field(save("home.coords", b"53.\xff\xfe"))


def test_a_wrong_cell_size_is_a_parameter_error(save: Save) -> None:
    with pytest.raises(ParameterError, match="cell size"):
        read_field(save("home.coords", COORDS), cell_size=0.0)


# GeoPackage, shapefile, KML

DRIVERS = {".gpkg": "GPKG", ".shp": "ESRI Shapefile", ".kml": "KML"}


def write_geofile(path: Path, shapes: list[Any], roles: list[str], crs: str | None) -> None:
    pyogrio = pytest.importorskip("pyogrio")
    if path.suffix == ".kml" and "LIBKML" not in pyogrio.list_drivers():
        pytest.skip("GDAL's older driver writes a role as a second name")
    pyogrio.raw.write(
        path,
        np.array([shapely.to_wkb(shape) for shape in shapes], dtype=object),
        [np.array(roles, dtype=object)],
        ["role"],
        geometry_type=shapes[0].geom_type,
        crs=crs,
        driver=DRIVERS[path.suffix],
    )


@pytest.mark.parametrize("suffix", DRIVERS)
def test_gdal_formats_are_read_longitude_first_with_their_roles(
    tmp_path: Path, suffix: str
) -> None:
    path = tmp_path / f"home{suffix}"
    write_geofile(path, [OUTLINE, POND], ["", "keep-out"], "EPSG:4326")
    field = read_field(path)
    assert field.boundary.symmetric_difference(TRUTH.boundary).area < 1e-2
    assert field.crs == TRUTH.crs
    assert len(field.keep_outs) == 1


@pytest.mark.parametrize("suffix", [".gpkg", ".shp"])
def test_gdal_formats_in_metres_keep_their_frame(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"home{suffix}"
    write_geofile(path, [Polygon(METRES)], [""], "EPSG:32630")
    field = read_field(path)
    assert (field.crs, round(field.area_ha, 3)) == ("EPSG:32630", 0.5)


@pytest.mark.filterwarnings("ignore:'crs' was not provided")
def test_a_shapefile_without_its_prj_needs_a_crs(tmp_path: Path) -> None:
    path = tmp_path / "home.shp"
    write_geofile(path, [Polygon(METRES)], [""], None)
    with pytest.raises(BoundaryError, match=r"home\.shp: it does not name its CRS.*\.prj"):
        read_field(path)
    assert read_field(path, crs="EPSG:32630").crs == "EPSG:32630"


def test_a_geopackage_of_points_has_no_outline(tmp_path: Path) -> None:
    path = tmp_path / "home.gpkg"
    write_geofile(path, [Point(-0.5, 53.2)], [""], "EPSG:4326")
    with pytest.raises(BoundaryError, match=r"home\.gpkg: layers of polygons: none.*alone"):
        read_field(path)


def test_a_file_that_gdal_cannot_read_is_refused_in_one_line(save: Save) -> None:
    pytest.importorskip("pyogrio")
    with pytest.raises(
        BoundaryError, match=r"^home\.gpkg: it is no gpkg file by its content [^\n]*$"
    ):
        read_field(save("home.gpkg", "not a database"))
    with pytest.raises(BoundaryError, match=r"^home\.shp: GDAL cannot read it: [^\n]*$"):
        read_field(save("home.shp", b"\x00\x00\x27\x0a" + bytes(200)))


def test_without_pyogrio_the_way_to_install_it_is_said(
    save: Save, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pyogrio", None)
    with pytest.raises(MissingExtraError, match=r"home\.gpkg: .*pip install 'subsoil\[geo\]'"):
        read_field(save("home.gpkg", ""))


# Metres that are not metres on the ground


STRETCHED = ("EPSG:3857", "EPSG:3395", "ESRI:54034", "EPSG:6933", "EPSG:3034")


def drawn_in(frame: str, shape: Polygon) -> dict[str, Any]:
    moved = shapely.transform(shape, lambda xy: project("EPSG:4326", frame, xy[:, 0], xy[:, 1]))
    named = {"type": "name", "properties": {"name": frame}}
    return {**collection(feature(moved)), "crs": named}


@pytest.mark.parametrize("frame", STRETCHED)
def test_a_field_drawn_in_stretched_metres_is_kept_in_its_utm_zone_and_says_so(
    save: Save, frame: str
) -> None:
    field = read_field(
        save("home.geojson", drawn_in(frame, OUTLINE)),
        keep_outs=save("pond.geojson", drawn_in(frame, POND)),
    )
    assert field.crs == TRUTH.crs
    assert field.boundary.hausdorff_distance(TRUTH.boundary) < 0.01
    assert field.keep_outs[0].area == pytest.approx(1113, rel=0.01)
    assert len(others(field.findings)) == 1
    assert f"metres of {frame} are" in others(field.findings)[0]
    assert "kept in EPSG:32630" in others(field.findings)[0]


def test_a_stretched_frame_that_the_caller_names_is_no_measure_either(save: Save) -> None:
    corners = project("EPSG:4326", "EPSG:3857", *np.transpose(CORNERS))
    text = "easting,northing\n" + "".join(f"{x!r},{y!r}\n" for x, y in corners.tolist())
    field = read_field(save("home.csv", text), crs="EPSG:3857")
    assert same_place(field, TRUTH) or field.boundary.hausdorff_distance(TRUTH.boundary) < 0.01
    with pytest.raises(BoundaryError, match=r"home: a metre of EPSG:3857 is not .*32630"):
        Field.from_metres(corners, crs="EPSG:3857", name="home")


@pytest.mark.parametrize(
    ("frame", "place"),
    [
        ("EPSG:32630", (-0.5, 53.0)),
        ("EPSG:32630", (-6.0, 0.1)),
        ("EPSG:32631", (-0.5, 53.0)),
        ("EPSG:28992", (5.6, 52.1)),
        ("EPSG:31370", (4.0, 51.0)),
        ("EPSG:2154", (2.0, 47.0)),
        ("EPSG:3067", (27.0, 62.0)),
        ("EPSG:2193", (175.0, -40.0)),
    ],
)
def test_a_national_grid_or_utm_zone_stays_as_it_is(
    save: Save, frame: str, place: tuple[float, float]
) -> None:
    east, north = Proj(frame)(*place)
    text = f"easting,northing\n{east},{north}\n{east + 90},{north}\n{east},{north + 90}\n"
    field = read_field(save("home.csv", text), crs=frame)
    assert (field.crs, others(field.findings)) == (frame, ())


def test_a_place_that_a_frame_does_not_have_is_refused() -> None:
    with pytest.raises(BoundaryError, match="is no place in EPSG:32630"):
        stretch("EPSG:32630", (9e9, 9e9))


# What a file has beside its outline


def kml(*placemarks: str) -> str:
    document = f"<Document>{''.join(placemarks)}</Document>"
    return f'<kml xmlns="http://www.opengis.net/kml/2.2">{document}</kml>'


def placemark(name: str, *shapes: str) -> str:
    drawn = f"<MultiGeometry>{''.join(shapes)}</MultiGeometry>"
    return f"<Placemark><name>{name}</name>{drawn}</Placemark>"


RING = "<LinearRing><coordinates>{}</coordinates></LinearRing>".format(
    " ".join(f"{x},{y}" for x, y in CORNERS)
)
DRAWN = f"<Polygon><outerBoundaryIs>{RING}</outerBoundaryIs></Polygon>"
PIN, LINE = (
    f"<{kind}><coordinates>-0.5,53.26 -0.4,53.26</coordinates></{kind}>"
    for kind in ("Point", "LineString")
)
LINK = "<NetworkLink><Link><href>other.kml</href></Link></NetworkLink>"

BESIDE = {
    "KML": (
        "home.kml",
        kml(
            placemark("gate", PIN), placemark("home", DRAWN, PIN), placemark("fence", LINE),
            placemark("ring", RING), placemark(""), LINK,
        ),
        "Point of feature 1 (gate), Point of feature 2 (home), LineString of feature 3 (fence), "
        "LinearRing of feature 4 (ring), feature without geometry of feature 5, "
        "NetworkLink of home.kml",
    ),
    "GeoJSON": (
        "home.geojson",
        collection(
            feature(Point(1, 2), name="gate"), feature(OUTLINE), feature(LineString(CORNERS)),
            {"type": "Feature", "geometry": None, "properties": None},
        ),
        "Point of feature 1 (gate), LineString of feature 3, feature without geometry of feature 4",
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", BESIDE)
def test_points_and_lines_beside_an_outline_are_left_alone_and_named(save: Save, case: str) -> None:
    name, content, words = BESIDE[case]
    field = read_field(save(name, content))
    assert same_place(field, TRUTH)
    assert others(field.findings) == (f"{name}: no polygons, left alone: {words}",)


def test_of_many_pins_the_first_are_named_and_the_others_counted(save: Save) -> None:
    pins = (feature(Point(1, 2), name="x" * 5000) for _ in range(1000))
    (note,) = others(read_field(save("home.geojson", collection(feature(OUTLINE), *pins))).findings)
    assert note.endswith(" and 994 more")
    assert len(note) < 400


@pytest.mark.parametrize("shape", [PIN, LINE])
def test_a_pin_or_line_marked_as_a_keep_out_keeps_nobody_out_and_is_refused(
    save: Save, shape: str
) -> None:
    role = '<ExtendedData><Data name="role"><value>keep-out</value></Data></ExtendedData>'
    drain = f"<Placemark><name>drain</name>{role}{shape}</Placemark>"
    with pytest.raises(BoundaryError, match=r"home\.kml, feature 2 \(drain\): a .* no.* outline"):
        read_field(save("home.kml", kml(placemark("home", DRAWN), drain)))


def test_what_is_beside_the_keep_outs_of_another_file_is_named_too(save: Save) -> None:
    far = shapely.affinity.translate(POND, 1.0)
    ponds = collection(feature(POND), feature(far), feature(Point(1, 2), name="well"))
    field = read_field(save("home.coords", COORDS), keep_outs=save("ponds.geojson", ponds))
    assert len(field.keep_outs) == 2
    assert others(field.findings) == (
        "ponds.geojson: no polygons, left alone: Point of feature 3 (well)",
        "ponds.geojson: 1 of 2 keep-outs do not touch the field",
    )


def test_notes_of_a_file_in_stretched_metres_say_all_that_is_to_know(save: Save) -> None:
    drawn = drawn_in("EPSG:3857", OUTLINE)
    drawn["features"].append(feature(Point(1, 2), name="gate"))
    moved, left = others(read_field(save("home.geojson", drawn)).findings)
    assert "kept in EPSG:32630" in moved
    assert "Point of feature 2 (gate)" in left


def test_layers_and_shapes_beside_the_outline_of_a_geopackage_are_named(tmp_path: Path) -> None:
    raw = pytest.importorskip("pyogrio").raw
    path = tmp_path / "home.gpkg"
    for layer, shapes, kind in (
        ("home", [Point(1, 2), OUTLINE, LineString(CORNERS), None], "Unknown"),
        ("pins", [Point(1, 2)], "Point"),
        ("drains", [LineString(CORNERS)], "LineString"),
    ):
        geometry = [shape and shapely.to_wkb(shape) for shape in shapes]
        raw.write(
            path, np.array(geometry, dtype=object), [np.zeros(len(shapes))], ["n"], layer=layer,
            geometry_type=kind, crs="EPSG:4326", driver="GPKG", append=path.exists(),
        )  # fmt: skip
    field = read_field(path)
    assert same_place(field, TRUTH)
    assert others(field.findings) == (
        "home.gpkg: no polygons, left alone: Point of feature 1, LineString of feature 3, "
        "feature without geometry of feature 4",
        "home.gpkg: no polygons, left alone: layer pins, layer drains",
    )
