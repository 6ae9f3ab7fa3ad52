"""Strategies: where to probe next.

A strategy is one callable from a :class:`View` to a :class:`Plan`. Those of the paper are here by
name; any other comes with an installed package, or is given as ``module:attribute`` and allowed.
"""

from __future__ import annotations

from subsoil.strategies.adaptive import adaptive_greedy, adaptive_monte_carlo
from subsoil.strategies.coverage import area_split, random, w_shape
from subsoil.strategies.joint.plans import designs_for, joint, joint_adaptive
from subsoil.strategies.named import STRATEGIES, strategy_named
from subsoil.strategies.next_best_view import greedy, monte_carlo
from subsoil.strategies.planning import plan, planned
from subsoil.strategies.view import Plan, Strategy, View

__all__ = [
    "STRATEGIES",
    "Plan",
    "Strategy",
    "View",
    "adaptive_greedy",
    "adaptive_monte_carlo",
    "area_split",
    "designs_for",
    "greedy",
    "joint",
    "joint_adaptive",
    "monte_carlo",
    "plan",
    "planned",
    "random",
    "strategy_named",
    "w_shape",
]
