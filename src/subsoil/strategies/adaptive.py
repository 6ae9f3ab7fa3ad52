"""Adaptive sampling: start from a coverage plan, change it after every sample (paper, III-B.3)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from subsoil.routing import reroute
from subsoil.strategies.coverage import area_split, carry_on, random
from subsoil.strategies.next_best_view import draw
from subsoil.strategies.view import Plan, View

Floats = NDArray[np.float64]
Initial = Literal["area-split", "random"]

_INITIAL = {"area-split": area_split, "random": random}


def adaptive_greedy(
    view: View,
    *,
    initial: Initial = "area-split",
    drop_sigma: float = 2.0,
    first_change: int = 3,
) -> Plan:
    """Drop planned cells of low KV, add the cell whose KV exceeds all in the plan, re-route.

    The paper drops targets whose "KV is less than 2 sigma of the distribution of the KV of the
    targets"; read here as below mean - 2 sigma. Its authors' later code used 0.2.

    Parameters
    ----------
    view
        The survey so far.
    initial
        Strategy of the plan before leaving.
    drop_sigma
        Standard deviations below the plan's mean KV at which a target is dropped.
    first_change
        Samples before the plan is changed for the first time.
    """
    if view.fresh or len(view.visited) < first_change:
        return _keep(view, initial)
    kv, planned = view.soil_map.kv, np.array(view.plan, dtype=np.int64)
    kept = planned[kv[planned] >= _mean(kv[planned]) - drop_sigma * _std(kv[planned])]
    free = np.flatnonzero(view.free)
    best = free[np.argmax(kv[free])] if free.size else -1
    add = free.size and (not kept.size or kv[best] > kv[kept].max() * (1 + 1e-9))
    if len(kept) == len(planned) and not add:
        return Plan(view.plan, "no cell exceeds the plan's KV")
    cells = reroute(view.field.cells, view.position, kept.tolist(), [int(best)] if add else [])
    dropped = len(planned) - len(kept)
    return Plan(cells, f"{dropped} dropped, {f'cell {best} added' if add else 'none added'} by KV")


def adaptive_monte_carlo(
    view: View,
    *,
    initial: Initial = "area-split",
    candidates: int = 50,
    first_change: int = 3,
) -> Plan:
    """Add one cell drawn by KV, let the target of lowest KV go, re-route; the count stays.

    Parameters
    ----------
    view
        The survey so far.
    initial
        Strategy of the plan before leaving.
    candidates
        Size of the random set the new cell is drawn from.
    first_change
        Samples before the plan is changed for the first time.
    """
    plan = _keep(view, initial)
    if view.fresh or len(view.visited) < first_change or not view.free.any():
        return plan
    new = draw(replace(view, plan=plan.cells), candidates)
    kv = view.soil_map.kv
    targets = [*plan.cells, new]
    worst = targets[int(np.argmin(kv[targets]))]
    if worst == new:
        return Plan(plan.cells, f"cell {new} drawn, but lowest in KV")
    kept = [cell for cell in plan.cells if cell != worst]
    cells = reroute(view.field.cells, view.position, kept, [new])
    return Plan(cells, f"cell {new} drawn by KV for cell {worst}")


def _keep(view: View, initial: Initial) -> Plan:
    return _INITIAL[initial](view) if view.fresh else carry_on(view)


def _mean(values: Sequence[float] | Floats) -> float:
    return float(np.mean(values)) if len(values) else 0.0


def _std(values: Sequence[float] | Floats) -> float:
    return float(np.std(values)) if len(values) else 0.0
