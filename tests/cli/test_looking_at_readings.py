"""map, variogram and cv: what they leave out, and what they say of it."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from subsoil.land.crs import project

Cli = Callable[..., Any]
TWO = ("--layers", "0,0.05,0.1")
CORNERS = [(5.640, 52.096), (5.643, 52.096), (5.643, 52.0975), (5.640, 52.0975)]


def arguments(verb: str, readings: Path, outline: Path) -> tuple[object, ...]:
    maps = ("--boundary", outline, "--out", readings.parent / "m") if verb == "map" else ()
    return (verb, readings, *maps, *TWO)


@pytest.mark.parametrize("verb", ["map", "variogram", "cv"])
def test_rows_left_out_are_named_on_the_screen_and_in_json(
    cli: Cli, outline: Path, readings: Path, verb: str
) -> None:
    readings.write_text(readings.read_text() + "20,20,x,900\n21,21,-5,900\n")
    told = cli(*arguments(verb, readings, outline), "--json")
    assert told.code == 1
    found = told.json
    assert found["samples"] == 12
    where = [line.split(":")[0] for line in found["refused"]]
    assert where == ["row 14, column kpa_5cm", "row 15"]
    shown = cli(*arguments(verb, readings, outline)).out
    assert "row 14" in shown
    assert "no soil strength" in shown


@pytest.mark.parametrize("verb", ["map", "variogram", "cv"])
def test_what_is_odd_about_a_file_is_said_by_every_verb(
    cli: Cli, outline: Path, readings: Path, verb: str
) -> None:
    lines = readings.read_text().splitlines()
    head, *rows = (line.split(",") for line in lines)
    soft = [[x, y, str(float(a) / 1000), str(float(b) / 1000), "24"] for x, y, a, b in rows]
    table = [[*head, "vwc_10cm"], *soft]
    readings.write_text("\n".join(",".join(row) for row in table) + "\n")
    notes = " ".join(cli(*arguments(verb, readings, outline), "--json").json["notes"])
    assert "columns left alone: vwc_10cm" in notes
    assert "any soil's strength" in notes
    assert "vwc_10cm" in cli(*arguments(verb, readings, outline)).out


@pytest.mark.parametrize("verb", ["map", "cv"])
def test_a_layer_without_pattern_is_said_to_be_no_better_than_its_mean(
    cli: Cli, tmp_path: Path, outline: Path, verb: str
) -> None:
    rng = np.random.default_rng(4)
    rows = [
        f"{5 + 10 * i},{5 + 10 * j},{400 + 60 * i},{rng.uniform(800, 1600):.0f}"
        for i in range(6)
        for j in range(4)
    ]
    readings = tmp_path / "readings.csv"
    readings.write_text("easting,northing,kpa_5cm,kpa_10cm\n" + "\n".join(rows) + "\n")
    found = cli(*arguments(verb, readings, outline), "--json").json
    layers = {row["layer"]: row["loo_skill"] for row in found["layers"]}
    said = [note.split(":")[0] for note in found["notes"] if "does not beat" in note]
    assert said == [name for name, skill in layers.items() if skill <= 0]
    assert said, layers
    assert "does not beat the field's mean" in cli(*arguments(verb, readings, outline)).out


def test_a_field_in_web_mercator_is_mapped_in_metres_on_the_ground(
    cli: Cli, tmp_path: Path
) -> None:
    corners = project("EPSG:4326", "EPSG:3857", *np.transpose(CORNERS)).tolist()
    drawn = {
        "type": "Polygon",
        "crs": {"type": "name", "properties": {"name": "EPSG:3857"}},
        "coordinates": [[*corners, corners[0]]],
    }
    (tmp_path / "field.geojson").write_text(json.dumps(drawn))
    lon, lat = np.meshgrid(np.linspace(5.6405, 5.6425, 4), np.linspace(52.0962, 52.0973, 4))
    places = project("EPSG:4326", "EPSG:3857", lon.ravel(), lat.ravel())
    rows = [f"{x!r},{y!r},{500 + 3 * k},{900 + 5 * k}" for k, (x, y) in enumerate(places.tolist())]
    (tmp_path / "r.csv").write_text("easting,northing,kpa_5cm,kpa_10cm\n" + "\n".join(rows) + "\n")
    found = cli(
        "map", tmp_path / "r.csv", "--boundary", tmp_path / "field.geojson",
        "--crs", "EPSG:3857", "--out", tmp_path / "m", *TWO, "--json",
    ).json  # fmt: skip
    assert found["area_ha"] == pytest.approx(3.43, abs=0.02)
    assert found["samples"] == 16
    assert "kept in EPSG:32631" in found["notes"][0]


def test_figures_of_a_map_come_in_the_format_that_is_asked_for(
    cli: Cli, outline: Path, readings: Path
) -> None:
    made = cli(*arguments("map", readings, outline), "--figures", "pdf", "--json").json["figures"]
    names = ["depth_slices.pdf", "std_dev.pdf", "variograms.pdf", "profiles.pdf"]
    assert [Path(path).name for path in made] == names
    assert all(Path(path).read_bytes().startswith(b"%PDF-") for path in made)
