"""Workbooks and points as tables: which sheet, which cells, and what is refused."""

from __future__ import annotations

import json
import re
import sys
import zipfile
from collections.abc import Callable, Sequence
from datetime import datetime
from pathlib import Path
from typing import Any

import numpy as np
import openpyxl
import pyogrio.raw
import pytest
import shapely

from subsoil.errors import InputError, MissingExtraError, ReadingsError
from subsoil.findings import left_out, others
from subsoil.io.read.readings import read_readings
from subsoil.io.read.tables.table import recording_of
from subsoil.io.read.tables.workbook import read_workbook

HEAD = ["date", "lat", "lon", "kpa_5cm", "kpa_10cm"]
FIRST = [datetime(2024, 5, 13, 8, 15), 53.2615, -0.525, 1119, 1350.5]
SECOND = [datetime(2024, 5, 13, 8, 20), 53.2616, -0.525, 834, None]

Book = Callable[..., Path]


@pytest.fixture
def book(tmp_path: Path) -> Book:
    """Write sheets by their names, some of them hidden."""

    def write(hidden: Sequence[str] = (), **sheets: list[list[Any]]) -> Path:
        found = openpyxl.Workbook()
        assert found.active is not None
        found.remove(found.active)
        for name, rows in sheets.items():
            sheet = found.create_sheet(name)
            for row in rows:
                sheet.append(row)
            if name in hidden:
                sheet.sheet_state = "hidden"
        path = tmp_path / "walk.xlsx"
        found.save(path)
        return path

    return write


def changed(path: Path, part: str, change: Callable[[bytes], bytes]) -> Path:
    """The workbook with one of its parts changed."""
    with zipfile.ZipFile(path) as archive:
        parts = {name: archive.read(name) for name in archive.namelist()}
    parts[part] = change(parts[part])
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in parts.items():
            archive.writestr(name, data)
    return path


def test_numbers_of_a_workbook_are_numbers_and_never_have_thousands_marks(book: Book) -> None:
    path = book(walk=[["Field 7"], [], HEAD, FIRST, SECOND])
    readings = read_readings(path)
    assert [p.kpa.tolist() for p in readings.profiles] == [[1119.0, 1350.5], [834.0]]
    assert readings.rows.tolist() == [4, 5]
    assert readings.findings == ()


def test_dates_of_a_workbook_are_times(book: Book) -> None:
    (sheet,) = read_workbook(book(walk=[HEAD, FIRST]))
    assert recording_of(sheet).records[0].time == FIRST[0]


def test_the_sheet_that_holds_readings_is_read_and_named(book: Book) -> None:
    path = book(hidden=["old"], notes=[["by Ada"]], walk=[HEAD, FIRST], old=[HEAD, SECOND])
    readings = read_readings(path)
    assert readings.profiles[0].kpa.tolist() == [1119.0, 1350.5]
    assert set(others(readings.findings)) == {
        "walk.xlsx: sheet walk is read, others left alone: notes",
        "walk.xlsx: hidden sheets left alone: old",
    }


def test_two_sheets_of_readings_are_refused_by_name(book: Book) -> None:
    with pytest.raises(ReadingsError, match=r"sheets May, June all hold readings"):
        read_readings(book(May=[HEAD, FIRST], June=[HEAD, SECOND]))


def test_no_sheet_of_readings_is_refused_with_its_headings(book: Book) -> None:
    with pytest.raises(ReadingsError, match=r"walk\.xlsx, sheet .*headings seen: "):
        read_readings(book(May=[["what", "when"], [1, 2]], June=[["who"], ["me"]]))
    with pytest.raises(ReadingsError, match=r"walk\.xlsx: all its cells are blank"):
        read_readings(book(May=[]))


def test_formulas_count_with_their_values_and_are_refused_without(book: Book) -> None:
    path = book(walk=[HEAD, [*FIRST[:3], "=500+600", 1350]])
    with pytest.raises(ReadingsError, match=r"formulas in sheet1\.xml have no values yet"):
        read_readings(path)
    part = "xl/worksheets/sheet1.xml"
    computed = changed(path, part, lambda xml: re.sub(rb"<v ?/>|<v></v>", b"<v>1100</v>", xml))
    assert read_readings(computed).profiles[0].kpa.tolist() == [1100.0, 1350.0]


def test_entities_and_what_unpacks_without_end_are_refused(book: Book) -> None:
    path = book(walk=[HEAD, FIRST])
    bomb = b'<!DOCTYPE x [<!ENTITY a "aaaa">]>'
    changed(path, "xl/workbook.xml", lambda xml: bomb + xml)
    with pytest.raises(ReadingsError, match=r"walk\.xlsx: xl/workbook\.xml declares entities"):
        read_readings(path)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("[Content_Types].xml", b" " * 400_000_000)
    with pytest.raises(ReadingsError, match=r"walk\.xlsx: unpacked it is larger"):
        read_readings(path)


@pytest.mark.parametrize("keep", [10, 500, 2500])
def test_a_workbook_that_was_cut_off_is_refused_in_one_line(book: Book, keep: int) -> None:
    path = book(walk=[HEAD, FIRST])
    path.write_bytes(path.read_bytes()[:keep])
    with pytest.raises(ReadingsError, match=r"^walk\.xlsx: .*damaged") as caught:
        read_readings(path)
    assert "\n" not in str(caught.value)


def test_a_workbook_without_its_library_says_what_to_install(
    book: Book, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = book(walk=[HEAD, FIRST])
    monkeypatch.setitem(sys.modules, "python_calamine", None)
    with pytest.raises(MissingExtraError, match=r"pip install 'subsoil\[geo\]', or save it as CSV"):
        read_readings(path)


# Points


def feature(at: Any, **properties: Any) -> dict[str, Any]:
    geometry = None if at is None else {"type": "Point", "coordinates": at}
    return {"type": "Feature", "geometry": geometry, "properties": properties}


def collection(path: Path, *features: Any, **members: Any) -> Path:
    path.write_text(json.dumps({"type": "FeatureCollection", "features": features, **members}))
    return path


def test_points_give_their_own_places_and_their_columns_of_places_are_left_alone(
    tmp_path: Path,
) -> None:
    path = collection(
        tmp_path / "walk.geojson",
        feature([-0.525, 53.2615], id="a", lat=0.0, lon=0.0, kpa_5cm=1119),
        feature(None, id="b", kpa_5cm=700),
        feature([-0.526, 53.2616, 30.0], id="c", kpa_5cm=600.5),
    )
    readings = read_readings(path)
    assert [p.kpa.tolist() for p in readings.profiles] == [[1119.0], [600.5]]
    assert readings.crs == "EPSG:32630"
    assert [str(f) for f in left_out(readings.findings)] == ["row 2: it has no place; left out"]
    assert others(readings.findings) == ("walk.geojson: columns left alone: lat, lon",)


def test_points_with_a_row_a_depth_are_a_tidy_table(tmp_path: Path) -> None:
    rows = [feature([-0.525, 53.2615], push=1, depth_cm=d, mpa=d / 10) for d in (10, 5)]
    readings = read_readings(collection(tmp_path / "walk.geojson", *rows))
    assert readings.profiles[0].kpa.tolist() == [500.0, 1000.0]


def test_points_in_metres_are_in_the_frame_of_their_file(tmp_path: Path) -> None:
    for name in ("walk.gpkg", "walk.shp"):
        pyogrio.raw.write(
            tmp_path / name,
            geometry=shapely.to_wkb(shapely.points([[665000.0, 5904000.0], [665010.0, 5904000.0]])),
            field_data=[np.array([500.0, 600.0])],
            fields=["kpa_5cm"],
            geometry_type="Point",
            crs="EPSG:32630",
        )
        readings = read_readings(tmp_path / name)
        assert (readings.crs, readings.at[1].tolist()) == ("EPSG:32630", [665010.0, 5904000.0])


@pytest.mark.parametrize(
    ("features", "message"),
    [
        ([], "walk.geojson: .*"),
        (
            [{"type": "Feature", "geometry": {"type": "LineString"}}],
            "feature 1: this is not a point",
        ),
        ([feature([1, "x"], kpa_5cm=1)], "feature 1: its coordinates are not two numbers"),
        ([feature([10**400, 1], kpa_5cm=1)], "feature 1: its coordinates are not two numbers"),
        ([feature([1, 2], a=1, b=2)], "no column names a depth; headings seen: a, b"),
    ],
)
def test_points_that_are_no_readings_are_refused(
    tmp_path: Path, features: list[Any], message: str
) -> None:
    with pytest.raises(InputError, match=message):
        read_readings(collection(tmp_path / "walk.geojson", *features))
