"""Short open routes through places: from where the agent is, ending anywhere.

Lengths are those of the ways that a :class:`subsoil.ways.open_land.Travel` finds through the field.
A new set of stops is ordered by :mod:`subsoil.ways.tours`; a route that changes while it is driven keeps
its order as far as it can: stops are put in where they cost least, then 2-opt and or-opt moves
shorten it (Croes 1958, Oper. Res. 6, 791; Or 1976). The second way does not make the agent dither.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from subsoil.ways.open_land import Travel
from subsoil.ways.tours import quantised, short_tour

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

_LONGEST_SEGMENT = 3


def length(travel: Travel, start: ArrayLike, places: ArrayLike) -> float:
    """Length in m of the way from a start through (k, 2) places in order."""
    nodes = _nodes(start, places)
    return float(np.diagonal(travel.between(nodes, nodes), 1).sum())


def way(travel: Travel, start: ArrayLike, places: ArrayLike) -> Floats:
    """(p, 2) places in m along the way from a start through (k, 2) places in order."""
    nodes = _nodes(start, places)
    legs = [travel.way(here, there)[1:] for here, there in pairwise(nodes)]
    return np.concatenate([nodes[:1], *legs])


def tour(travel: Travel, start: ArrayLike, places: ArrayLike) -> tuple[int, ...]:
    """Order of (k, 2) places that makes the way from a start through all of them short.

    The same at every call, on every machine and however busy it is: see
    :func:`subsoil.ways.tours.short_tour` for how short.

    Examples
    --------
    >>> from subsoil.field import Field
    >>> from subsoil.ways.open_land import travel_of
    >>> travel = travel_of(Field.from_metres([(0, 0), (50, 0), (50, 20), (0, 20)]))
    >>> tour(travel, (0, 0), [(30, 0), (10, 0), (20, 0)])
    (1, 2, 0)
    """
    nodes = _nodes(start, places)
    return tuple(node - 1 for node in short_tour(travel.between(nodes, nodes)))


def reroute(
    travel: Travel,
    at: Floats,
    start: ArrayLike,
    route: Sequence[int],
    added: Sequence[int] = (),
) -> tuple[int, ...]:
    """Shorten a route of indices into (N, 2) places, with further stops put in where they fit.

    Parameters
    ----------
    travel
        Ways through the field.
    at
        (N, 2) places in m.
    start
        Where the agent is.
    route
        Stops in their present order.
    added
        Stops to put in.
    """
    stops = [*route, *added]
    nodes = _nodes(start, at[stops])
    distance = travel.between(nodes, nodes)
    units = quantised(distance)
    path = list(range(len(route) + 1))
    for new in range(len(path), len(nodes)):
        path.insert(_cheapest_gap(units, path, new), new)
    shortened = shorten(distance[np.ix_(path, path)])
    return tuple(stops[path[node] - 1] for node in shortened)


def shorten(distance: Floats) -> tuple[int, ...]:
    """Improve the open path 0, 1, ... k - 1 by 2-opt and or-opt moves, the best one each time.

    Lengths are told apart by a millimetre, and of equal moves the first is made: rounding noise
    decides nothing.

    Parameters
    ----------
    distance
        (k, k) symmetric distances in m; node 0 is the fixed start.

    Returns
    -------
    tuple of int
        Nodes after the start, in their new order.
    """
    n = len(distance)
    order = np.arange(n + 1)
    d = np.zeros((n + 1, n + 1))
    d[:n, :n] = quantised(distance)
    while n > 2:
        gain, move = max(_two_opt(d), _or_opt(d), key=lambda option: option[0])
        if gain <= 0:
            break
        order, d = order[move], d[np.ix_(move, move)]
    return tuple(order[1:-1].tolist())


def _two_opt(d: Floats) -> tuple[float, Integers]:
    """Best reversal of a stretch of the way 0, 1, ...: its gain, and the order after it."""
    step = np.diagonal(d, 1)
    gain = np.triu(step[:-1, None] + step[None, 1:] - d[:-2, 1:-1] - d[1:-1, 2:], 1)
    i, j = np.unravel_index(int(np.argmax(gain)), gain.shape)
    order = np.arange(len(d))
    order[i + 1 : j + 2] = order[i + 1 : j + 2][::-1]
    return float(gain[i, j]), order


def _or_opt(d: Floats) -> tuple[float, Integers]:
    """Best move of up to three neighbours, either way round: its gain, and the order after it."""
    step = np.diagonal(d, 1)
    n = len(d)
    gap = np.arange(n - 1)
    best, order = 0.0, np.arange(n)
    for size in range(1, min(_LONGEST_SEGMENT, n - 2) + 1):
        first = np.arange(1, n - size)
        last = first + size - 1
        saved = step[first - 1] + step[last] - d[first - 1, last + 1]
        inside = (gap >= first[:, None] - 1) & (gap <= last[:, None])
        for head, tail in ((first, last), (last, first)):
            cost = d[head[:, None], gap] + d[tail[:, None], gap + 1] - step
            gain = np.where(inside, -np.inf, saved[:, None] - cost)
            k, g = np.unravel_index(int(np.argmax(gain)), gain.shape)
            if gain[k, g] > best:
                best = float(gain[k, g])
                order = _moved(n, int(first[k]), size, int(g), turned=head is last)
    return best, order


def _moved(n: int, first: int, size: int, gap: int, *, turned: bool) -> Integers:
    """Order of n nodes with a segment moved to behind node ``gap``."""
    segment = np.arange(first, first + size)
    rest = np.delete(np.arange(n), segment)
    place = gap + 1 if gap < first else gap + 1 - size
    return np.insert(rest, place, segment[::-1] if turned else segment)


def _cheapest_gap(distance: Floats, path: Sequence[int], new: int) -> int:
    """Place in a path of nodes at which one more costs least; its end costs just the way there."""
    to_new = distance[path, new]
    detour = to_new[:-1] + to_new[1:] - distance[path[:-1], path[1:]]
    return 1 + int(np.argmin(np.append(detour, to_new[-1])))


def _nodes(start: ArrayLike, places: ArrayLike) -> Floats:
    """(1 + k, 2) a start and (k, 2) places in m."""
    points = np.asarray(places, dtype=float).reshape(-1, 2)
    return np.concatenate([np.asarray(start, dtype=float).reshape(1, 2), points])
