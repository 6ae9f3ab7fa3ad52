"""Estimators: from the samples of a survey to one variogram a layer."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, is_dataclass, replace
from math import inf
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from subsoil.arrays import Floats
from subsoil.errors import ParameterError, brief
from subsoil.registry import NOBODY, Allowed, Registry
from subsoil.variogram.empirical import (
    EmpiricalVariogram,
    Formula,
    check_binning,
    empirical_layers,
)
from subsoil.variogram.fitting import (
    Fit,
    Weights,
    check_settings,
    fit_layers,
    too_little,
    with_floor,
)
from subsoil.variogram.models import Bounded, BoundedLinear, Exponential, Matern32, Spherical
from subsoil.variogram.own import Checked, Own
from subsoil.variogram.pooled import EXTENT_M, Pooled
from subsoil.variogram.reml import Reml

if TYPE_CHECKING:
    from _typeshed import DataclassInstance


Estimator = Callable[[Floats, Floats], tuple[Fit, ...]]
"""What a survey calls after a reading: places (n, 2) in m and values (m, n), NaN where a layer was
not measured, to one :class:`~subsoil.variogram.fitting.Fit` a layer. It answers for any number of
samples, none included, and says where the answer is a prior."""

NO_SETTINGS: Mapping[str, float] = MappingProxyType({})
FEWEST_SAMPLES = 4
"""Samples of a layer below which it gets a prior."""
PRIOR_NUGGET = 0.1
"""Share of the nugget in a prior's sill."""


@dataclass(frozen=True)
class LeastSquares:
    """An :data:`Estimator`: a model fitted to the empirical variogram of each layer.

    A layer gets a prior instead if it has fewer than four samples, fewer than three pairs of
    places within the cut-off, or values that do not differ. The prior's sill is the mean squared
    deviation of the layer's samples, or a stated one where that is zero or unknown; 10 % of it is
    nugget.

    Parameters
    ----------
    model
        Kind of model, such as :class:`~subsoil.variogram.models.Spherical`.
    bin_width, cutoff, formula
        As in :func:`~subsoil.variogram.empirical`.
    weights, range_bounds, starts, polish, nugget_floor
        As in :func:`~subsoil.variogram.fitting.fit`.
    prior_range
        Range of the prior in m.
    prior_sill
        Sill of the prior, in squared units of the data, where the samples tell none.

    Raises
    ------
    ParameterError
        If a setting is outside what it may be.

    Examples
    --------
    >>> from subsoil.variogram.models import Spherical
    >>> estimate = LeastSquares(Spherical, prior_range=40.0)
    >>> (fit,) = estimate(np.array([[0.0, 0.0], [9.0, 0.0]]), np.array([[950.0, 1050.0]]))
    >>> fit.variogram
    Spherical(nugget=250.0, range=40.0, psill=2250.0)
    >>> fit.why
    '2 samples only: prior of 10 % nugget and 40 m range on their variance, not a fit'
    """

    model: type[Bounded]
    bin_width: float | None = None
    cutoff: float | None = None
    formula: Formula = "matheron"
    weights: Weights = "pairs"
    range_bounds: tuple[float, float] | None = None
    starts: int = 25
    polish: bool = True
    nugget_floor: float = 0.0
    prior_range: float = 50.0
    prior_sill: float = 1.0

    def __post_init__(self) -> None:
        check_binning(self.bin_width, self.cutoff, self.formula)
        check_settings(self.weights, self.range_bounds, self.starts, self.nugget_floor)
        for name, value in (("range", self.prior_range), ("sill", self.prior_sill)):
            if not 0 < value < inf:
                raise ParameterError(
                    f"must be positive, not {value:g}", where=f"variogram prior {name}"
                )

    def __call__(self, at: Floats, z: Floats) -> tuple[Fit, ...]:
        """Fit each layer of values (m, n) at places (n, 2), or fall back on its prior.

        Raises
        ------
        ReadingsError
            If shapes do not match, or a coordinate or value is not finite.
        ParameterError
            If a bin of repeats at distance 0 would have an infinite weight.
        """
        curves = self.bins(at, z)
        samples = [layer[~np.isnan(layer)] for layer in z]
        lacks = [_lack(curve, known.size) for curve, known in zip(curves, samples, strict=True)]
        fits = iter(
            fit_layers(
                [curve for curve, lack in zip(curves, lacks, strict=True) if not lack],
                self.model,
                weights=self.weights,
                range_bounds=self.range_bounds,
                starts=self.starts,
                polish=self.polish,
                nugget_floor=self.nugget_floor,
            )
        )
        return tuple(
            self._prior(curve, known, lack) if lack else next(fits)
            for curve, known, lack in zip(curves, samples, lacks, strict=True)
        )

    def bins(self, at: Floats, z: Floats) -> tuple[EmpiricalVariogram, ...]:
        """Empirical variogram of each layer, which its model is fitted to."""
        return empirical_layers(
            at, z, bin_width=self.bin_width, cutoff=self.cutoff, formula=self.formula
        )

    def _prior(self, curve: EmpiricalVariogram, z: Floats, lack: str) -> Fit:
        """Variogram that is assumed for want of samples."""
        differ = z.size > 1 and np.ptp(z) > 0
        sill = float(z.var()) if differ else self.prior_sill
        nugget = PRIOR_NUGGET * sill
        variogram = with_floor(
            self.model(nugget, self.prior_range, sill - nugget), self.nugget_floor
        )
        scale = "on their variance" if differ else f"and a sill of {sill:g} for want of a variance"
        share = 100 * max(PRIOR_NUGGET, self.nugget_floor)
        return Fit(
            variogram=variogram,
            empirical=curve,
            is_prior=True,
            why=f"{lack}: prior of {share:g} % nugget and {self.prior_range:g} m range {scale}, "
            "not a fit",
        )


def _lack(curve: EmpiricalVariogram, samples: int) -> str:
    """Why a layer gets a prior; empty if it does not."""
    if samples == 0:
        return "no samples"
    if samples < FEWEST_SAMPLES:
        return f"{samples} sample{'' if samples == 1 else 's'} only"
    return too_little(curve)


paper_10 = LeastSquares(
    BoundedLinear,
    bin_width=10.0,
    cutoff=110.0,
    range_bounds=(10.0, 110.0),
    polish=False,
    nugget_floor=0.1,
)
"""The estimator of the paper's strategies in comparisons: the linear model with a sill on 10 m
bins up to 110 m, weighted by pairs, the best of 25 ranges, and a nugget of at least 10 %."""

ESTIMATORS: dict[str, LeastSquares | Pooled | Reml] = {
    "paper-10": paper_10,
    "spherical": LeastSquares(Spherical, nugget_floor=0.1),
    "exponential": LeastSquares(Exponential, nugget_floor=0.1),
    "matern-3/2": LeastSquares(Matern32, nugget_floor=0.1),
    "pmc": Pooled(),
    "reml": Reml(),
}
"""Estimators by the name the command line and the journal use."""


REGISTRY: Registry[Own] = Registry("estimator", "subsoil.estimators", ESTIMATORS)
"""Estimators by name, those of installed packages included."""


def estimator_named(
    name: str,
    extent_m: float = EXTENT_M,
    settings: Mapping[str, float] = NO_SETTINGS,
    allowed: Allowed = NOBODY,
) -> Estimator:
    """Estimator of a name, for a field of some size, with some parameters set.

    One that is not built in may give models in place of fits, and its answers are looked at.

    Parameters
    ----------
    name
        One of :data:`ESTIMATORS`, or an entry point ``subsoil.estimators`` of an installed package,
        or ``module:attribute`` of an allowed module.
    extent_m
        Diagonal of the field in m, which a pooled correlogram takes its ranges in proportion to.
    settings
        Parameters that differ from what they are otherwise.
    allowed
        Modules that may be imported.

    Raises
    ------
    ParameterError
        If there is none of that name, it has no such parameter, or the parameter cannot be that.
    NotAllowedError
        If it is code of a module that is not allowed.

    Examples
    --------
    >>> estimator_named("pmc", 444.0).median_range, ESTIMATORS["pmc"].median_range
    (90.0, 45.0)
    """
    found = REGISTRY.named(name, allowed)
    if isinstance(found, Pooled) and name not in allowed.given:
        found = found.scaled_to(extent_m)
    if settings:
        found = _with_settings(name, found, settings)
    return found if isinstance(found, LeastSquares | Pooled | Reml) else Checked(name, found)


def _with_settings(name: str, estimator: Own, settings: Mapping[str, float]) -> Own:
    if not is_dataclass(estimator) or isinstance(estimator, type):
        raise ParameterError(f"estimator {brief(name)} has no parameters", where="estimator")
    changed: Own = replace(estimator, **_checked(name, estimator, settings))
    return changed


def bins_of(estimator: Estimator, at: Floats, z: Floats) -> tuple[EmpiricalVariogram, ...]:
    """Empirical variogram of each layer in the bins that an estimator looks at.

    Parameters
    ----------
    estimator
        What the variograms are estimated by.
    at
        (n, 2) places in m.
    z
        (m, n) values, NaN where a layer was not measured.
    """
    if isinstance(estimator, LeastSquares):
        return estimator.bins(at, z)
    return empirical_layers(at, z)


def _checked(
    name: str, estimator: DataclassInstance, settings: Mapping[str, float]
) -> dict[str, Any]:
    """Settings, whole numbers made whole, of an estimator that has parameters of these names."""
    numbers = {
        field.name: getattr(estimator, field.name)
        for field in fields(estimator)
        if isinstance(getattr(estimator, field.name), int | float)
    }
    for key in settings:
        if key not in numbers:
            raise ParameterError(
                f"estimator {brief(name)} has no parameter {brief(key)!r} that is a number",
                where="estimator",
                remedy=f"it has {', '.join(numbers) or 'none'}",
            )
    return {
        key: int(value) if isinstance(numbers[key], int) else value
        for key, value in settings.items()
    }
