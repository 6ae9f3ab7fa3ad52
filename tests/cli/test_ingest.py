"""Files taken into a survey: once, whole, each reading at its own place, nothing half-written."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pytest

from subsoil.journal import read_events, read_survey
from subsoil.survey import Survey, fold

Cli = Callable[..., Any]
HEAD = "easting,northing,kpa_5cm,kpa_10cm"
ROWS = tuple(
    f"{5 + 10 * i},{5 + 10 * j},{400 + 50 * i + 7 * j},{900 + 80 * i}"
    for i in range(5)
    for j in range(3)
)


def written(path: Path, rows: Sequence[str], head: str = HEAD) -> Path:
    path.write_text("\n".join([head, *rows]) + "\n")
    return path


@pytest.fixture
def survey(cli: Cli, outline: Path, tmp_path: Path) -> Path:
    return begun(cli, outline, tmp_path / "survey.gpkg")


def begun(cli: Cli, outline: Path, path: Path) -> Path:
    made = cli(
        "init", path, "--boundary", outline, "--layers", "0,0.05,0.1", "--samples", 20,
        "--strategy", "area-split", "--estimator", "spherical",
    )  # fmt: skip
    assert made.code == 0, made.err
    return path


def state_of(path: Path) -> Survey:
    return fold(read_events(path))


def ids(path: Path) -> list[str]:
    return [report.id for report in state_of(path).readings]


def counts(cli: Cli, survey: Path, *words: object, code: int = 0) -> tuple[int, int, int, int]:
    """Readings accepted, known, flagged and refused."""
    outcome = cli("ingest", survey, *words, "--json")
    assert outcome.code == code, outcome.err
    told = outcome.json
    return told["accepted"], told["known"], told["flagged"], len(told["refused"])


def test_each_reading_keeps_its_place_and_says_where_it_is_from(
    cli: Cli, survey: Path, tmp_path: Path
) -> None:
    assert counts(cli, survey, written(tmp_path / "a.csv", ROWS)) == (15, 0, 0, 0)
    readings = state_of(survey).readings
    assert [r.at for r in readings[:2]] == [(5.0, 5.0), (5.0, 15.0)]
    assert readings[1].reading.kpa == (407.0, 900.0)
    assert {(r.source.kind, r.source.file) for r in readings} == {("file", "a.csv")}
    assert [r.source.row for r in readings] == list(range(2, 17))
    assert cli("verify", survey).code == 0


def test_a_file_that_is_taken_again_adds_nothing(cli: Cli, survey: Path, tmp_path: Path) -> None:
    file = written(tmp_path / "a.csv", ROWS)
    counts(cli, survey, file)
    before = read_survey(survey).fingerprint
    assert counts(cli, survey, file) == (0, 15, 0, 0)
    shuffled = written(tmp_path / "other name.csv", ROWS[::-1])
    assert counts(cli, survey, shuffled, "--agent", "hand") == (0, 15, 0, 0)
    moved = [f"{r.split(',')[1]},{r.split(',')[0]},{r.split(',', 2)[2]}" for r in ROWS]
    swapped = written(tmp_path / "b.csv", moved, "northing,easting,kpa_5cm,kpa_10cm")
    assert counts(cli, survey, swapped) == (0, 15, 0, 0)
    assert read_survey(survey).fingerprint == before


def test_a_file_that_grew_adds_what_is_new(cli: Cli, survey: Path, tmp_path: Path) -> None:
    counts(cli, survey, written(tmp_path / "a.csv", ROWS[:9]))
    assert counts(cli, survey, written(tmp_path / "a.csv", ROWS)) == (6, 9, 0, 0)
    both = (written(tmp_path / "b.csv", ROWS[3:12]), written(tmp_path / "c.csv", ROWS[:2]))
    assert counts(cli, survey, *both) == (0, 11, 0, 0)


def test_two_equal_pushes_of_one_file_stay_two(cli: Cli, survey: Path, tmp_path: Path) -> None:
    file = written(tmp_path / "a.csv", [*ROWS[:4], ROWS[1]])
    accepted, known, flagged, refused = counts(cli, survey, file)
    assert (accepted, known, flagged, refused) == (5, 0, 1, 0)
    assert counts(cli, survey, file) == (0, 5, 0, 0)
    assert counts(cli, survey, written(tmp_path / "b.csv", [ROWS[1], *ROWS[:5]])) == (1, 5, 0, 0)
    assert [r.at for r in state_of(survey).readings].count((5.0, 15.0)) == 2


def test_a_value_that_changed_makes_another_push(cli: Cli, survey: Path, tmp_path: Path) -> None:
    counts(cli, survey, written(tmp_path / "a.csv", ROWS[:3]))
    changed = written(tmp_path / "a.csv", [ROWS[0].replace("900", "901"), *ROWS[1:3]])
    assert counts(cli, survey, changed) == (1, 2, 0, 0)


def test_what_was_withdrawn_or_amended_does_not_come_back(
    cli: Cli, survey: Path, tmp_path: Path
) -> None:
    file = written(tmp_path / "a.csv", ROWS[:5])
    counts(cli, survey, file)
    first, second, *_ = ids(survey)
    assert cli("withdraw", survey, first, "--reason", "a root").code == 0
    change = ("--kpa", "450,950", "--depths", "5,10", "--reason", "misread")
    assert cli("amend", survey, second, *change).code == 0
    assert counts(cli, survey, file) == (0, 5, 0, 0)
    readings = state_of(survey).readings
    assert len(readings) == 4
    assert readings[0].reading.kpa == (450.0, 950.0)


def test_a_preview_says_the_same_and_writes_nothing(cli: Cli, survey: Path, tmp_path: Path) -> None:
    file = written(tmp_path / "a.csv", [*ROWS, "300,300,500,600"])
    before = survey.read_bytes()
    assert counts(cli, survey, file, "--preview", code=1) == (15, 0, 0, 1)
    assert survey.read_bytes() == before
    assert "nothing is written" in cli("ingest", survey, file, "--preview").out
    assert counts(cli, survey, file, code=1) == (15, 0, 0, 1)


def test_readings_outside_the_fence_are_refused_and_named(
    cli: Cli, survey: Path, tmp_path: Path
) -> None:
    file = written(tmp_path / "a.csv", [*ROWS[:6], "30,90,500,600"])
    told = cli("ingest", survey, file, "--json")
    assert told.code == 1
    assert told.json["accepted"] == 6
    (finding,) = [each for each in told.json["findings"] if each["severity"] == "left out"]
    assert (finding["file"], finding["row"]) == ("a.csv", 8)
    assert "50 m outside" in finding["seen"]
    screen = cli("ingest", survey, file).out
    assert "already in\t6" in screen
    assert "refused\t1" in screen


def test_a_gap_in_a_profile_is_kept_as_a_gap(cli: Cli, survey: Path, tmp_path: Path) -> None:
    head = "easting,northing,kpa_5cm,kpa_10cm,kpa_15cm"
    file = written(tmp_path / "a.csv", ["5,5,400,,600", "15,5,400,500,600"], head)
    counts(cli, survey, file, code=1)
    gap, whole = (report.reading for report in state_of(survey).readings)
    assert (gap.depth_m, gap.top_m) == ((0.05, 0.15), (0.0, 0.1))
    assert (whole.depth_m, whole.top_m) == ((0.05, 0.1, 0.15), ())
    assert counts(cli, survey, file, code=1)[:2] == (0, 2)


def test_one_file_that_cannot_be_read_keeps_all_out(cli: Cli, survey: Path, tmp_path: Path) -> None:
    before = read_survey(survey).fingerprint
    bad = tmp_path / "bad.csv"
    bad.write_text("notes\nwet\n")
    outcome = cli("ingest", survey, written(tmp_path / "a.csv", ROWS), bad)
    assert outcome.code == 2
    assert "bad.csv" in outcome.err
    assert read_survey(survey).fingerprint == before


def test_forces_need_a_cone_and_units_are_said_as_for_a_map(
    cli: Cli, survey: Path, tmp_path: Path
) -> None:
    file = written(tmp_path / "n.csv", ["5,5,65,130"], "easting,northing,n_5cm,n_10cm")
    assert "no cone area" in cli("ingest", survey, file).err
    assert counts(cli, survey, file, "--cone-area", 130) == (1, 0, 0, 0)
    assert state_of(survey).readings[0].reading.kpa == (500.0, 1000.0)


def test_readings_taken_elsewhere_leave_the_planned_stop_and_take_its_place(
    cli: Cli, survey: Path, tmp_path: Path
) -> None:
    stop = cli("next", survey, "--json").json["stop"]
    away = [row for row in ROWS if abs(float(row.split(",")[0]) - stop["easting_m"]) > 15]
    counts(cli, survey, written(tmp_path / "a.csv", away[:3]))
    assert cli("next", survey, "--json").json["stop"] == stop
    there = f"{stop['easting_m']},{stop['northing_m']},500,600"
    counts(cli, survey, written(tmp_path / "b.csv", [there]))
    assert cli("next", survey, "--json").json["stop"]["cell"] != stop["cell"]


def many(path: Path, rows: int) -> Path:
    made = [
        f"{1 + k % 58}.25,{1 + k // 58 % 38}.5,{400 + k % 97},{900 + k % 89}" for k in range(rows)
    ]  # fmt: skip
    return written(path, made)


@pytest.mark.slow
def test_a_kill_in_the_middle_loses_nothing_and_doubles_nothing(
    cli: Cli, outline: Path, tmp_path: Path
) -> None:
    file = many(tmp_path / "many.csv", 300)
    at_once, killed = (begun(cli, outline, tmp_path / f"{k}.gpkg") for k in ("one", "killed"))
    assert cli("ingest", at_once, file).code == 0
    command = [sys.executable, "-m", "subsoil", "ingest", str(killed), str(file)]
    wal = killed.with_name(killed.name + "-wal")
    struck = 0
    for wait in (0.0, 0.05, 0.2, 0.5, 1.0):
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, env=dict(os.environ))
        while process.poll() is None and not wal.exists():
            time.sleep(0.005)
        time.sleep(wait)
        if process.poll() is None:
            process.send_signal(signal.SIGKILL)
            struck += 1
        process.wait()
        assert len(ids(killed)) in (0, 300)
    assert struck > 0
    assert cli("ingest", killed, file).code == 0
    assert ids(killed) == ids(at_once)
    assert cli("verify", killed, "--json").json["findings"] == "none"
