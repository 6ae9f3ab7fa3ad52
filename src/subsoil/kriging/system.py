"""The ordinary kriging system: factorised once, bordered by further readings.

The mean of the field is unknown, so only differences carry information. Taking the first
reading z1, of noise e1, as the reference, the differences to it have the covariance
(generalised; Chilès & Delfiner, *Geostatistics*, 2012, sec. 3.4.2; it solves eq. 1-3 of Pulido
Fentanes et al. 2018, whose variance line leaves the Lagrange term out)::

    b(p)    = c(0) + e1 - c(p, x1)
    G(p, q) = c(p, q) + b(p) + b(q) - (c(0) + e1)

and ordinary kriging is simple kriging with G. With L L' = G + noise over the other readings,
W = L^-1, y = W (z - z1) and v(t) = W G(., t)::

    mean(t)     = z1 + y . v(t)
    variance(t) = 2 b(t) - e1 - |v(t)|^2

G is positive definite for every model that is valid in the plane, bounded or not; a further
reading adds one row to W and v and one entry to y.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from subsoil.arrays import Bools, Floats, Indices
from subsoil.kriging.covariance import Covariance, lags, strips
from subsoil.kriging.growing_stack import GrowingStack
from subsoil.kriging.readings import Readings


@dataclass(frozen=True)
class System:
    """Readings conditioned on; made by :func:`factorised` and :meth:`grown`.

    Attributes
    ----------
    readings
        n of them.
    covariance
        g models.
    base
        (g, n) b at the readings.
    inverse
        (g, n-1, n-1) W.
    y
        (m, n-1) W (z - z1).
    """

    readings: Readings
    covariance: Covariance
    base: Floats
    inverse: GrowingStack
    y: Floats

    @cached_property
    def scale(self) -> Floats:
        """(g,) size of the variances at play: the largest sill or variance of a difference."""
        e1 = self.readings.noise[:, :1]
        sill = self.covariance.psill + self.covariance.nugget
        scale: Floats = np.maximum(sill, (2.0 * self.base - e1).max(axis=1))
        return scale

    @property
    def factor(self) -> Floats:
        """(g, n-1, n-1) W, read-only."""
        return self.inverse.array[:, :, : len(self.readings) - 1]

    def whitened(self, values: Floats) -> Floats:
        """(g, n-1, ...) W times values (n-1, ...) or (g, n-1, ...) in differences to the first."""
        columns = values[..., None] if values.ndim == 1 else values
        product: Floats = np.matmul(self.factor, columns)
        return product[..., 0] if values.ndim == 1 else product

    def precision_times(self, whitened: Floats) -> Floats:
        """(m, n) D' W' times whitened (m, n-1) values: B z, of all readings, of :attr:`y`."""
        groups = len(self.base)
        rows = whitened.reshape(groups, len(whitened) // groups, -1)
        product = np.matmul(rows, self.factor).reshape(len(whitened), -1)
        return np.concatenate([-product.sum(axis=1, keepdims=True), product], axis=1)

    def precision_diagonal(self) -> Floats:
        """(g, n) diagonal of B = D' W' W D: the inverse variances of readings given the others."""
        squares = np.einsum("gij,gij->gj", self.factor, self.factor)
        of_first = np.einsum("gi,gi->g", self.factor.sum(axis=2), self.factor.sum(axis=2))
        return np.concatenate([of_first[:, None], squares], axis=1)

    def precision_among(self, some: Indices) -> Floats:
        """(g, k, k) rows and columns of B of k of the readings."""
        columns = self.factor[:, :, some - 1]
        if not some.all():
            columns[:, :, some == 0] = -self.factor.sum(axis=2, keepdims=True)
        return np.asarray(columns.transpose(0, 2, 1) @ columns)

    def layers(self) -> list[slice]:
        """Layers that each of the g variograms is for."""
        m, g = len(self.readings.z), len(self.base)
        return [slice(k * m // g, (k + 1) * m // g) for k in range(g)]

    def of(self, group: int) -> System:
        """System of one of the variograms and its layers."""
        layers, one = self.layers()[group], slice(group, group + 1)
        r = self.readings
        return System(
            Readings(r.at, r.z[layers], r.noise[one], r.certain[one]),
            self.covariance.of(group),
            self.base[one],
            GrowingStack(self.inverse.array[one]),
            self.y[layers],
        )

    def border(self, lag: Floats, k: Floats, noise: Floats) -> Border:
        """How a reading extends the system.

        Parameters
        ----------
        lag, k
            (n,) distances in m and (g, n) covariances of its place with the readings.
        noise
            (g,) variance of its value around what is predicted.
        """
        n, e1 = len(self.readings), self.readings.noise[:, 0]
        base = self.covariance.origin + e1 - k[:, 0]
        column = k[:, 1:] + self.base[:, 1:]
        column -= k[:, :1]
        row = np.matmul(self.factor, column[:, :, None])[:, :, 0]
        alone = 2.0 * base - e1 + noise
        pivot = alone - np.einsum("gn,gn->g", row, row)
        sound = lag.all() and (pivot > _least_pivot(n) * alone).all() and self.readings.leads(noise)
        return Border(base, row, pivot, bool(sound))

    def grown(self, border: Border, at: Floats, z: Floats, noise: Floats) -> System:
        """Return the system with one more reading, O(n^2); its border must be sound."""
        d, n = np.sqrt(border.pivot), len(self.readings)
        inverse, last = self.inverse.grown(n)
        np.divide(
            np.matmul(border.row[:, None, :], self.factor)[:, 0], -d[:, None], out=last[:, : n - 1]
        )
        last[:, n - 1] = 1.0 / d
        last[:, n:] = 0.0
        y = (z - self.readings.z[:, 0] - (border.row * self.y).sum(axis=1)) / d
        return System(
            self.readings.appended(at, z, noise),
            self.covariance,
            np.concatenate([self.base, border.base[:, None]], axis=1),
            inverse,
            np.concatenate([self.y, y[:, None]], axis=1),
        )


@dataclass(frozen=True)
class Border:
    """The next row of L, W and y.

    Attributes
    ----------
    base
        (g,) b at the new reading.
    row
        (g, n-1) L left of its diagonal.
    pivot
        (g,) square of L's diagonal.
    sound
        Whether the system may grow by it. Not at a place already read, nor where the pivot is
        rounding, nor beside a far noisier first reading: these are factorised anew.
    """

    base: Floats
    row: Floats
    pivot: Floats
    sound: bool


def factorised(readings: Readings, covariance: Covariance) -> tuple[System, Bools]:
    """Solve a system from its readings, O(n^3).

    Returns
    -------
    tuple
        The system, and which of the (g,) models are not positive definite for these readings;
        the system is NaN in those.
    """
    at, n, e1 = readings.at, len(readings), readings.noise[:, :1]
    top = covariance.origin[:, None] + e1
    base = top - covariance(lags(at[:1], at))[:, 0]
    inverse = np.empty((len(base), n - 1, n - 1))
    for strip in strips(n - 1, base.size):
        g = covariance(lags(at[1:][strip], at[1:]))
        g += (base - top)[:, 1:, None][:, strip]
        g += base[:, None, 1:]
        inverse[:, strip] = g
    diagonal = np.arange(n - 1)
    inverse[:, diagonal, diagonal] += readings.noise[:, 1:]
    for matrix in inverse:
        _invert_factor(matrix)
    y = np.matmul(inverse, (readings.z[:, 1:] - readings.z[:, :1])[:, :, None])[:, :, 0]
    failed = np.asarray(np.isnan(inverse).any(axis=(1, 2)))
    return System(readings, covariance, base, GrowingStack(inverse), y), failed


def _invert_factor(matrix: Floats) -> None:
    """Put the inverse of its Cholesky factor in the place of a matrix; NaN where there is none."""
    from scipy.linalg.lapack import dpotrf, dtrtri  # costs half of `import subsoil`

    n = len(matrix)
    if not n:
        return
    variance = np.diag(matrix).copy()
    # Upper by columns is lower by rows: transposed, nothing has to be copied.
    factor, info = dpotrf(matrix.T, lower=0, clean=1, overwrite_a=1)
    if info or np.any(np.diag(factor) ** 2 <= _least_pivot(n) * variance):
        matrix[:] = np.nan
    else:
        matrix[:] = dtrtri(factor, lower=0, overwrite_c=1)[0].T


def _least_pivot(n: int) -> float:
    return 8.0 * n * float(np.finfo(float).eps)
