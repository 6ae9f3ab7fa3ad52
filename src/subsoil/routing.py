"""Short open routes through places: from where the agent is, ending anywhere.

A new set of stops is ordered by ``fast-tsp``; a route that changes while it is driven keeps its
order as far as it can: stops are put in where they cost least, then 2-opt and or-opt moves shorten
it (Croes 1958; Or 1976). The second way is deterministic and does not make the agent dither.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import fast_tsp
import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.distance import cdist

Floats = NDArray[np.float64]

_LARGEST = 65_535
_EPSILON = 1e-9
_LONGEST_SEGMENT = 3


def length(start: ArrayLike, places: ArrayLike) -> float:
    """Length in m of the way from a start through (k, 2) places in order."""
    way = np.vstack([np.asarray(start, dtype=float), np.reshape(places, (-1, 2))])
    return float(np.hypot(*np.diff(way, axis=0).T).sum())


def tour(start: ArrayLike, places: ArrayLike) -> tuple[int, ...]:
    """Order of (k, 2) places that makes the way from a start through all of them short.

    Optimal up to 19 places; beyond, the best that fast-tsp finds in a tenth of a second (up to 60
    places) or a second.

    Examples
    --------
    >>> tour((0, 0), [(30, 0), (10, 0), (20, 0)])
    (1, 2, 0)
    """
    points = np.reshape(np.asarray(places, dtype=float), (-1, 2))
    if len(points) < 2:
        return tuple(range(len(points)))
    distance = _distances(np.vstack([np.asarray(start, dtype=float), points]))
    farthest = distance.max()
    if farthest == 0.0:
        return tuple(range(len(points)))
    cycle = fast_tsp.find_tour(
        _closed(distance / farthest).tolist(),
        duration_seconds=0.1 if len(points) <= 60 else 1.0,
    )
    end = cycle.index(len(distance))
    path = cycle[end + 1 :] + cycle[:end]
    if path[0] != 0:
        path.reverse()
    return tuple(node - 1 for node in path[1:])


def _closed(distance: Floats) -> NDArray[np.int64]:
    """Integer matrix whose shortest cycle is the shortest open path from node 0.

    One more node joins the path's two ends: it is next to the start for free and at twice the
    greatest distance from everything else.
    """
    n = len(distance)
    padded = np.full((n + 1, n + 1), 2.0)
    padded[:n, :n] = distance
    padded[n, 0] = padded[0, n] = padded[n, n] = 0.0
    return np.round(padded * (_LARGEST / 2.0)).astype(np.int64)


def reroute(
    at: Floats, start: ArrayLike, route: Sequence[int], added: Iterable[int] = ()
) -> tuple[int, ...]:
    """Shorten a route of indices into (N, 2) places, with further stops put in where they fit.

    Parameters
    ----------
    at
        (N, 2) places in m.
    start
        Where the agent is.
    route
        Stops in their present order.
    added
        Stops to put in.
    """
    order = list(route)
    for stop in added:
        order.insert(_cheapest_gap(at[[*order, stop]], np.asarray(start, dtype=float)), stop)
    if len(order) < 2:
        return tuple(order)
    shortened = shorten(_distances(np.vstack([np.asarray(start, dtype=float), at[order]])))
    return tuple(order[node - 1] for node in shortened)


def shorten(distance: Floats) -> tuple[int, ...]:
    """Improve the open path 0, 1, ... k - 1 by 2-opt and or-opt moves, the best one each time.

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
    padded = np.zeros((n + 1, n + 1))
    padded[:n, :n] = distance
    order = np.arange(n + 1)
    while True:
        gain, order_after = max(
            (_two_opt(padded, order), _or_opt(padded, order)), key=lambda move: move[0]
        )
        if gain <= _EPSILON:
            return tuple(int(node) for node in order[1:-1])
        order = order_after


def _two_opt(distance: Floats, order: NDArray[np.int64]) -> tuple[float, NDArray[np.int64]]:
    """Best reversal of a stretch: its gain, and the order after it."""
    d = distance[np.ix_(order, order)]
    step = np.diagonal(d, 1)
    gain = step[:-1, None] + step[None, 1:] - d[:-2, 1:-1] - d[1:-1, 2:]
    gain = np.triu(gain, 1)
    i, j = np.unravel_index(int(np.argmax(gain)), gain.shape)
    after = order.copy()
    after[i + 1 : j + 2] = order[i + 1 : j + 2][::-1]
    return float(gain[i, j]), after


def _or_opt(distance: Floats, order: NDArray[np.int64]) -> tuple[float, NDArray[np.int64]]:
    """Best move of up to three neighbours, either way round: its gain, and the order after it."""
    d = distance[np.ix_(order, order)]
    step = np.diagonal(d, 1)
    n = len(order)
    best, after = 0.0, order
    for size in range(1, min(_LONGEST_SEGMENT, n - 2) + 1):
        first = np.arange(1, n - size)
        last = first + size - 1
        saved = step[first - 1] + step[last] - d[first - 1, last + 1]
        gap = np.arange(n - 1)
        outside = (gap[None, :] < first[:, None] - 1) | (gap[None, :] > last[:, None])
        for head, tail in ((first, last), (last, first)):
            cost = d[head[:, None], gap] + d[tail[:, None], gap + 1] - step
            gain = np.where(outside, saved[:, None] - cost, -np.inf)
            k, g = np.unravel_index(int(np.argmax(gain)), gain.shape)
            if gain[k, g] > best:
                best = float(gain[k, g])
                after = _moved(order, int(first[k]), size, int(g), head is last)
    return best, after


def _moved(
    order: NDArray[np.int64], first: int, size: int, gap: int, turned: bool
) -> NDArray[np.int64]:
    segment = order[first : first + size]
    rest = np.concatenate([order[:first], order[first + size :]])
    place = gap + 1 if gap < first else gap + 1 - size
    return np.concatenate([rest[:place], segment[::-1] if turned else segment, rest[place:]])


def _cheapest_gap(places: Floats, start: Floats) -> int:
    """Where on the way start, places[:-1] the last place costs least."""
    way, new = np.vstack([start, places[:-1]]), places[-1]
    to_new = np.hypot(*(way - new).T)
    detour = to_new[:-1] + to_new[1:] - np.hypot(*np.diff(way, axis=0).T)
    return int(np.argmin(np.append(detour, to_new[-1])))


def _distances(points: Floats) -> Floats:
    return cdist(points, points)
