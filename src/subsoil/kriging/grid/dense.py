"""Dense maps: ordinary kriging from all readings at every cell of a large grid."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from threadpoolctl import threadpool_limits

from subsoil.arrays import Floats, Indices
from subsoil.errors import ParameterError
from subsoil.kriging.determined import is_delicate
from subsoil.kriging.direct import predicted
from subsoil.kriging.grid.chebyshev import NODES, Box, Stretch
from subsoil.kriging.grid.tiles import Tiler
from subsoil.kriging.system import System

Run = Callable[[Callable[[Any], None], Iterable[Any]], object]
"""Call a function with each of some jobs."""

_ACCEPTED = 2e-10
"""What a map may differ by from direct kriging, in standard deviations and sills."""
_ERRORS = (5e-11, 1e-13)
"""Errors of interpolated covariances to try in turn, in their own units."""
_SPOTS = 256
"""Random cells at which a map is compared with direct kriging."""
_DIRECT = 4 * NODES**2
"""Cells up to which a map is kriged directly."""
_UNEVEN = 1e-3
"""Share of a cell by which a coordinate may be off."""


def predicted_on_grid(
    system: System, easting: ArrayLike, northing: ArrayLike
) -> tuple[Floats, Floats, float]:
    """Krige on a grid.

    Returns
    -------
    tuple
        Mean (m, ny, nx), variance (g, ny, nx), and the largest difference to direct kriging at
        random cells, in standard deviations of the readings and in sills; 0 for a direct map.

    Raises
    ------
    ParameterError
        If an axis is not ascending and evenly spaced.
    """
    east, north = _axis(easting, "easting"), _axis(northing, "northing")
    grid = Box(Stretch(north, 0, len(north)), Stretch(east, 0, len(east)))
    mean = np.empty((len(system.readings.z), len(north), len(east)))
    variance = np.empty((len(system.base), len(north), len(east)))
    spot_check = 0.0
    with _threads() as run:
        for group, layers in enumerate(system.layers()):
            part = system.of(group)
            out = mean[layers], variance[group : group + 1]
            spot_check = max(spot_check, _mapped(part, grid, *out, run))
    return mean, variance, spot_check


def _mapped(system: System, grid: Box, mean: Floats, variance: Floats, run: Run) -> float:
    """Fill the map of one variogram as fast as is exact enough; return its spot check."""
    if grid.cells > _DIRECT and not is_delicate(system):
        for error in _ERRORS:
            tiler = Tiler(system, grid.east.at, grid.north.at, error)
            run(partial(tiler.fill, mean=mean, variance=variance[0]), tiler.tiles())
            _reset_readings(system, grid, mean, variance)
            spot_check = _spot_check(system, grid, mean, variance)
            if spot_check <= _ACCEPTED:
                return spot_check
    rows = max(1, _DIRECT // len(grid.east))
    blocks = [np.arange(k, min(k + rows, len(grid.north))) for k in range(0, len(grid.north), rows)]
    run(lambda block: _fill_directly(system, grid, block, mean, variance), blocks)
    return 0.0


def _fill_directly(
    system: System, grid: Box, block: Indices, mean: Floats, variance: Floats
) -> None:
    row, column = np.meshgrid(block, np.arange(len(grid.east)), indexing="ij")
    _put_direct(system, grid, row, column, mean, variance)


def _put_direct(
    system: System, grid: Box, row: Indices, column: Indices, mean: Floats, variance: Floats
) -> None:
    """Krige cells directly and write them into a map."""
    cells = np.stack([grid.east.at[column], grid.north.at[row]], axis=-1)
    direct = predicted(system, cells.reshape(-1, 2))
    mean[:, row, column] = direct[0].reshape(-1, *row.shape)
    variance[:, row, column] = direct[1].reshape(-1, *row.shape)


def _reset_readings(system: System, grid: Box, mean: Floats, variance: Floats) -> None:
    """Krige cells at readings directly where the prediction jumps there, or has no variance."""
    readings = system.readings
    column, row = (
        np.minimum(np.searchsorted(axis, x), len(axis) - 1)
        for axis, x in zip((grid.east.at, grid.north.at), readings.at.T, strict=True)
    )
    at = np.stack([grid.east.at[column], grid.north.at[row]], axis=-1)
    jumps = (at == readings.at).all(axis=1)
    jumps &= (readings.noise[0] == 0.0) | (system.covariance.jump[0] > 0.0)
    if jumps.any():
        _put_direct(system, grid, row[jumps], column[jumps], mean, variance)


def _spot_check(system: System, grid: Box, mean: Floats, variance: Floats) -> float:
    random = np.random.default_rng(0)
    row = random.integers(len(grid.north), size=_SPOTS)
    column = random.integers(len(grid.east), size=_SPOTS)
    cells = np.stack([grid.east.at[column], grid.north.at[row]], axis=-1)
    direct_mean, direct_variance = predicted(system, cells)
    scale = float(system.scale[0])
    sd = system.readings.z.std(axis=1, keepdims=True)
    off_mean = np.abs(mean[:, row, column] - direct_mean) / np.where(sd > 0.0, sd, np.sqrt(scale))
    off_variance = np.abs(variance[:, row, column] - direct_variance) / scale
    return float(max(off_mean.max(), off_variance.max()))


@contextmanager
def _threads() -> Iterator[Run]:
    """Run a function over jobs in threads, BLAS in one each.

    Half as many as there are cores: more of them mostly wait for the interpreter.
    """
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    threads = max(1, (cores or 1) // 2)
    with threadpool_limits(1, user_api="blas"), ThreadPoolExecutor(threads) as pool:
        yield lambda work, jobs: deque(pool.map(work, jobs), maxlen=0)


def _axis(values: ArrayLike, name: str) -> Floats:
    axis = np.asarray(values, dtype=float)
    if axis.ndim != 1 or not len(axis) or not np.isfinite(axis).all():
        raise ParameterError("must be one or more finite coordinates in metres", where=name)
    step = np.diff(axis)
    even = np.linspace(axis[0], axis[-1], len(axis))
    if (step <= 0.0).any() or (np.abs(axis - even) > _UNEVEN * np.ptp(axis) / len(axis)).any():
        raise ParameterError(
            "must be ascending and evenly spaced",
            where=name,
            remedy="use predict() for other places",
        )
    return axis
