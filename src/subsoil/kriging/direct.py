"""Kriged means and variances at scattered targets."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from subsoil.arrays import Floats, Indices
from subsoil.kriging.covariance import lags, strips
from subsoil.kriging.determined import is_delicate, undetermined
from subsoil.kriging.readings import Readings
from subsoil.kriging.system import System
from subsoil.kriging.validity import not_determined


@dataclass(frozen=True)
class Solution:
    """What a system says about N targets.

    Attributes
    ----------
    base
        (g, N) b at the targets.
    mean, variance
        (m, N) and (g, N).
    pins
        (k, 2) pairs of target and reading at one place.
    v
        (g, n-1, N) W G, one row a reading but the first; None where there are too many to keep.
    """

    base: Floats
    mean: Floats
    variance: Floats
    pins: Indices
    v: Floats | None


def solved(system: System, targets: Floats) -> Solution:
    """Krige at (N, 2) targets, a block at a time; what fits in one block is kept."""
    blocks = _blocks(system, targets)
    if fits_at_once(system, targets):
        return _solved(system, targets)
    (groups, _), layers = system.base.shape, len(system.readings.z)
    base, variance = np.empty((2, groups, len(targets)))
    mean, pins = np.empty((layers, len(targets))), []
    for part in blocks:
        one = _solved(system, targets[part])
        base[:, part], mean[:, part], variance[:, part] = one.base, one.mean, one.variance
        pins.append(one.pins + np.array([part.start, 0]))
    return Solution(base, mean, variance, np.concatenate(pins), None)


def predicted(system: System, targets: Floats) -> tuple[Floats, Floats]:
    """Mean (m, N) and variance (g, N) at (N, 2) targets."""
    solution = solved(system, targets)
    return solution.mean, solution.variance


def whitened(system: System, targets: Floats) -> Floats:
    """(g, n-1, N) v at (N, 2) targets, which is all that is held."""
    groups, n = system.base.shape
    v = np.empty((groups, n - 1, len(targets)))
    for part in _blocks(system, targets):
        v[:, :, part] = system.whitened(_seen(system, targets[part])[2])
    return v


def combined(system: System, y: Floats, targets: Floats) -> Floats:
    """(g, N) products y . v of (g, n-1) rows with v at (N, 2) targets, without v."""
    weights = np.matmul(y[:, None], system.factor)
    product = np.empty((len(y), len(targets)))
    for part in _blocks(system, targets):
        product[:, part] = np.matmul(weights, _seen(system, targets[part])[2])[:, 0]
    return product


def fits_at_once(system: System, targets: Floats) -> bool:
    """Whether (N, 2) targets are few enough to krige in one go and keep the work on them."""
    return len(_blocks(system, targets)) == 1


def base_at(system: System, targets: Floats) -> Floats:
    """(g, N) b of :mod:`subsoil.kriging.system` at (N, 2) targets."""
    lag = lags(system.readings.at[:1], targets)
    return _base(system, system.covariance(lag)[:, 0])


def _base(system: System, first: Floats) -> Floats:
    """(g, N) b of targets from their covariances (g, N) with the first reading."""
    return system.covariance.origin[:, None] + system.readings.noise[:, :1] - first


def _blocks(system: System, targets: Floats) -> list[slice]:
    """Targets kriged at a time."""
    return list(strips(len(targets), system.base.size))


def _solved(system: System, targets: Floats) -> Solution:
    readings = system.readings
    lag, base, seen = _seen(system, targets)
    v = system.whitened(seen)
    mean = readings.z[:, :1] + _combined(system.y, v)
    variance = 2.0 * base - readings.noise[:, :1] - np.einsum("gnt,gnt->gt", v, v)
    reading, target = np.nonzero(lag == 0.0)
    pins = np.column_stack([target, reading])
    check_determined(system, targets, v, mean, pins)
    pin(readings, pins, mean, variance)
    return Solution(base, mean, variance, pins, v)


def check_determined(
    system: System, targets: Floats, v: Floats, mean: Floats, pins: Indices
) -> None:
    """Check that readings, and not rounding, decide means (m, N) at (N, 2) targets.

    Raises
    ------
    SingularSystemError
        If they do not, at a target that is not at a reading.
    """
    if not is_delicate(system):
        return
    doubtful = undetermined(system, v, mean)
    doubtful[:, pins[:, 0]] = False
    if doubtful.any():
        layer, target = np.argwhere(doubtful)[0].tolist()
        groups = len(system.base)
        raise not_determined(
            system.readings, system.covariance.variograms, layer * groups // len(mean),
            targets[target],
        )  # fmt: skip


def _seen(system: System, targets: Floats) -> tuple[Floats, Floats, Floats]:
    """Lags (n, N) of targets to the readings, b (g, N) and G (g, n-1, N) of them."""
    readings = system.readings
    lag = lags(readings.at, targets)
    k = system.covariance(lag)
    base = _base(system, k[:, 0])
    column = k[:, 1:]
    column += base[:, None]
    e1 = readings.noise[:, :1]
    column += (system.base - system.covariance.origin[:, None] - e1)[:, 1:, None]
    return lag, base, column


def pin(readings: Readings, pins: Indices, mean: Floats, variance: Floats) -> None:
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
