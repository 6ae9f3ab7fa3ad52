"""Making a survey and looking into it, as its user would."""

from __future__ import annotations

import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from subsoil.cli import run
from subsoil.strategies import STRATEGIES

Cli = Callable[..., Any]


@pytest.fixture
def survey(cli: Cli, outline: Path, tmp_path: Path) -> Path:
    """A survey just set up."""
    path = tmp_path / "survey.gpkg"
    assert cli("init", path, "--boundary", outline).code == 0
    return path


def test_init_says_what_field_it_is(cli: Cli, outline: Path, tmp_path: Path) -> None:
    result = cli("init", tmp_path / "s.gpkg", "--boundary", outline, "--cell", 10, "--json").json
    assert result["area_ha"] == pytest.approx(0.24)
    assert result["cells"] == 24
    assert result["force_limit_kpa"] == pytest.approx(600 / 130 * 1000)


def test_a_survey_runs_to_its_end_and_says_how_it_stands(cli: Cli, survey: Path) -> None:
    assert cli("run", survey, "--samples", 6, "--strategy", "area-split", "--seed", 2).code == 0
    status = cli("status", survey, "--json").json
    assert status["samples"] == 6
    assert status["finished"] == "6 samples taken"
    assert {"refused", "metres", "minutes", "mean_kv", "next"} <= status.keys()
    assert cli("verify", survey).code == 0


def test_status_knows_the_next_stop_before_the_survey_is_over(cli: Cli, survey: Path) -> None:
    cli("run", survey, "--samples", 6, "--seed", 2)
    events = cli("verify", survey, "--json").json["events"]
    past = cli("replay", survey, "--at", events - 5, "--json").json
    assert past["next"]["cell"] >= 0
    assert past["samples"] < 6


@pytest.mark.parametrize("strategy", STRATEGIES)
def test_every_strategy_runs_by_name_and_repeats_with_its_seed(
    cli: Cli, survey: Path, tmp_path: Path, strategy: str
) -> None:
    again = Path(shutil.copy(survey, tmp_path / "again.gpkg"))
    results = []
    for path in (survey, again):
        command = ("run", path, "--strategy", strategy, "--samples", 5, "--seed", 9, "--json")
        results.append(cli(*command).json)
    assert results[0] == results[1]
    assert results[0]["samples"] == 5


def test_plan_shows_the_stops_that_run_then_makes(cli: Cli, survey: Path) -> None:
    command = (survey, "--strategy", "area-split", "--samples", 5, "--seed", 4)
    plan = cli("plan", *command, "--json").json
    assert len(plan["plan"]) == 5
    assert cli("status", survey, "--json").json["planned"] == 0
    ran = cli("run", *command, "--json").json
    assert ran["metres"] == pytest.approx(plan["metres"])


def test_a_survey_stops_at_its_limits(cli: Cli, survey: Path) -> None:
    call = ("run", survey, "--strategy", "area-split", "--samples", 40, "--json")
    result = cli(*call, "--minutes", 6).json
    assert "the next stop would take it beyond 6" in result["finished"]
    assert result["minutes"] <= 6
    limit = result["metres"] + 60
    kept = cli(*call, "--metres", limit).json
    assert kept["samples"] == result["samples"], "a limit that is not given stays"
    more = cli(*call, "--metres", limit, "--minutes", "inf").json
    assert more["samples"] > result["samples"]
    assert more["metres"] <= limit
    assert "metres driven" in more["finished"]


def test_a_joint_survey_fills_its_minutes_and_keeps_to_them(cli: Cli, survey: Path) -> None:
    result = cli("run", survey, "--samples", 40, "--minutes", 12, "--json").json
    assert 10 < result["minutes"] <= 12
    assert result["finished"] == "the limits leave no room for another stop"


def test_resume_of_a_finished_survey_changes_nothing(cli: Cli, survey: Path) -> None:
    ran = cli("run", survey, "--samples", 4, "--json").json
    assert cli("resume", survey, "--json").json == ran


def test_a_users_own_strategy_runs_by_module_and_attribute(
    cli: Cli, survey: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "mine.py").write_text(
        "from subsoil.strategies import Plan, View\n\n\n"
        "def westmost(view: View) -> Plan:\n"
        "    cell = min(c for c in range(len(view.field.cells)) if view.free[c])\n"
        '    return Plan((cell,), "furthest south-west")\n'
    )
    monkeypatch.syspath_prepend(tmp_path)
    result = cli("run", survey, "--strategy", "mine:westmost", "--samples", 3, "--json").json
    assert result["samples"] == 3
    assert cli("verify", survey).code == 0


def test_the_terminal_shows_units(cli: Cli, survey: Path) -> None:
    out = cli("run", survey, "--samples", 3).out
    for unit in ("(m)", "(min)", "(kPa)", "(kPa²)", "(ha)"):
        assert unit in out


@pytest.mark.slow
def test_ctrl_c_stops_in_one_line_and_loses_nothing(survey: Path, cli: Cli) -> None:
    command = [sys.executable, "-m", "subsoil", "run", str(survey), "--samples", "90"]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    while not cli("status", survey, "--json").json["samples"]:
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    _, said = process.communicate()
    assert process.returncode == 3
    assert said == "error: stopped; nothing recorded is lost, go on with `subsoil resume`\n"
    assert cli("resume", survey, "--json").json["samples"] == 90
    assert cli("verify", survey).code == 0


def test_doctor_says_what_is_there(cli: Cli) -> None:
    outcome = cli("doctor", "--json")
    assert outcome.code == 0
    assert outcome.json["missing"] == []
    shown = cli("doctor")
    assert shown.code == 0
    assert "remedy" not in shown.out


def test_help_names_every_verb(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["--help"]) == 0
    out = capsys.readouterr().out
    for verb in (
        "demo", "init", "plan", "run", "resume", "status", "map", "variogram", "cv", "replay",
        "verify", "withdraw", "doctor",
    ):  # fmt: skip
        assert verb in out


def test_the_demonstration_leaves_a_survey_that_verifies_and_a_report_of_the_same_events(
    cli: Cli, tmp_path: Path
) -> None:
    made = cli("demo", "--out", tmp_path, "--samples", 4, "--json").json
    assert made["samples"] == 4
    verified = cli("verify", tmp_path / "survey.gpkg", "--json").json
    assert verified["findings"] == "none"
    status = cli("status", tmp_path / "survey.gpkg", "--json").json
    assert verified["fingerprint"] == status["fingerprint"]
    report = (tmp_path / "report.html").read_text()
    assert status["fingerprint"] in report
    assert "simulated; soil: simulated, seed 0" in report
    for name in ("mean_kpa.tif", "std_dev_kpa.tif"):
        assert (tmp_path / name).stat().st_size > 0


def test_figures_of_a_demonstration_come_in_another_format_and_the_page_holds_pixels(
    cli: Cli, tmp_path: Path
) -> None:
    made = cli("demo", "--out", tmp_path, "--samples", 3, "--figures", "svg", "--json").json
    names = {"depth_slices", "std_dev", "variograms", "profiles", "learning_curves"}
    assert {path.name for path in tmp_path.glob("*.[sp][vn]g")} == {f"{name}.svg" for name in names}
    page = (tmp_path / "report.html").read_text()
    assert page.count("data:image/png;base64,") == 5
    assert "File: depth_slices.svg." in page
    assert "80 % sure to stay below" in made["outlook"]
    assert made["outlook"] in page
    refused = cli("demo", "--out", tmp_path, "--figures", "gif")
    assert refused.code == 2
    assert "png" in refused.err


def test_init_says_that_it_moved_a_field_whose_metres_are_not_ground_metres(
    cli: Cli, tmp_path: Path
) -> None:
    outline = tmp_path / "mercator.csv"
    outline.write_text(
        "easting,northing\n628000,6817000\n628200,6817000\n628200,6817200\n628000,6817200\n"
    )
    call = ("init", tmp_path / "s.gpkg", "--boundary", outline, "--crs", "EPSG:3857", "--json")
    (note,) = cli(*call).json["notes"]
    assert "EPSG:3857" in note
