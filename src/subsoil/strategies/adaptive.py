"""Adaptive sampling: start from a coverage plan, change it after every sample (paper, III-B.3)."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np

from subsoil.errors import ParameterError
from subsoil.routing import reroute
from subsoil.strategies.coverage import area_split, random
from subsoil.strategies.next_best_view import TIE, draw, highest
from subsoil.strategies.view import Plan, Strategy, View

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

    Cells are added one at a time: once the highest is in the plan, none exceeds it. The number of
    stops may come to differ from the budget; the survey ends at the budget all the same. The
    paper drops targets whose "KV is less than 2 sigma of the distribution of the KV of the
    targets", read here as below the mean by more than 2 sigma (of the population). Its authors'
    later code used 0.2.

    Parameters
    ----------
    view
        The survey so far.
    initial
        Strategy of the plan before leaving.
    drop_sigma
        Standard deviations below the plan's mean KV at which a target is dropped.
    first_change
        Samples before the plan is changed for the first time. The map of one or two samples has a
        variogram that is assumed.

    Raises
    ------
    ParameterError
        If there is no such initial strategy.
    """
    if _too_early(view, first_change):
        return _covered(view, initial)
    kv, planned = view.soil_map.kv, list(view.plan)
    floor = kv[planned].mean() - drop_sigma * kv[planned].std() if planned else 0.0
    kept = [cell for cell in planned if kv[cell] >= floor]
    added = [cell] if exceeds_all else []
    ...


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

    Raises
    ------
    ParameterError
        If there is no such initial strategy, or no candidate.
    """
