"""Restricted likelihood of correlations, with mean and sill of every layer profiled out.

With R the correlation of n readings z of a layer, W' W = R^-1 and q = 1' R^-1 1::

    SS   = z' R^-1 z - (1' R^-1 z)^2 / q
    logL = -1/2 [(n - 1) log SS + log |R| + log q]

up to a constant, and the sill that goes with it is SS / (n - 1) (Patterson & Thompson 1971,
Biometrika 58, 545; Diggle & Ribeiro, *Model-based Geostatistics*, 2007, sec. 5.4).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from subsoil.arrays import Floats, Integers

LARGEST_BLOCK = 100
"""Readings up to which their likelihood is taken whole."""
_ABOVE_ALL = 1e9
"""Stands below the readings in the bordered matrix, to keep it positive definite."""


@dataclass(frozen=True)
class Likelihood:
    """Restricted likelihood of k correlations for m layers.

    Attributes
    ----------
    log
        (k, m) log likelihoods, up to a constant of each layer.
    squares
        (k, m) SS, in squared units of the data.
    """

    log: Floats
    squares: Floats


def restricted(correlation: Floats, z: Floats) -> Likelihood:
    """Restricted likelihood of k correlations of n readings.

    One batched Cholesky factorisation of the correlations bordered by the readings and ones gives
    all of it: below the factor of R stand W z and W 1.

    Parameters
    ----------
    correlation
        (k, n, n) positive definite matrices with ones on their diagonals.
    z
        (m, n) readings of layers, in which some differ.

    Raises
    ------
    numpy.linalg.LinAlgError
        If a correlation is not positive definite.
    """
    (m, n), k = z.shape, len(correlation)
    centred = z - z.mean(axis=1, keepdims=True)
    spread = np.sqrt((centred**2).mean(axis=1, keepdims=True))
    bordered = np.zeros((k, n + m + 1, n + m + 1))
    bordered[:, :n, :n] = correlation
    bordered[:, n:-1, :n] = centred / spread
    bordered[:, -1, :n] = 1.0
    border = np.arange(n, n + m + 1)
    bordered[:, border, border] = _ABOVE_ALL
    factor = np.linalg.cholesky(bordered)
    half_log_det = np.log(np.einsum("kii->ki", factor[:, :n, :n])).sum(axis=1)
    wz, w1 = factor[:, n:-1, :n], factor[:, -1, :n]
    q = np.einsum("kn,kn->k", w1, w1)
    drift = np.einsum("kmn,kn->km", wz, w1)
    squares = np.einsum("kmn,kmn->km", wz, wz) - drift**2 / q[:, None]
    log = -0.5 * ((n - 1) * np.log(squares) + np.log(q)[:, None]) - half_log_det[:, None]
    return Likelihood(log, squares * (spread[:, 0] ** 2))


def blocks(at: Floats) -> list[Integers]:
    """Split (n, 2) places into compact blocks of at most a hundred, halving along the long side.

    The product of the blocks' likelihoods stands for that of all readings where those are many
    (independent blocks; Stein, Chi & Welty 2004, J. R. Stat. Soc. B 66, 275).

    Examples
    --------
    >>> [len(block) for block in blocks(np.random.default_rng(1).uniform(size=(250, 2)))]
    [62, 63, 62, 63]
    """
    return _halved(at, np.arange(len(at)))


def _halved(at: Floats, members: Integers) -> list[Integers]:
    if len(members) <= LARGEST_BLOCK:
        return [members]
    along = int(np.argmax(np.ptp(at[members], axis=0)))
    order = members[np.argsort(at[members, along], kind="stable")]
    middle = len(order) // 2
    return _halved(at, order[:middle]) + _halved(at, order[middle:])


def lags_of(at: Floats) -> Floats:
    """(n, n) distances in m between (n, 2) places."""
    return np.asarray(scipy.spatial.distance.cdist(at, at))
