"""Things by name: what is built in, what packages bring along, and what the user allows."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from subsoil.errors import NotAllowedError, ParameterError
from subsoil.land.field import Field
from subsoil.registry import NOBODY, Allowed, Registry, handed_over, imported
from subsoil.strategies import plan, strategy_named
from subsoil.variogram import Spherical, estimator_named


def built_in() -> str:
    """Stand for what is there always."""
    return "built in"


THINGS: Registry[object] = Registry("thing", "subsoil.things", {"first": built_in})


@pytest.fixture
def plug_in(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """An installed package that offers a strategy, an estimator, and two names taken already."""
    (tmp_path / "plugged_in.py").write_text(
        """
import numpy as np
from subsoil.strategies import Plan
from subsoil.variogram import Spherical

def last(view):
    return Plan((int(np.flatnonzero(view.free)[-1]),), "the last cell")

def fixed(at, z):
    return [Spherical(1.0, 20.0, 9.0)] * len(z)
"""
    )
    (tmp_path / "broken_plug.py").write_text("1 / 0\n")
    folder = tmp_path / "plugged_in-1.0.dist-info"
    folder.mkdir()
    (folder / "METADATA").write_text("Metadata-Version: 2.1\nName: plugged-in\nVersion: 1.0\n")
    (folder / "entry_points.txt").write_text(
        "[subsoil.strategies]\nlast-cell = plugged_in:last\ngreedy = plugged_in:last\n"
        "[subsoil.estimators]\nfixed = plugged_in:fixed\n"
        "[subsoil.things]\nzebra = plugged_in:last\nadder = plugged_in:fixed\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    yield
    for name in ("plugged_in", "broken_plug"):
        sys.modules.pop(name, None)


@pytest.mark.usefixtures("plug_in")
def test_a_package_brings_strategies_and_estimators_along_without_leave() -> None:
    field = Field.from_metres([(0, 0), (60, 0), (60, 40), (0, 40)])
    assert plan(field, "last-cell", samples=3).cells == (95,)
    fits = estimator_named("fixed")(np.zeros((2, 2)), np.ones((1, 2)))
    assert fits[0].variogram == Spherical(1.0, 20.0, 9.0)
    assert fits[0].why == "fixed"


@pytest.mark.usefixtures("plug_in")
def test_no_package_takes_the_name_of_what_is_built_in() -> None:
    assert strategy_named("greedy").__module__ == "subsoil.strategies.next_best_view"


@pytest.mark.usefixtures("plug_in")
def test_names_are_those_built_in_and_then_those_of_packages_by_the_alphabet() -> None:
    assert THINGS.names == ("first", "adder", "zebra")
    with pytest.raises(ParameterError) as raised:
        THINGS["second"]
    assert str(raised.value) == (
        "thing: there is no thing 'second' (remedy: one of first, adder, zebra, or your own as "
        "module:attribute)"
    )


@pytest.mark.usefixtures("plug_in")
def test_a_module_is_imported_where_it_is_allowed_and_only_there() -> None:
    with pytest.raises(NotAllowedError) as raised:
        THINGS.named("plugged_in:last", Allowed.by_name("other:thing"))
    assert raised.value.remedy == "if you trust it, give --allow plugged_in"
    assert "plugged_in" not in sys.modules
    found = THINGS.named("plugged_in:last", Allowed.by_name("plugged_in:anything"))
    assert found is sys.modules["plugged_in"].last


@pytest.mark.usefixtures("plug_in")
@pytest.mark.parametrize(
    ("name", "what", "remedy"),
    [
        ("plugged_in:first", "its module has no 'first'", "check what plugged_in defines"),
        ("plugged_in:np", "'plugged_in:np' is not callable", ""),
        ("broken_plug:x", "cannot import 'broken_plug': ZeroDivisionError: division by", "check"),
        ("no_such_plug:x", "cannot import 'no_such_plug': ModuleNotFoundError", "from this folder"),
    ],
)
def test_what_cannot_be_imported_is_said_with_why(name: str, what: str, remedy: str) -> None:
    with pytest.raises(ParameterError) as raised:
        THINGS.named(name, Allowed.by_name(name))
    assert what in raised.value.what
    assert remedy in raised.value.remedy
    assert raised.value.where.startswith("thing")
    assert "\n" not in str(raised.value)


def test_what_is_handed_over_stands_for_its_name_before_all_else() -> None:
    other = Allowed(given={"first": len})
    assert THINGS.named("first", other) is len
    assert THINGS.named("first", NOBODY) is built_in
    assert THINGS["first"] is built_in


def test_what_is_handed_over_is_named_by_where_it_is_defined() -> None:
    class Callable_:  # noqa: N801
        def __call__(self) -> None: ...

    one, two = handed_over(built_in), handed_over(Callable_())
    assert one[0].endswith("test_registry:built_in")
    assert two[0].endswith("<locals>.Callable_")
    assert handed_over(partial(built_in))[0] == "functools:partial"
    for name, allowed in (one, two):
        assert set(allowed.given) == {name}
        assert not allowed.modules
    assert handed_over("greedy") == ("greedy", NOBODY)


@given(
    st.frozensets(st.sampled_from("abc")), st.frozensets(st.sampled_from("abc")),
    st.dictionaries(st.sampled_from("xyz"), st.just(len)),
    st.dictionaries(st.sampled_from("xyz"), st.just(abs)),
)  # fmt: skip
def test_both_allow_what_either_does_and_the_later_thing_wins(
    one: frozenset[str], other: frozenset[str], given_: dict[str, object], later: dict[str, object]
) -> None:
    both = Allowed(one, given_) | Allowed(other, later)  # type: ignore[arg-type]
    assert both.modules == one | other
    assert both.given == {**given_, **later}
    assert (Allowed(one) | NOBODY) == Allowed(one)


@pytest.mark.parametrize("name", ["plain", ":attribute", "module:"])
def test_a_name_without_a_module_or_an_attribute_allows_nothing(name: str) -> None:
    assert {module for module in Allowed.by_name(name).modules if module} == set()


def test_long_names_are_cut_short_in_what_is_said_of_them() -> None:
    long = "m" * 300
    for name in (long, f"{long}:x"):
        with pytest.raises(ParameterError) as raised:
            THINGS.named(name)
        assert len(raised.value.what) < 200
    with pytest.raises(ParameterError) as raised:
        imported(long, "nowhere")
    assert raised.value.where == "nowhere"
    assert len(raised.value.what) < 300
