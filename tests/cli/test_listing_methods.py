"""The list of strategies and estimators says what they are and what can be set."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from subsoil.strategies import STRATEGIES
from subsoil.variogram import ESTIMATORS

Cli = Callable[..., Any]


def test_every_strategy_and_estimator_is_listed_with_a_line_of_its_own(cli: Cli) -> None:
    found = cli("strategies", "--json").json
    assert list(found["strategy"]) == list(STRATEGIES)
    assert list(found["estimator"]) == list(ESTIMATORS)
    for methods in found.values():
        lines = [method["what"] for method in methods.values()]
        assert len(set(lines)) == len(lines)
        assert all(line.endswith(".") and "`" not in line for line in lines)


def test_settings_are_listed_as_they_are_when_not_set(cli: Cli) -> None:
    found = cli("strategies", "--json").json
    assert found["strategy"]["random"]["settings"] == {}
    assert found["strategy"]["w-shape"]["settings"] == {"margin": 0.03, "amplitude": 0.7}
    assert found["estimator"]["pmc"]["settings"]["median_range"] == 45.0
    shown = cli("strategies").out
    assert "w-shape\tmargin=0.03, amplitude=0.7\n" in shown
    assert "--strategy-setting NAME=VALUE" in shown


def test_the_list_says_how_to_give_and_check_one_of_your_own(cli: Cli) -> None:
    shown = cli("strategies").out
    assert "--strategy mine:plan" in shown
    assert "--estimator mine:estimate" in shown
    assert "subsoil bench check mine:plan" in shown


@pytest.mark.parametrize("kind", ["strategy", "estimator"])
def test_every_setting_that_is_listed_can_be_set_to_what_it_is(
    cli: Cli, tmp_path: Path, outline: Path, kind: str
) -> None:
    path = tmp_path / "s.gpkg"
    cli("init", path, "--boundary", outline)
    for name, method in cli("strategies", "--json").json[kind].items():
        settings = [
            word
            for key, value in method["settings"].items()
            if value is not None
            for word in (f"--{kind}-setting", f"{key}={value}")
        ]
        call = ("plan", path, "--samples", 3, "--strategy", "area-split")
        outcome = cli(*call, f"--{kind}", name, *settings)
        assert outcome.code == 0, outcome.err
