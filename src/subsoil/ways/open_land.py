"""Shortest ways through a field: inside its outline, around its keep-outs.

A shortest way among polygons is straight but for bends at corners that stick out into the land
(Lee & Preparata 1984, *Networks* 14, 393; de Berg et al., *Computational Geometry*, 2008, ch. 15).
The ways between those corners are found once a field, by Dijkstra's method on the graph of
corners that see one another; any other way is straight, or straight to a corner at both ends.

The carrier is a point and may follow an edge. Draw keep-outs as much larger as it is wide.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import cast

import numpy as np
import scipy
import shapely
from numpy.typing import ArrayLike, NDArray
from shapely.geometry.polygon import orient

from subsoil.arrays import Bools, Floats
from subsoil.land.field import Field
from subsoil.land.outline import Area

Integers = NDArray[np.int32]

_GRAZE_M = 1e-6
"""How far a way may cut into what is barred: rounding, so that it can follow edges."""
_BLOCK = 200_000
"""Pairs of places looked at in one go; what is worked on then stays in the processor's cache."""


@dataclass(frozen=True)
class OpenLand:
    """Land that may be driven on everywhere but in keep-outs; one stops at the centres of cells.

    A way that starts or ends outside the field or in a keep-out first goes straight to the nearest
    allowed place, through whatever lies there. Between parts of a field that are not connected,
    or in a point only, the way is the straight line, through everything: the carrier is lifted or
    takes the road. Where the allowed land is convex, as in a convex field without keep-outs,
    nothing is in the way, and every way is straight, also from outside.

    Attributes
    ----------
    field
        The land.
    """

    field: Field

    @property
    def at(self) -> Floats:
        """(N, 2) centres of the cells in m."""
        return self.field.cells

    @cached_property
    def stops(self) -> Bools:
        """(N,) all cells: those of a field lie outside its keep-outs."""
        everywhere = np.ones(len(self.field.cells), dtype=bool)
        everywhere.setflags(write=False)
        return everywhere

    @property
    def is_symmetric(self) -> bool:
        """Every way is as long back as forth."""
        return True

    @cached_property
    def free(self) -> Area:
        """The part of the land that may be driven on."""
        barred = shapely.union_all(list(self.field.keep_outs))
        return cast("Area", shapely.difference(self.field.boundary, barred))

    @cached_property
    def walls(self) -> tuple[Floats, ...]:
        """(p, 2) places in m along each line that a way may not cross.

        The free land's outline but for its convex hull's, moved outwards by a micrometre.
        """
        return _walls(self.free)

    @cached_property
    def corners(self) -> Floats:
        """(v, 2) places in m where a way may bend."""
        corners = _bends(self.free) if self.walls else np.empty((0, 2))
        corners.setflags(write=False)
        return corners

    @cached_property
    def _ways(self) -> tuple[Floats, Integers]:
        """(v, v) lengths in m of the ways between corners, and the corner before the second.

        Infinite where there is no way, and the corner negative.
        """
        step = scipy.spatial.distance.cdist(self.corners, self.corners)
        step[~_visible(self.walls, self.corners, self.corners)] = np.inf
        length, before = scipy.sparse.csgraph.shortest_path(
            step, method="D", directed=False, return_predecessors=True
        )
        return length, np.asarray(before, dtype=np.int32)

    def between(self, a: ArrayLike, b: ArrayLike) -> Floats:
        """Lengths (k, l) in m of the shortest ways from (k, 2) to (l, 2) places in m.

        Always finite, and the same both ways. Over places of one part of a
        field the triangle inequality holds. Costs O(k l e) where walls have e edges.

        Examples
        --------
        >>> pond = [(40, 0), (60, 0), (60, 40), (40, 40)]
        >>> meadow = [(0, 0), (100, 0), (100, 50), (0, 50)]
        >>> land = OpenLand(Field.from_metres(meadow, keep_outs=[pond]))
        >>> land.between([(40, 0)], [(60, 0), (20, 0), (60, 40)])
        array([[100.,  20.,  60.]])
        """
        a, b = _places(a), _places(b)
        straight = scipy.spatial.distance.cdist(a, b)
        if not self.walls:
            return straight
        one, other = self._sight(a), self._sight(b)
        bent = _through(_through(one.corners, self._ways[0]), other.corners.T)
        direct = scipy.spatial.distance.cdist(one.at, other.at)
        direct[~_visible(self.walls, one.at, other.at)] = np.inf
        inside = np.minimum(direct, bent, out=bent)
        inside += one.approach[:, None] + other.approach
        apart = np.isinf(inside) | (straight == 0.0)
        return np.where(apart, straight, np.maximum(inside, straight))

    def way(self, a: ArrayLike, b: ArrayLike) -> Floats:
        """(p, 2) places in m along the shortest way from one to another: ends and bends.

        Examples
        --------
        >>> shed = [(50, 50), (100, 50), (100, 100), (50, 100)]
        >>> yard = Field.from_metres([(0, 0), (100, 0), (100, 100), (0, 100)], keep_outs=[shed])
        >>> OpenLand(yard).way((20, 90), (90, 20)).tolist()
        [[20.0, 90.0], [50.0, 50.0], [90.0, 20.0]]
        """
        ends = np.concatenate([_places(a), _places(b)])
        if not self.walls or (ends[0] == ends[1]).all():
            return ends
        sight = self._sight(ends)
        (start, stop), seen = sight.at[:, None], sight.corners
        bent = seen[0][:, None] + self._ways[0] + seen[1]
        direct = _visible(self.walls, start, stop)[0, 0]
        if not (direct or np.isfinite(bent).any()):
            return ends
        bends = [] if direct else self._chain(int(np.argmin(bent)))
        return _without_repeats(
            np.concatenate([ends[:1], start, self.corners[bends], stop, ends[1:]])
        )

    def _chain(self, pair: int) -> list[int]:
        """Corners on the way between two, given as an index into all (v, v) pairs."""
        first, last = divmod(pair, len(self.corners))
        chain = [last]
        while chain[-1] != first:
            chain.append(int(self._ways[1][first, chain[-1]]))
        return chain[::-1]

    def _sight(self, places: Floats) -> _Sight:
        if np.array_equal(places, self.field.cells):
            return self._sight_of_cells
        return _looked(self.free, self.walls, self.corners, places)

    @cached_property
    def _sight_of_cells(self) -> _Sight:
        return _looked(self.free, self.walls, self.corners, self.field.cells)


@dataclass(frozen=True, eq=False)
class _Sight:
    """What is seen from k places.

    Attributes
    ----------
    at
        (k, 2) nearest allowed places in m.
    approach
        (k,) distances in m to them, zero but for places that are not allowed.
    corners
        (k, v) distances in m from there to the corners in sight, infinite for the others.
    """

    at: Floats
    approach: Floats
    corners: Floats


def _walls(free: Area) -> tuple[Floats, ...]:
    """Lines (p, 2) in m that a straight line between two places on free land may cross."""
    origin = np.floor(free.bounds[:2])
    # So near the origin rounding is far below a micrometre, wherever on Earth the field lies.
    near = shapely.transform(free, lambda at: at - origin)
    wider = shapely.buffer(near, _GRAZE_M, join_style="mitre")
    hull = shapely.boundary(shapely.convex_hull(wider))
    lines: list[Floats] = []
    for ring in _rings(wider):
        middle = (ring[:-1] + ring[1:]) / 2
        off = [shapely.distance(hull, shapely.points(at)) for at in (ring[:-1], middle, ring[1:])]
        inner = np.max(off, axis=0) > _GRAZE_M / 100
        ends = np.flatnonzero(np.diff(np.concatenate([[False], inner, [False]])))
        lines += [ring[first : last + 1] + origin for first, last in ends.reshape(-1, 2)]
    return tuple(lines)


def _bends(free: Area) -> Floats:
    """(v, 2) places in m where the outline of free land turns away from the land."""
    found = [np.empty((0, 2))]
    for ring in _rings(free):
        at = ring[:-1]
        come, go = at - np.roll(at, 1, axis=0), np.roll(at, -1, axis=0) - at
        found.append(at[come[:, 0] * go[:, 1] < come[:, 1] * go[:, 0]])
    return np.unique(np.concatenate(found), axis=0)


def _rings(area: Area) -> Iterator[Floats]:
    """Closed rings (k, 2) of an area, with the land on their left."""
    for part in shapely.get_parts(area):
        turned = orient(part)
        for ring in (turned.exterior, *turned.interiors):
            yield shapely.get_coordinates(ring)


def _looked(free: Area, walls: tuple[Floats, ...], corners: Floats, places: Floats) -> _Sight:
    """What is seen from (k, 2) places in m."""
    at, points = places.copy(), np.asarray(shapely.points(places))
    off = ~shapely.dwithin(free, points, _GRAZE_M / 2)
    at[off] = shapely.get_coordinates(shapely.shortest_line(points[off], free))[1::2]
    seen = scipy.spatial.distance.cdist(at, corners)
    seen[~_visible(walls, at, corners)] = np.inf
    return _Sight(at, np.hypot(*(places - at).T), seen)


def _visible(walls: tuple[Floats, ...], a: Floats, b: Floats) -> Bools:
    """(k, l) whether straight lines from (k, 2) to (l, 2) places in m on free land cross no wall.

    A line crosses an edge if its ends lie on different sides of the edge and the edge's ends on
    different sides of the line.
    """
    clear = np.ones((len(a), len(b)), dtype=bool)
    if not walls:
        return clear
    origin = walls[0][0]
    walls, a, b = tuple(wall - origin for wall in walls), a - origin, b - origin
    rows = max(1, _BLOCK // max(1, len(b)))
    for first in range(0, len(a), rows):
        block = slice(first, first + rows)
        _bar(clear[block], walls, a[block], b)
    return clear


def _bar(clear: Bools, walls: tuple[Floats, ...], a: Floats, b: Floats) -> None:
    """Strike out the lines from (k, 2) to (l, 2) places that cross a wall."""
    spanned = np.multiply.outer(a[:, 0], b[:, 1]) - np.multiply.outer(a[:, 1], b[:, 0])
    for wall in walls:
        past = _right(spanned, a, b, wall[0])
        for start, end in pairwise(wall):
            before, past = past, _right(spanned, a, b, end)
            parted = np.not_equal.outer(_left(a, start, end), _left(b, start, end))
            parted &= before != past
            clear &= ~parted


def _right(spanned: Floats, a: Floats, b: Floats, place: Floats) -> Bools:
    """(k, l) whether a place lies to one side of lines, given the cross products of their ends."""
    east, north = place
    own = np.add.outer(a[:, 0] * north - a[:, 1] * east, b[:, 1] * east - b[:, 0] * north)
    return np.asarray(spanned > own)


def _left(places: Floats, start: Floats, end: Floats) -> Bools:
    """(k,) whether (k, 2) places lie to the left of an edge."""
    east, north = end - start
    return np.asarray(east * (places[:, 1] - start[1]) > north * (places[:, 0] - start[0]))


def _through(a: Floats, b: Floats) -> Floats:
    """(k, l) least sums over the middle of (k, v) and (v, l) lengths."""
    least = np.full((len(a), b.shape[1]), np.inf)
    for left, right in zip(a.T, b, strict=True):
        np.minimum(least, left[:, None] + right, out=least)
    return least


def _without_repeats(way: Floats) -> Floats:
    stays = np.append(True, (np.diff(way, axis=0) != 0.0).any(axis=1))
    return np.asarray(way[stays])


def _places(at: ArrayLike) -> Floats:
    return np.asarray(at, dtype=float).reshape(-1, 2)
