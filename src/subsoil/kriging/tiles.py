"""Kriging on a grid, tile by tile, by interpolating what the readings around a tile contribute.

With c the covariances of a cell with all readings, mean and variance are polynomials in c::

    mean     = constant + slope . c
    variance = -(height + linear . c + c' gram c)

Seen from a box of cells, most readings are far enough away for c to be
smooth. What these contribute is computed at Chebyshev nodes of the box and interpolated; the
others are computed from cell to cell. Going from the whole grid down to tiles, a box inherits
from the one around it by interpolation, which loses nothing, and *absorbs* the readings that are
smooth over it and were not before. The idea is that of the fast multipole method
(Greengard & Rokhlin 1987) with interpolation for the expansion (Fong & Darve 2009), carried over
to the quadratic form of the variance.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import ceil, log2

import numpy as np
from numpy.typing import NDArray

from subsoil.kriging.chebyshev import NODES, Box, Stretch, squared_lags, to_cells, to_nodes
from subsoil.kriging.covariance import Shape
from subsoil.kriging.smoothness import Smoothness, smoothness
from subsoil.kriging.system import System

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

_STRIP = 1 << 16
"""Covariances in a strip of a tile: what stays in the cache of a processor core."""
_LARGEST = 1 << 14
"""Cells of the largest tile."""
_PAIR = 0.012
"""Work on a pair of readings at a cell, in evaluations of a covariance."""
_BOX = 8e4
"""Fixed work on a box, in evaluations of a covariance."""


@dataclass(frozen=True)
class Tile:
    """The polynomials of the cells of a box, in their covariances with r readings.

    Lengths and covariances are in units of the covariance's :class:`Shape`.

    Attributes
    ----------
    box
        Where the tile holds.
    fields
        (p, 1 + k + r, q) height, k constants and linear at the p x q nodes of the box: what
        readings that were absorbed made of them.
    at
        (r, 2) places of the readings.
    slope, gram
        (k, r) and (r, r).
    """

    box: Box
    fields: Floats
    at: Floats
    slope: Floats
    gram: Floats

    def __len__(self) -> int:
        return len(self.at)

    @property
    def first(self) -> int:
        """Index of the first linear field."""
        return 1 + len(self.slope)

    def only(self, kept: Bools) -> Tile:
        """Tile without some of its readings, whose covariance is zero."""
        if kept.all():
            return self
        stay = np.flatnonzero(kept)
        rows = np.concatenate([np.arange(self.first), self.first + stay])
        return self._of(self.box, self.fields.take(rows, axis=1), stay)

    def absorb(self, box: Box, kept: Bools, smooth: Bools, shape: Shape) -> Tile:
        """Tile of a box within, with readings kept or absorbed; others have no covariance."""
        first, stay, go = self.first, np.flatnonzero(kept), np.flatnonzero(smooth)
        left = first + len(stay)
        rows = np.concatenate([np.arange(first), first + stay, first + go])
        north, east = to_nodes(self.box.north, box.north), to_nodes(self.box.east, box.east)
        fields = _interpolated(self.fields.take(rows, axis=1), north, east)
        c = _covariances(self.at[go], box.north.nodes, box.east.nodes, shape)
        gram = self.gram.take(go, axis=0)
        linear = gram.take(go, axis=1) @ c
        grid = -1, len(north), len(east)
        by_field = fields.swapaxes(0, 1)
        linear.reshape(grid)[...] += by_field[left:]
        by_field[0] += np.einsum("ij,ij->j", c, linear).reshape(grid)[0]
        by_field[1:first] += (self.slope[:, go] @ c).reshape(grid)
        by_field[first:left] += 2.0 * (gram.take(stay, axis=1).T @ c).reshape(grid)
        return self._of(box, fields[:, :left], stay)

    def _of(self, box: Box, fields: Floats, stay: NDArray[np.intp]) -> Tile:
        gram = self.gram.take(stay, axis=0).take(stay, axis=1)
        return Tile(box, fields, self.at[stay], self.slope[:, stay], gram)

    def evaluate(self, box: Box, mean: Floats, variance: Floats, shape: Shape) -> None:
        """Write the (k, ny, nx) means and (ny, nx) variances of a box into those of a grid."""
        first, (rows, columns) = self.first, box.part
        north, east = to_cells(self.box.north, box.north), to_cells(self.box.east, box.east)
        step = max(1, _STRIP // max(1, len(self) * len(east)))
        for start in range(0, len(north), step):
            strip = slice(start, min(start + step, len(north)))
            by_field = _interpolated(self.fields, north[strip], east).swapaxes(0, 1)
            if len(self):
                grid = -1, *by_field.shape[1:]
                c = _covariances(self.at, box.north.at[strip], box.east.at, shape)
                linear = self.gram @ c
                linear.reshape(grid)[...] += by_field[first:]
                by_field[0] += np.einsum("ij,ij->j", c, linear).reshape(grid)[0]
                by_field[1:first] += (self.slope @ c).reshape(grid)
            part = slice(rows.start + strip.start, rows.start + strip.stop), columns
            np.negative(by_field[0], out=variance[part])
            mean[:, part[0], part[1]] = by_field[1:first]


def _covariances(at: Floats, north: Floats, east: Floats, shape: Shape) -> Floats:
    """(r, p q) covariances of (r, 2) places with the points of a (p, q) grid."""
    lag = squared_lags(at, north, east).reshape(len(at), len(north) * len(east))
    return shape.at(np.sqrt(lag, out=lag))


def _interpolated(fields: Floats, north: Floats, east: Floats) -> Floats:
    """(p', f, q') of fields (p, f, q), by weights (p', p) and (q', q)."""
    p, f, q = fields.shape
    across = fields.reshape(p * f, q) @ east.T
    return (north @ across.reshape(p, -1)).reshape(len(north), f, len(east))


class Tiler:
    """Fills a grid with the mean and variance of a system of one variogram.

    Parameters
    ----------
    system
        What to krige by.
    easting, northing
        (nx,) and (ny,) coordinates in m.
    error
        To which a covariance is interpolated, in units of its height.
    """

    def __init__(self, system: System, easting: Floats, northing: Floats, error: float) -> None:
        extent = float(max(np.ptp(easting), np.ptp(northing)))
        self._shape = system.covariance.shape(extent)
        self._error = error
        self._smoothness: dict[int, Smoothness] = {}
        length = self._shape.length
        north = Stretch(northing / length, 0, len(northing))
        east = Stretch(easting / length, 0, len(easting))
        self._whole = _whole(system, self._shape, Box(north, east))

    def tiles(self) -> list[tuple[Tile, Box]]:
        """Boxes that are filled independently of each other, and the tiles they lie in."""
        return list(self._parts(self._whole, self._whole.box))

    def fill(self, tile: Tile, box: Box, mean: Floats, variance: Floats) -> None:
        """Write means (k, ny, nx) and variances (ny, nx) of a box into those of the grid."""
        tile = self._narrowed(tile, box)
        work = len(tile) * (1.0 + _PAIR * len(tile))
        if box.cells * work > 4.0 * (_BOX + NODES**2 * work):
            for part in box.split():
                self.fill(tile, part, mean, variance)
        else:
            tile.evaluate(box, mean, variance, self._shape)

    def _parts(self, tile: Tile, box: Box) -> Iterator[tuple[Tile, Box]]:
        if box.cells <= _LARGEST:
            yield tile, box
            return
        tile = self._narrowed(tile, box)
        for part in box.split():
            yield from self._parts(tile, part)

    def _narrowed(self, tile: Tile, box: Box) -> Tile:
        """Tile for a box within: absorb what is smooth over it, if that is worth it."""
        nearest, furthest = box.span(tile.at)
        touching = nearest < self._shape.end**2
        rough = self._at(box.half).rough(nearest, furthest) & touching
        smooth = touching & ~rough
        if box.cells < 2 * box.nodes or smooth.sum() <= 0.25 * len(tile):
            return tile.only(touching)
        return tile.absorb(box, rough, smooth, self._shape)

    def _at(self, half: float) -> Smoothness:
        size = ceil(16.0 * log2(half)) if half > 0.0 else -1024
        if size not in self._smoothness:
            self._smoothness[size] = smoothness(self._shape, 2.0 ** (size / 16.0), self._error)
        return self._smoothness[size]


def _whole(system: System, shape: Shape, box: Box) -> Tile:
    """Tile of a whole grid.

    With v = U c + w, U = (-W 1, W) and w = W b, the mean is z1 + y . v and the variance
    2 c(0) + e1 - 2 c1 - |v|^2.
    """
    readings, n = system.readings, len(system.readings)
    inverse = system.inverse.array[0, :, : n - 1]
    u = np.concatenate([-inverse.sum(axis=1, keepdims=True), inverse], axis=1)
    w = inverse @ system.base[0, 1:]
    linear = 2.0 * (w @ u)
    linear[0] += 2.0
    height = w @ w - 2.0 * system.covariance.origin[0] - readings.noise[0, 0]
    values = np.concatenate([[height], readings.z[:, 0] + system.y @ w, shape.height * linear])
    nodes = len(box.north.nodes), len(box.east.nodes)
    return Tile(
        box,
        np.broadcast_to(values[:, None], (nodes[0], len(values), nodes[1])),
        readings.at / shape.length,
        shape.height * (system.y @ u),
        shape.height**2 * (u.T @ u),
    )
