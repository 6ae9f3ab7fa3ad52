"""A strategy or estimator of somebody's own is checked by the rules that hold for ours."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from subsoil.bench.conformance import RULES, check
from subsoil.cli import run
from subsoil.strategies import Plan, View, area_split

STRATEGIES = """
import gc
import itertools

import numpy as np
from subsoil.strategies import Plan, area_split

_calls = itertools.count()


def free(view):
    return np.flatnonzero(view.free).tolist()


def first(view):
    return Plan(tuple(free(view)[:1]), "the first free cell")


def twice(view):
    return Plan(tuple(2 * free(view)[:1]), "one cell, twice")


def silent(view):
    return Plan(first(view).cells, "")


def early(view):
    return first(view) if len(view.visited) < 3 else Plan((), "three are enough")


def careless(view):
    return Plan((int(np.flatnonzero(view.free)[0]),), "the first of some")


def stubborn(view):
    return area_split(view) if view.fresh else Plan(view.plan, "as planned")


def trusting(view):
    cells = free(view)
    if not cells or len(view.visited) < 3:
        return first(view)
    return Plan((cells[int(np.nanargmax(view.soil_map.kv[cells]))],), "where least is known")


def moody(view):
    cells = free(view)
    return Plan((int(np.random.default_rng().choice(cells)),), "any") if cells else first(view)


def counting(view):
    cells = free(view)
    return Plan((cells[next(_calls) % len(cells)],), "by turns") if cells else first(view)


def meddling(view):
    object.__setattr__(view, "plan", (0, 1))
    return first(view)


def peeking(view):
    from subsoil.bench.conformance.courses import Reader

    cells = free(view)
    readers = [each for each in gc.get_objects() if isinstance(each, Reader)]
    if not (cells and readers):
        return first(view)
    kpa = [readers[-1].soil(*view.field.cells[cell])[0] for cell in cells]
    return Plan((cells[int(np.argmax(kpa))],), "the hardest soil")
"""
ESTIMATORS = """
import itertools

import numpy as np
from subsoil import Spherical

_calls = itertools.count()


def models(z, range_m=50.0, sill=None):
    each = [layer[np.isfinite(layer)] for layer in z]
    sills = [sill or (layer.var() if layer.size > 1 and np.ptp(layer) else 1.0) for layer in each]
    return [Spherical(0.1 * sill, range_m, 0.9 * sill) for sill in sills]


def honest(at, z):
    return models(z)


def fewer(at, z):
    return models(z)[:1]


def strict(at, z):
    if np.isnan(z).any():
        raise ValueError("gaps")
    return models(z)


def ordered(at, z):
    return models(z, range_m=50.0 + (float(at[0, 0]) % 7.0 if len(at) else 0.0))


def rooted(at, z):
    return models(z, range_m=50.0 + (np.abs(at).max() if len(at) else 0.0))


def absolute(at, z):
    return models(z, sill=900.0)


def counting(at, z):
    return models(z, range_m=50.0 + next(_calls))


def filling(at, z):
    z[np.isnan(z)] = 0.0
    return models(z)


class Bent(Spherical):
    def __post_init__(self):
        pass


def bent(at, z):
    return [Bent(-1.0, 50.0, 900.0) for _ in z]


class Maker:
    pass


def three(a, b, c):
    return ()
"""


@pytest.fixture(autouse=True)
def own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Modules of one's own in the current folder."""
    for name, code in (("own_strategies", STRATEGIES), ("own_estimators", ESTIMATORS)):
        (tmp_path / f"{name}.py").write_text(code)
        monkeypatch.delitem(sys.modules, name, raising=False)
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)


def breaks(name: str) -> dict[str, str]:
    """Rules that are broken, by a word or two of theirs, with what was seen."""
    return {each.rule: each.seen for each in check(name).broken}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "rule", "seen"),
    [
        ("twice", "free cells", "planned already"),
        ("silent", "free cells", "no reason"),
        ("early", "takes the samples", "ended after 3 of 24 samples: three are enough"),
        ("careless", "last free cell", "IndexError"),
        ("stubborn", "cells that refuse", "of 10 samples"),
        ("trusting", "no push tells", "All-NaN"),
        ("moody", "same seed", "at first, then"),
        ("counting", "function of the view", "in two ways"),
        ("meddling", "leaves that as it is", "changes the view"),
        ("peeking", "never by the truth", "another way"),
    ],
)
def test_a_strategy_that_breaks_a_rule_is_told_which_and_what_was_seen(
    name: str, rule: str, seen: str
) -> None:
    found = breaks(f"own_strategies:{name}")
    (words,) = (each for each in found if rule in each)
    assert seen in found[words]


@pytest.mark.parametrize(
    ("name", "rule", "seen"),
    [
        ("fewer", "one variogram a layer", "1 variograms for 3 layers"),
        ("strict", "one variogram a layer", "in layer 2: ValueError: gaps"),
        ("bent", "not negative", "layer 1 has a nugget of -1"),
        ("ordered", "order of the readings", "layer 1"),
        ("rooted", "origin of the places", "layer 1"),
        ("absolute", "four times", "not 3600"),
        ("counting", "same variograms", "at first, then"),
        ("filling", "leaves places and values", "changes the values"),
    ],
)
def test_an_estimator_that_breaks_a_rule_is_told_which_and_what_was_seen(
    name: str, rule: str, seen: str
) -> None:
    found = breaks(f"own_estimators:{name}")
    (words,) = (each for each in found if rule in each)
    assert seen in found[words]


def test_what_keeps_all_rules_is_told_so_and_timed() -> None:
    for name, kind in (
        ("own_strategies:first", "strategy"),
        ("own_estimators:honest", "estimator"),
    ):
        found = check(name)
        assert (found.kind, found.broken) == (kind, ())
        assert 0.0 < found.seconds < 5.0


def test_a_function_in_memory_is_checked_too() -> None:
    def mine(view: View) -> Plan:
        return area_split(view)

    assert check(mine).broken == ()


Said = Callable[..., tuple[int, str, str]]


@pytest.fixture
def said(capsys: pytest.CaptureFixture[str]) -> Said:
    def call(*arguments: str) -> tuple[int, str, str]:
        code = run(["bench", "check", *arguments])
        out, err = capsys.readouterr()
        return code, out, err

    return call


def test_a_line_a_rule_says_whether_it_holds_what_was_seen_where_and_what_to_do(
    said: Said,
) -> None:
    code, out, _ = said("own_strategies:early")
    *lines, last = out.splitlines()
    assert code == 1
    assert len(lines) == len(RULES["strategy"])
    assert lines[0] == f"ok: {RULES['strategy'][0].words}"
    assert lines[1] == (
        "BROKEN: a survey takes the samples it was given, or tries every cell: it ended after 3 of "
        "24 samples: three are enough (on: test bed; remedy: plan a stop while View.remaining is "
        "above zero)"
    )
    assert last.startswith("strategy own_strategies:early: ")
    assert "s of processor time a decision" in last


def test_what_breaks_every_rule_is_said_once(said: Said) -> None:
    code, out, _ = said("own_strategies:twice")
    assert code == 1
    assert out.count("planned already") < out.count("BROKEN: ") == out.count("\n") - 1
    assert out.count(": the same\n") > 3


def test_a_program_gets_every_rule_as_json(said: Said) -> None:
    code, out, _ = said("own_estimators:absolute", "--json")
    found = json.loads(out)
    assert (code, found["kind"], found["broken"]) == (1, "estimator", 1)
    assert len(found["verdicts"]) == len(RULES["estimator"])
    (broken,) = (each for each in found["verdicts"] if not each["holds"])
    assert broken["case"] == "30 places, 3 layers"
    assert broken["remedy"]


def test_registered_names_are_checked_and_all_is_well(said: Said) -> None:
    assert said("area-split")[0] == 0
    assert said("spherical")[0] == 0


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("nope",), "no strategy or estimator 'nope'"),
        (("own_estimators:three",), "it takes 3 arguments"),
        (("own_estimators:Maker",), "it is a class"),
        (("own_strategies:missing",), "has no 'missing'"),
        (("no_such_module:mine",), "cannot import"),
        (("area-split", "--kind", "estimator"), "no estimator 'area-split'"),
        (("area-split", "--kind", "robot"), "'robot' is not one of"),
    ],
)
def test_what_cannot_be_checked_is_refused_in_a_line(
    said: Said, arguments: tuple[str, ...], words: str
) -> None:
    code, out, err = said(*arguments)
    assert (code, out) == (2, "")
    assert err.count("\n") == 1
    assert words in err
