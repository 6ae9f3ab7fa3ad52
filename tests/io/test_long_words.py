"""Words of a file without end: as much of them in an error or a note as tells which is meant."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from subsoil.errors import BoundaryError, InputError, brief, listed
from subsoil.io.read.boundary import read_field
from subsoil.io.read.covariate import read_covariate
from subsoil.io.read.readings import read_readings
from subsoil.land.crs import check_metric, project
from subsoil.land.field import Field

LONG = "x" * 5000
RING = [[-0.5, 53], [-0.498, 53], [-0.498, 53.002], [-0.5, 53]]
HOME = Field.from_metres([(0, 0), (60, 0), (60, 40), (0, 40)], name="home")
FEET = (
    f'LOCAL_CS["{LONG}",UNIT["{LONG}",0.3],AXIS["Easting",EAST],AXIS["Northing",NORTH]]'
)  # fmt: skip
MOST = 400


def geojson(**members: Any) -> str:
    return json.dumps({"type": "Polygon", "coordinates": [RING], **members})


def framed(name: str) -> str:
    return geojson(crs={"type": "name", "properties": {"name": name}})


def row(name: str) -> str:
    return f"easting,northing,{name}\n1,2,500\n3,4,600\n"


FILES: dict[str, tuple[Callable[[Path], object], str, str]] = {
    "frame of an outline": (read_field, "a.geojson", framed(LONG)),
    "unit of a frame": (read_field, "a.geojson", framed(FEET)),
    "kind of shape": (read_field, "a.geojson", geojson(type=LONG)),
    "member twice": (read_field, "a.geojson", f'{{"{LONG}":1,"{LONG}":2}}'),
    "entity of a KML": (read_field, "a.kml", f"<kml>&{LONG};</kml>"),
    "root of a KML": (read_field, "a.kml", f"<{LONG}/>"),
    "header of corners": (read_field, "a.csv", f"{LONG},y\n1,2\n"),
    "corner": (read_field, "a.coords", f"{LONG}\n"),
    "corner with commas": (read_field, "a.coords", f"1{'0' * 5000},5 2,5\n"),
    "thousands": (read_field, "a.coords", f"{'1.000' + '.000' * 2000}, 5\n"),
    "cell": (read_readings, "a.csv", f"easting,northing,kpa_5cm\n5,6,{LONG}\n"),
    "heading": (read_readings, "a.csv", row(f"kpa_{'1' * 5000}")),
    "unit": (read_readings, "a.csv", row(f"{LONG}_5cm")),
    "depth": (read_readings, "a.csv", row(f"kpa_{'9' * 5000}cm")),
    "other columns": (read_readings, "a.csv", f"easting,northing,{LONG},force_{LONG}_5,5cm\n"),
    "names of a log": (read_readings, "a.yaml", f"names: [{LONG}]\ndata: []\n"),
    "alias of a log": (read_readings, "a.yaml", f"names: *{LONG}\n"),
    "column of a covariate": (
        lambda path: read_covariate(path, HOME),
        "a.csv",
        f"easting,northing,{LONG},y{LONG}\n1,2,3,4\n",
    ),
}


@pytest.mark.parametrize("case", FILES)
def test_an_error_holds_as_much_of_a_file_as_tells_which_word_is_meant(
    tmp_path: Path, case: str
) -> None:
    read, name, text = FILES[case]
    path = tmp_path / name
    path.write_text(text)
    with pytest.raises(InputError) as caught:
        read(path)
    assert len(str(caught.value)) < MOST


def test_errors_about_frames_hold_as_much_of_their_names_as_tells_them_apart() -> None:
    for call in (
        lambda: project(LONG, "EPSG:32630", [0.0], [0.0]),
        lambda: project("EPSG:32630", "", [0.0], [0.0]),
        lambda: check_metric(FEET, "home"),
        lambda: Field.from_metres([(0, 0), (60, 0), (60, 40)], crs=LONG),
    ):
        with pytest.raises(BoundaryError) as caught:
            call()
        assert len(str(caught.value)) < MOST


def test_short_words_and_lists_stay_as_they_are() -> None:
    assert brief("EPSG:32630") == "EPSG:32630"
    assert brief("a" * 40) == "a" * 40
    assert brief("a" * 41) == "a" * 40 + "..."
    assert listed(["a", "b"]) == "a, b"
    assert listed(["a" * 50]) == "a" * 40 + "..."
    assert listed([]) == ""
