"""What typer leaves to us: options in groups, flags without a type, names that complete."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable
from dataclasses import MISSING, fields, is_dataclass
from functools import wraps
from typing import Any, get_type_hints

from typer.core import TyperCommand, TyperGroup

FIELD = "Field and readings"
STRATEGY = "Strategy and estimator"
LIMITS = "Limits: when it is enough"
WAY = "Start and pace"
ROBOT = "Simulated robot"
COMPARISON = "What to compare"
WORK = "How to work"
OUTPUT = "Output"
"""Groups of options in help."""

Complete = Callable[[str], list[str]]
"""From what is typed so far to what it may become."""


def grouped(verb: Callable[..., None]) -> Callable[..., None]:
    """Let the fields of a verb's parameters that are dataclasses be options of their own.

    Parameters
    ----------
    verb
        Function of a verb, all of whose parameters and dataclasses' fields typer understands.

    Returns
    -------
    callable
        What typer takes in its place: it puts the dataclasses together and calls the verb.
    """
    signature = inspect.signature(verb, eval_str=True)
    groups: dict[str, Any] = {
        name: given.annotation
        for name, given in signature.parameters.items()
        if is_dataclass(given.annotation)
    }
    options: list[inspect.Parameter] = []
    for name, given in signature.parameters.items():
        options += _options(groups[name]) if name in groups else [given]

    @wraps(verb)
    def call(**given: Any) -> None:
        for name, group in groups.items():
            given[name] = group(**{each.name: given.pop(each.name) for each in fields(group)})
        verb(**given)

    by_name = [option.replace(kind=inspect.Parameter.KEYWORD_ONLY) for option in options]
    call.__signature__ = signature.replace(parameters=by_name)  # type: ignore[attr-defined]
    return call


def _options(group: Any) -> list[inspect.Parameter]:
    hints = get_type_hints(group, include_extras=True)
    return [
        inspect.Parameter(
            each.name,
            inspect.Parameter.KEYWORD_ONLY,
            default=inspect.Parameter.empty if each.default is MISSING else each.default,
            annotation=hints[each.name],
        )
        for each in fields(group)
    ]


def one_of(names: Iterable[str]) -> Complete:
    """Complete a name."""
    return lambda incomplete: [name for name in names if name.startswith(incomplete)]


def some_of(names: Iterable[str]) -> Complete:
    """Complete the last of several names with commas between them."""

    def complete(incomplete: str) -> list[str]:
        before, comma, last = incomplete.rpartition(",")
        return [f"{before}{comma}{name}" for name in names if name.startswith(last)]

    return complete


class Verb(TyperCommand):
    """A verb whose help shows flags without a type, and ``--help`` with the output's options."""

    def get_params(self, ctx: Any) -> Any:
        """Parameters, as help shows them."""
        params = _as_flags(super().get_params(ctx))
        for param in params:
            if "--help" in param.opts:
                param.rich_help_panel = OUTPUT
        return params


class Verbs(TyperGroup):
    """Verbs under a name, whose help shows flags without a type."""

    def get_params(self, ctx: Any) -> Any:
        """Parameters, as help shows them."""
        return _as_flags(super().get_params(ctx))


def _as_flags(params: Any) -> Any:
    for param in params:
        if getattr(param, "is_flag", False):
            param.metavar = ""
    return params
