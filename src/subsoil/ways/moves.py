"""Moves that shorten an open path whose distances may differ back and forth.

2-opt turns a stretch of the path round, or-opt moves up to three neighbours elsewhere, either way
round (Croes 1958, Oper. Res. 6, 791; Or 1976). Where a way is not as long back as forth, a stretch
that is turned round has another length; cumulated lengths along the path and back tell which.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from subsoil.arrays import Floats, Integers
from subsoil.ways.access import finite

Draw = Callable[[], float]

PER_METRE = 1024
"""Units of length in a metre. Lengths people choose never lie half way between two of them."""
_LONGEST_SEGMENT = 3
_LONGEST_STRETCH = 30
"""Nodes in either stretch of a swap."""


def quantised(distance: Floats) -> Floats:
    """Distances in m as whole numbers of units, which floats hold and add exactly."""
    return np.round(finite(distance) * PER_METRE)


def shorten(distance: Floats) -> tuple[int, ...]:
    """Improve the open path 0, 1, ... k - 1 by 2-opt and or-opt moves, the best one each time.

    Lengths are told apart by a millimetre, and of equal moves the first is made: rounding noise
    decides nothing.

    Parameters
    ----------
    distance
        (k, k) distances in m from row to column; node 0 is the fixed start.

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


def to_the_nearest(apart: Floats) -> list[int]:
    """Path from node 0 to the nearest node left each time, of several the first."""
    left = apart.copy()
    path = [0]
    while len(path) < len(apart):
        left[:, path[-1]] = np.inf
        path.append(int(np.argmin(left[path[-1]])))
    return path


def stretches(stops: int, draw: Draw) -> tuple[int, int, int]:
    """Where two stretches of a path that follow one another begin, meet and end."""
    longest = min(_LONGEST_STRETCH, stops // 2)
    one, other = 1 + int(draw() * longest), 1 + int(draw() * longest)
    first = 1 + int(draw() * (stops - one - other + 1))
    return first, first + one, first + one + other


def _turned(d: Floats) -> Floats:
    """(n,) what the way 0, 1, ... up to each node is shorter back than forth."""
    return np.append(0.0, np.cumsum(np.diagonal(d, 1) - np.diagonal(d, -1)))


def _two_opt(d: Floats) -> tuple[float, Integers]:
    """Best reversal of a stretch of the way 0, 1, ...: its gain, and the order after it."""
    step, back = np.diagonal(d, 1), _turned(d)
    gain = step[:-1, None] + step[None, 1:] - d[:-2, 1:-1] - d[1:-1, 2:]
    gain = np.triu(gain + (back[1:-1] - back[1:-1, None]), 1)
    i, j = np.unravel_index(int(np.argmax(gain)), gain.shape)
    order = np.arange(len(d))
    order[i + 1 : j + 2] = order[i + 1 : j + 2][::-1]
    return float(gain[i, j]), order


def _or_opt(d: Floats) -> tuple[float, Integers]:
    """Best move of up to three neighbours, either way round: its gain, and the order after it."""
    step, back = np.diagonal(d, 1), _turned(d)
    n = len(d)
    gap = np.arange(n - 1)
    best, order = 0.0, np.arange(n)
    for size in range(1, min(_LONGEST_SEGMENT, n - 2) + 1):
        first = np.arange(1, n - size)
        last = first + size - 1
        saved = step[first - 1] + step[last] - d[first - 1, last + 1]
        inside = (gap >= first[:, None] - 1) & (gap <= last[:, None])
        turned = back[last] - back[first]
        for head, tail, shorter in ((first, last, 0.0 * turned), (last, first, turned)):
            cost = d[gap, head[:, None]] + d[tail[:, None], gap + 1] - step
            gain = np.where(inside, -np.inf, (saved + shorter)[:, None] - cost)
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
