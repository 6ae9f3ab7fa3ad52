"""Help: an example of every verb that works, options in groups, choices by name."""

from __future__ import annotations

import re
import shlex
from collections.abc import Callable
from pathlib import Path
from typing import Any, get_args

import pytest
import typer

from subsoil.bench.task import PROTOCOLS
from subsoil.cli import app
from subsoil.cli.bench import Protocol
from subsoil.cli.examples import EXAMPLES
from subsoil.cli.options import World
from subsoil.cli.parsing import COMPARISON, FIELD, LIMITS, OUTPUT, ROBOT, STRATEGY, WAY, WORK
from subsoil.mapping.drift_choice import DriftRule
from subsoil.strategies import STRATEGIES
from subsoil.variogram import ESTIMATORS
from subsoil.worlds import WORLDS

Cli = Callable[..., Any]

GROUPS = {COMPARISON, FIELD, LIMITS, OUTPUT, ROBOT, STRATEGY, WAY, WORK}


def commands() -> dict[str, Any]:
    """All verbs, those under `bench` by both words."""
    top = dict(typer.main.get_command(app).commands)  # type: ignore[attr-defined]
    bench = top.pop("bench").commands
    return {**top, **{f"bench {name}": verb for name, verb in bench.items()}}


COMMANDS = commands()


def options(verb: str) -> dict[str, Any]:
    context = typer.Context(COMMANDS[verb])
    found = COMMANDS[verb].get_params(context)
    return {param.opts[0]: param for param in found if param.param_type_name == "option"}


@pytest.fixture
def said(monkeypatch: pytest.MonkeyPatch, cli: Cli) -> Callable[[str], str]:
    """Help of a verb as one line of words, on a screen of 80 columns."""
    monkeypatch.setenv("COLUMNS", "80")
    monkeypatch.setenv("TERMINAL_WIDTH", "80")

    def help_of(verb: str) -> str:
        outcome = cli(*verb.split(), "--help")
        assert outcome.code == 0
        assert all(len(line) <= 80 for line in outcome.out.splitlines())
        return " ".join(re.sub(r"[│╭╮╰╯─]", " ", outcome.out).split())

    return help_of


def test_every_verb_has_an_example_of_itself() -> None:
    assert list(EXAMPLES) == list(COMMANDS)
    for verb, lines in EXAMPLES.items():
        assert all(line.startswith(f"subsoil {verb}") for line in lines)
        assert all(len(line) <= 78 for line in lines)


@pytest.mark.parametrize("verb", COMMANDS)
def test_help_shows_the_examples_whole_and_no_type_of_a_flag(
    said: Callable[[str], str], verb: str
) -> None:
    shown = said(verb)
    for line in EXAMPLES[verb]:
        assert line in shown
    assert "<bool>" not in shown


@pytest.mark.parametrize("verb", COMMANDS)
def test_every_option_is_in_a_group(verb: str) -> None:
    assert {option.rich_help_panel for option in options(verb).values()} <= GROUPS


@pytest.mark.slow
def test_the_examples_work_as_written(
    cli: Cli, tmp_path: Path, readings: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    corners = "[[0.0,52.0],[0.0009,52.0],[0.0009,52.0005],[0.0,52.0005],[0.0,52.0]]"
    (tmp_path / "field.geojson").write_text(f'{{"type":"Polygon","coordinates":[{corners}]}}')
    rows = readings.read_text().splitlines()[1:]
    places = [line.split(",") for line in rows]
    readings.write_text(
        "lon,lat,kpa_5cm,kpa_15cm\n"
        + "\n".join(f"{int(x) * 1.4e-5},{52 + int(y) * 1e-5},{a},{b}" for x, y, a, b in places)
    )
    for line in [line for lines in EXAMPLES.values() for line in lines]:
        outcome = cli(*shlex.split(line)[1:])
        if "REPORT" in line:
            assert "there is no reading" in outcome.err
        else:
            assert outcome.code == 0, f"{line}: {outcome.err}"


@pytest.mark.parametrize("verb", ["plan", "run", "demo", "bench run"])
def test_help_names_all_strategies_and_estimators(said: Callable[[str], str], verb: str) -> None:
    shown = said(verb).replace(" ", "")
    for name in (*STRATEGIES, *ESTIMATORS):
        assert name in shown
    assert "module:attribute" in shown


@pytest.mark.parametrize(
    ("type_", "names"),
    [
        (World, WORLDS),
        (Protocol, PROTOCOLS),
        (DriftRule, ("auto", "always", "never")),
    ],
)
def test_choices_of_the_command_line_are_those_there_are(type_: Any, names: Any) -> None:
    assert get_args(type_) == tuple(names)


def test_plan_takes_every_limit_and_method_that_run_takes() -> None:
    def shared(verb: str) -> set[str]:
        return {k for k, o in options(verb).items() if o.rich_help_panel in (LIMITS, STRATEGY)}

    assert shared("plan") == shared("run")
    assert {"--money", "--target-rmse", "--estimator"} <= shared("plan")
