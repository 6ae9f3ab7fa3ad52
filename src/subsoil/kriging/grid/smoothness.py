"""From how far away a covariance can be interpolated over a box of cells."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import inf, sqrt

import numpy as np

from subsoil.arrays import Bools, Floats
from subsoil.kriging.covariance import Shape
from subsoil.kriging.grid.chebyshev import NODES, Stretch, squared_lags

_GAPS = (0.0, 0.25, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 6.0, 10.0, 20.0)
"""Distances tried, in half sides of a square."""
_FAR = 3.0
"""Distance, in half sides, at which only the breaks matter."""
_INSIDE = ((0.0, 0.0), (0.3, 0.5), (1.0, 0.2), (1.0, 1.0))
"""Places tried within a square, in its half sides."""
_MORE = (1.0 + 1e-9, 1.4, 2.2, 4.0)
"""Multiples of a distance tried as well."""


@dataclass(frozen=True)
class Smoothness:
    """Where a reading's covariance is smooth over a square, and boxes in it, in units of its own.

    Attributes
    ----------
    half
        Half the side of the square.
    reach
        Distance from the nearest point of the square beyond which it is smooth.
    guard
        Distance by which the furthest point has to stay short of a break.
    breaks
        Distances at which the covariance is not smooth; it is zero from the last on.
    """

    half: float
    reach: float
    guard: float
    breaks: tuple[float, ...]

    def span(self, x: Floats) -> tuple[Floats, Floats]:
        """Squared distances to the nearest and furthest point of a side with its middle at 0."""
        away = np.abs(x)
        nearest = np.maximum(away - self.half, 0.0)
        nearest *= nearest
        away += self.half
        away *= away
        return nearest, away

    def rough(self, nearest: Floats, furthest: Floats) -> Bools:
        """Mark readings whose covariance is not smooth, by squared distances to the square."""
        rough = nearest < self.reach**2
        for lag in self.breaks:
            rough |= (nearest < lag**2) & (furthest > max(lag - self.guard, 0.0) ** 2)
        return rough

    def rough_from(self, at: Floats) -> Bools:
        """Mark readings whose covariance is not smooth, by (n, 2) places from the middle."""
        (near_x, far_x), (near_y, far_y) = self.span(at[:, 0]), self.span(at[:, 1])
        return self.rough(near_x + near_y, far_x + far_y)


def smoothness(shape: Shape, half: float, error: float) -> Smoothness:
    """Try out from where on a covariance is interpolated to an error, all in units of its own."""
    axis = np.linspace(-half, half, NODES + 1)
    side = Stretch(axis, 0, len(axis))

    def fits(at: Floats, tried: Smoothness) -> bool:
        smooth = at[~tried.rough_from(at)]
        return not len(smooth) or _interpolation_error(shape, smooth, side) <= error

    def guarded(gap: float) -> bool:
        tried = Smoothness(half, _FAR * half, gap, shape.breaks)
        return fits(_short(tried), tried)

    def reached(gap: float) -> bool:
        tried = Smoothness(half, gap, guard, shape.breaks)
        return fits(np.concatenate([_beyond(gap / half, half), _short(tried)]), tried)

    guard = _least(half, guarded)
    return Smoothness(half, _least(half, reached), guard, shape.breaks)


def _least(half: float, fits: Callable[[float], bool]) -> float:
    """Find the least of the gaps that fits, if those beyond it do; infinite if none does."""
    gaps = [gap * half for gap in _GAPS] + [inf]
    low, high = 0, len(_GAPS)
    while low < high:
        middle = (low + high) // 2
        if fits(gaps[middle]):
            high = middle
        else:
            low = middle + 1
    return gaps[high]


def _beyond(gap: float, half: float) -> Floats:
    """Return (k, 2) places a gap, in half sides, and more from a square; for 0 also within it."""
    away = np.array([gap * more if gap else more - 1.0 for more in _MORE])[:, None]
    beside = [(1.0 + away, np.full_like(away, y)) for y in (0.0, 0.5, 1.0)]
    angles = np.radians([22.5, 45.0])
    beside.append((1.0 + away * np.cos(angles), 1.0 + away * np.sin(angles)))
    places = [np.column_stack([x.ravel(), y.ravel()]) for x, y in beside]
    return half * np.concatenate([*places, np.array(_INSIDE)] if not gap else places)


def _short(tried: Smoothness) -> Floats:
    """Return (k, 2) places of which the furthest point of a square is a guard short of a break."""
    half = tried.half
    reach = np.array([lag - tried.guard * more for lag in tried.breaks for more in _MORE])
    sideways = (0.0, 0.5 * half, half)
    x = [np.sqrt(np.maximum(reach**2 - (y + half) ** 2, 0.0)) - half for y in sideways]
    places = [np.column_stack([x, np.full_like(x, y)]) for x, y in zip(x, sideways, strict=True)]
    aslant = reach * sqrt(0.5) - half
    at = np.concatenate([*places, np.column_stack([aslant, aslant])])
    return at[at[:, 0] >= 0.0] * (1.0 - 1e-12)


def _interpolation_error(shape: Shape, at: Floats, side: Stretch) -> float:
    """Largest error of the covariances with (k, 2) places interpolated over a square."""
    nodes, cells = side.nodes, side.at[::2]
    c = shape.at(np.sqrt(squared_lags(at, nodes, nodes)))
    weights = side.weights(cells)
    exact = shape.at(np.sqrt(squared_lags(at, cells, cells)))
    return float(np.abs(weights @ c @ weights.T - exact).max())
