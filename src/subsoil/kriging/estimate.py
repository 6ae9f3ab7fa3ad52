"""Kriging at fixed targets that follows the readings as they come."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from subsoil.errors import SingularSystemError
from subsoil.kriging.covariance import lags
from subsoil.kriging.ordinary import OrdinaryKriging, Prediction, rounding
from subsoil.kriging.rows import Rows
from subsoil.variogram.models import BoundedLinear

Floats = NDArray[np.float64]

_BLOCK = 4096
"""Targets solved at a time in a direct prediction: bounds its memory."""


@dataclass(frozen=True)
class Estimate:
    """Kriged mean and variance at (N, 2) targets, with what it takes to update them.

    Made by :func:`over`. Appending a reading costs O(n^2 + n N) and equals starting again.

    Attributes
    ----------
    kriging
        The readings conditioned on.
    targets
        (N, 2) places in m.
    v
        (g, n, N) W C0, one row a reading.
    yv, fv, vv
        (m, N), (g, N) and (g, N): y V, f V and the column sums of V^2.
    pins
        (k, 2) pairs of target and reading at one place.
    """

    kriging: OrdinaryKriging
    targets: Floats
    v: Rows
    yv: Floats
    fv: Floats
    vv: Floats
    pins: NDArray[np.int64]

    @cached_property
    def prediction(self) -> Prediction:
        """Mean and variance, (N,) or (m, N)."""
        ok = self.kriging
        mean, variance = self._layers
        return Prediction(mean, variance, ok.notes) if ok.layered else _flat(mean, variance, ok)

    @cached_property
    def _layers(self) -> tuple[Floats, Floats]:
        ok = self.kriging
        u = 1.0 - self.fv
        mean = ok.mu[:, None] * u + self.yv
        variance = ok.target_variance[:, None] - self.vv + u * u / ok.ff[:, None]
        if len(self.pins):
            target, reading = self.pins.T
            certain = _certain(ok)[:, reading]
            variance[:, target] = np.where(certain, 0.0, variance[:, target])
            mean[:, target] = np.where(certain, ok.z[:, reading], mean[:, target])
        return mean, np.broadcast_to(variance, mean.shape)

    def append(self, at: ArrayLike, z: ArrayLike, *, error_variance: ArrayLike = 0.0) -> Estimate:
        """Follow further readings; see :meth:`OrdinaryKriging.append`."""
        places, values, error = self.kriging._check_new(at, z, error_variance)
        grown = self
        for k in range(len(places)):
            ok = grown.kriging
            noise = error[:, k] if ok.exact else error[:, k] + ok.covariance.nugget
            grown = grown._follow(places[k], values[:, k], noise)
        return grown

    def _follow(self, at: Floats, z: Floats, noise: Floats) -> Estimate:
        ok, border = self.kriging.border(at, z, noise)
        if border is None:
            return over(ok, self.targets)
        lag = np.sqrt(((self.targets - at) ** 2).sum(axis=1))
        v = self.kriging.target_covariance(lag)
        v -= np.matmul(border.row[:, None, :], self.v.array)[:, 0]
        v /= border.d[:, None]
        here = np.flatnonzero(lag == 0.0)
        if here.size:
            new = np.column_stack([here, np.full(here.size, len(ok.at) - 1)])
            pins = np.concatenate([self.pins, new])
        else:
            pins = self.pins
        return Estimate(
            ok,
            self.targets,
            self.v.append(v),
            self.yv + border.y[:, None] * v,
            self.fv + border.f[:, None] * v,
            self.vv + v * v,
            pins,
        )

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
        ok = self.kriging
        index = np.asarray(candidates, dtype=np.int64)
        v = self.v.array
        joint = ok.target_covariance(lags(self.targets[index], self.targets))
        joint -= np.matmul(v[:, :, index].transpose(0, 2, 1), v)
        u = 1.0 - self.fv
        joint += u[:, index, None] * u[:, None, :] / ok.ff[:, None, None]
        own = joint[:, np.arange(len(index)), index]
        reading = own if ok.exact else own + ok.covariance.nugget[:, None]
        drop = joint**2 / reading[:, :, None]
        shape = (len(ok.z), *drop.shape[1:])
        return np.broadcast_to(drop, shape) if ok.layered else drop[0]


def over(ok: OrdinaryKriging, targets: ArrayLike) -> Estimate:
    """Krige at fixed targets, ready to follow further readings.

    Parameters
    ----------
    ok
        Readings conditioned on.
    targets
        (N, 2) places in m.
    """
    places = np.atleast_2d(np.asarray(targets, dtype=float))
    lag = lags(ok.at, places)
    n = len(ok.at)
    v = np.matmul(ok.inverse.array[:, :, :n], ok.target_covariance(lag))
    reading, target = np.nonzero(lag == 0.0)
    return Estimate(
        ok,
        places,
        Rows(v),
        np.matmul(ok.y[:, None, :], v)[:, 0],
        np.matmul(ok.f[:, None, :], v)[:, 0],
        np.einsum("gnt,gnt->gt", v, v),
        np.column_stack([target, reading]),
    )


def predict_direct(ok: OrdinaryKriging, targets: Floats) -> Prediction:
    """Mean and variance at (N, 2) targets, a block at a time."""
    starts = range(0, max(len(targets), 1), _BLOCK)
    blocks = [over(ok, targets[k : k + _BLOCK])._layers for k in starts]
    mean = np.concatenate([mean for mean, _ in blocks], axis=1)
    variance = np.concatenate([variance for _, variance in blocks], axis=1)
    broken = broken_layers(ok, variance)
    if broken.any() and ok.invalid == "circular":
        return predict_direct(ok.with_circular(broken), targets)
    if broken.any():
        negative = variance < -rounding(ok)[:, None]
        mean, variance = np.where(negative, np.nan, mean), np.where(negative, np.nan, variance)
    return Prediction(mean, variance, ok.notes) if ok.layered else _flat(mean, variance, ok)


def broken_layers(ok: OrdinaryKriging, variance: Floats) -> NDArray[np.bool_]:
    """Mark the (g,) bounded linear models that gave a negative variance in (m, ...).

    Raises
    ------
    SingularSystemError
        If a model that is valid in the plane did so: the system is too ill-conditioned to trust.
    """
    lowest = variance.reshape(len(variance), -1).min(axis=1, initial=0.0)
    groups = lowest if len(ok.noise) == len(lowest) else lowest.min(keepdims=True)
    broken = groups < -rounding(ok)
    for g in np.flatnonzero(broken):
        if not isinstance(ok.variograms[g], BoundedLinear):
            raise SingularSystemError(
                f"kriging variance fell to {groups[g]:.3g}: the system is too ill-conditioned",
                where=f"layer {g + 1}, {ok.variograms[g]}",
                remedy="add a nugget or choose a rougher model",
            )
    return np.asarray(broken)


def _certain(ok: OrdinaryKriging) -> NDArray[np.bool_]:
    """(g, n) whether a reading is what is predicted at its place, without any noise."""
    return ok.noise == 0.0


def _flat(mean: Floats, variance: Floats, ok: OrdinaryKriging) -> Prediction:
    return Prediction(mean[0], variance[0], ok.notes)


