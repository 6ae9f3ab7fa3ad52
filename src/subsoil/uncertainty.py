"""What a kriging variance says in the unit of the readings."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]


def standard_deviation(variance: ArrayLike) -> Floats:
    """Standard deviation of a kriging variance, in any shape; kPa of kPa2.

    A variance that rounding left a hair below zero has no root and is not made into zero: its
    standard deviation is NaN, as is that of NaN.

    Examples
    --------
    >>> standard_deviation([10_000.0, 0.0, -1e-12])
    array([100.,   0.,  nan])
    """
    values = np.asarray(variance, dtype=float)
    root = np.full(values.shape, np.nan)
    np.sqrt(values, out=root, where=values >= 0.0)
    return root
