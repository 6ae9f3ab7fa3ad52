"""Where one may stop on a field, and how one gets from here to there."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from subsoil.arrays import Bools, Floats

FARTHEST_M = 1e9
"""What a search takes for the length of a way that does not exist: more than any there is."""


class Access(Protocol):
    """Which of a field's N cells may be stopped at, where in them, and the ways between places.

    A value: equal accesses give equal answers, and what is found once is kept with it.

    A way need not be as long back as forth, and where none leads from one place to another its
    length is infinite. Searches (:mod:`subsoil.ways.routing`, the strategies) accept both.
    """

    @property
    def stops(self) -> Bools:
        """(N,) cells that may be stopped at."""

    @property
    def at(self) -> Floats:
        """(N, 2) place in m at which one stops in each cell."""

    @property
    def is_symmetric(self) -> bool:
        """Whether every way is as long back as forth."""

    def between(self, a: ArrayLike, b: ArrayLike) -> Floats:
        """Lengths (k, l) in m of the shortest ways from (k, 2) to (l, 2) places in m.

        Never shorter than the straight line, zero from a place to itself, and infinite where there
        is no way.
        """

    def way(self, a: ArrayLike, b: ArrayLike) -> Floats:
        """(p, 2) places in m along the shortest way from one to another: ends and bends.

        Raises
        ------
        ParameterError
            If there is no way.
        """


def finite(distance: Floats) -> Floats:
    """Distances in m to search with: where there is no way, farther than any way."""
    return np.minimum(distance, FARTHEST_M)
