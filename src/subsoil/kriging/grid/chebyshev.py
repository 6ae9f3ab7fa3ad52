"""Stretches of a grid's axes, boxes of them, and interpolation over them from Chebyshev nodes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from subsoil.arrays import Floats

NODES = 12
"""Nodes to a stretch of an axis."""

_ANGLES = (np.arange(NODES) + 0.5) * np.pi / NODES
_BARYCENTRIC = np.where(np.arange(NODES) % 2, -1.0, 1.0) * np.sin(_ANGLES)


@dataclass(frozen=True, eq=False)
class Stretch:
    """Coordinates ``axis[start:stop]`` of an axis.

    Attributes
    ----------
    axis
        (n,) ascending coordinates in m.
    start, stop
        Indices of the stretch.
    """

    axis: Floats
    start: int
    stop: int

    def __len__(self) -> int:
        return self.stop - self.start

    @cached_property
    def at(self) -> Floats:
        """(t,) coordinates in m."""
        return self.axis[self.start : self.stop]

    @cached_property
    def centre(self) -> float:
        """Middle of the stretch in m."""
        return 0.5 * float(self.at[0] + self.at[-1])

    @cached_property
    def half(self) -> float:
        """Half the length of the stretch in m."""
        return 0.5 * float(self.at[-1] - self.at[0])

    @cached_property
    def nodes(self) -> Floats:
        """(p,) coordinates in m that functions on the stretch are interpolated from.

        Chebyshev nodes of the first kind, or the coordinates where there are no more than that.
        """
        chebyshev: Floats = self.centre + self.half * np.cos(_ANGLES)
        return self.at if len(self) <= NODES else chebyshev

    @cached_property
    def halves(self) -> tuple[Stretch, Stretch]:
        """The stretch in two; it must have two coordinates or more."""
        middle = (self.start + self.stop) // 2
        return Stretch(self.axis, self.start, middle), Stretch(self.axis, middle, self.stop)

    def weights(self, at: Floats) -> Floats:
        """(t, p) weights of the nodes for interpolation at (t,) coordinates of the stretch.

        Barycentric (Berrut & Trefethen, SIAM Review 46, 2004).

        Examples
        --------
        >>> s = Stretch(np.linspace(2.0, 3.0, 40), 0, 40)
        >>> float(abs(s.weights(s.at) @ np.exp(s.nodes) - np.exp(s.at)).max()) < 1e-13
        True
        """
        gap = at[:, None] - self.nodes
        hit = gap == 0.0
        if len(self) <= NODES:
            return np.where(hit, 1.0, 0.0)
        weights: Floats = np.where(
            hit.any(axis=1, keepdims=True), hit, _BARYCENTRIC / np.where(hit, 1.0, gap)
        )
        weights /= weights.sum(axis=1, keepdims=True)
        return weights


@lru_cache(maxsize=1024)
def to_nodes(outer: Stretch, inner: Stretch) -> Floats:
    """Weights from the nodes of a stretch to those of a stretch within it."""
    return outer.weights(inner.nodes)


@lru_cache(maxsize=1024)
def to_cells(outer: Stretch, inner: Stretch) -> Floats:
    """Weights from the nodes of a stretch to the coordinates of a stretch within it."""
    return outer.weights(inner.at)


@dataclass(frozen=True)
class Box:
    """Rectangle of cells.

    Attributes
    ----------
    north, east
        Its rows and columns.
    """

    north: Stretch
    east: Stretch

    @property
    def cells(self) -> int:
        """Number of cells."""
        return len(self.north) * len(self.east)

    @property
    def nodes_of_parts(self) -> int:
        """Number of nodes of all parts."""
        rows, columns = self.parts
        return sum(len(r.nodes) for r in rows) * sum(len(c.nodes) for c in columns)

    @property
    def part(self) -> tuple[slice, slice]:
        """Where the box is in a map of the whole grid."""
        north, east = self.north, self.east
        return slice(north.start, north.stop), slice(east.start, east.stop)

    @cached_property
    def parts(self) -> tuple[tuple[Stretch, ...], tuple[Stretch, ...]]:
        """Rows and columns with the longer side halved, or both if neither is twice the other."""
        tall = len(self.north) > 1 and 2.0 * self.north.half > self.east.half
        wide = len(self.east) > 1 and 2.0 * self.east.half > self.north.half
        rows = self.north.halves if tall else (self.north,)
        columns = self.east.halves if wide else (self.east,)
        return rows, columns


def squared_lags(at: Floats, north: Floats, east: Floats) -> Floats:
    """(n, len(north), len(east)) squared distances from (n, 2) places to a grid's points."""
    return ((at[:, 1, None] - north) ** 2)[:, :, None] + ((at[:, 0, None] - east) ** 2)[:, None, :]
