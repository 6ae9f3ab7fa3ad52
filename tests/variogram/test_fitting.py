"""Weighted least squares: optimality, bounds, what the report says, and what cannot be fitted."""

from __future__ import annotations

from math import isnan

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import Bounds, differential_evolution, nnls
from scipy.spatial.distance import cdist

from subsoil.arrays import Floats
from subsoil.errors import ParameterError, ReadingsError
from subsoil.variogram import (
    MODELS,
    Bounded,
    BoundedLinear,
    EmpiricalVariogram,
    Exponential,
    Fit,
    Spherical,
    Variogram,
    Weights,
    empirical,
    empirical_layers,
    fit,
    fit_layers,
    semivariance,
)
from subsoil.variogram.least_squares import solve

LAG = np.arange(5.0, 115.0, 10.0)
PAIRS = np.array([12, 31, 55, 72, 80, 88, 90, 84, 71, 60, 41])

every_model = pytest.mark.parametrize("model", MODELS.values(), ids=MODELS)
every_weight = pytest.mark.parametrize("weights", ["pairs", "pairs/lag2", "pairs/gamma2"])
semivariances = st.lists(st.just(0.0) | st.floats(1e-6, 1e6), min_size=1, max_size=LAG.size).filter(
    any
)


def bins(gamma: Floats | list[float]) -> EmpiricalVariogram:
    gamma = np.array(gamma, dtype=float)
    return EmpiricalVariogram(LAG[: gamma.size].copy(), gamma, PAIRS[: gamma.size].copy())


def noisy_bins(seed: int) -> EmpiricalVariogram:
    rng = np.random.default_rng(seed)
    truth = Spherical(rng.uniform(0, 5), rng.uniform(15, 150), rng.uniform(0, 10))
    return bins(semivariance(truth, LAG) * rng.uniform(0.6, 1.4, LAG.size))


def weighted_squares(curve: EmpiricalVariogram, model: Variogram, weights: Weights) -> float:
    modelled = semivariance(model, curve.lag)
    divisor = np.ones(1)
    if weights != "pairs":
        divisor = curve.lag**2 if weights == "pairs/lag2" else modelled**2
    return float(curve.pairs / divisor @ (curve.semivariance - modelled) ** 2)


def parameters(found: Fit) -> tuple[float, float, float]:
    return found.variogram.nugget, found.variogram.range, found.variogram.psill


@every_model
@every_weight
@pytest.mark.parametrize("truth", [(2.0, 41.0, 6.0), (0.0, 63.0, 4e4), (9.0, 27.0, 1.0)])
def test_an_exact_curve_gives_back_its_parameters(
    model: type[Bounded], weights: Weights, truth: tuple[float, float, float]
) -> None:
    found = fit(bins(semivariance(model(*truth), LAG)), model, weights=weights)
    np.testing.assert_allclose(parameters(found), truth, rtol=1e-4, atol=1e-5 * truth[2])
    assert found.r2 == pytest.approx(1.0)
    assert "range" not in found.at_bound


@pytest.mark.parametrize("weights", ["pairs", "pairs/lag2"])
@pytest.mark.parametrize("model", [BoundedLinear, Spherical, Exponential])
@pytest.mark.parametrize("seed", range(4))
def test_no_other_search_finds_less_weighted_squares(
    model: type[Bounded], weights: Weights, seed: int
) -> None:
    curve = noisy_bins(seed)
    found = fit(curve, model, weights=weights, range_bounds=(10.0, 110.0))
    top = 2.0 * float(curve.semivariance.max())

    def squares(guess: Floats) -> float:
        return weighted_squares(curve, model(*guess.tolist()), weights)

    peer = differential_evolution(
        squares,
        bounds=Bounds([0.0, 10.0, 0.0], [top, 110.0, 10 * top]),
        popsize=8,
        maxiter=60,
        seed=seed,
    )
    assert found.sse == pytest.approx(weighted_squares(curve, found.variogram, weights))
    assert found.sse <= peer.fun * (1 + 1e-9)


@settings(deadline=None)
@given(gamma=semivariances, reach=st.floats(6.0, 500.0))
def test_at_a_given_range_the_closed_form_is_non_negative_least_squares(
    gamma: list[float], reach: float
) -> None:
    curve = bins(gamma)
    nugget, psill, squares = solve(
        Exponential,
        curve.lag[None],
        curve.semivariance[None],
        curve.pairs[None].astype(float),
        np.array([[reach]]),
    )
    root = np.sqrt(curve.pairs)
    rise = 1.0 - Exponential.correlation(curve.lag / reach)
    _, norm = nnls(np.column_stack([root, root * rise]), root * curve.semivariance)
    assert nugget[0, 0] >= 0
    assert psill[0, 0] >= 0
    assert squares[0, 0] <= norm**2 * (1 + 1e-9) + 1e-12 * float(root**2 @ curve.semivariance**2)


@every_model
@settings(max_examples=25, deadline=None)
@given(
    gamma=semivariances, floor=st.floats(0.0, 1.0), weights=st.sampled_from(["pairs", "pairs/lag2"])
)
def test_any_bins_give_parameters_within_their_bounds_and_an_honoured_floor(
    model: type[Bounded], gamma: list[float], floor: float, weights: Weights
) -> None:
    curve = bins(gamma)
    free = fit(curve, model, weights=weights, range_bounds=(8.0, 90.0))
    found = fit(curve, model, weights=weights, range_bounds=(8.0, 90.0), nugget_floor=floor)
    nugget, reach, psill = parameters(found)
    assert nugget >= 0
    assert psill >= 0
    assert 8.0 <= reach <= 90.0
    assert nugget >= floor * (nugget + psill) * (1 - 1e-12)
    assert nugget + psill == pytest.approx(free.variogram.sill)


def test_a_raised_nugget_is_reported_with_the_squares_it_costs() -> None:
    curve = bins(semivariance(Spherical(0.0, 50.0, 8.0), LAG))
    free, found = fit(curve, Spherical), fit(curve, Spherical, nugget_floor=0.25)
    assert parameters(found) == pytest.approx((2.0, parameters(free)[1], 6.0), rel=1e-4)
    assert found.sse == pytest.approx(weighted_squares(curve, found.variogram, "pairs"))
    assert found.sse > free.sse
    assert found.at_bound == ("nugget",)
    assert found.why.endswith("nugget raised to 25 % of the sill")


@every_model
def test_the_scan_alone_stays_on_its_grid_and_polishing_never_does_worse(
    model: type[Bounded],
) -> None:
    grid = np.geomspace(10.0, 110.0, 25)
    for seed in range(20):
        curve = noisy_bins(seed)
        scan = fit(curve, model, range_bounds=(10.0, 110.0), polish=False)
        polished = fit(curve, model, range_bounds=(10.0, 110.0))
        assert np.abs(grid - scan.variogram.range).min() < 1e-9
        assert polished.sse <= scan.sse + 1e-12 * float(curve.pairs @ curve.semivariance**2)


def test_weights_by_the_models_own_semivariance_are_those_of_the_fit_found() -> None:
    """At the optimum of the last round the derivatives of its weighted squares vanish."""
    for seed in range(10):
        curve = noisy_bins(seed)
        found = fit(curve, Exponential, weights="pairs/gamma2", range_bounds=(5.0, 300.0))
        gamma = semivariance(found.variogram, curve.lag)
        weight = curve.pairs / gamma**2
        assert found.sse == pytest.approx(
            weighted_squares(curve, found.variogram, "pairs/gamma2"), rel=1e-3
        )
        if "nugget" not in found.at_bound:
            pull = weight * (curve.semivariance - gamma)
            assert abs(pull.sum()) < 1e-3 * np.abs(pull).sum()


def test_layers_give_what_each_layer_gives_alone() -> None:
    curves = [bins(noisy_bins(seed).semivariance[: 4 + seed]) for seed in range(8)]
    for together, curve in zip(fit_layers(curves, Spherical), curves, strict=True):
        np.testing.assert_allclose(
            parameters(together), parameters(fit(curve, Spherical)), rtol=1e-6
        )
        assert together.empirical is curve
    assert fit_layers([], Spherical) == ()


def test_estimates_at_the_true_range_are_unbiased() -> None:
    """At a fixed range the fit is linear in the bins, and Matheron's bins are unbiased.

    600 fields on the same 200 places. A bin's lag is the mean of its pairs' and the model is
    straight within the cut-off, so binning adds no bias; no fit ends on nugget or sill zero. Both
    means lie within 4 standard errors of the truth.
    """
    rng = np.random.default_rng(5)
    at = rng.uniform(0, 150, (200, 2))
    truth = BoundedLinear(nugget=6.0, range=40.0, psill=12.0)
    covariance = truth.psill * truth.correlation(cdist(at, at) / truth.range)
    root = np.linalg.cholesky(covariance + truth.nugget * np.eye(200))
    z = rng.standard_normal((600, 200)) @ root.T
    fits = fit_layers(
        empirical_layers(at, z, bin_width=4, cutoff=32), BoundedLinear, range_bounds=(40.0, 40.0)
    )
    found = np.array([parameters(found) for found in fits])[:, [0, 2]]
    error = found.std(axis=0, ddof=1) / np.sqrt(len(fits))
    assert all(found.at_bound == ("range",) for found in fits)
    assert np.all(np.abs(found.mean(axis=0) - [truth.nugget, truth.psill]) < 4 * error)


def test_fits_of_simulated_fields_scatter_around_the_true_curve() -> None:
    """Median fitted curve of 100 fields of 150 readings within 15 % of the truth, 5 to 50 m.

    One field's semivariance at these lags scatters by about a third; a hundredfold median by a
    twentieth of that or so, the rest is the bias of a free range.
    """
    rng = np.random.default_rng(6)
    at = rng.uniform(0, (180, 130), (150, 2))
    truth = Exponential(nugget=3.0, range=45.0, psill=9.0)
    covariance = truth.psill * truth.correlation(cdist(at, at) / truth.range)
    root = np.linalg.cholesky(covariance + truth.nugget * np.eye(150))
    curves = empirical_layers(at, rng.standard_normal((100, 150)) @ root.T)
    lag = np.arange(5.0, 55.0, 5.0)
    fitted = [semivariance(found.variogram, lag) for found in fit_layers(curves, Exponential)]
    np.testing.assert_allclose(np.median(fitted, axis=0), semivariance(truth, lag), rtol=0.15)


def test_order_of_samples_does_not_change_the_fit_even_where_ranges_tie() -> None:
    """With the bounded linear model all ranges beyond the last lag fit equally well."""
    rng = np.random.default_rng(7)
    for _ in range(25):
        at = rng.uniform(0, 100, (12, 2))
        z = at[:, 0] + rng.standard_normal(12)
        order = rng.permutation(12)
        one, other = (
            fit(empirical(a, v, cutoff=60.0), BoundedLinear, range_bounds=(5.0, 200.0))
            for a, v in ((at, z), (at[order], z[order]))
        )
        np.testing.assert_allclose(parameters(one), parameters(other), rtol=1e-5, atol=1e-5)


def test_no_rise_is_pure_nugget() -> None:
    found = fit(bins([9.0, 8.0, 7.0, 6.0, 5.0, 4.0]), Spherical)
    assert found.variogram.psill == 0
    assert found.variogram.nugget == pytest.approx(
        np.average([9, 8, 7, 6, 5, 4], weights=PAIRS[:6])
    )
    assert found.at_bound == ("psill",)
    assert found.why == "no rise with distance: pure nugget"
    assert found.r2 == pytest.approx(0.0)


def test_a_sill_reached_before_the_first_lag_is_taken_as_rise_and_says_so() -> None:
    found = fit(bins([0.0, 4.0, 4.0, 4.0]), BoundedLinear, range_bounds=(2.0, 5.0))
    mean = np.average([0, 4, 4, 4], weights=PAIRS[:4])
    np.testing.assert_allclose(parameters(found), (0.0, 2.0, mean))
    assert found.at_bound == ("nugget", "range")
    assert found.why.startswith("flat at all lags: nugget and rise cannot be told apart")


def test_a_curve_without_a_sill_says_that_the_range_may_be_longer() -> None:
    found = fit(bins(0.5 + 0.01 * LAG), Spherical)
    assert found.at_bound == ("range",)
    assert found.variogram.range == pytest.approx(LAG[-1])
    assert found.why == "still rising at the last lag, 105 m: the range may be longer"


def test_a_range_held_by_its_bounds_is_reported() -> None:
    curve = bins(semivariance(Spherical(1.0, 50.0, 5.0), LAG))
    longest = fit(curve, Spherical, range_bounds=(10.0, 30.0))
    shortest = fit(curve, Spherical, range_bounds=(70.0, 90.0))
    given_ = fit(curve, Spherical, range_bounds=(40.0, 40.0))
    assert longest.why == "still rising at the longest range allowed, 30 m"
    assert shortest.why == "level beyond the shortest range allowed, 70 m"
    assert given_.why == "range given as 40 m"
    assert given_.variogram.range == 40.0
    for found in (longest, shortest, given_):
        assert "range" in found.at_bound


def test_two_bins_are_one_of_many_curves_and_one_bin_has_no_r2() -> None:
    two = fit(bins([1.0, 2.0]), Spherical)
    assert two.why == "two bins for three parameters: one of many curves through them"
    one = fit(bins([3.0]), Spherical)
    assert one.variogram.sill == pytest.approx(3.0)
    assert isnan(one.r2)


def test_too_few_pairs_or_equal_values_are_refused_in_one_line() -> None:
    none = EmpiricalVariogram(np.empty(0), np.empty(0), np.empty(0, dtype=np.int64))
    few = EmpiricalVariogram(np.array([0.0, 9.0]), np.array([2.0, 1.0]), np.array([8, 2]))
    for curve, says in (
        (none, "0 pairs of places only"),
        (few, "2 pairs of places only"),
        (bins([0.0, 0.0, 0.0]), "no pair of values differs"),
    ):
        with pytest.raises(ReadingsError, match=says) as raised:
            fit(curve, Spherical)
        assert "\n" not in str(raised.value)


@pytest.mark.parametrize("weights", ["pairs/lag2", "pairs/gamma2"])
def test_weights_that_repeats_make_infinite_are_refused_with_a_remedy(weights: Weights) -> None:
    repeats = EmpiricalVariogram(
        np.array([0.0, 9.0, 20.0]), np.array([1.0, 2.0, 3.0]), np.array([4, 9, 16])
    )
    with pytest.raises(ParameterError, match="average repeats first"):
        fit(repeats, Spherical, weights=weights)
    assert fit(repeats, Spherical).variogram.nugget > 0.5


def test_settings_outside_their_bounds_are_refused() -> None:
    curve = noisy_bins(1)
    for bounds in ((0.0, 9.0), (9.0, 8.0), (9.0, np.inf), (np.nan, 9.0)):
        with pytest.raises(ParameterError, match="range bounds"):
            fit(curve, Spherical, range_bounds=bounds)
    for floor in (-0.1, 1.1, np.nan):
        with pytest.raises(ParameterError, match="nugget floor"):
            fit(curve, Spherical, nugget_floor=floor)
    with pytest.raises(ParameterError, match="starts"):
        fit(curve, Spherical, starts=0)
    with pytest.raises(ParameterError, match="pairs/lag2"):
        fit(curve, Spherical, weights="equal")  # type: ignore[arg-type]
