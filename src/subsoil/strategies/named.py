"""Strategies by name."""

from __future__ import annotations

from functools import partial
from inspect import Parameter, signature
from typing import Any, cast

from subsoil.errors import ParameterError, brief
from subsoil.registry import NOBODY, Allowed, Registry
from subsoil.strategies.adaptive import adaptive_greedy, adaptive_monte_carlo
from subsoil.strategies.coverage import area_split, random, w_shape
from subsoil.strategies.joint.plans import joint, joint_adaptive
from subsoil.strategies.next_best_view import greedy, monte_carlo
from subsoil.strategies.view import Strategy

STRATEGIES: dict[str, Strategy] = {
    "random": random,
    "w-shape": w_shape,
    "area-split": area_split,
    "greedy": greedy,
    "monte-carlo": monte_carlo,
    "adaptive-greedy": adaptive_greedy,
    "adaptive-monte-carlo": adaptive_monte_carlo,
    "joint": joint,
    "joint-adaptive": joint_adaptive,
}
"""Strategies by name."""


REGISTRY: Registry[Strategy] = Registry("strategy", "subsoil.strategies", STRATEGIES)
"""Strategies by name, those of installed packages included."""


def strategy_named(
    name: str,
    settings: dict[str, float | str] | None = None,
    allowed: Allowed = NOBODY,
) -> Strategy:
    """Strategy of a registered name, with some parameters set.

    Parameters
    ----------
    name
        Built in, or an entry point ``subsoil.strategies`` of an installed package, or
        ``module:attribute`` of an allowed module.
    settings
        Parameters of the strategy that differ from what they are otherwise.
    allowed
        Modules that may be imported.

    Raises
    ------
    ParameterError
        If there is no such strategy, or it has no such parameter.
    NotAllowedError
        If it is code of a module that is not allowed.

    Examples
    --------
    >>> name = "subsoil.strategies:greedy"
    >>> own = strategy_named(name, allowed=Allowed.by_name(name))
    >>> strategy_named("greedy") is own
    True
    """
    strategy = REGISTRY.named(name, allowed)
    return _with_settings(name, strategy, settings) if settings else strategy


def _with_settings(name: str, strategy: Strategy, settings: dict[str, float | str]) -> Strategy:
    known = dict(list(signature(strategy).parameters.items())[1:])
    for key in settings:
        if key not in known:
            raise ParameterError(
                f"strategy {brief(name)} has no parameter {brief(key)!r}",
                where="strategy",
                remedy=f"it has {', '.join(known) or 'none'}",
            )
    values: dict[str, Any] = {key: _suiting(known[key], value) for key, value in settings.items()}
    return cast(Strategy, partial(strategy, **values))


def _suiting(parameter: Parameter, value: float | str) -> float | str:
    """Value of the kind of a parameter's default: settings keep whole numbers as floats.

    Raises
    ------
    ParameterError
        If it is of another kind.
    """
    match default := parameter.default:
        case str():
            suits = isinstance(value, str)
        case int():
            suits = not isinstance(value, str) and float(value).is_integer()
        case float():
            suits = not isinstance(value, str)
        case _:
            suits = True
    if not suits:
        raise ParameterError(
            f"{parameter.name} cannot be {brief(repr(value))}",
            where="strategy",
            remedy=f"use something like {default!r}",
        )
    return int(value) if isinstance(default, int) else value
