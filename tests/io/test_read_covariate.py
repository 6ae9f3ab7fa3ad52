"""Covariates of a field's cells, from rasters and points, and what is wrong with a file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pyogrio
import pytest
import rasterio
import shapely
from numpy.testing import assert_allclose

from subsoil.arrays import Floats
from subsoil.errors import BoundaryError, ReadingsError
from subsoil.findings import left_out
from subsoil.io.read.covariate import read_covariate
from subsoil.land.crs import WGS84, project
from subsoil.land.field import Field

UTM = "EPSG:32630"


def land(crs: str = UTM) -> Field:
    """A field of 93 cells, without a corner."""
    origin = (681_000.0, 5_900_000.0) if crs else (0.0, 0.0)
    corners = np.array([(0, 0), (60, 0), (60, 30), (50, 40), (0, 40)]) + origin
    return Field.from_metres(corners, crs=crs, name="land")


def plane(at: Floats) -> Floats:
    """A value that is linear in the place, so that it is its own average."""
    east, north = (at.T + 500.0) % 1000.0 - 500.0
    return np.asarray(20.0 + 0.3 * east - 0.2 * north)


def raster(
    path: Path, field: Field, pixel: float = 1.0, margin: float = 10.0, crs: str | None = UTM
) -> Path:
    """Raster of the plane around a field, whose north-west corner is a hole."""
    west, south, east, north = np.array(field.boundary.bounds) + margin * np.array([-1, -1, 1, 1])
    x = np.arange(west + pixel / 2, east, pixel)
    y = np.arange(north - pixel / 2, south, -pixel)
    values = plane(np.column_stack([k.ravel() for k in np.meshgrid(x, y)])).reshape(len(y), len(x))
    values[: int(margin / pixel), : int(margin / pixel)] = -9999.0
    with rasterio.open(
        path, "w", driver="GTiff", width=len(x), height=len(y), count=1, dtype="float64",
        crs=crs, transform=rasterio.Affine(pixel, 0, west, 0, -pixel, north), nodata=-9999.0,
    ) as file:  # fmt: skip
        file.write(values, 1)
    return path


@pytest.mark.parametrize("crs", [UTM, ""])
@pytest.mark.parametrize("pixel", [0.5, 2.5, 5.0])
def test_a_raster_is_averaged_over_each_cell(tmp_path: Path, crs: str, pixel: float) -> None:
    field = land(crs)
    path = raster(tmp_path / "ec.tif", field, pixel, crs=crs or None)
    assert_allclose(read_covariate(path, field).values, plane(field.cells), atol=1e-9)


def test_a_raster_in_another_frame_is_brought_to_the_fields(tmp_path: Path) -> None:
    field = land()
    here = raster(tmp_path / "ec.tif", field, margin=40.0)
    there = tmp_path / "there.tif"
    with rasterio.open(here) as source:
        from rasterio.vrt import WarpedVRT

        with WarpedVRT(source, crs="EPSG:27700") as warped:
            profile = {**warped.profile, "driver": "GTiff"}
            with rasterio.open(there, "w", **profile) as target:
                target.write(warped.read())
    assert_allclose(read_covariate(there, field).values, plane(field.cells), atol=0.4)


def table(path: Path, at: Floats, values: Floats, header: str = "easting,northing,ec") -> Path:
    rows = (f"{x:.9f},{y:.9f},{value:.9f}" for (x, y), value in zip(at, values, strict=True))
    path.write_text("\n".join([header, *rows]) + "\n")
    return path


def test_points_in_a_cell_are_averaged_and_a_cell_without_one_takes_the_nearest(
    tmp_path: Path,
) -> None:
    field = land()
    cells = np.delete(field.cells, [3, 40], axis=0)
    at = np.concatenate([np.add(cells, (1.0, 0.5)), np.subtract(cells, (1.0, 0.2))])
    path = table(tmp_path / "ec.csv", at, plane(at))
    found = read_covariate(path, field).values
    assert_allclose(np.delete(found, [3, 40]), plane(np.add(cells, (0.0, 0.15))), atol=1e-6)
    for cell in (3, 40):
        nearest = at[np.argmin(np.hypot(*(at - field.cells[cell]).T))]
        assert_allclose(found[cell], plane(nearest[None])[0], atol=1e-6)


@pytest.mark.parametrize("suffix", [".gpkg", ".geojson", ".csv"])
def test_points_in_degrees_are_brought_to_the_fields_frame(tmp_path: Path, suffix: str) -> None:
    field, path = land(), tmp_path / f"ec{suffix}"
    lonlat = project(UTM, WGS84, *field.cells.T)
    values = plane(field.cells)
    if suffix == ".csv":
        table(path, lonlat, values, "Lon,Lat,EC")
    else:
        pyogrio.raw.write(
            path, shapely.to_wkb(shapely.points(lonlat)), [values, np.arange(len(values))],
            ["ec", "row"], geometry_type="Point", crs=WGS84,
        )  # fmt: skip
    column = None if suffix == ".csv" else "ec"
    assert_allclose(read_covariate(path, field, column=column).values, values, atol=1e-6)


def refused(path: Path, field: Field | None = None, **options: str) -> str:
    with pytest.raises((ReadingsError, BoundaryError)) as caught:
        read_covariate(path, field or land(), **options)
    text = str(caught.value)
    assert "\n" not in text
    assert path.name in text or "CRS" in text
    return text


def test_a_raster_that_does_not_cover_the_field_is_refused(tmp_path: Path) -> None:
    field = land()
    far = np.add([(0, 0), (50, 0), (50, 50)], (641_000, 5_900_000))
    assert "nothing is known of any cell" in refused(
        raster(tmp_path / "far.tif", Field.from_metres(far, crs=UTM))
    )
    half = Field.from_metres(np.add([(0, 0), (28, 0), (28, 40)], (681_000, 5_900_000)), crs=UTM)
    assert "cells, the first at" in refused(raster(tmp_path / "half.tif", half, margin=0.0), field)


def dug(path: Path, value: float, rows: slice, columns: slice, *, declared: bool) -> Path:
    """A raster with one value in some pixels, which its header calls no data or not."""
    with rasterio.open(path) as file:
        profile, values = dict(file.profile), file.read(1)
    values[values == -9999.0] = -9999.0 if declared else 20.0
    values[rows, columns] = value
    with rasterio.open(path, "w", **{**profile, "nodata": value if declared else None}) as file:
        file.write(values, 1)
    return path


def test_a_small_hole_in_a_raster_takes_the_nearest_value_and_is_noted(tmp_path: Path) -> None:
    path = dug(
        raster(tmp_path / "ec.tif", land()), -9999, slice(20, 30), slice(20, 35), declared=True
    )
    found = read_covariate(path, land())
    (note,) = found.findings
    assert (note.seen, note.severity) == ("nothing is known of 6 of 93 cells", "note")
    assert_allclose(found.values, plane(land().cells), atol=4)


def test_a_wide_hole_in_a_raster_is_refused(tmp_path: Path) -> None:
    path = dug(
        raster(tmp_path / "ec.tif", land()), -9999, slice(0, 60), slice(20, 80), declared=True
    )
    assert "nothing is known within 25 m of" in refused(path)


@pytest.mark.parametrize("code", [-9999.0, -32768.0, 32767.0, -99.0, -3.4028234663852886e38, 1e20])
def test_a_code_that_no_header_declares_is_left_out_and_counted(
    tmp_path: Path, code: float
) -> None:
    path = dug(
        raster(tmp_path / "ec.tif", land()), code, slice(20, 30), slice(20, 35), declared=False
    )
    found = read_covariate(path, land())
    (finding,) = left_out(found.findings)
    assert finding.seen.startswith("6 cells hold ")
    assert "where others hold " in finding.seen
    assert_allclose(found.values, plane(land().cells), atol=4)


def test_a_code_that_may_be_a_value_among_others_is_one(tmp_path: Path) -> None:
    cells = land().cells
    values = np.linspace(-120.0, -80.0, len(cells))
    values[7] = -99.0
    found = read_covariate(table(tmp_path / "ec.csv", cells, values), land())
    assert found.findings == ()
    assert found.values[7] == -99.0


def test_zeros_far_from_all_others_are_a_doubt_and_stay(tmp_path: Path) -> None:
    cells = land().cells
    values = np.linspace(24.0, 36.0, len(cells))
    values[3:9] = 0.0
    found = read_covariate(table(tmp_path / "ec.csv", cells, values), land())
    (finding,) = found.findings
    assert (finding.seen, finding.severity) == (
        "6 points hold 0 where others hold 24 to 36",
        "doubt",
    )
    assert (found.values == 0).sum() == 6


def test_points_with_codes_or_without_a_value_are_counted(tmp_path: Path) -> None:
    cells = land().cells
    path = table(
        tmp_path / "ec.csv", cells, np.where(np.arange(len(cells)) < 4, -9999, plane(cells))
    )
    lines = path.read_text().splitlines()
    for k, blank in ((50, ""), (51, "NA"), (52, "-")):
        lines[k] = lines[k].rpartition(",")[0] + f",{blank}"
    path.write_text("\n".join(lines))
    found = read_covariate(path, land())
    assert [(f.seen.split(" where")[0], f.severity) for f in found.findings] == [
        ("4 points hold -9999", "left out"),
        ("3 points have no value", "note"),
    ]
    assert_allclose(found.values, plane(cells), atol=8)


def test_points_with_their_degrees_swapped_are_named(tmp_path: Path) -> None:
    cells = land().cells
    lonlat = project(UTM, WGS84, *cells.T)
    path = table(tmp_path / "ec.csv", lonlat, plane(cells), "lat,lon,ec")
    assert "swapping latitude and longitude puts them inside" in refused(path)


def test_frames_that_nothing_leads_between_are_refused(tmp_path: Path) -> None:
    assert "name the CRS of both" in refused(raster(tmp_path / "ec.tif", land()), land(""))


def test_a_constant_covariate_is_refused(tmp_path: Path) -> None:
    cells = land().cells
    path = table(tmp_path / "flat.csv", cells, np.full(len(cells), 7.0))
    assert "it is 7 in all" in refused(path)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("easting,northing,ec,yield\n0,0,1,2\n", "2 columns may be meant"),
        ("easting,northing\n0,0\n", "0 columns may be meant"),
        ("ec\n1\n", "no columns say where"),
        ("easting,northing,ec\n681001,5900001,much\n", "row 2"),
        ("easting,northing,ec\n681001,5900001\n", "row 2: cells are missing"),
        ("easting,northing,ec\n681001,5900001,\n", "no values"),
        ("easting,northing,ec\n681001,5900001,4\n", "cells, the first at"),
    ],
)
def test_a_table_that_cannot_be_used_is_refused(tmp_path: Path, text: str, said: str) -> None:
    path = tmp_path / "ec.csv"
    path.write_text(text)
    assert said in refused(path)


def test_a_column_that_is_not_there_and_other_files_are_refused(tmp_path: Path) -> None:
    cells = land().cells
    path = table(tmp_path / "ec.csv", cells, plane(cells))
    assert "there is no column 'deep'" in refused(path, column="deep")
    assert "no such file" in refused(tmp_path / "none.tif")
    other = tmp_path / "ec.docx"
    other.write_text("x")
    assert "with this suffix" in refused(other)
    broken = tmp_path / "broken.tif"
    broken.write_text("x")
    assert "no tif file by its content" in refused(broken)
