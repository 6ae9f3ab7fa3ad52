"""Short open routes through places: from where the agent is, ending anywhere.

Lengths are those of the ways of an :class:`~subsoil.ways.access.Access`. A new set of stops is
ordered by :mod:`subsoil.ways.tours`; a route that changes while it is driven keeps its order as far
as it can: stops are put in where they cost least, then :mod:`subsoil.ways.moves` shorten it, so
that the agent does not dither.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from subsoil.arrays import Floats
from subsoil.ways.access import Access
from subsoil.ways.moves import quantised, shorten
from subsoil.ways.tours import short_tour


def length(access: Access, start: ArrayLike, places: ArrayLike) -> float:
    """Length in m of the way from a start through (k, 2) places in order."""
    nodes = _nodes(start, places)
    return float(np.diagonal(access.between(nodes, nodes), 1).sum())


def way(access: Access, start: ArrayLike, places: ArrayLike) -> Floats:
    """(p, 2) places in m along the way from a start through (k, 2) places in order."""
    nodes = _nodes(start, places)
    legs = [access.way(here, there)[1:] for here, there in pairwise(nodes)]
    return np.concatenate([nodes[:1], *legs])


def tour(access: Access, start: ArrayLike, places: ArrayLike) -> tuple[int, ...]:
    """Order of (k, 2) places that makes the way from a start through all of them short.

    The same at every call, on every machine and however busy it is: see
    :func:`subsoil.ways.tours.short_tour` for how short.

    Examples
    --------
    >>> from subsoil.land.field import Field
    >>> from subsoil.ways.open_land import OpenLand
    >>> meadow = OpenLand(Field.from_metres([(0, 0), (50, 0), (50, 20), (0, 20)]))
    >>> tour(meadow, (0, 0), [(30, 0), (10, 0), (20, 0)])
    (1, 2, 0)
    """
    nodes = _nodes(start, places)
    return tuple(node - 1 for node in short_tour(access.between(nodes, nodes)))


def reroute(
    access: Access,
    at: Floats,
    start: ArrayLike,
    route: Sequence[int],
    added: Sequence[int] = (),
) -> tuple[int, ...]:
    """Shorten a route of indices into (N, 2) places, with further stops put in where they fit.

    Parameters
    ----------
    access
        Ways between the places.
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
    distance = access.between(nodes, nodes)
    units = quantised(distance)
    path = list(range(len(route) + 1))
    for new in range(len(path), len(nodes)):
        path.insert(_cheapest_gap(units, path, new), new)
    shortened = shorten(distance[np.ix_(path, path)])
    return tuple(stops[path[node] - 1] for node in shortened)


def _cheapest_gap(distance: Floats, path: Sequence[int], new: int) -> int:
    """Place in a path of nodes at which one more costs least; its end costs just the way there."""
    to_new, onward = distance[path, new], distance[new, path]
    detour = to_new[:-1] + onward[1:] - distance[path[:-1], path[1:]]
    return 1 + int(np.argmin(np.append(detour, to_new[-1])))


def _nodes(start: ArrayLike, places: ArrayLike) -> Floats:
    """(1 + k, 2) a start and (k, 2) places in m."""
    points = np.asarray(places, dtype=float).reshape(-1, 2)
    return np.concatenate([np.asarray(start, dtype=float).reshape(1, 2), points])
