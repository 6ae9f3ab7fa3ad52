"""What holds for every strategy, on every field, with every robot: the loop is the real one."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from functools import partial

import pytest

from subsoil.bench.conformance.courses import driven, how, laid_down
from subsoil.bench.conformance.rule import Rule, Subject
from subsoil.bench.conformance.strategies import RULES, end_of
from subsoil.errors import NotAllowedError, ParameterError
from subsoil.land.field import Field
from subsoil.registry import Allowed
from subsoil.strategies import STRATEGIES, strategy_named

OWN = "nearest_cell_strategy:nearest"
EVERY = [*STRATEGIES, OWN]
PLANNED_AHEAD = ["random", "w-shape", "area-split", "joint"]
SEARCHING = ["joint", "joint-adaptive"]
"""They may find the same optimum from any seed."""
BY_CHANCE = [name for name in STRATEGIES if name not in {"w-shape", *SEARCHING}]
FIELDS = ["test bed", "L", "keep-out", "tiny", "thin"]
TRIED = [(rule, case) for rule in RULES for case in rule.cases]


@pytest.fixture(scope="module", autouse=True)
def own_strategy(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """A user's strategy in a file of their own."""
    folder = tmp_path_factory.mktemp("own")
    (folder / "nearest_cell_strategy.py").write_text(
        """
import numpy as np
from subsoil.strategies import Plan, View

def nearest(view: View) -> Plan:
    free = np.flatnonzero(view.free)
    if not free.size:
        return Plan((), "no cell is left")
    away = ((view.field.cells[free] - np.array(view.position)) ** 2).sum(axis=1)
    return Plan((int(free[np.argmin(away)]),), "the nearest")
"""
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(folder)
        yield


@pytest.mark.parametrize("name", EVERY)
@pytest.mark.parametrize(("rule", "case"), TRIED, ids=lambda x: getattr(x, "words", x))
def test_a_strategy_keeps_every_rule(rule: Rule, case: str, name: str) -> None:
    assert rule.seen(Subject(name, Allowed.by_name(name)), case) == ""


@pytest.mark.parametrize("name", BY_CHANCE)
def test_another_seed_gives_another_survey(fields: dict[str, Field], name: str) -> None:
    visited = {driven(fields["L"], how(name, 6, seed)).state.visited for seed in range(3)}
    assert len(visited) == 3


def test_a_w_leaves_nothing_to_chance(fields: dict[str, Field]) -> None:
    visited = {driven(fields["L"], how("w-shape", 6, seed)).state.visited for seed in range(3)}
    assert len(visited) == 1


@pytest.mark.parametrize("name", PLANNED_AHEAD)
@pytest.mark.parametrize("land", FIELDS)
def test_coverage_visits_what_it_planned_in_the_order_it_planned(
    fields: dict[str, Field], land: str, name: str
) -> None:
    course = driven(fields[land], how(name, 12))
    assert course.state.visited == course.plans[0][1].cells


@pytest.mark.parametrize("name", [*PLANNED_AHEAD, "adaptive-monte-carlo"])
def test_the_number_of_stops_stays_with_stones_or_without(
    fields: dict[str, Field], name: str
) -> None:
    stony = set(range(0, len(fields["L"].cells), 4))
    for before, event in driven(fields["L"], how(name, 10), stony=stony).plans:
        assert len(laid_down(before, event)) == 10 - len(before.visited)


def test_settings_reach_the_strategy(fields: dict[str, Field]) -> None:
    course = driven(fields["L"], how("adaptive-greedy", 9, settings={"first_change": 99}))
    assert course.state.visited == driven(fields["L"], how("area-split", 9)).state.visited
    wild: dict[str, float | str] = {"initial": "random", "first_change": 99}
    course = driven(fields["L"], how("adaptive-monte-carlo", 9, settings=wild))
    assert course.state.visited == driven(fields["L"], how("random", 9)).state.visited


def test_a_whole_number_survives_being_kept_as_a_float(fields: dict[str, Field]) -> None:
    settings = how("monte-carlo", 4, settings={"candidates": 7}).settings.strategy_settings
    assert end_of(driven(fields["L"], how("monte-carlo", 4, settings=settings))) == ""
    strategy = strategy_named("monte-carlo", {"candidates": 7.0})
    assert isinstance(strategy, partial)
    assert strategy.keywords == {"candidates": 7}


@pytest.mark.parametrize(
    ("name", "settings", "message"),
    [
        ("grredy", {}, "there is no strategy 'grredy'"),
        ("no_such_module:plan", {}, "cannot import"),
        ("subsoil.strategies:plan_nothing", {}, "cannot import"),
        ("subsoil.strategies:STRATEGIES", {}, "is not callable"),
        ("greedy", {"sigma": 1.0}, "it has none"),
        ("monte-carlo", {"candidate": 9.0}, "it has candidates"),
        ("monte-carlo", {"candidates": 9.5}, "candidates cannot be 9.5"),
        ("monte-carlo", {"candidates": float("nan")}, "candidates cannot be nan"),
        ("w-shape", {"margin": "wide"}, "margin cannot be 'wide'"),
        ("adaptive-greedy", {"initial": 3.0}, "initial cannot be 3.0"),
    ],
)
def test_a_name_or_setting_that_does_not_exist_is_refused(
    name: str, settings: dict[str, float | str], message: str
) -> None:
    with pytest.raises(ParameterError, match=message):
        strategy_named(name, settings, Allowed.by_name(name))


def test_code_of_a_module_that_nobody_allowed_is_not_run() -> None:
    for name in ("os:system", OWN, "subsoil.strategies:greedy", "antigravity:fly"):
        with pytest.raises(NotAllowedError, match=f"give --allow {name.split(':')[0]}"):
            strategy_named(name)
    for name in (":x", "..x:y", "a b:c", "greedy:"):
        with pytest.raises(ParameterError, match="there is no strategy"):
            strategy_named(name)
    assert "antigravity" not in sys.modules
