"""Tables: whole numbers of digits on a narrow terminal, plain lines in a pipe."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from subsoil.cli.output import tell, tell_table
from subsoil.units import US

Cli = Callable[..., Any]
Screen = Callable[[int], None]

COLUMNS = ("layer", "mean_kpa", "loo_skill", "northing_m", "latitude")
ROWS = [
    (f"{k / 20:.2f}-{(k + 1) / 20:.2f} m", 1234.5678 + k, -0.123, 5904187.5049, 53.27112349)
    for k in range(8)
]


@pytest.fixture
def screen(monkeypatch: pytest.MonkeyPatch) -> Screen:
    """Make standard output a terminal of some columns."""

    def of_width(columns: int) -> None:
        monkeypatch.setenv("FORCE_COLOR", "1")
        monkeypatch.setenv("COLUMNS", str(columns))

    return of_width


def plain(printed: str) -> list[str]:
    return [line.rstrip() for line in re.sub(r"\x1b\[[0-9;]*m", "", printed).splitlines()]


@pytest.mark.parametrize("width", [24, 40, 60, 80, 120])
def test_no_number_is_cut_and_no_row_wrapped_however_narrow_a_terminal(
    capsys: pytest.CaptureFixture[str], screen: Screen, width: int
) -> None:
    screen(width)
    tell_table("Layers", COLUMNS, ROWS)
    lines = plain(capsys.readouterr().out)
    assert all(len(line) <= width for line in lines)
    assert not any("…" in line for line in lines)
    shown = " ".join(lines).split()
    for layer, *_ in ROWS:
        assert [line[: len(layer)] for line in lines].count(layer) == shown.count("layer")
    for number in ("1235", "1242", "-0.12", "5904187.50", "53.2711235"):
        assert number in shown


def test_a_table_that_fits_is_one_table(capsys: pytest.CaptureFixture[str], screen: Screen) -> None:
    screen(80)
    tell_table("Layers", COLUMNS, ROWS)
    assert capsys.readouterr().out.count("layer") == 1


def test_a_table_in_a_pipe_has_tabs_and_nothing_to_look_at(
    capsys: pytest.CaptureFixture[str],
) -> None:
    tell_table("Layers", COLUMNS, ROWS)
    printed = capsys.readouterr().out
    _, title, heads, first, *_ = printed.splitlines()
    assert title == "Layers"
    assert heads.split("\t") == ["layer", "mean (kPa)", "loo skill", "northing (m)", "latitude"]
    assert first.split("\t") == ["0.00-0.05 m", "1235", "-0.12", "5904187.50", "53.2711235"]
    assert printed.isascii()
    assert not any(line.endswith((" ", "\t")) for line in printed.splitlines())


def test_values_without_anything_to_say_are_left_out(
    capsys: pytest.CaptureFixture[str],
) -> None:
    tell({"a": (), "b": [], "c": "", "d": None, "e": float("nan"), "f": 0, "g": "none"}, False)
    assert capsys.readouterr().out == "f\t0\ng\tnone\n"


def test_several_words_are_a_line_each(capsys: pytest.CaptureFixture[str], screen: Screen) -> None:
    tell({"notes": ("one", "two")}, False)
    assert capsys.readouterr().out == "notes\tone\nnotes\ttwo\n"
    screen(80)
    tell({"notes": ("one", "two")}, False)
    assert plain(capsys.readouterr().out) == ["notes  one", "       two"]


def test_other_units_convert_what_is_shown_and_name_themselves(
    capsys: pytest.CaptureFixture[str],
) -> None:
    result = {"area_ha": 15.4, "metres": 304.8, "std_dev_kpa": 2068.43, "mean_kv": 47.537}
    tell({**result, "northing_m": 12.0}, False, US)
    assert capsys.readouterr().out.splitlines() == [
        "area (acres)\t38.1", "way (ft)\t1000", "std dev (psi)\t300.0", "mean KV (psi²)\t1",
        "northing (m)\t12.00",
    ]  # fmt: skip


@pytest.fixture
def survey(cli: Cli, outline: Path, tmp_path: Path) -> Path:
    path = tmp_path / "survey.gpkg"
    assert cli("init", path, "--boundary", outline).code == 0
    return path


def test_a_finished_survey_shows_no_next_stop_and_keeps_its_keys_in_json(
    cli: Cli, survey: Path
) -> None:
    cli("run", survey, "--samples", 3, "--strategy", "area-split")
    names = [line.split("\t")[0] for line in cli("status", survey).out.splitlines()]
    assert not {"next", "planned", "refused"} & set(names)
    found = cli("status", survey, "--json").json
    assert (found["next"], found["planned"], found["refused"]) == ("none", 0, 0)


def test_status_speaks_the_units_asked_for_and_json_stays_metric(cli: Cli, survey: Path) -> None:
    cli("run", survey, "--samples", 5, "--strategy", "area-split")
    us, metric = cli("status", survey, "--units", "us"), cli("status", survey)
    assert "psi" in us.out
    assert "kPa" not in us.out
    assert "psi" not in metric.out
    json = cli("status", survey, "--units", "us", "--json")
    assert json.out == cli("status", survey, "--json").out
    words = re.search(r"typical error ([\d.]+) psi \(80 % sure: below ([\d.]+)\)", us.out)
    assert words
    assert float(words[1]) == pytest.approx(0.1450377 * json.json["rmse_kpa"], abs=0.6)
    assert float(words[2]) == pytest.approx(0.1450377 * json.json["rmse_80_kpa"], abs=0.6)


def test_stops_have_degrees_to_seven_decimals_and_metres_to_centimetres(
    cli: Cli, tmp_path: Path
) -> None:
    corners = "[[0.0,52.0],[0.0009,52.0],[0.0009,52.0005],[0.0,52.0005],[0.0,52.0]]"
    (tmp_path / "f.geojson").write_text(f'{{"type":"Polygon","coordinates":[{corners}]}}')
    path = tmp_path / "s.gpkg"
    cli("init", path, "--boundary", tmp_path / "f.geojson")
    shown = cli("plan", path, "--samples", 3, "--strategy", "area-split").out
    stops = [line.split("\t") for line in shown.splitlines()[-3:]]
    for *_, east, north, longitude, latitude in stops:
        assert re.fullmatch(r"\d+\.\d\d", east)
        assert re.fullmatch(r"\d+\.\d\d", north)
        assert re.fullmatch(r"0\.\d{7}", longitude)
        assert re.fullmatch(r"52\.\d{7}", latitude)


@pytest.mark.parametrize("verb", ["cv", "variogram"])
def test_rows_of_a_file_are_left_out_and_not_refused(cli: Cli, readings: Path, verb: str) -> None:
    readings.write_text(readings.read_text() + "20,20,x,900\n")
    shown = cli(verb, readings, "--layers", "0,0.05,0.1").out
    assert "left out\trow 14" in shown
    assert "refused" not in shown


def test_scores_name_layers_in_inches_where_asked(cli: Cli, readings: Path) -> None:
    shown = cli("cv", readings, "--layers", "0,0.05,0.1", "--units", "us").out
    assert "\n0.0-2.0 in\t12\t" in shown
    assert "mean (psi)" in shown


def test_the_report_of_a_demonstration_speaks_the_units_asked_for(cli: Cli, tmp_path: Path) -> None:
    cli("demo", "--out", tmp_path, "--samples", 4, "--units", "us")
    page = re.sub(r"data:image/png;base64,[^\"]*", "", (tmp_path / "report.html").read_text())
    table, _, rest = page.partition("What to know before")
    assert "5.4 acres, " in table
    assert "psi" in table
    assert "kPa" not in table
    assert "Mean, psi" in rest
    assert "0.0-2.0 in" in rest
