"""Nested models: the sum of several bounded ones, as a mixture of correlations is."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from math import inf
from typing import ClassVar

import numpy as np

from subsoil.arrays import Floats
from subsoil.errors import ParameterError
from subsoil.variogram.models import Bounded, name_of_kind

_AT_THE_RANGE = 0.05
"""Correlation at the practical range."""
_HALVINGS = 50
_MOST_LEFT_OUT = 0.05
"""Share of the whole that traces left out come to, at most."""
_CACHED = 1 << 14
"""Lags worked on at a time: what stays in the cache of a processor core."""


@dataclass(frozen=True)
class Structure:
    """One term of a nested model.

    Parameters
    ----------
    share
        Its part of the sill.
    kind
        Its model.
    range
        Its practical range in m.
    """

    share: float
    kind: type[Bounded]
    range: float


@dataclass(frozen=True)
class Nested:
    """A sill, and the structures that make it up; what they leave of it is nugget.

    A sum of valid models is valid (Chilès & Delfiner, *Geostatistics*, 2012, sec. 2.5.1). Models of
    one shape and several sills, as those of a survey's layers, are kriged with one system.

    Parameters
    ----------
    sill
        Semivariance at a great distance, in squared units of the data.
    structures
        Terms, whose shares come to one at most.

    Raises
    ------
    ParameterError
        If the sill or a share is negative, a range not positive, or the shares exceed one.

    Examples
    --------
    >>> from subsoil.variogram.models import Exponential, Spherical
    >>> model = Nested(50.0, (Structure(0.5, Spherical, 20.0), Structure(0.3, Exponential, 90.0)))
    >>> round(model.nugget, 9), model.rise(np.array([0.0, 1e6])), round(model.range)
    (10.0, array([ 0., 40.]), 60)
    """

    sill: float
    structures: tuple[Structure, ...]

    valid_dims: ClassVar[int] = 3

    def __post_init__(self) -> None:
        if not 0 <= self.sill < inf:
            raise ParameterError(
                f"must be zero or more, not {self.sill:g}", where="nested variogram, sill"
            )
        for structure in self.structures:
            if not (structure.share >= 0 and 0 < structure.range < inf):
                raise ParameterError(
                    f"a share of {structure.share:g} and a range of {structure.range:g} m make "
                    "no structure",
                    where="nested variogram",
                    remedy="use shares from zero to one and ranges greater than zero",
                )
        if self._structured > 1.0 + 1e-9:
            raise ParameterError(
                f"shares come to {self._structured:g} of the sill", where="nested variogram"
            )

    @cached_property
    def _structured(self) -> float:
        return sum(structure.share for structure in self.structures)

    @property
    def nugget(self) -> float:
        """What the structures leave of the sill."""
        return self.sill * max(1.0 - self._structured, 0.0)

    @property
    def psill(self) -> float:
        """Sill above the nugget."""
        return self.sill - self.nugget

    def correlation(self, lag: Floats) -> Floats:
        """Correlation of readings at lags in m beyond 0, nugget included: below one at 0+."""
        total = np.zeros(np.shape(lag))
        flat, sums = lag.reshape(-1), total.reshape(-1)
        for start in range(0, flat.size, _CACHED):
            part = slice(start, start + _CACHED)
            for structure in self.structures:
                of_one = structure.kind.correlation(flat[part] / structure.range)
                sums[part] += structure.share * of_one
        return total

    def rise(self, lag: Floats) -> Floats:
        """Semivariance above the nugget at lags in m."""
        rise = self.correlation(lag)
        rise *= -self.sill
        rise += self.psill
        return rise

    @cached_property
    def range(self) -> float:
        """Practical range in m: where 95 % of the rise is made. Zero without a structure."""
        low, high = 0.0, max((structure.range for structure in self.structures), default=0.0)
        level = _AT_THE_RANGE * self._structured
        for _ in range(_HALVINGS):
            middle = (low + high) / 2
            if float(self.correlation(np.array(middle))) > level:
                low = middle
            else:
                high = middle
        return high

    def with_sill(self, sill: float) -> Nested:
        """Model of the same shape and another sill."""
        return Nested(sill, self.structures)


def name_of(model: Bounded | Nested) -> str:
    """Name of a model with a sill, for people."""
    return "nested" if isinstance(model, Nested) else name_of_kind(type(model))


def without_traces(structures: Iterable[Structure], trace: float) -> tuple[Structure, ...]:
    """Leave out structures below a share of the whole; the others grow to keep its nugget.

    The smallest first, as long as they come to little together: many may all be small.

    Examples
    --------
    >>> from subsoil.variogram.models import Exponential as E
    >>> without_traces([Structure(0.8, E, 20.0), Structure(0.0001, E, 90.0)], 0.001)[0].share
    0.8001
    """
    everything = tuple(structures)
    shares = np.array([structure.share for structure in everything])
    total = sum(structure.share for structure in everything)
    order = np.argsort(shares, kind="stable")
    gone = (shares < trace * total)[order] & (np.cumsum(shares[order]) <= _MOST_LEFT_OUT * total)
    kept = [everything[k] for k in np.sort(order[~gone])]
    growth = total / (sum(structure.share for structure in kept) or 1.0)
    return tuple(Structure(s.share * growth, s.kind, s.range) for s in kept)
