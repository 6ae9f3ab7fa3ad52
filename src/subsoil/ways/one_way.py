"""Short open tours where a way may be longer back than forth.

As in :mod:`subsoil.ways.tours` two stretches that follow one another swap places, what that broke
is mended, and the outcome is kept if it is shorter. Mending is :func:`subsoil.ways.moves.shorten`,
which weighs all moves and takes the best: slower than moves among near nodes, so that fewer rounds
are made.
"""

from __future__ import annotations

from random import Random

import numpy as np

from subsoil.arrays import Floats
from subsoil.ways.moves import quantised, shorten, stretches, to_the_nearest

_ROUNDS, _STOPS = 100, 200
"""Rounds, and the stops up to which they are made; beyond, a round takes longer."""


def one_way_tour(distance: Floats) -> tuple[int, ...]:
    """Order of the nodes after node 0 that makes the open path through all of them short.

    Parameters
    ----------
    distance
        (k, k) distances in m from row to column, infinite where there is no way.
    """
    units = quantised(distance)
    apart = units.copy()
    np.fill_diagonal(apart, np.inf)
    draw = Random(0).random
    best = _mended(distance, to_the_nearest(apart))
    stops = len(best) - 1
    for _ in range(round(_ROUNDS / max(1.0, stops / _STOPS) ** 2)):
        first, middle, end = stretches(stops, draw)
        swapped = [*best[:first], *best[middle:end], *best[first:middle], *best[end:]]
        other = _mended(distance, swapped)
        if _length(units, other) < _length(units, best):
            best = other
    return tuple(best[1:])


def _mended(distance: Floats, path: list[int]) -> list[int]:
    return [0, *(path[node] for node in shorten(distance[np.ix_(path, path)]))]


def _length(units: Floats, path: list[int]) -> float:
    return float(units[path[:-1], path[1:]].sum())
