"""Places of pushes from a second file: joined by number or time, or named where they are not."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from datetime import datetime, timedelta
from pathlib import Path

import numpy as np
import pytest
import shapely

from subsoil.errors import ReadingsError
from subsoil.findings import left_out
from subsoil.io.read.joining import Positions, located
from subsoil.io.read.position_files import read_positions
from subsoil.io.read.readings import read_readings
from subsoil.io.read.recording import Record, Recording

Write = Callable[[str, str], Path]
DEPTH_M = np.array([0.1, 0.2])
NOON = datetime(2026, 4, 1, 12, 0, 0)
PLACES = {"1": (5.6426, 52.0961), "2": (5.6431, 52.0960), "3": (5.6434, 52.0962)}
SC900 = (
    "Datum: WGS 84\nSoil Compation In KPa\n"
    "Longitude,Latitude,Number,0.0 cm,2.5 cm,5.0 cm,Cone Size\n"
    ",,N= 1 , 0 , 300 , 500 ,1/2 Inch\n"
    ",,Logger Started\n"
    ",,N= 1 , 0 , 310 , 510 ,1/2 Inch\n"
    ",,N= 2 , 0 , 320 , 520 ,1/2 Inch\n"
)


@pytest.fixture
def write(tmp_path: Path) -> Write:
    def save(name: str, text: str) -> Path:
        path = tmp_path / name
        path.write_text(text)
        return path

    return save


def pushes(*times: datetime | None, numbers: str = "") -> Recording:
    """Pushes without a place, at these times or with these numbers."""
    called = numbers.split() or [""] * len(times)
    records = (
        Record(
            row, np.nan, np.nan, DEPTH_M, np.array([500.0, 900.0 + row]), number=number, time=time
        )
        for row, (number, time) in enumerate(
            zip(called, times or [None] * len(called), strict=True), 2
        )
    )
    return Recording(tuple(records), (), "none", "kpa")


def positions(
    *xy: tuple[float, float], numbers: str = "", times: tuple[datetime, ...] = ()
) -> Positions:
    x, y = np.array(xy, dtype=float).T
    called = numbers.split() or [""] * len(xy)
    return Positions("gps.csv", "lonlat", x, y, called, times or (None,) * len(xy))


def at(recording: Recording) -> dict[int, float]:
    """Longitudes by row."""
    return {record.row: record.x for record in recording.records}


def said(recording: Recording) -> list[str]:
    return [str(finding) for finding in recording.findings]


# By number


def test_positions_are_joined_by_number_whatever_their_order() -> None:
    found = located(
        pushes(numbers="1 02 3"), positions((3, 0), (1, 0), (2, 0), numbers="3 1 2"), "a.txt"
    )
    assert at(found) == {2: 1.0, 3: 2.0, 4: 3.0}
    assert (found.frame, found.findings) == ("lonlat", ())


def test_a_push_without_a_position_is_named_and_a_position_without_a_push_is_noted() -> None:
    found = located(pushes(numbers="1 2"), positions((1, 0), (9, 0), numbers="1 7"), "a.txt")
    assert at(found) == {2: 1.0}
    assert [each.severity for each in found.findings] == ["left out", "note"]
    assert said(found) == [
        "row 3: push 2: gps.csv has no position with its number; left out",
        "gps.csv: 1 positions are of no push: 7; not used",
    ]


def test_a_number_with_two_places_is_ambiguous_and_one_with_the_same_place_twice_is_not() -> None:
    far = positions((1, 0), (1, 0.1), (2, 0), (2, 0), numbers="1 1 2 2")
    found = located(pushes(numbers="1 2"), far, "a.txt")
    assert at(found) == {3: 2.0}
    assert said(found) == [
        "row 2: push 1: gps.csv has 2 positions with its number, not at one place; left out"
    ]


def test_two_pushes_of_one_number_are_a_doubt() -> None:
    found = located(pushes(numbers="1 1"), positions((1, 0), numbers="1"), "a.txt")
    assert said(found) == [
        "row 2: 2 pushes take one position: rows 2, 3; check their numbers or times"
    ]


# By time


def test_positions_are_joined_by_the_nearest_time() -> None:
    track = positions(
        *((k * 1e-6, 0.0) for k in range(600)),
        times=tuple(NOON + timedelta(seconds=k) for k in range(600)),
    )
    found = located(
        pushes(NOON + timedelta(seconds=100), NOON + timedelta(seconds=400)), track, "a.csv"
    )
    assert at(found) == pytest.approx({2: 100e-6, 3: 400e-6})
    assert found.findings == ()


def test_a_time_beyond_the_tolerance_is_left_out() -> None:
    stops = positions((1, 0), (2, 0), times=(NOON, NOON + timedelta(minutes=10)))
    near = NOON + timedelta(seconds=29), NOON + timedelta(minutes=10, seconds=31)
    found = located(pushes(*near), stops, "a.csv")
    assert at(found) == {2: 1.0}
    assert "gps.csv has no position with a time within 30 s of it" in said(found)[0]


def test_a_time_between_two_places_is_ambiguous() -> None:
    stops = positions((1, 0), (2, 0), times=(NOON, NOON + timedelta(seconds=20)))
    found = located(pushes(NOON + timedelta(seconds=10), NOON), stops, "a.csv")
    assert at(found) == {3: 1.0}
    assert "has 2 positions with a time within 30 s of it, not at one place" in said(found)[0]


@pytest.mark.parametrize(("hours", "way"), [(2, "back"), (-5.5, "forward")])
def test_clocks_of_two_time_zones_are_named_and_not_mended(hours: float, way: str) -> None:
    times = tuple(NOON + timedelta(minutes=3 * k) for k in range(20))
    stops = positions(*((k, 0) for k in range(20)), times=times)
    taken = [time + timedelta(hours=hours) for time in times[:15]]
    with pytest.raises(ReadingsError, match=rf"put {abs(hours):g} h {way}.*one time zone"):
        located(pushes(*taken), stops, "a.csv")


def test_files_with_nothing_in_common_are_refused() -> None:
    with pytest.raises(ReadingsError, match="neither the number nor the time of any push"):
        located(pushes(numbers="1 2"), positions((1, 0)), "a.txt")


# Without positions, and with both


def test_pushes_without_any_position_are_refused_with_the_remedy() -> None:
    with pytest.raises(ReadingsError, match=r"none of 2 pushes has a position.*--positions FILE"):
        located(pushes(numbers="1 2"), None, "a.txt")


def some_placed() -> Recording:
    one, two = pushes(numbers="1 2").records
    own = replace(one, x=5.0, y=52.0)
    return Recording((own, two), (), "lonlat", "kpa")


def test_a_push_without_a_position_among_others_is_left_out_and_named() -> None:
    found = located(some_placed(), None, "a.txt")
    assert said(found) == ["row 3: no position; left out, or give --positions"]
    assert len(left_out(found.findings)) == 1


def test_positions_fill_only_what_the_instrument_lacks() -> None:
    found = located(some_placed(), positions((1, 0), (2, 0), numbers="1 2"), "a.txt")
    assert at(found) == {2: 5.0, 3: 2.0}


def test_positions_in_another_frame_than_the_instruments_are_refused() -> None:
    metres = positions((1, 0), numbers="2")
    metres = Positions("gps.csv", "metres", metres.x, metres.y, metres.numbers, metres.times)
    with pytest.raises(ReadingsError, match="another frame"):
        located(some_placed(), metres, "a.txt")


# Files

TABLE = "number,lat,lon\n" + "".join(f"{n},{y},{x}\n" for n, (x, y) in PLACES.items())
GPX = (
    '<?xml version="1.0" encoding="UTF-8"?>\n<gpx xmlns="http://www.topografix.com/GPX/1/1">'
    + "".join(
        f'<wpt lat="{y}" lon="{x}"><time>2026-04-01T12:0{n}:00Z</time><name>00{n}</name></wpt>'
        for n, (x, y) in PLACES.items()
    )
    + "</gpx>"
)
GEOJSON = json.dumps(
    {
        "type": "FeatureCollection",
        "features": [
            {
                "type": "Feature",
                "geometry": {"type": "Point", "coordinates": [x, y, 12.0]},
                "properties": {"push": int(n), "time": f"2026-04-01T12:0{n}:00+00:00"},
            }
            for n, (x, y) in PLACES.items()
        ],
    }
)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("p.csv", TABLE),
        ("p.csv", TABLE.replace(",", ";").replace(".", ",")),
        ("p.csv", TABLE.replace("number", "ID").replace(",", "\t")),
        ("p.gpx", GPX),
        ("p.gpx", GPX.replace("wpt", "trkpt")),
        ("p.geojson", GEOJSON),
    ],
)
def test_an_sc_900_without_a_receiver_takes_its_places_from_another_file(
    write: Write, name: str, text: str
) -> None:
    readings = read_readings(write("walk.txt", SC900), positions=write(name, text))
    alone = write("places.csv", TABLE.replace("number", "kpa_5cm"))
    np.testing.assert_allclose(readings.at, read_readings(alone).at, atol=0.02)
    assert [profile.kpa[-1] for profile in readings.profiles] == [500, 510, 520]


@pytest.mark.parametrize("crs", ["EPSG:4326", "EPSG:32631"])
@pytest.mark.parametrize("suffix", ["gpkg", "shp"])
def test_points_of_a_geopackage_or_shapefile_are_positions(
    tmp_path: Path, crs: str, suffix: str
) -> None:
    pyogrio = pytest.importorskip("pyogrio")
    from subsoil.land.crs import project

    path = tmp_path / f"p.{suffix}"
    lonlat = np.array(list(PLACES.values()))
    there = project("EPSG:4326", crs, *lonlat.T) if crs != "EPSG:4326" else lonlat
    pyogrio.raw.write(
        path,
        np.array([shapely.to_wkb(point) for point in np.asarray(shapely.points(there))]),
        [np.array([1, 2, 3])],
        ["push"],
        geometry_type="Point",
        crs=crs,
    )
    found = read_positions(path)
    assert list(found.numbers) == ["1", "2", "3"]
    np.testing.assert_allclose(np.column_stack([found.x, found.y]), there, atol=1e-9)
    assert found.frame == ("lonlat" if crs == "EPSG:4326" else "metres")


def test_times_of_a_file_are_read(write: Write) -> None:
    for name, text in (("p.gpx", GPX), ("p.geojson", GEOJSON)):
        first = read_positions(write(name, text)).times[0]
        assert first is not None
        assert first.isoformat() == "2026-04-01T12:01:00+00:00"


def test_gpx_that_declares_entities_is_refused(write: Write) -> None:
    bomb = '<!DOCTYPE gpx [<!ENTITY a "b"><!ENTITY x SYSTEM "file:///etc/passwd">]><gpx>&x;</gpx>'
    with pytest.raises(ReadingsError, match="declares entities"):
        read_positions(write("p.gpx", bomb))


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("p.gpx", "<gpx><wpt", "not XML"),
        ("p.gpx", "<gpx></gpx>", "holds no positions"),
        ("p.csv", "number,a,b\n1,2,3\n", "no columns say where it was; it has number, a, b"),
        ("p.csv", "number,lat,lon\n1,x,5\n", "holds no positions; first row 2: 'x' is no latitude"),
        ("p.json", "{", "not JSON"),
    ],
)
def test_a_file_that_holds_no_positions_is_refused(
    write: Write, name: str, text: str, message: str
) -> None:
    with pytest.raises(ReadingsError, match=message):
        read_positions(write(name, text))


def test_a_position_that_cannot_be_read_is_named_and_its_push_too(write: Write) -> None:
    table = TABLE.replace("52.096,", "52.0x96,")
    readings = read_readings(write("walk.txt", SC900), positions=write("p.csv", table))
    assert len(readings) == 2
    assert [(each.file, each.row) for each in left_out(readings.findings)] == [
        ("p.csv", 3),
        ("walk.txt", 6),
    ]
