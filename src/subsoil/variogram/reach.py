"""Layers by the samples that reached them: those alike are estimated and kriged together."""

from __future__ import annotations

import numpy as np

from subsoil.arrays import Bools, Floats, Integers


def by_reach(z: Floats) -> list[tuple[Bools, Integers]]:
    """Layers that the same samples reached, after the (n,) samples that did.

    Parameters
    ----------
    z
        (m, n) values, NaN where a layer was not measured; layers without any are left out.

    Examples
    --------
    >>> z = np.array([[1.0, 2.0], [3.0, 4.0], [np.nan, 5.0]])
    >>> [(reached.tolist(), layers.tolist()) for reached, layers in by_reach(z)]
    [([True, True], [0, 1]), ([False, True], [2])]
    """
    groups: dict[bytes, list[int]] = {}
    reached = np.isfinite(z)
    for layer in np.flatnonzero(reached.any(axis=1)).tolist():
        groups.setdefault(reached[layer].tobytes(), []).append(layer)
    return [(reached[layers[0]], np.array(layers)) for layers in groups.values()]
