"""Short open routes through places: from where the agent is, ending anywhere.

Lengths are those of the ways that a :class:`subsoil.travel.Travel` finds through the field.
A new set of stops is ordered by ``fast-tsp``; a route that changes while it is driven keeps its
order as far as it can: stops are put in where they cost least, then 2-opt and or-opt moves shorten
it (Croes 1958, Oper. Res. 6, 791; Or 1976). The second way does not make the agent dither.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import fast_tsp
import numpy as np
from numpy.typing import ArrayLike, NDArray

from subsoil.travel import Travel

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

_MOST_SOLVED_EXACTLY = 20
"""Nodes up to which fast-tsp enumerates; beyond, it searches at random."""
_SHORTEST_SEARCH_S, _LONGEST_SEARCH_S = 0.05, 0.8
"""Time of a search, at first and where searches keep to disagree."""
_LARGEST = 65_535
"""Largest distance that fast-tsp takes."""
_ASIDE = 1.1
"""Distance of the node that closes a path to a cycle, as a share of the greatest distance."""
_TELL_APART = 64
"""Integer distances are told apart by up to this much: grids are full of equally short routes."""
_EPSILON = 1e-9
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

    Optimal up to 18 places, but for distances rounded to 1 part in 60 000. Beyond, the search is
    random and is given more time until it finds the same twice, two seconds in all at most. Up to
    some 60 places that is the optimum again, and the same at every call; of 300 places it comes
    within some 0.2 %, and another call may come to another order.

    Examples
    --------
    >>> from subsoil.field import Field
    >>> from subsoil.travel import travel_of
    >>> travel = travel_of(Field.from_metres([(0, 0), (50, 0), (50, 20), (0, 20)]))
    >>> tour(travel, (0, 0), [(30, 0), (10, 0), (20, 0)])
    (1, 2, 0)
    """
    nodes = _nodes(start, places)
    distance = travel.between(nodes, nodes)
    if not distance.any():
        return tuple(range(len(nodes) - 1))
    path = np.array(_searched(_closed(distance)))
    return tuple((path[list(shorten(distance[np.ix_(path, path)]))] - 1).tolist())


def _searched(closed: Integers) -> list[int]:
    """Shortest open path from node 0 in a matrix with a node more to close it."""
    seconds = float(np.clip(1e-5 * len(closed) ** 2, _SHORTEST_SEARCH_S, _LONGEST_SEARCH_S))
    path = _search(closed, seconds)
    while len(closed) > _MOST_SOLVED_EXACTLY and seconds <= _LONGEST_SEARCH_S:
        other = _search(closed, seconds)
        if other == path:
            break
        path = min(path, other, key=lambda nodes: int(closed[nodes[:-1], nodes[1:]].sum()))
        seconds *= 2
    return path


def _search(closed: Integers, seconds: float) -> list[int]:
    cycle: list[int] = fast_tsp.find_tour(closed.tolist(), duration_seconds=seconds)
    end = cycle.index(len(closed) - 1)
    path = cycle[end + 1 :] + cycle[:end]
    return path if path[0] == 0 else path[::-1]


def _closed(distance: Floats) -> Integers:
    """Integer matrix whose shortest cycle is the shortest open path from node 0.

    One more node joins the path's two ends: it is next to the start for free and farther from
    everything else than anything is. Where there is more to solve than fast-tsp enumerates,
    distances are told apart by up to a thousandth of the greatest, always the same way.
    """
    n = len(distance)
    scale = (_LARGEST - _TELL_APART) / _ASIDE
    closed = np.full((n + 1, n + 1), round(scale * _ASIDE), dtype=np.int64)
    closed[:n, :n] = np.round(distance * (scale / distance.max()))
    if n + 1 > _MOST_SOLVED_EXACTLY:
        more = np.triu(np.random.default_rng(0).integers(0, _TELL_APART, (n, n)), 1)
        closed[:n, :n] += more + more.T
    closed[n, [0, n]] = closed[[0, n], n] = 0
    return closed


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
    path = list(range(len(route) + 1))
    for new in range(len(path), len(nodes)):
        path.insert(_cheapest_gap(distance, path, new), new)
    shortened = shorten(distance[np.ix_(path, path)])
    return tuple(stops[path[node] - 1] for node in shortened)


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
    order = np.arange(n + 1)
    d = np.zeros((n + 1, n + 1))
    d[:n, :n] = distance
    while n > 2:
        gain, move = max(_two_opt(d), _or_opt(d), key=lambda option: option[0])
        if gain <= _EPSILON:
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
