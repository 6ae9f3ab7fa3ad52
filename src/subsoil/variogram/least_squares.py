"""The search for the nugget, range and partial sill with the least weighted squares.

At a given range the best nugget and partial sill, neither negative, have a closed form; only the
range is searched. A geometric grid over its bounds finds the neighbourhood of the best one, and
ever finer grids close in on it, for all layers at once. That steps over local optima, needs no
derivatives (the bounded linear model has kinks) and costs a millisecond or two.

Arrays have a row a layer; rows with fewer bins are filled up with bins of weight 0.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from subsoil.arrays import Bools, Floats, Indices, Integers
from subsoil.variogram.models import Bounded

ZOOMS = 7
"""Finer grids after the first; each narrows the range twelvefold, to about 1e-8 of it in all."""
ZOOM_RANGES = 25
ROUNDING = 1e-13
"""Sums of squares that differ by less than this share of the data's own are equally good."""


def padded(rows: Sequence[Floats | Integers], fill: float) -> Floats:
    """Rows of unequal lengths as one array (m, b), filled up on the right.

    Examples
    --------
    >>> padded([np.array([1.0]), np.array([2.0, 3.0])], 0.0)
    array([[1., 0.],
           [2., 3.]])
    """
    array = np.full((len(rows), max(row.size for row in rows)), fill)
    for line, row in zip(array, rows, strict=True):
        line[: row.size] = row
    return array


def geometric(low: Floats, high: Floats, number: int) -> Floats:
    """(m, number) ranges in equal ratios between low and high, both (m,) and both included."""
    ranges = np.geomspace(low, high, number, axis=1)
    return np.clip(ranges, low[:, None], high[:, None])


def search(
    model: type[Bounded],
    lag: Floats,
    semivariance: Floats,
    weight: Floats,
    ranges: Floats,
    *,
    zooms: int,
) -> Floats:
    """Nugget, range and partial sill of each layer as the rows of a (3, m) array.

    Parameters
    ----------
    model
        Kind of model.
    lag, semivariance, weight
        (m, b) bins of each layer.
    ranges
        (m, k) increasing ranges to try in m. Of equally good ones the first wins.
    zooms
        How often to go on with a finer grid between the neighbours of the best range.
    """
    layer = np.arange(len(ranges))
    alike = ROUNDING * (weight * semivariance**2).sum(axis=1)
    for _ in range(zooms):
        best = _first_least(solve(model, lag, semivariance, weight, ranges)[2], alike)
        below, above = np.maximum(best - 1, 0), np.minimum(best + 1, ranges.shape[1] - 1)
        ranges = geometric(ranges[layer, below], ranges[layer, above], ZOOM_RANGES)
    nugget, psill, squares = solve(model, lag, semivariance, weight, ranges)
    best = _first_least(squares, alike)
    return np.stack([values[layer, best] for values in (nugget, ranges, psill)])


def solve(
    model: type[Bounded], lag: Floats, semivariance: Floats, weight: Floats, ranges: Floats
) -> tuple[Floats, Floats, Floats]:
    """Best non-negative nugget and partial sill, and their sum of squares, at (m, k) ranges.

    A straight line in x = 1 - correlation. Where the free line falls, the best one is level;
    where it starts below zero, the best one goes through the origin. Semivariances are not
    negative, so never both: this is non-negative least squares in two variables, exactly. Where
    x is the same in every bin only the sum of the two is known, and all of it is taken as rise.
    """
    x = 1.0 - model.correlation(lag[:, None] / ranges[:, :, None])
    y, w = semivariance[:, None], weight[:, None]
    total, square = w.sum(axis=-1), (w * x * x).sum(axis=-1)
    x_mean, y_mean = (w * x).sum(axis=-1) / total, (w * y).sum(axis=-1) / total
    from_mean = x - x_mean[..., None]
    spread = (w * from_mean * from_mean).sum(axis=-1)
    known_apart = spread > 1e-12 * square
    slope = _ratio((w * from_mean * y).sum(axis=-1), spread, known_apart)
    level = slope <= 0
    through_origin = (square > 0) & np.where(known_apart, y_mean < slope * x_mean, True)
    psill = np.where(level, 0.0, slope)
    psill = np.where(through_origin, _ratio((w * x * y).sum(axis=-1), square, square > 0), psill)
    nugget = np.where(through_origin, 0.0, y_mean - psill * x_mean)
    residual = y - nugget[..., None] - psill[..., None] * x
    return nugget, psill, (w * residual * residual).sum(axis=-1)


def _first_least(squares: Floats, alike: Floats) -> Indices:
    """(m,) first column of (m, k) that is as small as the smallest, to within (m,) rounding."""
    enough = squares.min(axis=1) + alike
    first: Indices = (squares <= enough[:, None]).argmax(axis=1)
    return first


def _ratio(over: Floats, under: Floats, where: Bools) -> Floats:
    return np.divide(over, under, out=np.zeros_like(over), where=where)
