"""How good a map is: errors, skill against the mean, and leave-one-out."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from subsoil.errors import ReadingsError
from subsoil.kriging import OrdinaryKriging, condition
from subsoil.variogram import Variogram

Floats = NDArray[np.float64]


def rmse(estimate: ArrayLike, truth: ArrayLike) -> float:
    """Root mean square difference, over layers and cells alike (the paper's eq. 6, rooted)."""
    difference = np.asarray(estimate, dtype=float) - np.asarray(truth, dtype=float)
    return float(np.sqrt(np.mean(difference**2)))


def skill(squared_error: Floats, squared_error_of_mean: Floats) -> float:
    """1 - MSE / MSE of the mean: 1 is perfect, 0 no better than the mean, below 0 worse."""
    return float(1.0 - np.mean(squared_error) / np.mean(squared_error_of_mean))


@dataclass(frozen=True)
class LeaveOneOut:
    """Each reading predicted from all others under the same variogram.

    Attributes
    ----------
    residual
        (m, n) reading minus prediction, in units of z.
    variance
        (m, n) variance the model gives that residual.
    mean_residual
        (m, n) reading minus the mean of all others: what kriging has to beat.
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
        """(m,) skill of each layer against the mean of the other readings."""
        pairs = zip(self.residual, self.mean_residual, strict=True)
        return np.array([skill(r**2, r0**2) for r, r0 in pairs])

    @property
    def calibration(self) -> Floats:
        """(m,) mean squared standardised residual: 1 where variances are right."""
        standardised: Floats = np.mean(self.residual**2 / self.variance, axis=1)
        return standardised


def leave_one_out(ok: OrdinaryKriging) -> LeaveOneOut:
    """Leave-one-out residuals and variances in closed form (Dubrule 1983, Math. Geol. 15, 687).

    With B = K^-1 - K^-1 1 1' K^-1 / (1' K^-1 1): residual = (B z)_i / B_ii, variance = 1 / B_ii.

    Raises
    ------
    ReadingsError
        With fewer than three readings.
    """
    n = len(ok.at)
    if n < 3:
        raise ReadingsError(f"leave-one-out needs three readings or more, not {n}")
    inverse = ok.inverse.array[:, :, :n]
    precision = np.matmul(inverse.transpose(0, 2, 1), inverse)
    ones = precision.sum(axis=2)
    b = precision - ones[:, :, None] * ones[:, None, :] / ones.sum(axis=1)[:, None, None]
    diagonal = np.einsum("gii->gi", b)
    bz = np.matmul(b, ok.z[:, :, None])[:, :, 0]
    residual = bz / diagonal
    return LeaveOneOut(
        residual,
        np.broadcast_to(1.0 / diagonal, residual.shape),
        (ok.z - ok.z.mean(axis=1, keepdims=True)) * n / (n - 1),
    )


def block_out(variogram: Variogram, at: Floats, z: Floats, block_m: float) -> LeaveOneOut:
    """Predict the readings of each square block from those of all others.

    Harder than leave-one-out, and closer to how well places without a reading nearby are mapped
    (Roberts et al. 2017, Ecography 40, 913).

    Parameters
    ----------
    variogram
        Model of the readings.
    at
        (n, 2) places in m.
    z
        (n,) values.
    block_m
        Side of a block in m.

    Raises
    ------
    ReadingsError
        If all readings lie in one block.
    """
    corner = np.floor(at / block_m).astype(np.int64)
    _, block = np.unique(corner, axis=0, return_inverse=True)
    block = block.ravel()
    if block.max() == 0:
        raise ReadingsError(
            f"all readings lie in one block of {block_m:g} m", remedy="use smaller blocks"
        )
    mean, variance, others = np.empty((3, 1, len(z)))
    for k in range(block.max() + 1):
        out = block == k
        ok = condition(variogram, at[~out], z[~out])
        mean[0, out], variance[0, out] = ok.predict(at[out])
        others[0, out] = z[~out].mean()
    return LeaveOneOut(z - mean, variance + variogram.nugget, z - others)
