"""Next best view: after every sample, go where the map is least sure (paper, sec. III-B.2)."""

from __future__ import annotations

import numpy as np

from subsoil.errors import ParameterError
from subsoil.strategies.view import Plan, View

TIE = 1e-9
"""Relative difference below which two KV are the same."""


def greedy(view: View) -> Plan:
    """The free cell of highest KV; ties go to the nearest, then to the lowest index.

    While the map says nothing yet every cell is alike, and the stop is drawn uniformly.
    """
    if not _can_choose(view):
        return _anywhere(view)
    cell = highest(view)
    return Plan((cell,), f"highest KV, {view.soil_map.kv[cell]:.0f} kPa2")


def monte_carlo(view: View, *, candidates: int = 50) -> Plan:
    """A free cell drawn with probability proportional to its KV from a random set of candidates.

    While the map says nothing yet the stop is drawn uniformly.

    Parameters
    ----------
    view
        The survey so far.
    candidates
        Size of the set, drawn uniformly.

    Raises
    ------
    ParameterError
        If there is no candidate.
    """
    if not _can_choose(view):
        return _anywhere(view)
    cell = draw(view, candidates)
    return Plan((cell,), f"drawn by KV, {view.soil_map.kv[cell]:.0f} kPa2")


def highest(view: View) -> int:
    """The free cell of highest KV; ties go to the nearest, then to the lowest index."""
    free = np.flatnonzero(view.free)
    kv = view.soil_map.kv[free]
    best = free[kv >= kv.max() * (1 - TIE)]
    away = view.access.between(view.position, view.access.at[best])
    return int(best[np.argmin(away)])


def draw(view: View, candidates: int) -> int:
    """Draw one cell with probability proportional to KV from some free cells.

    Parameters
    ----------
    view
        The survey so far; some cell is free.
    candidates
        How many, drawn uniformly; all where fewer are free.

    Raises
    ------
    ParameterError
        If there is no candidate.
    """
    if candidates < 1:
        raise ParameterError(f"{candidates} candidates leave nothing to draw", where="candidates")
    free = np.flatnonzero(view.free)
    some = view.rng.choice(free, min(candidates, len(free)), replace=False)
    kv = view.soil_map.kv[some]
    return int(view.rng.choice(some, p=kv / kv.sum()))


def _can_choose(view: View) -> bool:
    return view.informed and bool(view.free.any())


def _anywhere(view: View) -> Plan:
    free = np.flatnonzero(view.free)
    if not free.size:
        return Plan((), "no cell is left")
    return Plan((int(view.rng.choice(free)),), "the map says nothing yet: drawn uniformly")
