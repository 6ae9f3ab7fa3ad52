"""Saying on the command line when a survey has had enough."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

Cli = Callable[..., Any]


@pytest.fixture
def survey(cli: Cli, outline: Path, tmp_path: Path) -> Path:
    """A survey just set up."""
    path = tmp_path / "survey.gpkg"
    assert cli("init", path, "--boundary", outline).code == 0
    return path


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--minutes", 0.5), "0.5 min are too few for one stop"),
        (("--metres", 0.1), "do not reach the nearest cell"),
        (("--target-rmse", 0), "target RMSE: must be greater than zero"),
        (("--target-rmse", 40, "--probability", 1), "probability: must be between 0 and 1"),
        (("--probability", 0.8), "--probability: says nothing by itself"),
        (("--decided", 0.9), "--decided: says nothing by itself"),
        (("--confidence", 0.9), "--confidence: says nothing by itself"),
        (("--threshold-kpa", 2000, "--confidence", 0.5), "confidence"),
        (("--min-gain", -1), "least gain: must be greater than zero"),
        (("--money", 40), "nothing is charged"),
        (("--money", 40, "--call-out", 50), "40 EUR do not pay for one sample"),
        (("--money", 40, "--call-out", 40, "--rate-hour", 10), "do not pay for one stop"),
        (("--rate-hour", 10, "--currency", "euro"), "'euro' is no currency"),
    ],
)
@pytest.mark.parametrize("verb", ["run", "plan"])
def test_what_cannot_be_asked_for_is_one_line_and_changes_nothing(
    cli: Cli, survey: Path, verb: str, options: tuple[object, ...], said: str
) -> None:
    before = cli("verify", survey, "--json").json
    outcome = cli(verb, survey, *options)
    assert outcome.code == 2
    assert said in outcome.err
    assert outcome.err.count("\n") == 1
    assert cli("verify", survey, "--json").json == before


def test_every_rule_can_be_asked_for(cli: Cli, survey: Path) -> None:
    base = ("run", survey, "--strategy", "area-split", "--samples", 20, "--json")
    result = cli(*base, "--target-rmse", 5000, "--probability", 0.9).json
    assert result["samples"] == 12
    assert "sure of an RMSE at or below 5000 kPa, 90 % asked for" in result["finished"]
    result = cli(*base, "--threshold-kpa", 90000, "--decided", 0.95).json
    assert "95 % asked for" in result["finished"]
    result = cli(*base, "--min-gain", 500).json
    assert "not worth it" in result["finished"]
    assert result["goals"] == [result["finished"].removesuffix(", 3 updates running")]
    assert cli("verify", survey).code == 0


def test_money_is_counted_in_the_currency_asked_for(cli: Cli, survey: Path) -> None:
    options = ("--money", 60, "--call-out", 50, "--rate-hour", 60, "--currency", "CHF")
    result = cli("run", survey, *options, "--json").json
    assert result["money"] <= 60
    assert result["money"] == pytest.approx(50 + result["minutes"])
    assert "CHF spent" in result["finished"]
    assert "CHF) would bring it" in cli("status", survey).out


def test_status_says_how_good_the_map_is_and_what_more_would_buy(cli: Cli, survey: Path) -> None:
    cli("run", survey, "--strategy", "area-split", "--samples", 14)
    status = cli("status", survey, "--json").json
    assert status["outlook"].startswith("14 samples in ")
    assert status["rmse_80_kpa"] > status["rmse_kpa"] > 0
    assert [entry["samples"] for entry in status["forecast"]] == list(range(15, 35))
    curve = [status["rmse_kpa"], *(entry["rmse_kpa"] for entry in status["forecast"])]
    assert curve == sorted(curve, reverse=True)
    shown = cli("status", survey).out
    assert shown.startswith(status["outlook"])
    assert "What more would buy" in shown


def test_status_of_a_survey_not_begun_has_nothing_to_foresee(cli: Cli, survey: Path) -> None:
    status = cli("status", survey, "--json").json
    assert status["forecast"] == []
    assert "too few to say" in status["outlook"]
    assert "What more would buy" not in cli("status", survey).out


def test_status_draws_what_more_would_buy(cli: Cli, survey: Path, tmp_path: Path) -> None:
    cli("run", survey, "--strategy", "area-split", "--samples", 14)
    result = cli("status", survey, "--out", tmp_path / "new", "--json").json
    assert Path(result["picture"]).read_bytes().startswith(b"\x89PNG")
    assert Path(result["picture"]).parent == tmp_path / "new"
    printed = cli("status", survey, "--out", tmp_path / "new", "--figures", "pdf", "--json").json
    assert Path(printed["picture"]).name == "outlook.pdf"


def test_status_warns_of_variograms_that_are_too_sure(cli: Cli, survey: Path) -> None:
    cli("run", survey, "--strategy", "area-split", "--samples", 5, "--estimator", "paper-10")
    simulated, note = cli("status", survey, "--json").json["notes"]
    assert simulated.startswith("simulated: ")
    assert note.startswith("least-squares variograms")
    cli("run", survey, "--strategy", "area-split", "--samples", 6, "--estimator", "pmc")
    assert cli("status", survey, "--json").json["notes"] == [simulated]
