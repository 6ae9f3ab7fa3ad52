"""Readings near the fence, far from the field, and what explains that they lie elsewhere."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import ArrayLike
from shapely.geometry import box

from subsoil.errors import ReadingsError
from subsoil.findings import left_out
from subsoil.io.read.readings import read_readings
from subsoil.land.crs import project
from subsoil.land.field import Field

YARD = Field(box(0, 0, 100, 100), keep_outs=(box(40, 40, 60, 60),), name="yard")
PLACES = {
    "Kenya": (36.8, -1.2), "India": (77.2, 20.1), "Ethiopia": (38.7, 9.0), "Ukraine": (31.2, 49.4),
    "Britain": (-1.0, 52.0),
}  # fmt: skip


def home(place: str) -> Field:
    west, south = PLACES[place]
    return Field.from_lonlat(box(west, south, west + 0.003, south + 0.003), name="home")


def table(path: Path, x: ArrayLike, y: ArrayLike, header: str) -> Path:
    rows = [
        f"{a!r},{b!r},900"
        for a, b in zip(np.asarray(x).tolist(), np.asarray(y).tolist(), strict=True)
    ]
    path.write_text("\n".join([f"{header},kpa_10cm", *rows]))
    return path


def inside(field: Field) -> tuple[np.ndarray, np.ndarray]:
    lonlat = field.to_lonlat(field.cells[100:2000:150])
    return lonlat[:, 0], lonlat[:, 1]


def test_readings_at_the_fence_count_where_they_were_taken_and_are_noted(tmp_path: Path) -> None:
    path = table(
        tmp_path / "walk.csv", [50, -4.9, 103, 41, 50], [20, 50, 50, 50, 107], "easting,northing"
    )
    found = read_readings(path, field=YARD)
    assert found.at.tolist() == [[50, 20], [-4.9, 50], [103, 50], [41, 50]]
    assert [str(f) for f in found.findings if f.row] == [
        "row 3: 4.9 m outside the field; used where it was taken",
        "row 4: 3 m outside the field; used where it was taken",
        "row 5: 1 m inside a keep-out; used where it was taken",
        "row 6: 7 m outside the field; left out",
    ]


@pytest.mark.parametrize(("fence", "used"), [(0.0, 1), (3.0, 3), (10.0, 4)])
def test_the_fence_is_as_wide_as_asked_for(tmp_path: Path, fence: float, used: int) -> None:
    path = table(tmp_path / "walk.csv", [50, 20, 103, 108], [20, 20, 50, 50], "easting,northing")
    found = read_readings(path, field=YARD, fence_m=fence)
    assert len(found) == max(used, 2)
    assert len(left_out(found.findings)) == 4 - len(found)


@pytest.mark.parametrize("place", PLACES)
def test_swapped_degrees_of_readings_are_named(tmp_path: Path, place: str) -> None:
    field = home(place)
    x, y = inside(field)
    with pytest.raises(ReadingsError, match="swapping latitude and longitude puts them inside"):
        read_readings(table(tmp_path / "a.csv", x, y, "lat,lon"), field=field)


@pytest.mark.parametrize("place", ["Kenya", "Ethiopia", "Ukraine"])
def test_an_outline_with_swapped_degrees_is_named_where_the_map_cannot_tell(
    tmp_path: Path, place: str
) -> None:
    west, south = PLACES[place]
    swapped = Field.from_lonlat(box(south, west, south + 0.003, west + 0.003), name="home")
    x, y = inside(home(place))
    with pytest.raises(
        ReadingsError, match=r"puts them inside .* or mend the outline, at latitude"
    ):
        read_readings(table(tmp_path / "a.csv", y, x, "lat,lon"), field=swapped)


@pytest.mark.parametrize(
    ("east", "north", "said"), [(-1, 1, "longitude"), (1, -1, "latitude"), (-1, -1, "both")]
)
def test_a_wrong_sign_is_named(tmp_path: Path, east: int, north: int, said: str) -> None:
    field = home("Kenya")
    x, y = inside(field)
    with pytest.raises(ReadingsError, match=f"the other sign of {said} puts them inside"):
        read_readings(table(tmp_path / "a.csv", north * y, east * x, "lat,lon"), field=field)


def test_swapped_eastings_feet_and_a_neighbours_zone_are_named(tmp_path: Path) -> None:
    field = home("Ukraine")
    x, y = field.cells[100:2000:150].T
    header = "easting,northing"
    for first, second, words in (
        (y, x, "swapping easting and northing puts them inside"),
        (x / 0.3048, y / 0.3048, "taken as feet they lie inside"),
        (*inside(field), "taken as degrees they lie inside|these look like degrees"),
        (*project(field.crs, "EPSG:32635", x, y).T, r"in EPSG:32635 .*--crs EPSG:32635"),
        (*project(field.crs, "EPSG:3857", x, y).T, r"in EPSG:3857 .*--crs EPSG:3857"),
        (x / 1000, y / 1000, "look like kilometres"),
    ):
        with pytest.raises(ReadingsError, match=words):
            read_readings(table(tmp_path / "a.csv", first, second, header), field=field)


def test_readings_in_wgs84_reach_a_field_on_the_british_grid(tmp_path: Path) -> None:
    corners = project("EPSG:4326", "EPSG:27700", [-1.0, -0.997, -0.997], [52.0, 52.0, 52.003])
    field = Field.from_metres(corners, crs="EPSG:27700", name="home")
    found = read_readings(
        table(tmp_path / "a.csv", [52.0005, 52.001], [-0.998, -0.9975], "lat,lon"), field=field
    )
    assert (len(found), found.crs) == (2, "EPSG:27700")


def test_readings_over_the_antimeridian_share_a_frame(tmp_path: Path) -> None:
    path = table(
        tmp_path / "a.csv", [-16.8, -16.8001, -16.8], [179.9995, -179.9995, 179.9999], "lat,lon"
    )
    found = read_readings(path)
    assert found.crs == "EPSG:32760"
    assert np.ptp(found.at[:, 0]) == pytest.approx(107, abs=1)
