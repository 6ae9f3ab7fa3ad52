"""Kriged means and variances at scattered targets."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from subsoil.kriging.covariance import lags
from subsoil.kriging.readings import Readings
from subsoil.kriging.system import System

Floats = NDArray[np.float64]

_ELEMENTS = 1 << 22
"""Covariances held at a time: bounds the memory of a prediction."""


@dataclass(frozen=True)
class Solution:
    """What a system says about N targets.

    Attributes
    ----------
    base
        (g, N) b at the targets.
    v
        (g, n-1, N) W G, one row a reading but the first.
    mean, variance
        (m, N) and (g, N).
    pins
        (k, 2) pairs of target and reading at one place.
    """

    base: Floats
    v: Floats
    mean: Floats
    variance: Floats
    pins: NDArray[np.intp]


def solved(system: System, targets: Floats) -> Solution:
    """Krige at (N, 2) targets, keeping what appending readings needs."""
    readings = system.readings
    lag = lags(readings.at, targets)
    k = system.covariance(lag)
    e1 = readings.noise[:, :1]
    base = system.covariance.origin[:, None] + e1 - k[:, 0]
    column = k[:, 1:]
    column += base[:, None]
    column += (system.base - system.covariance.origin[:, None] - e1)[:, 1:, None]
    v = system.whitened(column)
    mean = readings.z[:, :1] + _combined(system.y, v)
    variance = 2.0 * base - e1 - np.einsum("gnt,gnt->gt", v, v)
    reading, target = np.nonzero(lag == 0.0)
    pins = np.column_stack([target, reading])
    pin(readings, pins, mean, variance)
    return Solution(base, v, mean, variance, pins)


def predicted(system: System, targets: Floats) -> tuple[Floats, Floats]:
    """Mean (m, N) and variance (g, N) at (N, 2) targets, a block at a time."""
    groups, n = system.base.shape
    block = max(1, _ELEMENTS // (groups * n))
    mean = np.empty((len(system.readings.z), len(targets)))
    variance = np.empty((groups, len(targets)))
    for start in range(0, len(targets), block):
        part = slice(start, start + block)
        solution = solved(system, targets[part])
        mean[:, part], variance[:, part] = solution.mean, solution.variance
    return mean, variance


def pin(readings: Readings, pins: NDArray[np.intp], mean: Floats, variance: Floats) -> None:
    """Set, in place, targets at a reading without noise to just that reading."""
    if len(pins):
        target, reading = pins.T
        certain = readings.noise[:, reading] == 0.0
        variance[:, target] = np.where(certain, 0.0, variance[:, target])
        mean[:, target] = np.where(certain, readings.z[:, reading], mean[:, target])


def _combined(y: Floats, v: Floats) -> Floats:
    """(m, N) products of (m, n) rows with (g, n, N), g being m or 1."""
    groups, n, targets = v.shape
    product: Floats = np.matmul(y.reshape(groups, len(y) // groups, n), v)
    return product.reshape(len(y), targets)
