"""Variograms, and how they were come by, as plain data."""

from __future__ import annotations

from math import nan

from subsoil.reports import Plain
from subsoil.variogram import Bounded, Fit, Nested, Structure, model_named, name_of, name_of_kind
from subsoil.variogram.empirical import EmpiricalVariogram


class BoundedRecord(Plain):
    """A bounded variogram by name and parameters."""

    name: str
    nugget: float
    range: float
    psill: float

    @property
    def variogram(self) -> Bounded:
        """The model recorded."""
        return model_named(self.name)(self.nugget, self.range, self.psill)


class NestedRecord(Plain):
    """A nested variogram by its sill and structures: share of the sill, model, range in m."""

    sill: float
    structures: tuple[tuple[float, str, float], ...]

    @property
    def variogram(self) -> Nested:
        """The model recorded."""
        terms = (Structure(share, model_named(n), reach) for share, n, reach in self.structures)
        return Nested(self.sill, tuple(terms))


Model = BoundedRecord | NestedRecord


class FitRecord(Plain):
    """The variogram of a layer, and how it was come by: a :class:`Fit` without its bins."""

    model: Model
    why: str
    is_prior: bool = False
    at_bound: tuple[str, ...] = ()
    sse: float = nan
    r2: float = nan

    def fit(self, bins: EmpiricalVariogram) -> Fit:
        """The fit recorded, with the bins of the samples."""
        return Fit(
            self.model.variogram, bins, self.is_prior, self.why, self.sse, self.r2, self.at_bound
        )


def model_record(variogram: Bounded | Nested) -> Model:
    """Record of a variogram."""
    if isinstance(variogram, Nested):
        terms = ((s.share, name_of_kind(s.kind), s.range) for s in variogram.structures)
        return NestedRecord(sill=variogram.sill, structures=tuple(terms))
    return BoundedRecord(
        name=name_of(variogram),
        nugget=variogram.nugget,
        range=variogram.range,
        psill=variogram.psill,
    )


def fit_record(fit: Fit) -> FitRecord:
    """Record of a fit."""
    return FitRecord(
        model=model_record(fit.variogram),
        why=fit.why,
        is_prior=fit.is_prior,
        at_bound=fit.at_bound,
        sse=fit.sse,
        r2=fit.r2,
    )
