"""Strategies: where to probe next.

A strategy is one callable from a :class:`View` to a :class:`Plan`. Those of the paper are here by
name; any other comes with an installed package, or is given as ``module:attribute`` and allowed.
"""

from __future__ import annotations

from subsoil.strategies.joint.plans import designs_for
from subsoil.strategies.named import STRATEGIES, strategy_named
from subsoil.strategies.planning import plan, planned
from subsoil.strategies.view import Plan, Strategy, View

__all__ = [
    "STRATEGIES",
    "Plan",
    "Strategy",
    "View",
    "designs_for",
    "plan",
    "planned",
    "strategy_named",
]
