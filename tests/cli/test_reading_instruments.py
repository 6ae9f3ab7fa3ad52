"""Files of instruments on the command line: what is read, forced, joined, refused and listed."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from subsoil.io.read.readings import READERS

Cli = Callable[..., Any]
TWO = ("--layers", "0,0.05,0.1")
HEAD = (
    "Datum: WGS 84\nSoil Compation In KPa\n"
    "Longitude,Latitude,Number,0.0 cm,2.5 cm,5.0 cm,7.5 cm,10.0 cm,Cone Size\n"
)
PLACES = {k: (5.6400123 + 0.0003 * (k % 4), 52.0960045 + 0.0002 * (k // 4)) for k in range(1, 13)}


def sc900(path: Path, *, placed: bool) -> Path:
    rows = (
        (f"{x:.7f},{y:.7f}" if placed else ",")
        + f",N= {k} , 0 , {300 + k} , 500 , {900 + k} , 990 ,"
        "1/2 Inch\n"
        for k, (x, y) in PLACES.items()
    )
    path.write_text(HEAD + "".join(rows))
    return path


@pytest.fixture
def walk(tmp_path: Path) -> Path:
    return sc900(tmp_path / "walk.txt", placed=True)


def test_an_instruments_file_is_told_apart_by_content_and_read(cli: Cli, walk: Path) -> None:
    shown = cli("cv", walk, *TWO, "--json")
    assert shown.code == 0
    assert shown.json["samples"] == 12
    assert shown.json["findings"] == []
    assert cli("cv", walk.rename(walk.with_suffix(".dat")), *TWO, "--json").out == shown.out


@pytest.mark.parametrize("verb", ["cv", "variogram", "map"])
def test_every_verb_joins_positions(cli: Cli, tmp_path: Path, verb: str) -> None:
    bare = sc900(tmp_path / "bare.txt", placed=False)
    places = tmp_path / "places.csv"
    rows = (f"{k},{y},{x}\n" for k, (x, y) in list(PLACES.items())[:-1])
    places.write_text("number,lat,lon\n" + "".join(rows))
    box = [[5.639, 52.095], [5.642, 52.095], [5.642, 52.098], [5.639, 52.098], [5.639, 52.095]]
    outline = tmp_path / "field.geojson"
    outline.write_text(json.dumps({"type": "Polygon", "coordinates": [box]}))
    maps = ("--boundary", outline, "--out", tmp_path / "m") if verb == "map" else ()
    found = cli(verb, bare, *maps, *TWO, "--positions", places, "--json")
    assert found.code == 1
    assert found.json["samples"] == 11
    (finding,) = [each for each in found.json["findings"] if each["severity"] == "left out"]
    assert finding["seen"] == "push 12: places.csv has no position with its number"
    without = cli(verb, bare, *maps, *TWO)
    assert without.code == 2
    assert "none of 12 pushes has a position" in without.err
    assert "--positions FILE" in without.err


def test_a_reader_can_be_forced(cli: Cli, walk: Path) -> None:
    assert cli("cv", walk, *TWO, "--reader", "sc900").code == 0
    wrong = cli("cv", walk, *TWO, "--reader", "gef")
    assert wrong.code == 2
    assert "walk.txt" in wrong.err
    unknown = cli("cv", walk, *TWO, "--reader", "sc9000")
    assert unknown.code == 2
    assert all(name in unknown.err for name in READERS)


def test_doctor_lists_the_readers(cli: Cli) -> None:
    assert cli("doctor", "--json").json["readers"] == {k: r.name for k, r in READERS.items()}
    shown = cli("doctor").out
    assert "FieldScout SC 900" in shown
    assert "penetrologger" in shown


def test_motor_effort_is_refused_with_the_reason(cli: Cli, tmp_path: Path) -> None:
    log = tmp_path / "Waypoint1.log"
    log.write_text("".join(f"{1503665159 + k // 90}, 21, 480.0, 25\n" for k in range(1800)))
    refused = cli("cv", log)
    assert refused.code == 2
    assert "motor effort in percent" in refused.err
    assert "no force" in refused.err


def test_a_cone_in_cm2_is_refused_with_the_remedy(cli: Cli, walk: Path) -> None:
    for area in (1.3, 13_000):
        refused = cli("cv", walk, *TWO, "--cone-area", area)
        assert refused.code == 2
        assert "1 cm2 is 100 mm2" in refused.err
