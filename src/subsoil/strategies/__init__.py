"""Strategies: where to probe next.

A strategy is one callable from a :class:`View` to a :class:`Plan`. Those of the paper are here by
name; any other is given as ``module:attribute``.
"""

from __future__ import annotations

from functools import partial
from importlib import import_module
from inspect import Parameter, signature
from typing import Any, cast

from subsoil.errors import ParameterError
from subsoil.strategies.adaptive import adaptive_greedy, adaptive_monte_carlo
from subsoil.strategies.coverage import area_split, random, w_shape
from subsoil.strategies.joint_plans import joint, joint_adaptive
from subsoil.strategies.next_best_view import greedy, monte_carlo
from subsoil.strategies.view import Plan, Strategy, View

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


def strategy_named(name: str, settings: dict[str, float | str] | None = None) -> Strategy:
    """Strategy of a registered name or of ``module:attribute``, with some parameters set.

    Raises
    ------
    ParameterError
        If there is no such strategy, or it has no such parameter.

    Examples
    --------
    >>> strategy_named("greedy") is strategy_named("subsoil.strategies:greedy")
    True
    """
    strategy = STRATEGIES[name] if name in STRATEGIES else _imported(name)
    return _with_settings(name, strategy, settings) if settings else strategy


def _imported(name: str) -> Strategy:
    module, _, attribute = name.partition(":")
    if not attribute:
        raise ParameterError(
            f"there is no strategy {name!r}",
            where="strategy",
            remedy=f"one of {', '.join(STRATEGIES)}, or your own as module:attribute",
        )
    try:
        strategy: Strategy = getattr(import_module(module), attribute)
    except (ImportError, AttributeError) as error:
        raise ParameterError(
            f"cannot import {name!r}: {error}",
            where="strategy",
            remedy="check that Python finds the module from here",
        ) from error
    if not callable(strategy):
        raise ParameterError(f"{name!r} is not callable", where="strategy")
    return strategy


def _with_settings(name: str, strategy: Strategy, settings: dict[str, float | str]) -> Strategy:
    known = dict(list(signature(strategy).parameters.items())[1:])
    for key in settings:
        if key not in known:
            raise ParameterError(
                f"strategy {name} has no parameter {key!r}",
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
            f"{parameter.name} cannot be {value!r}",
            where="strategy",
            remedy=f"use something like {default!r}",
        )
    return int(value) if isinstance(default, int) else value


__all__ = ["STRATEGIES", "Plan", "Strategy", "View", "strategy_named"]
