"""Stops as files: any GIS and any receiver finds them where they are, in their order."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pyogrio.raw
import pytest
import shapely

from subsoil.errors import ParameterError
from subsoil.io.write.stops import write_stops
from subsoil.land.field import Field

OUTLINE = shapely.Polygon([(-0.53, 53.26), (-0.528, 53.26), (-0.528, 53.262), (-0.53, 53.262)])
ON_EARTH = Field.from_lonlat(OUTLINE)
LOCAL = Field.from_metres([(0, 0), (60, 0), (60, 40), (0, 40)])


@pytest.fixture
def stops() -> np.ndarray:
    return ON_EARTH.cells[[40, 3, 17, 25]]


@pytest.mark.parametrize("name", ["stops.gpx", "stops.kml", "stops.geojson", "STOPS.GPX"])
def test_any_gis_finds_the_stops_in_order_to_a_centimetre(
    tmp_path: Path, stops: np.ndarray, name: str
) -> None:
    path = write_stops(tmp_path / name, ON_EARTH, stops)
    layer = "waypoints" if name.lower().endswith("gpx") else None
    _, _, geometry, fields = pyogrio.raw.read(path, layer=layer)
    at = shapely.get_coordinates(shapely.from_wkb(geometry))
    np.testing.assert_allclose(at, ON_EARTH.to_lonlat(stops), atol=5.1e-8)
    assert ["1", "2", "3", "4"] in [list(map(str, column)) for column in fields]


def test_a_table_of_stops_has_seven_decimals(tmp_path: Path, stops: np.ndarray) -> None:
    path = write_stops(tmp_path / "stops.csv", ON_EARTH, stops)
    head, first, *_ = csv.reader(path.read_text().splitlines())
    assert head == ["stop", "lat", "lon"]
    longitude, latitude = ON_EARTH.to_lonlat(stops)[0]
    assert first == ["1", f"{latitude:.7f}", f"{longitude:.7f}"]


def test_stops_of_a_local_frame_are_a_table_in_metres(tmp_path: Path) -> None:
    path = write_stops(tmp_path / "stops.csv", LOCAL, [(7.5, 32.5)])
    assert path.read_text().splitlines() == ["stop,northing,easting", "1,32.500,7.500"]
    for name in ("stops.gpx", "stops.kml", "stops.geojson"):
        with pytest.raises(ParameterError, match="local frame"):
            write_stops(tmp_path / name, LOCAL, [(7.5, 32.5)])


def test_nothing_is_written_of_no_stops_or_in_no_known_format(
    tmp_path: Path, stops: np.ndarray
) -> None:
    with pytest.raises(ParameterError, match="no stops"):
        write_stops(tmp_path / "stops.csv", ON_EARTH, np.empty((0, 2)))
    with pytest.raises(ParameterError, match=r"\.doc"):
        write_stops(tmp_path / "stops.doc", ON_EARTH, stops)
    assert not list(tmp_path.iterdir())


def test_a_file_that_cannot_be_written_leaves_the_one_before(
    tmp_path: Path, stops: np.ndarray, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = write_stops(tmp_path / "stops.gpx", ON_EARTH, stops)
    before = path.read_bytes()

    def fail(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(pyogrio.raw, "write", fail)
    with pytest.raises(OSError, match="No space"):
        write_stops(path, ON_EARTH, stops[:2])
    assert path.read_bytes() == before
    assert [each.name for each in tmp_path.iterdir()] == ["stops.gpx"]
