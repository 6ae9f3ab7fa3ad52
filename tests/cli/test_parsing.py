"""Every option takes what it says, refuses the rest by its name, and ends where it should."""

from __future__ import annotations

import sys
from collections.abc import Callable
from inspect import signature
from math import inf, nan
from pathlib import Path
from typing import Annotated, Any, Literal, get_args, get_origin

import pytest
import typer

from subsoil.cli import VERBS, bench
from subsoil.cli.limits import LimitOptions
from subsoil.cli.options import (
    MethodOptions,
    allowed_by,
    layers_of,
    numbers,
    settings_of,
    values,
)
from subsoil.cli.parsing import grouped, one_of, some_of
from subsoil.errors import ParameterError
from subsoil.land.field import Field
from subsoil.stopping import DecidedShare, LeastGain, Rates, SureRmse, TargetRmse
from subsoil.survey import Settings

Cli = Callable[..., Any]

FIELD = Field.from_metres([(0, 0), (60, 0), (60, 40), (0, 40)], name="plot")


def refused() -> list[tuple[str, str, str]]:
    """Verb, option and a value of the wrong kind, of each option that takes a number or a name.

    What verbs share is tried with the first of them.
    """
    verbs = {**VERBS, "bench run": bench.run, "bench report": bench.report}
    found: dict[tuple[str, str], str] = {}
    for verb, function in verbs.items():
        for name, given in signature(function, eval_str=True).parameters.items():
            if get_origin(given.annotation) is not Annotated:
                continue
            kind, option = get_args(given.annotation)[:2]
            if not isinstance(option, typer.models.OptionInfo):
                continue
            kinds = [kind, *get_args(kind)]
            said = [each for each in option.param_decls or () if each.startswith("--")]
            flag = (said or [f"--{name.replace('_', '-')}"])[0]
            if any(get_origin(each) is Literal or each in (int, float) for each in kinds):
                found.setdefault((flag, "no-such"), verb)
            if option.min is not None:
                found.setdefault((flag, f"{option.min - 1}"), verb)
    return [(verb, flag, value) for (flag, value), verb in found.items()]


WRONG = refused()


def test_there_are_options_of_every_kind_to_try() -> None:
    flags = {flag for _, flag, _ in WRONG}
    assert flags >= {
        "--samples", "--minutes", "--target-rmse", "--drift", "--units", "--figures", "--world",
        "--seed", "--protocol", "--fields", "--workers", "--at", "--block",
    }  # fmt: skip


@pytest.mark.parametrize(("verb", "option", "value"), WRONG)
def test_a_value_of_the_wrong_kind_is_refused_by_the_name_of_its_option_in_a_line(
    cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, verb: str, option: str, value: str
) -> None:
    monkeypatch.chdir(tmp_path)
    outcome = cli(*verb.split(), option, value)
    assert (outcome.code, outcome.out) == (2, "")
    assert outcome.err.count("\n") == 1
    assert option in outcome.err
    assert not any(tmp_path.iterdir())


# What options become


def test_every_limit_and_method_that_is_typed_is_in_the_settings() -> None:
    method = MethodOptions(
        strategy="joint", strategy_setting=["way=0.8"], estimator="pmc",
        estimator_setting=["median_range=30"], refit_every=3, drift="never", seed=11,
    )  # fmt: skip
    limits = LimitOptions(
        samples=12, metres=900.0, minutes=70.0, money=500.0, target_rmse=40.0, probability=0.9,
        threshold_kpa=2000.0, decided=0.95, confidence=0.7, min_gain=0.5, kv=1600.0,
        rate_hour=60.0, rate_km=5.0, rate_sample=2.0, call_out=100.0, currency="GBP",
    )  # fmt: skip
    settings = settings_of(Settings(start=FIELD.entrance), FIELD, method, limits)
    assert settings.model_dump(exclude={"rates", "goals", "pace"}) == {
        "start": FIELD.entrance, "strategy": "joint", "strategy_settings": {"way": 0.8},
        "estimator": "pmc", "estimator_settings": {"median_range": 30.0}, "refit_every": 3,
        "seed": 11, "samples": 12, "metres": 900.0, "minutes": 70.0, "mean_kv": 1600.0,
        "money": 500.0, "drift": "never",
    }  # fmt: skip
    assert settings.rates == Rates(60.0, 5.0, 2.0, 100.0, "GBP")
    assert settings.goals == (
        SureRmse(40.0, 0.9), DecidedShare(2000.0, 0.95, 0.7), LeastGain(0.5),
    )  # fmt: skip


def test_what_is_not_typed_is_what_help_says() -> None:
    limits = LimitOptions()
    assert limits.given(Rates()) == {}
    assert LimitOptions(target_rmse=40.0).goals == (TargetRmse(40.0),)
    assert LimitOptions(threshold_kpa=2000.0).goals == (DecidedShare(2000.0, 0.9, 0.8),)
    assert LimitOptions(threshold_kpa=2000.0, decided=1.0).goals == (
        DecidedShare(2000.0, 1.0, 0.8),
    )


@pytest.mark.parametrize(
    ("limits", "said"),
    [
        (
            LimitOptions(probability=0.8),
            "--probability: says nothing by itself (remedy: give --target-rmse too)",
        ),
        (
            LimitOptions(confidence=0.8),
            "--confidence: says nothing by itself (remedy: give --threshold-kpa too)",
        ),
        (
            LimitOptions(decided=0.8),
            "--decided: says nothing by itself (remedy: give --threshold-kpa too)",
        ),
    ],
)
def test_an_option_that_needs_another_names_it(limits: LimitOptions, said: str) -> None:
    with pytest.raises(ParameterError) as caught:
        _ = limits.goals
    assert str(caught.value) == said


@pytest.mark.parametrize(
    ("given", "found"),
    [
        (None, {}),
        ([], {}),
        (["a=1"], {"a": 1.0}),
        (["a=1e3", "b=-2.5"], {"a": 1000.0, "b": -2.5}),
        (["a=1", "a=2"], {"a": 2.0}),
        (["rule=auto"], {"rule": "auto"}),
        (["rule=a=b"], {"rule": "a=b"}),
        (["a=inf"], {"a": inf}),
    ],
)
def test_settings_of_a_method_are_names_and_numbers_or_words(
    given: list[str] | None, found: dict[str, float | str]
) -> None:
    assert values(given) == found


@pytest.mark.parametrize("text", ["", "=", "a", "a=", "=1"])
def test_a_setting_without_a_name_or_a_value_is_shown_as_typed(text: str) -> None:
    with pytest.raises(ParameterError) as caught:
        values(["ok=1", text])
    assert str(caught.value) == f"setting: {text!r} is not NAME=VALUE"


def test_an_estimator_takes_numbers_only() -> None:
    assert numbers(["a=1", "b=2"]) == {"a": 1.0, "b": 2.0}
    assert numbers(None) == {}
    with pytest.raises(ParameterError) as caught:
        numbers(["a=1", "median_range=far"])
    assert str(caught.value) == "setting: median_range needs a number, not 'far'"


@pytest.mark.parametrize(
    ("text", "edges"),
    [
        ("0,0.1,0.2", (0.0, 0.1, 0.2)),
        (" 0 , .1 ", (0.0, 0.1)),
        ("0.05,0.4", (0.05, 0.4)),
        ("0,1e-1", (0.0, 0.1)),
    ],
)
def test_edges_of_layers_are_numbers_between_commas(text: str, edges: tuple[float, ...]) -> None:
    assert layers_of(text).edges_m == edges


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (
            "0;0.1",
            "--layers: '0;0.1' is not a list of numbers (remedy: edges in metres, such as "
            "0,0.1,0.2,0.4)",
        ),
        ("0,,0.1", "--layers: '0,,0.1' is not a list of numbers"),
        ("", "--layers: '' is not a list of numbers"),
        ("x" * 60, "--layers: '" + "x" * 40 + "...' is not a list of numbers"),
        ("0", "layer edges: layers need at least two finite edges"),
        ("0,nan", "layer edges: layers need at least two finite edges"),
        ("0,10,20", "layer edges: the deepest edge is 20 m (remedy: edges are in metres"),
        ("0.2,0.1", "layer edges: edges do not increase: 0.1 m comes after 0.2 m"),
    ],
)
def test_edges_that_make_no_layers_are_said_to_be_so(text: str, said: str) -> None:
    with pytest.raises(ParameterError) as caught:
        layers_of(text)
    assert str(caught.value).startswith(said)


def test_modules_are_allowed_by_name_and_by_what_was_typed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "allowed_here.py").write_text("def plan(view): ...\n")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [*sys.path])
    monkeypatch.delitem(sys.modules, "allowed_here", raising=False)
    allowed = allowed_by(["allowed_here:plan"], "typed.module:name", "greedy")
    assert allowed.modules == {"allowed_here", "typed.module"}
    assert sys.path[-1] == str(tmp_path)
    assert sys.path.count(str(tmp_path)) == 1
    allowed_by(["allowed_here"])
    assert sys.path.count(str(tmp_path)) == 1


def test_without_code_of_ones_own_the_current_folder_is_not_searched(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    before = list(sys.path)
    assert allowed_by(None, "greedy", "pmc").modules == frozenset()
    assert sys.path == before


# What typer leaves to us


def test_fields_of_a_dataclass_become_options_and_come_back_as_one() -> None:
    seen: list[tuple[int, LimitOptions]] = []

    def verb(number: int, limits: LimitOptions) -> None:
        """Do something."""
        seen.append((number, limits))

    call = grouped(verb)
    parameters = call.__signature__.parameters  # type: ignore[attr-defined]
    assert list(parameters)[:3] == ["number", "samples", "metres"]
    assert parameters["currency"].default is None
    assert call.__doc__ == "Do something."
    given = {name: p.default for name, p in parameters.items() if name != "number"}
    call(number=3, **{**given, "samples": 9, "minutes": 5.0})
    assert seen == [(3, LimitOptions(samples=9, minutes=5.0))]


@pytest.mark.parametrize(
    ("typed", "found"),
    [
        ("", ["random", "reml", "greedy"]),
        ("r", ["random", "reml"]),
        ("greedy", ["greedy"]),
        ("G", []),
        ("x", []),
    ],
)
def test_a_name_is_completed_from_its_beginning(typed: str, found: list[str]) -> None:
    assert one_of(["random", "reml", "greedy"])(typed) == found


@pytest.mark.parametrize(
    ("typed", "found"),
    [
        ("", ["a", "ab"]),
        ("ab,", ["ab,a", "ab,ab"]),
        ("ab,ab", ["ab,ab"]),
        ("x,y,a", ["x,y,a", "x,y,ab"]),
        ("a b,z", []),
        ("b", []),
    ],
)
def test_the_last_of_several_names_is_completed_and_the_others_stay(
    typed: str, found: list[str]
) -> None:
    assert some_of(["a", "ab"])(typed) == found


@pytest.mark.parametrize("money", [0.0, nan, -5.0])
def test_money_that_is_none_is_refused_before_anything_is_made(cli: Cli, money: float) -> None:
    outcome = cli("demo", "--money", money, "--rate-hour", 10)
    assert outcome.code == 2
    assert f"money: must be greater than zero, not {money:g}" in outcome.err
