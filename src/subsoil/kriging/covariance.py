"""Covariances of one or several variograms at once."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from math import inf

import numpy as np

from subsoil.arrays import Floats
from subsoil.variogram.models import Bounded, Variogram
from subsoil.variogram.nested import Nested

AT_A_TIME = 1 << 22
"""Covariances held at a time beyond what is kept of them."""


@dataclass(frozen=True)
class Covariance:
    """Covariance of what is predicted, under g variograms stacked.

    A bounded model falls from its partial sill. An unbounded one has no covariance; kriging only
    ever sees differences of covariances, for which ``-rise(h)`` serves as well (Chilès & Delfiner,
    *Geostatistics*, 2012, sec. 3.4.2).

    Attributes
    ----------
    variograms
        g models.
    exact
        Whether the nugget belongs to what is predicted, or is noise around it.
    """

    variograms: tuple[Variogram, ...]
    exact: bool

    @cached_property
    def psill(self) -> Floats:
        """(g,) partial sills; 0 for an unbounded model."""
        return np.array(
            [v.sill - v.nugget if np.isfinite(v.sill) else 0.0 for v in self.variograms]
        )

    @cached_property
    def nugget(self) -> Floats:
        """(g,) nuggets."""
        return np.array([v.nugget for v in self.variograms])

    @cached_property
    def jump(self) -> Floats:
        """(g,) nuggets that are predicted: by how much the covariance is higher at lag 0."""
        return self.nugget if self.exact else np.zeros_like(self.nugget)

    @cached_property
    def noise(self) -> Floats:
        """(g,) nuggets that are noise: the variance of a reading around what is predicted."""
        return np.zeros_like(self.nugget) if self.exact else self.nugget

    @cached_property
    def origin(self) -> Floats:
        """(g,) covariances at lag 0."""
        return self.psill + self.jump

    def __call__(self, lag: Floats) -> Floats:
        """(g, ...) covariances at lags in m of any shape."""
        c = self.smooth(lag)
        if self.exact and not lag.all():
            c[:, lag == 0.0] += self.jump[:, None]
        return c

    def smooth(self, lag: Floats) -> Floats:
        """(g, ...) covariances at lags in m, without the jump at lag 0."""
        first = self.variograms[0]
        if isinstance(first, Bounded) and self._alike:
            one_each = (-1,) + (1,) * lag.ndim
            c: Floats = first.correlation(lag * self._inverse_range.reshape(one_each))
            c *= self.psill.reshape(one_each)
            return c
        c = np.empty((len(self.variograms), *lag.shape))
        for each, psill, v in zip(c, self.psill, self.variograms, strict=True):
            np.subtract(psill, v.rise(lag), out=each)
        return c

    def shape(self, extent: float) -> Shape:
        """Return the covariance of the only variogram, without the jump, in units of its own.

        That of an unbounded model is 1 in size at an extent in m.
        """
        (v,) = self.variograms
        if isinstance(v, Bounded):
            return Shape(v.range, v.psill, v.correlation, v.breaks)
        if isinstance(v, Nested) and v.structures:
            shortest = min(structure.range for structure in v.structures)
            return Shape(shortest, v.sill, lambda lag: v.correlation(shortest * lag), ())
        height = float(v.rise(np.array(extent))) or 1.0
        return Shape(extent, height, lambda lag: -v.rise(extent * lag) / height, ())

    def of(self, group: int) -> Covariance:
        """Covariance of one of the variograms."""
        return Covariance((self.variograms[group],), self.exact)

    @cached_property
    def _alike(self) -> bool:
        return len({type(v) for v in self.variograms}) == 1

    @cached_property
    def _inverse_range(self) -> Floats:
        return np.array([1.0 / v.range for v in self.variograms if isinstance(v, Bounded)])


@dataclass(frozen=True)
class Shape:
    """A covariance ``height * at(lag / length)``, smooth but at 0 and at some breaks.

    Attributes
    ----------
    length
        Unit of distance in m.
    height
        Unit of covariance in squared units of z.
    at
        Covariance by distance, in these units.
    breaks
        Distances beyond 0, in these units, at which it is not smooth; it is 0 from the last on.
    """

    length: float
    height: float
    at: Callable[[Floats], Floats]
    breaks: tuple[float, ...]

    @property
    def end(self) -> float:
        """Distance from which on the covariance is zero."""
        return max(self.breaks, default=inf)


def strips(rows: int, columns: int) -> Iterator[slice]:
    """Rows of a matrix of covariances, as many as are worked out at a time; one strip at least."""
    step = max(1, AT_A_TIME // max(1, columns))
    return (slice(k, min(k + step, rows)) for k in range(0, max(1, rows), step))


def lags(a: Floats, b: Floats) -> Floats:
    """(len(a), len(b)) distances in m between (n, 2) and (N, 2) places."""
    east = a[:, 0, None] - b[:, 0]
    north = a[:, 1, None] - b[:, 1]
    east *= east
    north *= north
    east += north
    return np.sqrt(east, out=east)
