"""How layers go together: their correlation, and how many independent ones they are worth."""

from __future__ import annotations

import numpy as np

from subsoil.arrays import Floats

_SHRINKING = 0.9
"""Weight of the correlation of samples against none."""
_FEWEST_PAIRS = 3
"""Samples of two layers that tell a correlation."""
_FEWEST_WHOLE = 4
"""Samples of all layers that tell how many independent layers there are."""
_UNKNOWN_LAYERS = 2.0
"""Independent layers assumed while samples are too few to tell."""
_ROUNDING = 1e-12
"""Share of the squares of a layer below which their spread is rounding."""


def layer_correlation(z: Floats) -> Floats:
    """(m, m) correlation of layers, shrunk towards none by a tenth.

    Two layers correlate by the samples that reached both. Two that fewer than three reached, or of
    which one does not vary, count as one and the same.

    Parameters
    ----------
    z
        (m, n) values, NaN where a layer was not measured.

    Examples
    --------
    >>> layer_correlation(np.array([[1.0, 5.0, 2.0, 8.0], [2.0, 10.0, 4.0, 16.0]]))
    array([[1. , 0.9],
           [0.9, 1. ]])
    """
    known = np.isfinite(z)
    counts = np.maximum(known.sum(axis=1, keepdims=True), 1)
    away = np.where(known, z, 0.0)
    away = np.where(known, z - away.sum(axis=1, keepdims=True) / counts, 0.0)
    both = known.astype(float)
    pairs = both @ both.T
    sums, squares = away @ both.T, away**2 @ both.T
    of_pairs = np.maximum(pairs, 1.0)
    product = away @ away.T - sums * sums.T / of_pairs
    spread = squares - sums**2 / of_pairs
    varies = spread > _ROUNDING * squares
    tells = (pairs >= _FEWEST_PAIRS) & varies & varies.T
    size = np.sqrt(spread * spread.T, out=np.ones_like(spread), where=tells)
    correlation = np.where(tells, product / size, 1.0)
    shrunk: Floats = _SHRINKING * correlation
    np.fill_diagonal(shrunk, 1.0)
    return shrunk


def independent_layers(z: Floats) -> float:
    """Effective number of independent layers among (m, n) values, NaN where not measured.

    (sum of eigenvalues)^2 / sum of their squares, of the layers' correlation (participation ratio;
    Bretherton et al. 1999, J. Climate 12, 1990): m^2 over the sum of squared correlations.

    Examples
    --------
    >>> round(independent_layers(np.array([[1.0, 5.0, 2.0, 8.0], [2.0, 10.0, 4.0, 16.0]])), 3)
    1.105
    """
    if np.isfinite(z).all(axis=0).sum() < _FEWEST_WHOLE:
        return min(_UNKNOWN_LAYERS, float(len(z)))
    return float(len(z) ** 2 / (layer_correlation(z) ** 2).sum())
