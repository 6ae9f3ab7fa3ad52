"""Adaptive sampling: start from a coverage plan, change it after every sample (paper, III-B.3)."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

from subsoil.errors import ParameterError
from subsoil.strategies.coverage import area_split, random
from subsoil.strategies.next_best_view import TIE, draw, highest
from subsoil.strategies.view import Plan, Strategy, View
from subsoil.ways.routing import reroute

Initial = Literal["area-split", "random"]

_INITIAL: dict[str, Strategy] = {"area-split": area_split, "random": random}


def adaptive_greedy(
    view: View,
    *,
    initial: Initial = "area-split",
    drop_sigma: float = 2.0,
    first_change: int = 3,
) -> Plan:
    """Drop planned cells of low KV, add the cell whose KV exceeds all in the plan, re-route.

    One cell at most is added at a time: with the highest in the plan, none exceeds the plan. The
    stops planned may come to be more than the budget, which ends the survey all the same.

    The paper drops targets whose "KV is less than 2 sigma of the distribution of the KV of the
    targets". It is read here as below their mean by more than two (population) standard
    deviations. Its authors' later code used 0.2.

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

    Raises
    ------
    ParameterError
        If there is no such initial strategy.
    """
    covering = _covering(initial)
    if not _may_change(view, first_change):
        return covering(view)
    kept = _worthy(view, drop_sigma)
    added = _exceeding(view, kept)
    dropped = len(view.plan) - len(kept)
    if not added and not dropped:
        return Plan(view.plan, "no cell exceeds the plan's KV")
    cells = reroute(view.access, view.access.at, view.position, kept, added)
    return Plan(cells, f"{dropped} dropped, {f'cell {added[0]}' if added else 'none'} added by KV")


def adaptive_monte_carlo(
    view: View,
    *,
    initial: Initial = "area-split",
    candidates: int = 50,
    first_change: int = 3,
) -> Plan:
    """Add one cell drawn by KV, let the target of lowest KV go, re-route; the count stays.

    The cell drawn may be the one of lowest KV: then the plan stays.

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

    Raises
    ------
    ParameterError
        If there is no such initial strategy, or no candidate.
    """
    plan = _covering(initial)(view)
    view = replace(view, plan=plan.cells)
    if not (plan.cells and _may_change(view, first_change)):
        return plan
    new, kv = draw(view, candidates), view.soil_map.kv
    worst = min((*plan.cells, new), key=lambda cell: float(kv[cell]))
    if worst == new:
        return Plan(plan.cells, f"cell {new} drawn, but lowest in KV")
    kept = [cell for cell in plan.cells if cell != worst]
    cells = reroute(view.access, view.access.at, view.position, kept, [new])
    return Plan(cells, f"cell {new} drawn by KV for cell {worst}")


def _covering(initial: Initial) -> Strategy:
    if initial not in _INITIAL:
        raise ParameterError(
            f"there is no initial plan {initial!r}",
            where="adaptive strategy",
            remedy=f"one of {', '.join(_INITIAL)}",
        )
    return _INITIAL[initial]


def _may_change(view: View, first_change: int) -> bool:
    seen = view.informed and len(view.visited) >= first_change
    return seen and not view.fresh and bool(view.free.any())


def _worthy(view: View, drop_sigma: float) -> list[int]:
    """Planned cells whose KV is not far below the plan's mean."""
    if not view.plan:
        return []
    kv = view.soil_map.kv[list(view.plan)]
    worthy = kv >= (kv.mean() - drop_sigma * kv.std()) * (1 - TIE)
    return [cell for cell, stays in zip(view.plan, worthy, strict=True) if stays]


def _exceeding(view: View, planned: list[int]) -> list[int]:
    """The cell of highest KV if that exceeds all in a plan, else none."""
    best, kv = highest(view), view.soil_map.kv
    return [best] if not planned or kv[best] > kv[planned].max() * (1 + TIE) else []
