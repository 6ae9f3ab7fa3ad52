"""Next best view: after every sample, go where the map is least sure (paper, sec. III-B.2)."""

from __future__ import annotations

import numpy as np

from subsoil.strategies.view import Plan, View


def greedy(view: View) -> Plan:
    """The free cell of highest KV; ties go to the nearest, then to the lowest index.

    Before the first sample every cell is alike: the first stop is drawn uniformly.
    """
    if not view.visited:
        return _first(view)
    free = np.flatnonzero(view.free)
    kv = view.soil_map.kv[free]
    best = free[kv >= kv.max() * (1 - 1e-12)]
    away = ((view.field.cells[best] - np.array(view.position)) ** 2).sum(axis=1)
    cell = int(best[np.argmin(away)])
    return Plan((cell,), f"highest KV, {view.soil_map.kv[cell]:.0f} kPa2")


def monte_carlo(view: View, *, candidates: int = 50) -> Plan:
    """A free cell drawn with probability proportional to its KV from a random set of candidates.

    Parameters
    ----------
    view
        The survey so far.
    candidates
        Size of the set, drawn uniformly.
    """
    if not view.visited:
        return _first(view)
    cell = draw(view, candidates)
    return Plan((cell,), f"drawn by KV, {view.soil_map.kv[cell]:.0f} kPa2")


def draw(view: View, candidates: int) -> int:
    """Draw one cell with probability proportional to KV from some free cells."""
    free = np.flatnonzero(view.free)
    some = view.rng.choice(free, min(candidates, len(free)), replace=False)
    kv = view.soil_map.kv[some]
    return int(view.rng.choice(some, p=kv / kv.sum()))


def _first(view: View) -> Plan:
    cell = int(view.rng.choice(np.flatnonzero(view.free)))
    return Plan((cell,), "first stop, drawn uniformly")
