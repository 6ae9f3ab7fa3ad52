"""Errors: one line that says what, where and what to do; a tree with stable exit codes."""

from __future__ import annotations

import pickle

import pytest

import subsoil.errors as tree
from subsoil.errors import BoundaryError, InputError, SubsoilError

KINDS = [
    kind
    for kind in vars(tree).values()
    if isinstance(kind, type) and kind.__module__ == tree.__name__
]


def parents(kind: type) -> set[str]:
    return {parent.__name__ for parent in kind.__mro__ if parent.__module__ == tree.__name__}


@pytest.mark.parametrize("kind", KINDS)
def test_every_error_is_a_subsoil_error_and_stands_in_the_tree_of_the_module(kind: type) -> None:
    assert issubclass(kind, SubsoilError)
    assert kind.__name__ in (tree.__doc__ or "")


@pytest.mark.parametrize("kind", KINDS)
def test_input_errors_exit_with_2_and_all_others_with_3(kind: type[SubsoilError]) -> None:
    assert kind.exit_code == (2 if issubclass(kind, InputError) else 3)


@pytest.mark.parametrize(
    ("child", "parent"),
    [
        ("BoundaryError", "InputError"),
        ("ReadingsError", "InputError"),
        ("ParameterError", "InputError"),
        ("MissingExtraError", "InputError"),
        ("SingularSystemError", "KrigingError"),
        ("SurveyBusyError", "JournalError"),
        ("CorruptJournalError", "JournalError"),
        ("BatteryError", "RobotError"),
    ],
)
def test_the_tree_has_the_branches_it_draws(child: str, parent: str) -> None:
    assert parent in parents(getattr(tree, child))


@pytest.mark.parametrize(
    ("where", "remedy", "line"),
    [
        ("", "", "it is empty"),
        ("a.csv", "", "a.csv: it is empty"),
        ("", "fill it", "it is empty (remedy: fill it)"),
        ("a.csv", "fill it", "a.csv: it is empty (remedy: fill it)"),
    ],
)
def test_a_message_is_place_fact_and_remedy_on_one_line(where: str, remedy: str, line: str) -> None:
    assert str(SubsoilError("it is empty", where=where, remedy=remedy)) == line


@pytest.mark.parametrize("kind", KINDS)
def test_an_error_survives_the_way_between_processes(kind: type[SubsoilError]) -> None:
    error = kind("it is empty", where="a.csv", remedy="fill it")
    copy = pickle.loads(pickle.dumps(error))
    assert type(copy) is kind
    assert str(copy) == str(error)
    assert (copy.what, copy.where, copy.remedy) == ("it is empty", "a.csv", "fill it")


def test_a_boundary_error_can_be_caught_as_wrong_input() -> None:
    with pytest.raises(InputError, match="no such file"):
        raise BoundaryError("there is no such file")
