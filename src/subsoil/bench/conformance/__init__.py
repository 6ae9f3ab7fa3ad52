"""What must hold of every strategy and every estimator, one's own included.

The tests of subsoil's own strategies and estimators try the same rules.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

from subsoil import variogram
from subsoil.bench.conformance import estimators, strategies
from subsoil.bench.conformance.rule import Rule, Subject, Verdict, verdict
from subsoil.errors import ParameterError, SubsoilError, brief
from subsoil.registry import Allowed, Registry, handed_over
from subsoil.strategies import named

Kind = Literal["strategy", "estimator"]

RULES: dict[Kind, tuple[Rule, ...]] = {
    "strategy": strategies.RULES,
    "estimator": estimators.RULES,
}
"""Rules by what they are for."""
_TIMED: dict[Kind, Callable[[Subject], float]] = {
    "strategy": strategies.decision_s,
    "estimator": estimators.estimate_s,
}
_REGISTRIES: dict[Kind, Registry[Any]] = {
    "strategy": named.REGISTRY,
    "estimator": variogram.estimators.REGISTRY,
}
_ARGUMENTS: dict[int, Kind] = {1: "strategy", 2: "estimator"}
"""What a function is by the number of arguments that it is called with: a view, or places and
values."""


@dataclass(frozen=True)
class Conformance:
    """What came of all rules for a strategy or an estimator.

    Attributes
    ----------
    name, kind
        What was checked, and as what.
    verdicts
        One a rule.
    seconds
        Processor time of a decision, or of the variograms of 30 readings; NaN where it fails.
    """

    name: str
    kind: Kind
    verdicts: tuple[Verdict, ...]
    seconds: float

    @property
    def broken(self) -> tuple[Verdict, ...]:
        """Rules that do not hold."""
        return tuple(each for each in self.verdicts if not each.holds)


def check(
    thing: str | Callable[..., Any],
    kind: Kind | None = None,
    *,
    told: Callable[[Verdict], None] = lambda _: None,
) -> Conformance:
    """Try all rules on a strategy or an estimator.

    Parameters
    ----------
    thing
        Registered name, ``module:attribute``, or a callable.
    kind
        What it is. Default: a strategy if it is called with one argument, the view; an estimator
        if with two, places and values.
    told
        Told of each verdict once it is there.

    Raises
    ------
    ParameterError
        If there is no such thing, or it cannot be told what it is.

    Examples
    --------
    >>> check("area-split").broken
    ()
    """
    name, allowed = handed_over(thing)
    known = kind or _kind_of(name, allowed)
    subject = Subject(name, allowed)
    _REGISTRIES[known].named(name, allowed)
    verdicts = []
    for rule in RULES[known]:
        verdicts.append(verdict(rule, subject))
        told(verdicts[-1])
    return Conformance(name, known, tuple(verdicts), _seconds(known, subject))


def _seconds(kind: Kind, subject: Subject) -> float:
    try:
        return _TIMED[kind](subject)
    except SubsoilError:
        return float("nan")


def _kind_of(name: str, allowed: Allowed) -> Kind:
    """What a thing is: as what it is registered, or else by how it is called.

    Raises
    ------
    ParameterError
        If there is no such thing, or it is called as neither.
    """
    registered = {each: kind for kind, them in _REGISTRIES.items() for each in them.names}
    if name in registered:
        return registered[name]
    if ":" not in name:
        raise ParameterError(
            f"there is no strategy or estimator {brief(name)!r}",
            where="check",
            remedy=f"one of {', '.join(registered)}, or your own as module:attribute",
        )
    found = _REGISTRIES["strategy"].named(name, allowed)
    if inspect.isclass(found):
        raise ParameterError(
            "it is a class, and what it makes is a strategy or an estimator",
            where=brief(name),
            remedy="make one in the module, and name that",
        )
    number = _arguments(found)
    if number not in _ARGUMENTS:
        taken = "does not say what it takes" if number is None else f"takes {number} arguments"
        raise ParameterError(
            f"it {taken}, where a strategy takes one (view) and an estimator two (at, z)",
            where=brief(name),
            remedy="give --kind strategy for plan(view), --kind estimator for estimate(at, z)",
        )
    return _ARGUMENTS[number]


def _arguments(thing: Callable[..., Any]) -> int | None:
    """Arguments that a callable must be given by their place; None if it does not say."""
    try:
        known = inspect.signature(thing).parameters.values()
    except (TypeError, ValueError):
        return None
    place = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    if any(each.kind is inspect.Parameter.VAR_POSITIONAL for each in known):
        return None
    return sum(each.kind in place and each.default is each.empty for each in known)
