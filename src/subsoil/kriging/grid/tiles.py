"""Kriging on a grid, tile by tile, by interpolating what the readings around a tile contribute.

With c the covariances of a cell with all readings, mean and variance are polynomials in c::

    mean     = constant + slope . c
    variance = -(height + linear . c + c' gram c)

Seen from a box of cells, most readings are far enough away for c to be smooth. What these
contribute is computed at Chebyshev nodes of the box and interpolated; the others are computed
from cell to cell. Going from the whole grid down to tiles, the parts of a box inherit from it by
interpolation, which loses nothing, and *absorb* the readings that are smooth over them and were
not before. The idea is that of the fast multipole method (Greengard & Rokhlin 1987) with
interpolation for the expansion (Fong & Darve 2009), carried over to the quadratic form of the
variance.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise, product

import numpy as np

from subsoil.arrays import Bools, Floats
from subsoil.kriging.covariance import Shape
from subsoil.kriging.grid.chebyshev import Box, Stretch, squared_lags, to_cells, to_nodes
from subsoil.kriging.grid.smoothness import Smoothness, smoothness
from subsoil.kriging.system import System

_STRIP = 1 << 16
"""Covariances in a strip of a tile: what stays in the cache of a processor core."""
_LARGEST = 1 << 14
"""Cells of the largest tile."""
_PAIR = 0.012
"""Work on a pair of readings at a cell, in evaluations of a covariance."""
_SPLIT = 8e4
"""Fixed work on splitting a tile, in evaluations of a covariance."""


@dataclass(frozen=True)
class Sighting:
    """How r readings look from a box; those neither rough nor smooth have no covariance there.

    Attributes
    ----------
    box
        The cells.
    rough, smooth
        (r,) readings whose covariance has, or has not, to be computed cell by cell.
    """

    box: Box
    rough: Bools
    smooth: Bools


@dataclass(frozen=True)
class Tile:
    """The polynomials of the cells of a box, in their covariances with r readings.

    Lengths and covariances are in units of the covariance's :class:`Shape`.

    Attributes
    ----------
    box
        The cells.
    fields
        (1 + k + r, p, q) height, k constants and linear at the p x q nodes of the box: what
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

    def split(self, sightings: list[Sighting], shape: Shape) -> list[Tile]:
        """Tiles of the parts of the box, as the readings look from each."""
        north, east = self.box.parts
        fields = _interpolated(
            self.fields,
            np.concatenate([to_nodes(self.box.north, part) for part in north]),
            np.concatenate([to_nodes(self.box.east, part) for part in east]),
        )
        corners = product(_slices(north), _slices(east))
        return [
            self._part(sighting, fields[:, row, column], shape)
            for sighting, (row, column) in zip(sightings, corners, strict=True)
        ]

    def _part(self, sighting: Sighting, fields: Floats, shape: Shape) -> Tile:
        """Tile of a part of the box, from the fields at its nodes."""
        first, box = 1 + len(self.slope), sighting.box
        stay, go = np.flatnonzero(sighting.rough), np.flatnonzero(sighting.smooth)
        kept = fields.take(np.concatenate([np.arange(first), first + stay]), axis=0)
        gram = self.gram.take(stay, axis=0)
        if len(go):
            c = _covariances(self.at[go], box.north.nodes, box.east.nodes, shape)
            among = self.gram.take(go, axis=0).take(go, axis=1)
            linear = fields.take(first + go, axis=0)
            _contribute(kept[:first], c, among, self.slope[:, go], linear)
            pairs = gram.take(go, axis=1) @ c
            pairs *= 2.0
            kept[first:] += pairs.reshape(kept[first:].shape)
        return Tile(box, kept, self.at[stay], self.slope[:, stay], gram.take(stay, axis=1))

    def evaluate(self, mean: Floats, variance: Floats, shape: Shape) -> None:
        """Write the means and variances of the box into (k, ny, nx) and (ny, nx) of a grid."""
        box, (rows, columns), first = self.box, self.box.part, 1 + len(self.slope)
        north, east = to_cells(box.north, box.north), to_cells(box.east, box.east)
        step = max(1, _STRIP // max(1, len(self) * len(east)))
        for start in range(0, len(north), step):
            strip = slice(start, min(start + step, len(north)))
            fields = _interpolated(self.fields, north[strip], east)
            if len(self):
                c = _covariances(self.at, box.north.at[strip], box.east.at, shape)
                _contribute(fields[:first], c, self.gram, self.slope, fields[first:])
            part = slice(rows.start + strip.start, rows.start + strip.stop), columns
            np.negative(fields[0], out=variance[part])
            mean[:, part[0], part[1]] = fields[1:first]


def _contribute(head: Floats, c: Floats, gram: Floats, slope: Floats, linear: Floats) -> None:
    """Add what readings contribute to (1 + k, p, q) height and constants.

    Parameters
    ----------
    head
        To be added to.
    c
        (r, p q) covariances of the readings with the points.
    gram, slope, linear
        (r, r), (k, r) and (r, p, q), of these readings.
    """
    grid = -1, *head.shape[1:]
    both = gram @ c
    both += linear.reshape(c.shape)
    head[0] += np.einsum("ij,ij->j", c, both).reshape(grid)[0]
    head[1:] += (slope @ c).reshape(grid)


def _slices(parts: tuple[Stretch, ...]) -> list[slice]:
    """Where the nodes of some stretches are among the nodes of all."""
    ends = np.cumsum([0, *(len(part.nodes) for part in parts)])
    return [slice(a, b) for a, b in pairwise(ends)]


def _covariances(at: Floats, north: Floats, east: Floats, shape: Shape) -> Floats:
    """(r, p q) covariances of (r, 2) places with the points of a (p, q) grid."""
    lag = squared_lags(at, north, east).reshape(len(at), len(north) * len(east))
    return shape.at(np.sqrt(lag, out=lag))


def _interpolated(fields: Floats, north: Floats, east: Floats) -> Floats:
    """(f, p', q') of fields (f, p, q), by weights (p', p) and (q', q)."""
    f, p, q = fields.shape
    along = north @ fields.swapaxes(0, 1).reshape(p, f * q)
    rows = along.reshape(len(north), f, q).swapaxes(0, 1).reshape(f * len(north), q)
    return (rows @ east.T).reshape(f, len(north), len(east))


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
        origin = np.array([easting[0], northing[0]])
        shape = system.covariance.shape(float(max(np.ptp(easting), np.ptp(northing))))
        east, north = ((x - x[0]) / shape.length for x in (easting, northing))
        box = Box(Stretch(north, 0, len(north)), Stretch(east, 0, len(east)))
        self._whole = _whole(system, shape, box, origin)
        self._shape = shape
        self._error = error
        self._smoothness: dict[float, Smoothness] = {}

    def tiles(self) -> list[Tile]:
        """Tiles of the whole grid that are filled independently of each other."""
        return list(self._small(self._whole))

    def fill(self, tile: Tile, mean: Floats, variance: Floats) -> None:
        """Write the means and variances of a tile into (k, ny, nx) and (ny, nx) of the grid."""
        nodes = tile.box.nodes_of_parts
        most = _work(tile.box.cells, len(tile)) - _SPLIT - _work(nodes, len(tile))
        sightings = self._sightings(tile) if most > 0.0 else []
        rest = sum(_work(sighting.box.cells, int(sighting.rough.sum())) for sighting in sightings)
        if most > rest:
            for part in tile.split(sightings, self._shape):
                self.fill(part, mean, variance)
        else:
            tile.evaluate(mean, variance, self._shape)

    def _small(self, tile: Tile) -> Iterator[Tile]:
        if tile.box.cells <= _LARGEST:
            yield tile
        else:
            for part in tile.split(self._sightings(tile), self._shape):
                yield from self._small(part)

    def _sightings(self, tile: Tile) -> list[Sighting]:
        """How the readings of a tile look from the parts of its box."""
        rows, columns = tile.box.parts
        look = self._smoothness_at(max(part.half for part in (*rows, *columns)))
        north = [(part, *look.span(tile.at[:, 1] - part.centre)) for part in rows]
        east = [(part, *look.span(tile.at[:, 0] - part.centre)) for part in columns]
        sightings = []
        for (row, y, far_y), (column, x, far_x) in product(north, east):
            nearest, furthest = y + x, far_y + far_x
            touching = nearest < self._shape.end**2
            rough = look.rough(nearest, furthest)
            rough &= touching
            sightings.append(Sighting(Box(row, column), rough, touching ^ rough))
        return sightings

    def _smoothness_at(self, half: float) -> Smoothness:
        if half not in self._smoothness:
            self._smoothness[half] = smoothness(self._shape, half, self._error)
        return self._smoothness[half]


def _work(cells: int, readings: int) -> float:
    """Work on some cells and all pairs of some readings, in evaluations of a covariance."""
    return cells * readings * (1.0 + _PAIR * readings)


def _whole(system: System, shape: Shape, box: Box, origin: Floats) -> Tile:
    """Tile of a whole grid, seen from an origin.

    With v = U c + w, U = (-W 1, W) and w = W b, the mean is z1 + y . v and the variance
    2 c(0) + e1 - 2 c1 - |v|^2.
    """
    readings = system.readings
    inverse = system.factor[0]
    u = np.concatenate([-inverse.sum(axis=1, keepdims=True), inverse], axis=1)
    w = inverse @ system.base[0, 1:]
    linear = 2.0 * (w @ u)
    linear[0] += 2.0
    height = w @ w - 2.0 * system.covariance.origin[0] - readings.noise[0, 0]
    values = np.concatenate([[height], readings.z[:, 0] + system.y @ w, shape.height * linear])
    nodes = len(box.north.nodes), len(box.east.nodes)
    return Tile(
        box,
        np.broadcast_to(values[:, None, None], (len(values), *nodes)),
        (readings.at - origin) / shape.length,
        shape.height * (system.y @ u),
        shape.height**2 * (u.T @ u),
    )
