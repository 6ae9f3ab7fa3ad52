"""Readings predicted from the others: what a map is worth, without any truth."""

from __future__ import annotations

from dataclasses import dataclass
from math import nan

import numpy as np

from subsoil.arrays import Floats, Indices
from subsoil.errors import ReadingsError
from subsoil.kriging.ordinary import OrdinaryKriging, condition
from subsoil.variogram import Variogram


def skill(squared_error: Floats, squared_error_of_mean: Floats) -> float:
    """1 - MSE / MSE of the mean: 1 is perfect, 0 no better than the mean, below 0 worse.

    NaN where the mean makes no error, that is where readings do not vary.
    """
    reference = float(np.mean(squared_error_of_mean))
    return 1.0 - float(np.mean(squared_error)) / reference if reference > 0 else nan


@dataclass(frozen=True)
class LeaveOneOut:
    """Readings predicted from others under the same variogram, without being among them.

    Attributes
    ----------
    residual
        (m, n) reading minus prediction, in units of z.
    variance
        (m, n) variance that the model gives the residual, noise of the reading included.
    mean_residual
        (m, n) reading minus the mean of the others: what kriging has to beat.
    """

    residual: Floats
    variance: Floats
    mean_residual: Floats

    @property
    def rmse(self) -> Floats:
        """(m,) root mean square residual of each layer."""
        mse: Floats = np.mean(self.residual**2, axis=1)
        return np.sqrt(mse)

    @property
    def skill(self) -> Floats:
        """(m,) skill of each layer against the mean of the others; see :func:`skill`."""
        pairs = zip(self.residual, self.mean_residual, strict=True)
        return np.array([skill(kriged**2, mean**2) for kriged, mean in pairs])

    @property
    def calibration(self) -> Floats:
        """(m,) mean squared standardised residual: 1 where variances are right."""
        standardised: Floats = np.mean(self.residual**2 / self.variance, axis=1)
        return standardised


def leave_one_out(ok: OrdinaryKriging) -> LeaveOneOut:
    """Leave-one-out residuals and variances in closed form (Dubrule 1983, Math. Geol. 15, 687).

    With K the covariance of the readings, noise included, and
    B = K^-1 - K^-1 1 1' K^-1 / (1' K^-1 1): residual = (B z)_i / B_ii, variance = 1 / B_ii. In
    differences D z to the first reading, as :mod:`subsoil.kriging.system` keeps them,
    B = D' W' W D. Readings at one place were averaged, and are left out together.

    Parameters
    ----------
    ok
        Readings conditioned on; its variograms are held.

    Raises
    ------
    ReadingsError
        With fewer than three readings.
    """
    n = len(ok.at)
    if n < 3:
        raise ReadingsError(f"leave-one-out needs three readings or more, not {n}")
    system = ok.system
    bz, diagonal = system.precision_times(system.y), system.precision_diagonal()
    diagonal = np.repeat(diagonal, len(bz) // len(diagonal), axis=0)
    residual, variance = bz / diagonal, 1.0 / diagonal
    mean_residual = (ok.z - ok.z.mean(axis=1, keepdims=True)) * n / (n - 1)
    return LeaveOneOut(residual, variance, mean_residual)


def block_out(variogram: Variogram, at: Floats, z: Floats, block_m: float) -> LeaveOneOut:
    """Predict the readings of each square block from those of all other blocks.

    Harder than leave-one-out, and closer to how well places without a reading nearby are mapped
    (Roberts et al. 2017, Ecography 40, 913). In closed form as :func:`leave_one_out`: with I the
    readings of a block and B_II their rows and columns of B, the residuals are B_II^-1 (B z)_I and
    their covariance is B_II^-1.

    Parameters
    ----------
    variogram
        Model of the readings; it is held.
    at
        (n, 2) places in m.
    z
        (n,) values.
    block_m
        Side of a block in m. Blocks begin at multiples of it.

    Returns
    -------
    LeaveOneOut
        Arrays are (1, n).

    Raises
    ------
    ReadingsError
        If all readings lie in one block.
    """
    block = _blocks(at, block_m)
    if not block.any():
        raise ReadingsError(
            f"all readings lie in one block of {block_m:g} m", remedy="use smaller blocks"
        )
    ok = condition(variogram, at, z)
    mean, variance = _from_other_blocks(ok, block_m)
    mended = ok.mended(variance[None])
    if mended is not ok:
        mean, variance = _from_other_blocks(mended, block_m)
    place = _found(at, ok.at)
    away, number = z - z.mean(), np.bincount(block)
    mean_residual = away + (np.bincount(block, away) / (len(z) - number))[block]
    return LeaveOneOut(
        (z - mean[place])[None], (variance[place] + variogram.nugget)[None], mean_residual[None]
    )


def _from_other_blocks(ok: OrdinaryKriging, block_m: float) -> tuple[Floats, Floats]:
    """(n,) means and variances at the places of readings of one layer, kriged from other blocks."""
    system = ok.system
    bz, residual, variance = system.precision_times(system.y)[0], *np.empty((2, len(ok.at)))
    block = _blocks(ok.at, block_m)
    members = np.split(np.argsort(block, kind="stable"), np.cumsum(np.bincount(block))[:-1])
    for out in members:
        covariance = np.linalg.inv(system.precision_among(out)[0])
        residual[out], variance[out] = covariance @ bz[out], np.diag(covariance)
    return ok.z[0] - residual, variance - system.readings.noise[0]


def _blocks(at: Floats, block_m: float) -> Indices:
    """(n,) number of the square block that each of (n, 2) places lies in."""
    return np.unique(np.floor(at / block_m), axis=0, return_inverse=True)[1].ravel()


def _found(at: Floats, among: Floats) -> Indices:
    """(n,) where each of (n, 2) places is among (k, 2) distinct ones that hold them all."""
    rank = np.unique(at, axis=0, return_inverse=True)[1].ravel()
    order: Indices = np.lexsort((among[:, 1], among[:, 0]))
    return order[rank]
