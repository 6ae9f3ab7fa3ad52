"""Variogram models: semivariance as a function of the distance between two places.

A model has a *nugget* (the jump at distance 0), a *partial sill* (the rise above the nugget) and
a *range*. ``range`` is always the practical range: the distance at which a bounded model has made
95 % of its rise, or all of it where it gets there. PyKrige's exponential uses the same
convention; GSTools' and gstat's length is a third of it, gstlearn's is range / ln 20. For the
gaussian, ``exp(-3 h^2 / range^2)``; PyKrige writes ``exp(-(7 h / 4 range)^2)``.

Not every model is valid in the plane: ``valid_dims`` says up to how many dimensions kriging
variances cannot turn negative (Chilès & Delfiner, *Geostatistics*, 2012, sec. 2.5).
"""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from math import inf, pi
from typing import ClassVar, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

from subsoil.arrays import Floats
from subsoil.errors import ParameterError, brief


@runtime_checkable
class Variogram(Protocol):
    """What kriging asks of a model."""

    @property
    def nugget(self) -> float:
        """Semivariance just off distance 0, in squared units of the data."""

    @property
    def valid_dims(self) -> int:
        """Highest number of dimensions in which the model is valid."""

    @property
    def sill(self) -> float:
        """Semivariance at a great distance; infinite for an unbounded model."""

    def rise(self, lag: Floats) -> Floats:
        """Semivariance above the nugget at lags in m; zero and continuous at 0."""


def semivariance(model: Variogram, lag: ArrayLike) -> Floats:
    """Semivariance of a model at lags in m: 0 at lag 0, nugget + rise beyond.

    Examples
    --------
    >>> semivariance(Spherical(nugget=1.0, range=10.0, psill=2.0), [0.0, 1e-9, 10.0, 50.0])
    array([0., 1., 3., 3.])
    """
    lag = np.asarray(lag, dtype=float)
    return np.where(lag > 0, model.nugget, 0.0) + model.rise(lag)


def _require(ok: bool, name: str, value: float, need: str) -> None:
    if not ok or not np.isfinite(value):
        raise ParameterError(f"{name} must be {need}, not {value:g}", where=f"variogram {name}")


@dataclass(frozen=True)
class Bounded:
    """A model with a sill: its shape is a correlation that falls from 1 to 0.

    Parameters
    ----------
    nugget
        Jump at distance 0, in squared units of the data (the paper's p0).
    range
        Practical range in m (the paper's p1).
    psill
        Rise above the nugget (the paper's p2, which it calls the sill).

    Raises
    ------
    ParameterError
        If nugget or partial sill is negative, or the range is not positive.
    """

    nugget: float
    range: float
    psill: float

    valid_dims: ClassVar[int] = 3
    breaks: ClassVar[tuple[float, ...]] = ()
    """Distances beyond 0, in ranges, at which the correlation is not smooth."""

    def __post_init__(self) -> None:
        _require(self.nugget >= 0, "nugget", self.nugget, "zero or more")
        _require(self.range > 0, "range", self.range, "greater than zero (metres)")
        _require(self.psill >= 0, "psill", self.psill, "zero or more")

    @staticmethod
    @abstractmethod
    def correlation(distance: Floats) -> Floats:
        """Correlation at a distance given in ranges."""

    @property
    def sill(self) -> float:
        """Nugget plus partial sill."""
        return self.nugget + self.psill

    def rise(self, lag: Floats) -> Floats:
        """Semivariance above the nugget at lags in m."""
        rho: Floats = self.correlation(lag / self.range)
        return self.psill * (1.0 - rho)


class BoundedLinear(Bounded):
    """The paper's model (eq. 5): a straight rise up to the range, then flat.

    Valid on a line only. In the plane 25-50 % of small-nugget systems are not conditionally
    positive; kriging then uses :meth:`circular` and says so.
    """

    valid_dims = 1
    breaks = (1.0,)

    @staticmethod
    def correlation(distance: Floats) -> Floats:
        """1 - h up to the range, 0 beyond."""
        return np.maximum(1.0 - distance, 0.0)

    def circular(self) -> Circular:
        """Return the circular model of the same nugget, partial sill and slope at the origin."""
        return Circular(self.nugget, 4.0 / pi * self.range, self.psill)


class Circular(Bounded):
    """Overlap of two discs; the plane's counterpart of the bounded linear model."""

    valid_dims = 2
    breaks = (1.0,)

    @staticmethod
    def correlation(distance: Floats) -> Floats:
        """2/pi (arccos h - h sqrt(1 - h^2)) up to the range, 0 beyond."""
        h: Floats = np.minimum(distance, 1.0)
        return 2.0 / pi * (np.arccos(h) - h * np.sqrt(1.0 - h * h))


class Spherical(Bounded):
    """Overlap of two balls; the workhorse of soil science."""

    breaks = (1.0,)

    @staticmethod
    def correlation(distance: Floats) -> Floats:
        """1 - 1.5 h + 0.5 h^3 up to the range, 0 beyond."""
        h = np.minimum(distance, 1.0)
        return 1.0 + h * (0.5 * h * h - 1.5)


class Exponential(Bounded):
    """Rough, Markov-like fields (Matern 1/2)."""

    @staticmethod
    def correlation(distance: Floats) -> Floats:
        """exp(-3 h)."""
        return np.exp(-3.0 * distance)


class Gaussian(Bounded):
    """Very smooth fields; needs a nugget to be solved in floating point."""

    @staticmethod
    def correlation(distance: Floats) -> Floats:
        """exp(-3 h^2)."""
        return np.exp(-3.0 * distance * distance)


_MATERN32_AT_95 = 4.743864518390585
_MATERN52_AT_95 = 5.918361182842417


class Matern32(Bounded):
    """Matern with smoothness 3/2: fields with a slope everywhere."""

    @staticmethod
    def correlation(distance: Floats) -> Floats:
        """(1 + u) exp(-u), scaled to fall to 5 % at the range."""
        u = _MATERN32_AT_95 * distance
        return (1.0 + u) * np.exp(-u)


class Matern52(Bounded):
    """Matern with smoothness 5/2: fields with a curvature everywhere."""

    @staticmethod
    def correlation(distance: Floats) -> Floats:
        """(1 + u + u^2 / 3) exp(-u), scaled to fall to 5 % at the range."""
        u = _MATERN52_AT_95 * distance
        return (1.0 + u * (1.0 + u / 3.0)) * np.exp(-u)


@dataclass(frozen=True)
class PureNugget:
    """No spatial correlation at all: every map is the mean.

    Parameters
    ----------
    nugget
        Semivariance at every distance beyond 0.
    """

    nugget: float
    valid_dims: ClassVar[int] = 3

    def __post_init__(self) -> None:
        _require(self.nugget >= 0, "nugget", self.nugget, "zero or more")

    @property
    def sill(self) -> float:
        """The nugget."""
        return self.nugget

    def rise(self, lag: Floats) -> Floats:
        """Zero at every lag."""
        return np.zeros_like(lag)


@dataclass(frozen=True)
class Power:
    """Unbounded model ``nugget + scale * h ** exponent``; exponent 1 is PyKrige's ``linear``.

    Parameters
    ----------
    nugget
        Jump at distance 0.
    scale
        Rise at a distance of 1 m.
    exponent
        Between 0 and 2, both excluded.

    Raises
    ------
    ParameterError
        If nugget or scale is negative or the exponent is not between 0 and 2.
    """

    nugget: float
    scale: float
    exponent: float = 1.0

    valid_dims: ClassVar[int] = 3
    sill: ClassVar[float] = inf

    def __post_init__(self) -> None:
        _require(self.nugget >= 0, "nugget", self.nugget, "zero or more")
        _require(self.scale >= 0, "scale", self.scale, "zero or more")
        _require(0 < self.exponent < 2, "exponent", self.exponent, "between 0 and 2")

    def rise(self, lag: Floats) -> Floats:
        """Semivariance above the nugget at lags in m."""
        return self.scale * (lag if self.exponent == 1.0 else lag**self.exponent)


MODELS: dict[str, type[Bounded]] = {
    "linear": BoundedLinear,
    "spherical": Spherical,
    "exponential": Exponential,
    "gaussian": Gaussian,
    "matern-3/2": Matern32,
    "matern-5/2": Matern52,
    "circular": Circular,
}
"""Bounded models by the name the command line and the journal use."""


def model_named(name: str) -> type[Bounded]:
    """Bounded model of a name.

    Raises
    ------
    ParameterError
        If there is none of that name.
    """
    if name not in MODELS:
        raise ParameterError(
            f"there is no variogram model {brief(name)!r}",
            where="variogram model",
            remedy=f"one of {', '.join(MODELS)}",
        )
    return MODELS[name]


def name_of_kind(kind: type[Bounded]) -> str:
    """Name of a kind of bounded model, as :func:`model_named` takes it."""
    return next(name for name, known in MODELS.items() if known is kind)
