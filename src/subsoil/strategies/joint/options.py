"""Cells that could join a design, and how one of them is chosen."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from subsoil.arrays import Floats, Integers


@dataclass(frozen=True)
class Options:
    """Cells that could join a design, and what each would bring.

    Attributes
    ----------
    cells
        (q,) their indices.
    gain
        (q,) fall of the mean variance.
    own
        (q,) variance of a reading there.
    weights
        (n + 1, q) A^-1 [c; 1]: kriging weights of the design's readings, and the multiplier.
    detour
        (q,) metres by which the way grows, put in at its best gap.
    gap
        (q,) that gap.
    """

    cells: Integers
    gain: Floats
    own: Floats
    weights: Floats
    detour: Floats
    gap: Integers


def drawn(objective: Floats, temperature: float, rng: np.random.Generator) -> int:
    """Index drawn with the Boltzmann weights of objectives; of the lowest at no temperature."""
    if temperature == 0.0:
        return int(np.argmin(objective))
    likely = np.cumsum(np.exp((objective.min() - objective) / temperature))
    return int(np.searchsorted(likely, rng.random() * likely[-1]))
