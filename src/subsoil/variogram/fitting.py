"""Fitting a model to an empirical variogram, and a report of how that went.

Bins are weighted by their number of pairs; by that over the squared lag; or by that over the
squared semivariance of the model itself (Cressie, *Math. Geol.* 17, 1985, 563-586), for which the
fit is repeated with the weights that the last one gives, as gstat does.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, isclose, nan
from typing import Literal, get_args

import numpy as np

from subsoil.arrays import Floats
from subsoil.errors import ParameterError, ReadingsError
from subsoil.variogram.empirical import EmpiricalVariogram
from subsoil.variogram.least_squares import ZOOMS, geometric, padded, search
from subsoil.variogram.models import Bounded
from subsoil.variogram.nested import Nested

Weights = Literal["pairs", "pairs/lag2", "pairs/gamma2"]
"""What a bin counts for: its pairs, or these over the square of its lag or of its semivariance."""

FEWEST_PAIRS = 3
"""Pairs of places below which the three parameters are not fitted."""
REWEIGHTINGS = 10
"""Fits after the first where the weights depend on the model."""


@dataclass(frozen=True)
class Fit:
    """A variogram, and how it was come by.

    Attributes
    ----------
    variogram
        The model: fitted, averaged, or the prior where there was too little for either. Without a
        rise a fitted range is the shortest allowed and means nothing.
    empirical
        The bins of the samples.
    is_prior
        Whether the model was assumed rather than learnt from the samples.
    why
        The outcome in a sentence.
    sse
        Weighted sum of squared residuals of the bins; NaN where they were not fitted to.
    r2
        Share of the bins' weighted variance around their weighted mean that the curve explains:
        1 at best, negative where a nugget floor makes it worse than a flat line, NaN where bins
        were not fitted to or do not vary. It judges the curve, not how well a map predicts.
    at_bound
        Which of ``"nugget"``, ``"range"`` and ``"psill"`` ended on a bound of the search.
    """

    variogram: Bounded | Nested
    empirical: EmpiricalVariogram
    is_prior: bool
    why: str
    sse: float = nan
    r2: float = nan
    at_bound: tuple[str, ...] = ()


def fit(
    empirical: EmpiricalVariogram,
    model: type[Bounded],
    *,
    weights: Weights = "pairs",
    range_bounds: tuple[float, float] | None = None,
    starts: int = 25,
    polish: bool = True,
    nugget_floor: float = 0.0,
) -> Fit:
    """Fit nugget, range and partial sill of a model to an empirical variogram.

    Of equally good ranges the shortest is taken. Where every lag lies beyond it, nugget and rise
    cannot be told apart and all of the sill is taken as rise. :attr:`Fit.why` says so.

    Parameters
    ----------
    empirical
        Bins of one layer.
    model
        Kind of model, such as :class:`~subsoil.variogram.models.Spherical`.
    weights
        ``"pairs"``, ``"pairs/lag2"`` or ``"pairs/gamma2"``.
    range_bounds
        Shortest and longest range in m. Default: from the second lag to the last, as a shorter
        range shows in one bin only and a longer one in none.
    starts
        Number of ranges in the first grid.
    polish
        Whether to close in on the optimum. If not, the range is the best of the first grid.
    nugget_floor
        Share of the sill to which the nugget is raised after the fit; the sill stays.

    Raises
    ------
    ReadingsError
        If there are fewer than three pairs of places, or the values do not differ.
    ParameterError
        If a setting is outside what it may be, or a bin of repeats at distance 0 would have an
        infinite weight.

    Examples
    --------
    >>> from subsoil.variogram.models import Spherical, semivariance
    >>> lag, pairs = np.arange(5.0, 65.0, 10.0), np.array([20, 55, 80, 95, 90, 70])
    >>> curve = semivariance(Spherical(nugget=2.0, range=40.0, psill=6.0), lag)
    >>> found = fit(EmpiricalVariogram(lag, curve, pairs), Spherical)
    >>> round(found.variogram.nugget, 3), round(found.variogram.range, 3)
    (2.0, 40.0)
    >>> found.why
    'least squares over 6 bins and 410 pairs'
    """
    return fit_layers(
        (empirical,),
        model,
        weights=weights,
        range_bounds=range_bounds,
        starts=starts,
        polish=polish,
        nugget_floor=nugget_floor,
    )[0]


def fit_layers(
    empiricals: Sequence[EmpiricalVariogram],
    model: type[Bounded],
    *,
    weights: Weights = "pairs",
    range_bounds: tuple[float, float] | None = None,
    starts: int = 25,
    polish: bool = True,
    nugget_floor: float = 0.0,
) -> tuple[Fit, ...]:
    """Fit each of several layers as :func:`fit` does, all in one search."""
    check_settings(weights, range_bounds, starts, nugget_floor)
    for curve in empiricals:
        _check_bins(curve, weights)
    if not empiricals:
        return ()
    lag = padded([curve.lag for curve in empiricals], 1.0)
    gamma = padded([curve.semivariance for curve in empiricals], 0.0)
    pairs = padded([curve.pairs for curve in empiricals], 0.0)
    bounds = np.array([range_bounds or (curve.lag[:2][-1], curve.lag[-1]) for curve in empiricals])
    ranges = geometric(bounds[:, 0], bounds[:, 1], starts)
    zooms = ZOOMS if polish else 0
    weight = pairs / lag**2 if weights == "pairs/lag2" else pairs
    found = search(model, lag, gamma, weight, ranges, zooms=zooms)
    for _ in range(REWEIGHTINGS if weights == "pairs/gamma2" else 0):
        nugget, reach, psill = found[:, :, None]
        weight = pairs / (nugget + psill * (1.0 - model.correlation(lag / reach))) ** 2
        found = search(model, lag, gamma, weight, ranges, zooms=zooms)
    return tuple(
        _report(
            curve,
            model(*best),
            line[: curve.lag.size],
            limits,
            nugget_floor=nugget_floor,
        )
        for curve, best, line, limits in zip(
            empiricals, found.T.tolist(), weight, bounds.tolist(), strict=True
        )
    )


def check_settings(
    weights: str, range_bounds: tuple[float, float] | None, starts: int, nugget_floor: float
) -> None:
    """Raise ParameterError for a setting of :func:`fit` that is outside what it may be."""
    low, high = range_bounds or (1.0, 1.0)
    for name, value, ok, need in (
        ("weights", weights, weights in get_args(Weights), f"one of {get_args(Weights)}"),
        ("range bounds", range_bounds, 0 < low <= high < inf, "positive, the shorter first"),
        ("starts", starts, starts >= 1, "one or more"),
        ("nugget floor", nugget_floor, 0 <= nugget_floor <= 1, "a share between 0 and 1"),
    ):
        if not ok:
            raise ParameterError(f"must be {need}, not {value!r}", where=f"variogram {name}")


def too_little(empirical: EmpiricalVariogram) -> str:
    """Why nothing can be fitted to these bins; empty if something can."""
    pairs = int(empirical.pairs[empirical.lag > 0].sum())
    if pairs < FEWEST_PAIRS:
        return f"{pairs} pair{'' if pairs == 1 else 's'} of places only"
    return "" if empirical.semivariance.any() else "no pair of values differs"


def with_floor(variogram: Bounded, share: float) -> Bounded:
    """Raise the nugget to a share of the sill, which stays.

    Examples
    --------
    >>> from subsoil.variogram.models import Spherical
    >>> with_floor(Spherical(nugget=0.0, range=40.0, psill=50.0), 0.1)
    Spherical(nugget=5.0, range=40.0, psill=45.0)
    """
    nugget = share * variogram.sill
    if variogram.nugget >= nugget:
        return variogram
    return type(variogram)(nugget, variogram.range, variogram.sill - nugget)


def _check_bins(empirical: EmpiricalVariogram, weights: Weights) -> None:
    if lack := too_little(empirical):
        raise ReadingsError(
            f"nothing to fit: {lack}",
            where="variogram fit",
            remedy="take more samples, or assume a variogram",
        )
    if weights != "pairs" and empirical.lag[0] == 0:
        raise ParameterError(
            f"{weights!r} is infinite for the bin of repeats at distance 0",
            where="variogram weights",
            remedy="weight by 'pairs', or average repeats first",
        )


def _report(
    empirical: EmpiricalVariogram,
    best: Bounded,
    weight: Floats,
    bounds: Sequence[float],
    *,
    nugget_floor: float,
) -> Fit:
    """Raise the nugget of the best variogram to its floor and report on the outcome."""
    variogram, gamma = with_floor(best, nugget_floor), empirical.semivariance
    residual = gamma - variogram.nugget - variogram.rise(empirical.lag)
    sse = float(weight @ residual**2)
    spread = float(weight @ (gamma - np.average(gamma, weights=weight)) ** 2)
    on_bound = {
        "nugget": best.nugget <= nugget_floor * best.sill,
        "range": best.psill > 0 and any(_at_limits(best.range, bounds)),
        "psill": best.psill == 0,
    }
    return Fit(
        variogram=variogram,
        empirical=empirical,
        is_prior=False,
        why=_outcome(empirical, best, bounds)
        + (f"; nugget raised to {100 * nugget_floor:g} % of the sill" * (variogram is not best)),
        sse=sse,
        r2=1.0 - sse / spread if spread > 1e-12 * float(weight @ gamma**2) else nan,
        at_bound=tuple(name for name, hit in on_bound.items() if hit),
    )


def _outcome(empirical: EmpiricalVariogram, best: Bounded, bounds: Sequence[float]) -> str:
    """Say in words what the search ended with."""
    bins, last, (low, high) = empirical.lag.size, empirical.lag[-1], bounds
    rises = np.ptp(best.rise(empirical.lag)) > 1e-6 * best.psill
    at_low, at_high = _at_limits(best.range, bounds)
    for holds, words in (
        (best.psill == 0, "no rise with distance: pure nugget"),
        (not rises, "flat at all lags: nugget and rise cannot be told apart, all taken as rise"),
        (bins < 3, "two bins for three parameters: one of many curves through them"),
        (low == high, f"range given as {low:g} m"),
        (best.range >= last, f"still rising at the last lag, {last:g} m: the range may be longer"),
        (at_high, f"still rising at the longest range allowed, {high:g} m"),
        (at_low, f"level beyond the shortest range allowed, {low:g} m"),
    ):
        if holds:
            return words
    return f"least squares over {bins} bins and {empirical.pairs.sum()} pairs"


def _at_limits(value: float, bounds: Sequence[float]) -> tuple[bool, ...]:
    return tuple(isclose(value, bound, rel_tol=1e-6) for bound in bounds)
