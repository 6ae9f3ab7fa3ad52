"""The same readings give the same samples, in whatever layout, unit, mark or encoding they come."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import openpyxl
import pyogrio.raw
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import box
from tests.io.layouts import DIGITS, KPA, Pushes, Style, geojson, text_of, tidy, wide, write

from subsoil.findings import left_out
from subsoil.io.read.readings import read_readings
from subsoil.land.field import Field
from subsoil.layers import Layers
from subsoil.readings import Readings

LAYERS = Layers((0.0, 0.05, 0.1, 0.2, 0.3))


SIDE_DEG = 0.004


def home(west: float, south: float) -> Field:
    return Field.from_lonlat(box(west, south, west + SIDE_DEG, south + SIDE_DEG), name="home")


FIELDS = {
    "Netherlands": home(5.64, 52.09),
    "England": home(-0.53, 53.26),
    "Chile": home(-71.2, -33.4),
}


def pushes_at(field: Field, depth_m: Sequence[float], seed: int = 3, n: int = 6) -> Pushes:
    rng = np.random.default_rng(seed)
    middle = field.to_lonlat([field.boundary.centroid.coords[0]])
    lonlat = middle + rng.uniform(-0.45, 0.45, (n, 2)) * SIDE_DEG
    kpa = rng.uniform(150.0, 4200.0, (n, len(depth_m)))
    kpa[1, -2:] = np.nan
    kpa[4, 1:] = np.nan
    return Pushes(lonlat[:, 0], lonlat[:, 1], np.array(depth_m), kpa)


def expected(pushes: Pushes) -> np.ndarray:
    """(m, n) layer means by the rule, apart from the product: each kPa since the depth above."""
    out = np.full((len(LAYERS), len(pushes.kpa)), np.nan)
    tops = np.concatenate([[0.0], pushes.depth_m[:-1]])
    for n, kpa in enumerate(pushes.kpa):
        known = np.isfinite(kpa)
        step = np.median(np.diff(pushes.depth_m[known])) if known.sum() > 1 else 0.0
        for m, (top, bottom) in enumerate(zip(LAYERS.top_m, LAYERS.bottom_m, strict=True)):
            covered = np.minimum(bottom, pushes.depth_m) - np.maximum(top, tops)
            share = np.where(known, np.maximum(covered, 0.0), 0.0)
            if share.sum() > 1e-9 and pushes.depth_m[known][-1] >= bottom - step / 2 - 1e-9:
                out[m, n] = (share * np.nan_to_num(kpa)).sum() / share.sum()
    return out


def check(readings: Readings, pushes: Pushes, field: Field, unit: str = "kpa") -> None:
    assert left_out(readings.findings) == ()
    rounding = 0.6 * KPA[unit] * 10.0 ** -DIGITS[unit]
    order = np.argsort(readings.rows)
    np.testing.assert_allclose(
        readings.layer_means(LAYERS)[:, order], expected(pushes), atol=rounding, rtol=1e-6
    )
    np.testing.assert_allclose(
        readings.at[order], field.to_metres(pushes.lon, pushes.lat), atol=0.002
    )


STEPS = {
    "1 cm": np.arange(1, 41) * 0.01,
    "2 cm": np.arange(1, 21) * 0.02,
    "2.5 cm": np.arange(1, 17) * 0.025,
    "3 cm": np.arange(1, 14) * 0.03,
    "5 cm": np.arange(1, 9) * 0.05,
    "5.08 cm": np.arange(1, 8) * 0.0508,
    "an inch": np.arange(1, 17) * 0.0254,
    "uneven": np.array([0.025, 0.05, 0.1, 0.2, 0.3, 0.45]),
}
HEADINGS = {
    "kpa_10cm": "{0}_{1}".format,
    "10cm (kPa)": "{1} ({0})".format,
    "10cm_kpa": "{1}_{0}".format,
    "kPa@10cm": "{0}@{1}".format,
    "CI at 10cm [kPa]": "CI at {1} [{0}]".format,
    "Eindringwiderstand 10cm kPa": "Eindringwiderstand {1} {0}".format,
}


@pytest.mark.parametrize("country", FIELDS)
@pytest.mark.parametrize("step", STEPS)
def test_any_step_gives_the_layer_means_that_plain_numpy_gives(
    tmp_path: Path, step: str, country: str
) -> None:
    field = FIELDS[country]
    pushes = pushes_at(field, STEPS[step].tolist())
    for length in ("cm", "mm"):
        for layout in (wide, tidy):
            rows = layout(pushes, Style(length=length), field)
            path = write(tmp_path / "a.csv", text_of(rows, ","), "utf-8")
            check(read_readings(path, field=field), pushes, field)


@pytest.mark.parametrize("layout", [wide, tidy])
@pytest.mark.parametrize("unit", KPA)
def test_any_unit_gives_the_same_samples(tmp_path: Path, unit: str, layout: object) -> None:
    field = FIELDS["England"]
    pushes = pushes_at(field, STEPS["5 cm"].tolist())
    rows = (wide if layout is wide else tidy)(pushes, Style(unit=unit), field)
    path = write(tmp_path / "a.csv", text_of(rows, ","), "utf-8")
    check(read_readings(path, field=field), pushes, field, unit)


@pytest.mark.parametrize("place", ["degrees", "metres", "xy", "nmea", "minutes", "seconds"])
@pytest.mark.parametrize("country", FIELDS)
@pytest.mark.parametrize(
    ("delimiter", "decimal"), [(",", "."), (";", ","), ("\t", ","), ("|", ".")]
)
def test_any_writing_of_places_and_numbers_gives_the_same_samples(
    tmp_path: Path, place: str, country: str, delimiter: str, decimal: str
) -> None:
    field = FIELDS[country]
    pushes = pushes_at(field, STEPS["2.5 cm"].tolist())
    style = Style(place=place, delimiter=delimiter, decimal=decimal)
    for layout in (wide, tidy):
        path = write(tmp_path / "a.csv", text_of(layout(pushes, style, field), delimiter), "utf-8")
        check(read_readings(path, field=field), pushes, field)


@pytest.mark.parametrize("heading", HEADINGS)
@pytest.mark.parametrize("length", ["cm", "in", "ft", "m"])
def test_any_usual_heading_of_a_depth_is_understood(
    tmp_path: Path, heading: str, length: str
) -> None:
    field = FIELDS["Netherlands"]
    pushes = pushes_at(field, STEPS["an inch"].tolist())
    if length == "ft":
        pushes = replace(pushes, depth_m=np.array([0.03048 * k for k in range(1, 17)]))
    style = Style(length=length, heading=HEADINGS[heading])
    path = write(tmp_path / "a.csv", text_of(wide(pushes, style, field), ","), "utf-8")
    check(read_readings(path, field=field), pushes, field)


@pytest.mark.parametrize(
    ("encoding", "note"),
    [
        ("utf-8", ""), ("utf-8-sig", ""), ("utf-16", ""), ("utf-16-le", ""), ("utf-16-be", ""),
        ("utf-32", ""), ("cp1252", "Windows-1252"),
    ],
)  # fmt: skip
@pytest.mark.parametrize("ends", ["\n", "\r\n", "\r"])
def test_any_encoding_gives_the_same_samples_and_only_a_guess_is_noted(
    tmp_path: Path, encoding: str, note: str, ends: str
) -> None:
    field = FIELDS["England"]
    pushes = pushes_at(field, STEPS["5 cm"].tolist())
    text = text_of(wide(pushes, Style(place="minutes"), field), ";").replace("\r\n", ends)
    readings = read_readings(write(tmp_path / "a.csv", text, encoding), field=field)
    check(readings, pushes, field)
    assert [note in finding.seen for finding in readings.findings] == ([True] if note else [])


@pytest.mark.parametrize("code", ["", "NA", "n/a", "-", "-1", "-9999", "9999", "--", "null", "0"])
@pytest.mark.parametrize("layout", [wide, tidy])
def test_any_code_for_not_reached_gives_the_same_samples(
    tmp_path: Path, code: str, layout: object
) -> None:
    field = FIELDS["England"]
    pushes = pushes_at(field, STEPS["5 cm"].tolist())
    rows = (wide if layout is wide else tidy)(pushes, Style(missing=code), field)
    check(
        read_readings(write(tmp_path / "a.csv", text_of(rows, ","), "utf-8"), field=field),
        pushes,
        field,
    )


@pytest.mark.parametrize("thousands", [" ", "'", "\u202f", "."])
def test_thousands_marks_that_are_certain_give_the_same_samples(
    tmp_path: Path, thousands: str
) -> None:
    field = FIELDS["Netherlands"]
    pushes = pushes_at(field, STEPS["5 cm"].tolist())
    style = Style(thousands=thousands, decimal=",")
    path = write(tmp_path / "a.csv", text_of(wide(pushes, style, field), ";"), "utf-8")
    check(read_readings(path, field=field), pushes, field)


@pytest.mark.parametrize(
    "above", ["sep=;\n", "Field 7; of May\n\n", "\n\n", "# by hand\n", ";;;\n"]
)
def test_lines_above_the_heading_do_not_matter(tmp_path: Path, above: str) -> None:
    field = FIELDS["Netherlands"]
    pushes = pushes_at(field, STEPS["5 cm"].tolist())
    text = above + text_of(wide(pushes, Style(), field), ";")
    check(read_readings(write(tmp_path / "a.csv", text, "utf-8"), field=field), pushes, field)


def test_rows_in_any_order_of_depth_and_columns_in_any_order_are_the_same(tmp_path: Path) -> None:
    field = FIELDS["Netherlands"]
    pushes = pushes_at(field, STEPS["5 cm"].tolist())
    rows = tidy(pushes, Style(), field, order=-1)
    path = write(tmp_path / "a.csv", text_of(rows, ","), "utf-8")
    check(read_readings(path, field=field), pushes, field)
    by_depth = [rows[0], *sorted(rows[1:], key=lambda row: (float(row[3]), int(row[0])))]
    path = write(tmp_path / "b.csv", text_of(by_depth, ","), "utf-8")
    check(read_readings(path, field=field), pushes, field)
    turned = [row[::-1] for row in wide(pushes, Style(), field)]
    path = write(tmp_path / "c.csv", text_of(turned, ","), "utf-8")
    check(read_readings(path, field=field), pushes, field)


def test_workbooks_and_points_give_the_same_samples(tmp_path: Path) -> None:
    field = FIELDS["Chile"]
    pushes = pushes_at(field, STEPS["5 cm"].tolist())
    rows = wide(pushes, Style(), field)
    book = openpyxl.Workbook()
    sheet = book.active
    assert sheet is not None
    for k, row in enumerate(rows):
        sheet.append([float(cell) if k and cell else cell or None for cell in row])
    book.save(tmp_path / "a.xlsx")
    check(read_readings(tmp_path / "a.xlsx", field=field), pushes, field)
    path = write(tmp_path / "a.geojson", geojson(pushes, Style()), "utf-8")
    check(read_readings(path, field=field), pushes, field)
    for name in ("a.gpkg", "a.shp"):
        pyogrio.raw.write(
            tmp_path / name,
            geometry=shapely.to_wkb(shapely.points(pushes.lon, pushes.lat)),
            field_data=[np.round(column, 1) for column in pushes.kpa.T],
            fields=[f"kpa_{d:g}cm" for d in np.round(pushes.depth_m * 100, 3)],
            geometry_type="Point",
            crs="EPSG:4326",
        )
        check(read_readings(tmp_path / name, field=field), pushes, field)


@given(
    st.sampled_from(sorted(FIELDS)),
    st.sampled_from(sorted(STEPS)),
    st.sampled_from(sorted(KPA)),
    st.sampled_from(["degrees", "xy", "nmea", "minutes", "seconds", "metres"]),
    st.sampled_from([(",", "."), (";", ","), ("\t", "."), (";", "."), ("\t", ",")]),
    st.sampled_from(["", "NA", "-9999", "n/a"]),
    st.sampled_from(["utf-8", "utf-16", "utf-8-sig"]),
    st.booleans(),
    st.integers(0, 10_000),
)
@settings(deadline=None, max_examples=120)
def test_any_mixture_of_all_that_gives_the_same_samples(
    tmp_path_factory: pytest.TempPathFactory,
    country: str,
    step: str,
    unit: str,
    place: str,
    marks: tuple[str, str],
    missing: str,
    encoding: str,
    is_tidy: bool,
    seed: int,
) -> None:
    field = FIELDS[country]
    pushes = pushes_at(field, STEPS[step].tolist(), seed)
    style = Style(unit, "cm", place, marks[0], marks[1], missing)
    rows = (tidy if is_tidy else wide)(pushes, style, field)
    path = tmp_path_factory.mktemp("mixed") / "a.csv"
    write(path, text_of(rows, marks[0]), encoding)
    check(read_readings(path, field=field), pushes, field, unit)
