"""Area coverage: choose all stops before leaving, then drive the tour (paper, sec. III-B.1)."""

from __future__ import annotations

from math import ceil

import numpy as np
import scipy
import shapely
from shapely.geometry import LineString

from subsoil.arrays import Floats, Integers
from subsoil.errors import ParameterError
from subsoil.land.field import Field
from subsoil.strategies.view import Plan, View
from subsoil.ways.routing import reroute, tour

_POINTS_A_CELL = 10
"""Points along the W to choose stops from, on the length of a cell."""
_YIELD = 0.1
"""Share of its surplus that an area gives away in a round."""


def random(view: View) -> Plan:
    """Stops at cells drawn uniformly without replacement, in tour order."""
    if not _due(view):
        return carry_on(view)
    cells = view.rng.choice(np.flatnonzero(view.free), view.remaining, replace=False)
    return _toured(view, cells, f"{view.remaining} random cells")


def w_shape(view: View, *, margin: float = 0.03, amplitude: float = 0.7) -> Plan:
    """Stops evenly spaced along a W, as far as it lies in the field, in tour order.

    The W runs along the longer side of the field's oriented extent and stands upright on a map
    with north up (for a field that runs due north, with west up).

    Parameters
    ----------
    view
        The survey so far.
    margin
        Share of the field's length kept free at either end of the W.
    amplitude
        Height of the W as a share of the field's width.

    Raises
    ------
    ParameterError
        If the W would have no length or leave the field's extent.
    """
    if not (0 <= margin < 0.5 and 0 < amplitude <= 1):
        raise ParameterError(
            f"a W of margin {margin:g} and amplitude {amplitude:g} does not lie in the field",
            where="strategy w-shape",
            remedy="use a margin from 0 to 0.5 and an amplitude up to 1",
        )
    if not _due(view):
        return carry_on(view)
    points = _w_inside(view.field, margin, amplitude)
    chosen = np.linspace(0, len(points) - 1, view.remaining).round().astype(np.int64)
    return _toured(view, nearest_free(view, points[chosen]), f"{view.remaining} stops along a W")


def area_split(view: View, *, rounds: int = 60) -> Plan:
    """Stops at the centres of areas of roughly equal size, in tour order.

    A centre outside the field moves to the nearest cell.

    Parameters
    ----------
    view
        The survey so far.
    rounds
        Rounds of :func:`areas`.

    Raises
    ------
    ParameterError
        If there is no round.
    """
    if rounds < 1:
        raise ParameterError(f"{rounds} rounds split nothing", where="strategy area-split")
    if not _due(view):
        return carry_on(view)
    _, centres = areas(view.field, view.remaining, rounds, view.rng)
    cells = nearest_free(view, centres)
    return _toured(view, cells, f"centres of {view.remaining} areas of about equal size")


def areas(field: Field, k: int, rounds: int, rng: np.random.Generator) -> tuple[Integers, Floats]:
    """Split a field into k compact areas of about equal size.

    Lloyd's k-means on the cells, from k of them drawn at random, with distances offset by what an
    area has too much of: a power diagram (Aurenhammer, Hoffmann & Aronov 1998, Algorithmica 20,
    61). With a dozen cells or more to an area, sizes come out within about a third of the
    fair one.

    Parameters
    ----------
    field
        The field of N cells.
    k
        Number of areas, from 1 to N.
    rounds
        Times that areas are drawn anew.
    rng
        Source of the first centres.

    Returns
    -------
    tuple
        (N,) area of each cell and (k, 2) centres in m. With few cells to an area some may be left
        without any; its centre stays where it was.
    """
    cells = field.cells
    fair = len(cells) / k
    surplus_m2 = _YIELD * fair * field.cell_size**2
    centres, offset = cells[rng.choice(len(cells), k, replace=False)], np.zeros(k)
    for _ in range(rounds):
        owner = np.argmin(
            scipy.spatial.distance.cdist(cells, centres, "sqeuclidean") + offset, axis=1
        )
        size = np.bincount(owner, minlength=k)
        total = np.stack([np.bincount(owner, xy, minlength=k) for xy in cells.T], axis=1)
        centres = np.where(size[:, None] > 0, total / np.maximum(size, 1)[:, None], centres)
        offset += surplus_m2 * (size / fair - 1.0)
    return owner, centres


def carry_on(view: View) -> Plan:
    """Keep to the plan; the nearest free cell stands in for a stop that was refused."""
    if not (view.plan or view.free.any()):
        return Plan((), "every cell was tried")
    if view.remaining <= len(view.plan) or not view.refused:
        return Plan(
            view.plan, "as planned" if view.plan else "every planned stop is made", view.pushes
        )
    refused = view.refused[-1]
    (stand_in,) = nearest_free(view, view.field.cells[[refused]]).tolist()
    cells = reroute(view.access, view.access.at, view.position, view.plan, [stand_in])
    asked = dict(zip(view.plan, view.pushes, strict=False))
    pushes = tuple(asked.get(cell, 1) for cell in cells) if asked else ()
    return Plan(cells, f"cell {stand_in} stands in for refused cell {refused}", pushes)


def _due(view: View) -> bool:
    """Whether stops have to be chosen: there is no plan yet, and something to plan."""
    return view.fresh and view.remaining > 0


def _toured(view: View, cells: Integers, reason: str) -> Plan:
    order = tour(view.access, view.position, view.access.at[cells])
    return Plan(tuple(cells[list(order)].tolist()), reason)


def nearest_free(view: View, points: Floats) -> Integers:
    """One free cell a point: the nearest that no point before it took, of several the first."""
    free = view.free
    cells = np.empty(len(points), dtype=np.int64)
    for k, point in enumerate(points):
        away = ((view.field.cells - point) ** 2).sum(axis=1)
        cells[k] = np.argmin(np.where(free, away, np.inf))
        free[cells[k]] = False
    return cells


def _w_inside(field: Field, margin: float, amplitude: float) -> Floats:
    """(n, 2) points in m close together along the part of a W that lies in a field.

    All of the W if none does: stops then move to the nearest cells.
    """
    w = _w_over(field, margin, amplitude)
    steps = np.linspace(0, w.length, 1 + _POINTS_A_CELL * ceil(w.length / field.cell_size))
    points = shapely.get_coordinates(shapely.line_interpolate_point(w, steps))
    inside = field.contains(points)
    return points[inside] if inside.any() else points


def _w_over(field: Field, margin: float, amplitude: float) -> LineString:
    origin, along, across = _extent(field)
    s = np.linspace(margin, 1 - margin, 5)[:, None]
    t = 0.5 + amplitude * np.array([0.5, -0.5, 0.5, -0.5, 0.5])[:, None]
    return LineString(origin + s * along + t * across)


def _extent(field: Field) -> tuple[Floats, Floats, Floats]:
    """Oriented rectangle around a field: a corner, its long side and its short side in m.

    The long side points east (or due north), the short one is a left turn from it.
    """
    corners = shapely.get_coordinates(shapely.oriented_envelope(field.boundary))[:4]
    one, other = np.diff(corners[:3], axis=0)
    rank = [(round(float(np.hypot(*side)), 6), abs(side[0])) for side in (one, other)]
    along, across = (one, other) if rank[0] > rank[1] else (other, one)
    along = along if (round(along[0], 6), along[1]) > (0.0, 0.0) else -along
    across = across if along[0] * across[1] > along[1] * across[0] else -across
    return corners.mean(axis=0) - (along + across) / 2, along, across
