"""Kriging at fixed targets that follows the readings as they come."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy
from numpy.typing import ArrayLike

from subsoil.arrays import Floats, Indices
from subsoil.kriging.covariance import lags
from subsoil.kriging.direct import (
    base_at,
    check_determined,
    combined,
    fits_at_once,
    pin,
    solved,
    whitened,
)
from subsoil.kriging.grid.dense import predicted_on_grid
from subsoil.kriging.growing_stack import GrowingStack
from subsoil.kriging.leave_one_out import LeaveOneOut, leave_one_out
from subsoil.kriging.ordinary import OrdinaryKriging
from subsoil.kriging.prediction import Prediction
from subsoil.kriging.readings import checked_targets
from subsoil.land.field import Field
from subsoil.variogram import Variogram

_FILLED = 0.25
"""Share of its rectangle that a field fills, from which on it is quicker to krige all of that."""


@dataclass(frozen=True)
class KrigedAt:
    """Ordinary kriging at (N, 2) targets, with what it takes to update it.

    Made by :func:`at_targets`. Appending a reading costs O(n^2 + n N) and equals starting again.
    A large map takes no more memory than its answers and a block of the work on them, until
    readings are appended or looked ahead at: that takes all of v.

    Attributes
    ----------
    kriging
        The readings conditioned on.
    targets
        (N, 2) places in m.
    base
        (g, N) b of :mod:`subsoil.kriging.system` at the targets.
    mean, variance
        (m, N) and (g, N).
    pins
        (k, 2) pairs of target and reading at one place.
    kept
        :attr:`v`, where it was kept.
    """

    kriging: OrdinaryKriging
    targets: Floats
    base: Floats
    mean: Floats
    variance: Floats
    pins: Indices
    kept: GrowingStack | None

    @property
    def at(self) -> Floats:
        """(n, 2) distinct places of the readings in m."""
        return self.kriging.at

    @property
    def variograms(self) -> tuple[Variogram, ...]:
        """The g models kriged with."""
        return self.kriging.variograms

    @cached_property
    def v(self) -> GrowingStack:
        """(g, n-1, N) one row a reading but the first."""
        return self.kept or GrowingStack(whitened(self.kriging.system, self.targets))

    @cached_property
    def prediction(self) -> Prediction:
        """Mean and variance, (N,) or (m, N)."""
        return self.kriging.prediction(self.mean, self.variance)

    def append(self, at: ArrayLike, z: ArrayLike, *, error_variance: ArrayLike = 0.0) -> KrigedAt:
        """Follow further readings; see :meth:`OrdinaryKriging.append`."""
        grown = self
        for place, values, noise in self.kriging.incoming(at, z, error_variance):
            grown = grown._follow(place, values, noise)
        return grown

    def _follow(self, at: Floats, z: Floats, noise: Floats) -> KrigedAt:
        system = self.kriging.system
        readings, n = system.readings, len(system.readings)
        lag = lags(np.concatenate([readings.at, self.targets]), at[None])[:, 0]
        k = system.covariance(lag)
        border = system.border(lag[:n], k[:, :n], noise)
        if not border.sound:
            return at_targets(self.kriging.joined(at, z, noise), self.targets)
        ok = self.kriging.grown(border, at, z, noise)
        rows, v = self.v.grown(len(self.targets))
        np.add(k[:, n:], self.base, out=v)
        v -= np.matmul(border.row[:, None, :], self.v.array)[:, 0]
        v -= k[:, :1]
        v /= np.sqrt(border.pivot)[:, None]
        mean = ok.system.y[:, -1:] * v
        mean += self.mean
        variance = v * v
        np.subtract(self.variance, variance, out=variance)
        here = np.flatnonzero(lag[n:] == 0.0)
        pins = self.pins
        if here.size:
            pins = np.concatenate([pins, np.column_stack([here, np.full(here.size, n)])])
        check_determined(ok.system, self.targets, rows.array, mean, pins)
        pin(ok.system.readings, pins, mean, variance)
        return _sound(KrigedAt(ok, self.targets, self.base, mean, variance, pins, rows))

    def at_targets(self, targets: ArrayLike) -> KrigedAt:
        """Krige from the same readings at (k, 2) other targets in m."""
        return at_targets(self.kriging, targets)

    def variance_drop(self, candidates: ArrayLike) -> Floats:
        """By how much the variance falls everywhere if one of these targets were probed next.

        Exact, and independent of what the reading would be (with the variogram held).

        Parameters
        ----------
        candidates
            (k,) indices of targets.

        Returns
        -------
        ndarray
            (k, N), or (m, k, N) for layers.
        """
        index = np.asarray(candidates, dtype=np.intp)
        noise = self.kriging.system.covariance.noise
        return self.kriging.shaped(variance_drop_of(self.error_covariance(index), index, noise))

    def combined(self, y: Floats) -> Floats:
        """(g, N) products of (g, n-1) rows with v."""
        if self.kept is None:
            return combined(self.kriging.system, y, self.targets)
        return np.asarray(np.einsum("gn,gnt->gt", y, self.kept.array))

    def leave_one_out(self) -> LeaveOneOut:
        """Each reading predicted from the others."""
        return leave_one_out(self.kriging)

    def error_covariance(self, rows: Indices, columns: Indices | slice = slice(None)) -> Floats:
        """(g, k, l) covariance of the kriging errors at k of the targets with those at l.

        With the terms of :mod:`subsoil.kriging.system`: ``c(s, t) + b(s) + b(t) - (c(0) + e1) -
        v(s) . v(t)``; where s is t it is the kriging variance.
        """
        system = self.kriging.system
        shift = self.base[:, rows].T - (system.covariance.origin + system.readings.noise[:, 0])
        joint = system.covariance(lags(self.targets[rows], self.targets[columns]))
        joint -= np.matmul(self._v_at(rows).transpose(0, 2, 1), self._v_at(columns))
        joint += self.base[:, None, columns]
        joint += shift.T[:, :, None]
        return joint

    def _v_at(self, which: Indices | slice) -> Floats:
        """(g, n-1, k) v at some of the targets; all of it stays once many were asked for."""
        if isinstance(which, slice) or self.kept is not None or "v" in vars(self):
            return self.v.array[:, :, which]
        return whitened(self.kriging.system, self.targets[which])


def variance_drop_of(joint: Floats, index: Indices, noise: Floats) -> Floats:
    """(g, k, N) fall of the variance if one of k targets were probed.

    Parameters
    ----------
    joint
        (g, k, N) covariance of the errors at these targets with those at all; it is overwritten.
    index
        (k,) indices of the targets.
    noise
        (g,) variance of a reading.
    """
    own = joint[:, np.arange(len(index)), index] + noise[:, None]
    joint *= joint
    # A place known for certain has nothing to tell.
    known = own[:, :, None] > 0.0
    return np.divide(joint, own[:, :, None], out=np.zeros_like(joint), where=known)


def at_targets(ok: OrdinaryKriging, targets: ArrayLike) -> KrigedAt:
    """Krige at fixed targets, ready to follow further readings.

    Parameters
    ----------
    ok
        Readings conditioned on.
    targets
        (N, 2) places in m.

    Raises
    ------
    SingularSystemError
        If a variance is negative beyond rounding under a model that should forbid it.
    """
    places = checked_targets(targets)
    s = solved(ok.system, places)
    kept = None if s.v is None else GrowingStack(s.v)
    return _sound(KrigedAt(ok, places, s.base, s.mean, s.variance, s.pins, kept))


def at_cells(ok: OrdinaryKriging, field: Field) -> KrigedAt:
    """Krige at all cells of a field, ready to follow further readings.

    As :func:`at_targets` with the cells, to about 1e-9 standard deviations of the readings and
    sills: where there are too many to keep the work on them, and they fill a good part of their
    rectangle, by :mod:`subsoil.kriging.grid.dense`, some ten times as fast.

    Parameters
    ----------
    ok
        Readings conditioned on.
    field
        The field of N cells.

    Raises
    ------
    SingularSystemError
        As :func:`at_targets`.
    """
    cells, grid = field.cells, field.grid
    if fits_at_once(ok.system, cells) or grid.inside.mean() < _FILLED:
        return at_targets(ok, cells)
    mean, variance, _ = predicted_on_grid(ok.system, grid.easting, grid.northing)
    away, nearest = scipy.spatial.KDTree(cells).query(ok.at)
    pins = np.column_stack([nearest, np.arange(len(ok.at))])[away == 0.0]
    inside = mean[:, grid.inside], variance[:, grid.inside]
    return _sound(KrigedAt(ok, cells, base_at(ok.system, cells), *inside, pins, None))


def _sound(estimate: KrigedAt) -> KrigedAt:
    """Return the estimate, or that of the replacement models where its own turned out invalid."""
    ok = estimate.kriging.mended(estimate.variance)
    return estimate if ok is estimate.kriging else at_targets(ok, estimate.targets)
