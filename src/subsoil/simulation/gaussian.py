"""Gaussian fields at places, by a factor of their covariance."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy

from subsoil.arrays import Floats
from subsoil.errors import SingularSystemError


def covariance_factor(
    at: Floats, covariance: Callable[[Floats], Floats], *, what: str, where: str
) -> Floats:
    """(n, n) lower Cholesky factor of a covariance between (n, 2) places in m.

    Times (n,) independent standard normal values it makes a Gaussian field (Cressie, *Statistics
    for Spatial Data*, 1993, sec. 3.6.1).

    Parameters
    ----------
    at
        Places.
    covariance
        Covariance by distance in m.
    what, where
        What is simulated, and where it is asked for, to name in an error.

    Raises
    ------
    SingularSystemError
        If it is not positive definite.
    """
    matrix = scipy.spatial.distance.squareform(covariance(scipy.spatial.distance.pdist(at)))
    np.fill_diagonal(matrix, covariance(np.zeros(1))[0])
    try:
        factor: Floats = scipy.linalg.cholesky(
            matrix, lower=True, overwrite_a=True, check_finite=False
        )
    except np.linalg.LinAlgError as error:
        raise SingularSystemError(
            f"{what} at {len(at)} places is not positive definite",
            where=where,
            remedy="use the spherical model, or larger cells",
        ) from error
    return factor
