"""Covariances of the spatially correlated part of one or several variograms at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from subsoil.variogram.models import Bounded, Variogram

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Covariance:
    """Signal covariance A - rise(h) of g variograms, stacked.

    For a bounded model A is the partial sill. An unbounded model has no covariance; any A large
    enough gives the same kriging (Chilès & Delfiner 2012, sec. 3.4.2), and A is taken from the
    extent of the data.

    Attributes
    ----------
    variograms
        g models.
    extent
        Distance in m over which unbounded models are to hold.
    """

    variograms: tuple[Variogram, ...]
    extent: float

    @cached_property
    def plateau(self) -> Floats:
        """(g,) covariance at distance 0 without the nugget."""
        return np.array(
            [
                v.sill - v.nugget if np.isfinite(v.sill) else 4.0 * float(v.rise(_lag(self.extent)))
                for v in self.variograms
            ]
        )

    @cached_property
    def nugget(self) -> Floats:
        """(g,) nuggets."""
        return np.array([v.nugget for v in self.variograms])

    @cached_property
    def bounded(self) -> bool:
        """Whether every model has a sill."""
        return all(np.isfinite(v.sill) for v in self.variograms)

    def __call__(self, lag: Floats) -> Floats:
        """(g, ...) covariances at lags in m of any shape."""
        first = self.variograms[0]
        if isinstance(first, Bounded) and all(type(v) is type(first) for v in self.variograms):
            one_each = (-1,) + (1,) * lag.ndim
            correlation: Floats = first.correlation(lag * self._inverse_range.reshape(one_each))
            return correlation * self.plateau.reshape(one_each)
        return np.stack(
            [a - v.rise(lag) for a, v in zip(self.plateau, self.variograms, strict=True)]
        )

    @cached_property
    def _inverse_range(self) -> Floats:
        return np.array([1.0 / v.range for v in self.variograms if isinstance(v, Bounded)])


def covariance_of(variograms: Sequence[Variogram], at: Floats) -> Covariance:
    """Covariance of variograms over the extent of (n, 2) places in m."""
    extent = float(np.hypot(*np.ptp(at, axis=0))) if len(at) > 1 else 0.0
    return Covariance(tuple(variograms), extent or 1.0)


def lags(a: Floats, b: Floats) -> Floats:
    """(len(a), len(b)) distances in m between two sets of places."""
    difference = a[:, None, :] - b[None, :, :]
    return np.sqrt(np.einsum("ijk,ijk->ij", difference, difference))


def _lag(metres: float) -> Floats:
    return np.asarray(metres, dtype=float)
