"""How far a map is from the truth, where that is known."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike


def rmse(estimate: ArrayLike, truth: ArrayLike) -> float:
    """Root mean square difference, over layers and cells alike (the paper's eq. 6, rooted).

    NaN if the estimate has a layer or cell without a value.

    Examples
    --------
    >>> rmse([[1.0, 2.0], [3.0, 4.0]], [[1.0, 2.0], [3.0, 8.0]])
    2.0
    """
    difference = np.asarray(estimate, dtype=float) - np.asarray(truth, dtype=float)
    return float(np.sqrt(np.mean(difference**2)))
