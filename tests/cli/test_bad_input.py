"""Bad input: one line that names the file, row or parameter and the remedy; nothing lost."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

Cli = Callable[..., Any]

SQUARE = (
    "[[-0.5278,53.2624],[-0.5274,53.2609],[-0.5230,53.2607],[-0.5225,53.2630],[-0.5278,53.2624]]"
)
BOUNDARIES = {
    "empty": ("f.geojson", "", ["f.geojson", "empty"]),
    "no polygon": ("f.geojson", '{"type":"Point","coordinates":[0,1]}', ["f.geojson", "Point"]),
    "self-crossing": (
        "f.geojson",
        '{"type":"Polygon","coordinates":[[[0,50],[0.01,50.01],[0.01,50],[0,50.01],[0,50]]]}',
        ["f.geojson", "not valid"],
    ),
    "swapped": (
        "f.coords",
        "-0.5278,53.2624\n-0.5274,53.2609\n-0.5230,53.2607\n",
        ["f.coords", "swapped"],
    ),
    "degrees as metres": (
        "f.csv",
        "easting,northing\n-0.5278,53.2624\n-0.5274,53.2609\n-0.5230,53.2607\n",
        ["f.csv", "degrees"],
    ),
    "not a number": ("f.csv", "easting,northing\n0,0\n60,x\n60,40\n", ["f.csv", "3"]),
}


def assert_one_line(outcome: Any, code: int, *words: str) -> None:
    assert outcome.code == code, outcome
    assert outcome.err.count("\n") == 1, outcome.err
    assert outcome.err.startswith("error: ")
    assert "Traceback" not in outcome.err
    for word in words:
        assert word in outcome.err, outcome.err


@pytest.mark.parametrize("case", BOUNDARIES)
def test_a_boundary_that_cannot_be_used(cli: Cli, tmp_path: Path, case: str) -> None:
    name, text, words = BOUNDARIES[case]
    path = tmp_path / name
    path.write_text(text)
    assert_one_line(cli("init", tmp_path / "s.gpkg", "--boundary", path), 2, *words)
    assert not (tmp_path / "s.gpkg").exists()


def test_a_boundary_that_is_not_there(cli: Cli, tmp_path: Path) -> None:
    outcome = cli("init", tmp_path / "s.gpkg", "--boundary", tmp_path / "none.geojson")
    assert_one_line(outcome, 2, "none.geojson")


def test_readings_outside_the_field_are_refused_by_row(
    cli: Cli, tmp_path: Path, outline: Path, readings: Path
) -> None:
    readings.write_text(readings.read_text() + "500,500,400,900\n")
    result = cli("map", readings, "--boundary", outline, "--out", tmp_path / "m", *TWO, "--json")
    assert result.code == 1
    assert result.json["samples"] == 12
    (refused,) = result.json["refused"]
    assert refused.startswith("row 14:")
    (finding,) = [each for each in result.json["findings"] if each["severity"] == "left out"]
    assert (finding["file"], finding["row"]) == ("readings.csv", 14)


TWO = ("--layers", "0,0.05,0.10")


@pytest.mark.parametrize("row", ["20,20,nan,900", "20,20,,900"])
def test_a_depth_without_a_number_is_left_out_and_the_rest_of_its_row_is_used(
    cli: Cli, tmp_path: Path, outline: Path, readings: Path, row: str
) -> None:
    readings.write_text(readings.read_text() + row + "\n")
    result = cli("map", readings, "--boundary", outline, "--out", tmp_path / "m", *TWO, "--json")
    assert result.code == 1
    assert result.json["samples"] == 13
    assert [layer["samples"] for layer in result.json["layers"]] == [12, 13]
    assert "row 14: nothing was read at 0.05 m" in result.json["refused"][0]


def test_a_row_that_cannot_be_used_is_refused_and_the_rest_is_used(
    cli: Cli, tmp_path: Path, outline: Path, readings: Path
) -> None:
    readings.write_text(readings.read_text() + "20,20,-5000,900\n")
    result = cli("map", readings, "--boundary", outline, "--out", tmp_path / "m", *TWO, "--json")
    assert result.code == 1
    assert result.json["samples"] == 12
    assert "row 14" in result.json["refused"][0]


def test_a_row_that_repeats_another_is_used_and_doubted(
    cli: Cli, tmp_path: Path, outline: Path, readings: Path
) -> None:
    readings.write_text(readings.read_text() + "5,5,400,900\n")
    result = cli("map", readings, "--boundary", outline, "--out", tmp_path / "m", *TWO, "--json")
    assert result.code == 0
    assert result.json["samples"] == 13
    assert result.json["refused"] == []
    (finding,) = [each for each in result.json["findings"] if each["severity"] == "doubt"]
    assert finding["row"] == 14
    assert "repeats row 2" in finding["seen"]


@pytest.mark.parametrize("n", range(6))
def test_few_readings_give_a_map_or_a_clear_answer(
    cli: Cli, tmp_path: Path, outline: Path, readings: Path, n: int
) -> None:
    lines = readings.read_text().splitlines()
    readings.write_text("\n".join(lines[: 1 + n]) + "\n")
    outcome = cli("map", readings, "--boundary", outline, "--out", tmp_path / "m", *TWO)
    if n < 3:
        assert_one_line(outcome, 2, "readings.csv")
    else:
        assert outcome.code == 0
        assert "Traceback" not in outcome.err


def test_constant_readings_give_a_constant_map_and_no_skill(
    cli: Cli, tmp_path: Path, outline: Path, readings: Path
) -> None:
    rows = [f"{5 + 15 * i},{5 + 15 * j},500,900" for i in range(4) for j in range(3)]
    readings.write_text("\n".join([readings.read_text().splitlines()[0], *rows]) + "\n")
    outcome = cli("map", readings, "--boundary", outline, "--out", tmp_path / "m", *TWO, "--json")
    assert outcome.code == 0
    assert outcome.err == ""
    assert outcome.json["layers"][0]["loo_skill"] is None


def test_unknown_units_and_a_missing_cone_area(cli: Cli, tmp_path: Path, outline: Path) -> None:
    path = tmp_path / "r.csv"
    for column, word in (("hpa_5cm", "hpa_5cm"), ("n_5cm", "cone")):
        path.write_text(f"easting,northing,{column}\n5,5,100\n20,20,110\n40,30,120\n")
        outcome = cli("map", path, "--boundary", outline, "--out", tmp_path / "m")
        assert_one_line(outcome, 2, "r.csv", word)


def test_an_unknown_strategy_estimator_robot_or_world(
    cli: Cli, tmp_path: Path, outline: Path
) -> None:
    path = tmp_path / "s.gpkg"
    cli("init", path, "--boundary", outline)
    before, size = cli("verify", path, "--json").json, path.stat().st_size
    for option, word in (
        ("--strategy", "adaptive-greedy"),
        ("--estimator", "paper-10"),
        ("--robot", "sim"),
        ("--world", "riseholme"),
    ):
        assert_one_line(cli("run", path, option, "nonsense"), 2, "nonsense", word)
    assert_one_line(cli("run", path, "--strategy", "no.such:thing"), 2, "no.such:thing")
    assert_one_line(cli("run", path, "--samples", 5000), 2, "5000", "96 cells")
    assert cli("verify", path, "--json").json == before
    assert path.stat().st_size == size


BROKEN = {
    "not there": ("gone", None, "ModuleNotFoundError: No module named 'gone'"),
    "nothing": ("", None, "cannot import ''"),
    "relative": ("..gone", None, "cannot import '..gone'"),
    "no part": ("subsoil.gone", None, "No module named 'subsoil.gone'"),
    "no Python": ("mine", "def own(view:\n", "SyntaxError"),
    "needs what is not there": ("mine", "import gone\n", "No module named 'gone'"),
    "fails": ("mine", "1 / 0\n", "ZeroDivisionError"),
}


@pytest.mark.parametrize("case", BROKEN)
@pytest.mark.parametrize("verb", ["verify", "plan", "run", "resume"])
def test_a_module_that_is_allowed_and_cannot_be_imported_is_a_wrong_option(
    cli: Cli, tmp_path: Path, outline: Path, monkeypatch: pytest.MonkeyPatch, verb: str, case: str
) -> None:
    module, text, words = BROKEN[case]
    path = tmp_path / "s.gpkg"
    cli("init", path, "--boundary", outline)
    before = path.read_bytes()
    if text is not None:
        (tmp_path / f"{module}.py").write_text(text)
    monkeypatch.syspath_prepend(tmp_path)
    outcome = cli(verb, path, "--allow", module)
    assert_one_line(outcome, 2, "--allow: cannot import", words, "check its name")
    assert outcome.out == ""
    assert path.read_bytes() == before


def test_readings_of_force_need_a_cone_that_there_is(
    cli: Cli, tmp_path: Path, outline: Path
) -> None:
    path = tmp_path / "r.csv"
    path.write_text("easting,northing,n_5cm\n5,5,100\n20,20,110\n40,30,120\n")
    for verb in (("map", path, "--boundary", outline, "--out", tmp_path / "m"), ("cv", path)):
        assert_one_line(cli(*verb, "--cone-area", "1e300"), 2, "between 10 and 10000 mm2")


def test_a_cone_without_area_and_layers_that_are_none(
    cli: Cli, tmp_path: Path, outline: Path
) -> None:
    path = tmp_path / "s.gpkg"
    for option, value, word in (
        ("--cone-area", "-5", "mm2"),
        ("--cone-area", "0", "mm2"),
        ("--cone-area", "1e300", "between 10 and 10000 mm2"),
        ("--cone-area", "nan", "between 10 and 10000 mm2"),
        ("--layers", "0.1,0.05", "do not increase"),
        ("--layers", "5,10,15", "centimetres"),
        ("--layers", "a,b", "--layers"),
        ("--cell", "0", "cell"),
    ):
        outcome = cli("init", path, "--boundary", outline, f"{option}={value}")
        assert_one_line(outcome, 2, word)
        assert not path.exists()


def test_a_missing_argument_is_one_line(cli: Cli) -> None:
    assert_one_line(cli("init", "x.gpkg"), 2, "--boundary")
    assert_one_line(cli("frobnicate"), 2, "frobnicate")


def test_a_foreign_or_missing_survey(cli: Cli, tmp_path: Path) -> None:
    text = tmp_path / "notes.gpkg"
    text.write_text("these are notes")
    for verb in (["status"], ["run"], ["resume"], ["verify"], ["replay", "--at", "1"], ["plan"]):
        assert_one_line(cli(verb[0], text, *verb[1:]), 3, "notes.gpkg", "no GeoPackage")
        assert_one_line(cli(verb[0], tmp_path / "none.gpkg", *verb[1:]), 3, "no such file")
    assert text.read_text() == "these are notes"


def test_a_survey_is_not_started_over(cli: Cli, tmp_path: Path, outline: Path) -> None:
    path = tmp_path / "s.gpkg"
    cli("init", path, "--boundary", outline)
    before = path.read_bytes()
    assert_one_line(cli("init", path, "--boundary", outline), 3, "exists already")
    assert path.read_bytes() == before


def test_a_folder_that_is_not_there(cli: Cli, tmp_path: Path, outline: Path) -> None:
    outcome = cli("init", tmp_path / "no" / "s.gpkg", "--boundary", outline)
    assert_one_line(outcome, 3, "no such folder")


def test_an_event_that_is_not_there(cli: Cli, tmp_path: Path, outline: Path) -> None:
    path = tmp_path / "s.gpkg"
    cli("init", path, "--boundary", outline)
    assert_one_line(cli("replay", path, "--at", 7), 2, "--at", "1 to 2")


def test_a_survey_without_a_strategy_says_how_to_go_on(
    cli: Cli, tmp_path: Path, outline: Path
) -> None:
    path = tmp_path / "s.gpkg"
    cli("init", path, "--boundary", outline)
    assert_one_line(cli("resume", path), 3, "subsoil run")


def test_a_changed_survey_file_is_found(cli: Cli, tmp_path: Path, outline: Path) -> None:
    import sqlite3

    path = tmp_path / "s.gpkg"
    cli("init", path, "--boundary", outline)
    cli("run", path, "--samples", 3)
    database = sqlite3.connect(path)
    database.execute("UPDATE samples SET kpa_0_5cm = 1 WHERE fid = 1")
    database.commit()
    database.close()
    outcome = cli("verify", path, "--json")
    assert outcome.code == 1
    assert "layer samples: kpa_0_5cm of row" in outcome.json["findings"][0]


@pytest.mark.slow
def test_a_full_disk_is_one_line_and_loses_nothing(tmp_path: Path, outline: Path) -> None:
    small = tmp_path / "small"
    small.mkdir()
    mounted = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", "size=600k", "tmpfs", str(small)],
        capture_output=True,
        check=False,
    )
    if mounted.returncode:
        pytest.skip("a small file system can only be mounted by root")
    try:
        path = small / "s.gpkg"
        call = [sys.executable, "-m", "subsoil"]
        subprocess.run(
            [*call, "init", path, "--boundary", outline], check=True, capture_output=True
        )
        run = subprocess.run(
            [*call, "run", path, "--samples", "60"], capture_output=True, text=True, check=False
        )
        assert run.returncode == 3
        assert run.stderr.count("\n") == 1
        assert "free some space" in run.stderr
        room = subprocess.run(["mount", "-o", "remount,size=20m", small], check=False)
        assert room.returncode == 0
        resumed = subprocess.run([*call, "resume", path], capture_output=True, check=False)
        assert resumed.returncode == 0
        assert (
            subprocess.run([*call, "verify", path], capture_output=True, check=False).returncode
            == 0
        )
    finally:
        subprocess.run(["umount", str(small)], check=False)


def test_a_survey_that_may_not_be_written(cli: Cli, tmp_path: Path, outline: Path) -> None:
    if os.geteuid() == 0:
        pytest.skip("root may write anywhere")
    path = tmp_path / "s.gpkg"
    cli("init", path, "--boundary", outline)
    path.chmod(0o444)
    assert_one_line(cli("run", path), 3, "cannot be written")
