"""Area coverage: choose all stops before leaving, then drive the tour (paper, sec. III-B.1)."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.spatial import cKDTree
from shapely.geometry import LineString

from subsoil.routing import reroute, tour
from subsoil.strategies.view import Plan, View

Floats = NDArray[np.float64]


def random(view: View) -> Plan:
    """Stops at cells drawn uniformly without replacement, in tour order."""
    if not view.fresh:
        return carry_on(view)
    cells = view.rng.choice(np.flatnonzero(view.free), view.remaining, replace=False)
    return _toured(view, cells, f"{view.remaining} random cells")


def w_shape(view: View, *, margin: float = 0.03, amplitude: float = 0.7) -> Plan:
    """Stops along a W over the field's oriented extent, evenly spaced, clipped to the boundary.

    Parameters
    ----------
    view
        The survey so far.
    margin
        Share of the field's length kept free at either end of the W.
    amplitude
        Height of the W as a share of the field's width.
    """
    if not view.fresh:
        return carry_on(view)
    w = shapely.intersection(_w_over(view, margin, amplitude), view.field.boundary)
    parts = [part for part in shapely.get_parts(w) if part.length > 0]
    ends = np.cumsum([0.0, *(part.length for part in parts)])
    along = np.linspace(0.0, ends[-1], view.remaining)
    index = np.clip(np.searchsorted(ends, along, side="right") - 1, 0, len(parts) - 1)
    points = [parts[k].interpolate(s - ends[k]) for k, s in zip(index, along, strict=True)]
    cells = _unique_nearest(view, np.array([(p.x, p.y) for p in points]))
    return _toured(view, cells, f"{view.remaining} stops along a W")


def area_split(view: View, *, rounds: int = 60) -> Plan:
    """Stops at the centres of areas of roughly equal size, in tour order.

    Lloyd's k-means on the cells; distances are offset so that large areas shrink (a power
    diagram; Aurenhammer et al. 1998). A centre outside the field moves to the nearest cell.

    Parameters
    ----------
    view
        The survey so far.
    rounds
        Lloyd iterations.
    """
    if not view.fresh:
        return carry_on(view)
    centres = _split(view.field.cells, view.remaining, rounds, view.rng)
    cells = _unique_nearest(view, centres)
    return _toured(view, cells, f"centres of {view.remaining} areas of equal size")


def carry_on(view: View) -> Plan:
    """Keep to the plan; a refused stop is tried again at the nearest free cell."""
    short = view.remaining - len(view.plan)
    if short <= 0 or not view.refused or not view.free.any():
        return Plan(view.plan, "as planned")
    free = np.flatnonzero(view.free)
    away = ((view.field.cells[free] - view.field.cells[view.refused[-1]]) ** 2).sum(axis=1)
    stand_in = int(free[np.argmin(away)])
    cells = reroute(view.field.cells, view.position, view.plan, [stand_in])
    return Plan(cells, f"cell {stand_in} stands in for refused cell {view.refused[-1]}")


def _toured(view: View, cells: NDArray[np.int64], reason: str) -> Plan:
    order = tour(view.position, view.field.cells[cells])
    return Plan(tuple(int(cells[k]) for k in order), reason)


def _w_over(view: View, margin: float, amplitude: float) -> LineString:
    box = shapely.oriented_envelope(view.field.boundary)
    corners = shapely.get_coordinates(box)[:4]
    sides = np.hypot(*(corners[1] - corners[0])), np.hypot(*(corners[2] - corners[1]))
    if sides[0] < sides[1]:
        corners = np.roll(corners, -1, axis=0)
    origin, along, across = corners[0], corners[1] - corners[0], corners[3] - corners[0]
    low, high = 0.5 - amplitude / 2, 0.5 + amplitude / 2
    s = np.linspace(margin, 1 - margin, 5)
    t = np.array([high, low, high, low, high])
    return LineString(origin + s[:, None] * along + t[:, None] * across)


def _split(cells: Floats, k: int, rounds: int, rng: np.random.Generator) -> Floats:
    centres = cells[rng.choice(len(cells), k, replace=False)].copy()
    share = len(cells) / k
    spread = np.prod(np.ptp(cells, axis=0)) / k
    offset = np.zeros(k)
    for _ in range(rounds):
        distance = ((cells[:, None, :] - centres[None]) ** 2).sum(axis=2) + offset
        owner = np.argmin(distance, axis=1)
        size = np.bincount(owner, minlength=k)
        held = size > 0
        for axis in range(2):
            total = np.bincount(owner, weights=cells[:, axis], minlength=k)
            centres[held, axis] = total[held] / size[held]
        offset += 0.1 * spread * (size / share - 1.0)
    return centres


def _unique_nearest(view: View, points: Floats) -> NDArray[np.int64]:
    """One free cell a point, the nearest not taken by an earlier point."""
    free = np.flatnonzero(view.free)
    tree = cKDTree(view.field.cells[free])
    taken: list[int] = []
    for point in points:
        near = tree.query(point, k=np.arange(1, min(len(taken) + 1, len(free)) + 1))[1]
        taken.append(int(next(c for c in free[np.atleast_1d(near)] if c not in taken)))
    return np.array(taken)
