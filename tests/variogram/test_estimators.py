"""Estimators of a survey: the published baseline, priors, missing layers and odd data."""

from __future__ import annotations

from dataclasses import replace
from math import hypot, inf, isnan, nan

import numpy as np
import pytest

from subsoil.arrays import Floats
from subsoil.errors import ParameterError, ReadingsError
from subsoil.variogram import (
    Bounded,
    BoundedLinear,
    Exponential,
    Fit,
    LeastSquares,
    Spherical,
    empirical,
    fit,
    paper_10,
    semivariance,
)


def readings(seed: int, n: int, layers: int = 1) -> tuple[Floats, Floats]:
    rng = np.random.default_rng(seed)
    at = rng.uniform(0, (180, 130), (n, 2))
    waves = np.sin(at @ rng.normal(0, 0.04, (2, layers)) + rng.uniform(0, 6, layers)).T
    return at, 1500 + 200 * waves + rng.uniform(0, 200) * rng.standard_normal((layers, n))


def parameters(found: Fit) -> tuple[float, float, float]:
    return found.variogram.nugget, found.variogram.range, found.variogram.psill


def baseline(at: Floats, z: Floats) -> tuple[tuple[float, float, float], float, bool]:
    """Fit by the published recipe in plain loops: parameters, sum of squares, is it unique?

    10 m bins to 110 m, weights by pairs, 25 geometric ranges, neither nugget nor sill negative.
    """
    sums = np.zeros((11, 3))
    for i in range(len(z)):
        for j in range(i):
            distance = hypot(at[i, 0] - at[j, 0], at[i, 1] - at[j, 1])
            if distance < 110:
                sums[int(distance / 10)] += 1, distance, (z[i] - z[j]) ** 2 / 2
    sums = sums[sums[:, 0] > 0]
    pairs, lag, gamma = sums[:, 0], sums[:, 1] / sums[:, 0], sums[:, 2] / sums[:, 0]
    tried = []
    for reach in np.geomspace(10, 110, 25):
        x = np.minimum(lag / reach, 1.0)
        candidates = [
            (0.0, (pairs * x) @ gamma / ((pairs * x) @ x)),
            (pairs @ gamma / pairs.sum(), 0.0),
        ]
        if np.ptp(x) > 1e-6:
            slope, start = np.polyfit(x, gamma, 1, w=np.sqrt(pairs))
            if slope >= 0 and start >= 0:
                candidates.append((start, slope))
        for nugget, psill in candidates:
            squares = pairs @ (gamma - nugget - psill * x) ** 2
            tried.append((squares, reach, nugget, psill))
    squares, reach, nugget, psill = min(tried)
    rivals = {round(t[1], 6) for t in tried if t[0] <= squares + 1e-12 * float(pairs @ gamma**2)}
    floor = 0.1 * (nugget + psill)
    if nugget < floor:
        nugget, psill = floor, nugget + psill - floor
    return (nugget, reach, psill), squares, len(rivals) == 1


def test_paper_10_is_the_published_recipe() -> None:
    """Where several ranges fit equally well the recipe names none of them; the squares agree."""
    unique = 0
    for seed in range(60):
        at, z = readings(seed, 5 + seed % 25)
        (found,) = paper_10(at, z)
        (free,) = replace(paper_10, nugget_floor=0.0)(at, z)
        expected, squares, only = baseline(at, z[0])
        total = float(free.empirical.pairs @ free.empirical.semivariance**2)
        assert free.sse == pytest.approx(squares, rel=1e-9, abs=1e-11 * total)
        if only:
            unique += 1
            np.testing.assert_allclose(parameters(found), expected, rtol=1e-6)
    assert unique > 40


def test_paper_10_keeps_a_tenth_of_the_sill_as_nugget_on_any_field() -> None:
    for seed in range(30):
        for found in paper_10(*readings(seed, 4 + seed, layers=3)):
            assert found.variogram.nugget >= 0.1 * found.variogram.sill * (1 - 1e-12)
            assert isinstance(found.variogram, BoundedLinear)


@pytest.mark.parametrize("estimator", [paper_10, LeastSquares(Spherical)])
@pytest.mark.parametrize("n", range(6))
def test_any_number_of_samples_has_an_answer_and_few_have_a_prior(
    estimator: LeastSquares, n: int
) -> None:
    at, z = readings(3, 6, layers=2)
    at /= 10
    for found in estimator(at[:n], z[:, :n]):
        assert isinstance(found.variogram, estimator.model)
        assert found.variogram.sill > 0
        if n < 4:
            assert found.is_prior
            assert isnan(found.sse)
            assert isnan(found.sse)
            assert found.why.endswith("not a fit")


def test_a_prior_has_a_tenth_nugget_the_stated_range_and_the_variance_of_its_samples() -> None:
    at, z = readings(4, 3)
    (found,) = paper_10(at, z)
    variance = z.var()
    assert parameters(found) == pytest.approx((0.1 * variance, 50.0, 0.9 * variance))
    assert found.why == (
        "3 samples only: prior of 10 % nugget and 50 m range on their variance, not a fit"
    )


def test_without_a_variance_the_sill_of_the_prior_is_stated() -> None:
    (found,) = LeastSquares(Spherical, prior_range=30.0, prior_sill=400.0)(
        np.zeros((1, 2)), np.array([[1500.0]])
    )
    assert parameters(found) == pytest.approx((40.0, 30.0, 360.0))
    assert found.why == (
        "1 sample only: prior of 10 % nugget and 30 m range and a sill of 400 "
        "for want of a variance, not a fit"
    )


def test_a_floor_above_the_priors_nugget_is_honoured() -> None:
    at, z = readings(5, 3)
    (found,) = LeastSquares(Spherical, nugget_floor=0.4)(at, z)
    assert found.variogram.nugget == pytest.approx(0.4 * z.var())
    assert found.variogram.sill == pytest.approx(z.var())
    assert "prior of 40 % nugget" in found.why


def test_four_samples_too_far_apart_for_three_pairs_have_a_prior() -> None:
    at = np.array([[0.0, 0.0], [50.0, 0.0], [500.0, 0.0], [900.0, 0.0]])
    (found,) = paper_10(at, np.array([[1.0, 2.0, 3.0, 4.0]]))
    assert found.is_prior
    assert found.why.startswith("1 pair of places only: prior")


def test_constant_readings_have_a_prior_that_says_so() -> None:
    at, _ = readings(6, 12)
    (found,) = paper_10(at, np.full((1, 12), 0.1))
    assert parameters(found) == pytest.approx((0.1, 50.0, 0.9))
    assert found.why.startswith("no pair of values differs: prior")
    assert "sill of 1 for want of a variance" in found.why


def test_samples_at_one_place_have_a_prior_of_their_variance() -> None:
    z = np.array([[900.0, 1000.0, 1100.0, 1000.0, 1000.0]])
    for estimator in (paper_10, LeastSquares(Spherical)):
        (found,) = estimator(np.full((5, 2), 7.0), z)
        assert found.is_prior
        assert found.variogram.sill == pytest.approx(4000.0)
        assert found.why.startswith("0 pairs of places only")


def test_two_flat_clusters_have_a_prior_of_their_variance() -> None:
    at = np.array([[0, 0], [5, 0], [0, 5], [500, 0], [505, 0], [500, 5]], dtype=float)
    (found,) = paper_10(at, np.array([[1.0, 1.0, 1.0, 3.0, 3.0, 3.0]]))
    assert found.is_prior
    assert found.variogram.sill == pytest.approx(1.0)


def test_a_layer_is_fitted_to_the_samples_that_measured_it() -> None:
    at, z = readings(7, 40, layers=3)
    z[1, :15] = nan
    z[2, 2:] = nan
    settings = LeastSquares(Exponential, bin_width=10.0, cutoff=90.0)
    whole, part, prior = settings(at, z)
    for found, keep in ((whole, slice(None)), (part, slice(15, None))):
        layer = 0 if found is whole else 1
        curve = empirical(at[keep], z[layer, keep], bin_width=10.0, cutoff=90.0)
        alone = fit(curve, Exponential)
        np.testing.assert_allclose(parameters(found), parameters(alone), rtol=1e-6)
    assert prior.why.startswith("2 samples only")


def test_a_layer_nobody_reached_has_a_prior() -> None:
    at, z = readings(8, 20, layers=2)
    z[1] = nan
    fitted, unreached = paper_10(at, z)
    assert not fitted.is_prior
    assert unreached.why.startswith("no samples: prior")


@pytest.mark.parametrize("truth", [Spherical(8e3, 60.0, 3e4), Exponential(2e3, 45.0, 2e4)])
def test_a_dense_survey_of_a_known_field_gives_a_curve_near_the_true_one(truth: Bounded) -> None:
    """20 layers of 300 samples: their mean fitted curve is within 25 % of the truth to 60 m.

    A field of 180 x 130 m holds some ten patches of this range, so one layer's sill scatters by
    about a third and the mean of 20 by a twelfth: three times that is 25 %.
    """
    rng = np.random.default_rng(9)
    at = rng.uniform(0, (180, 130), (300, 2))
    distance = np.hypot(*(at[:, None] - at[None]).transpose(2, 0, 1))
    covariance = truth.sill - semivariance(truth, distance)
    z = 1500 + np.linalg.cholesky(covariance) @ rng.standard_normal((300, 20))
    lag = np.linspace(5, 60, 12)
    fits = LeastSquares(type(truth))(at, z.T)
    mean = np.mean([semivariance(found.variogram, lag) for found in fits], axis=0)
    np.testing.assert_allclose(mean, semivariance(truth, lag), rtol=0.25)


def test_a_setting_outside_its_bounds_is_refused_before_the_survey_starts() -> None:
    for setting in (
        {"bin_width": 0.0},
        {"cutoff": nan},
        {"formula": "madogram"},
        {"weights": "equal"},
        {"range_bounds": (50.0, 10.0)},
        {"starts": 0},
        {"nugget_floor": 2.0},
        {"prior_range": 0.0},
        {"prior_sill": inf},
    ):
        with pytest.raises(ParameterError) as raised:
            replace(paper_10, **setting)
        assert "\n" not in str(raised.value)


def test_samples_that_are_not_numbers_or_do_not_match_are_refused() -> None:
    at, z = readings(10, 8)
    with pytest.raises(ReadingsError, match="do not pair"):
        paper_10(at[:5], z)
    at[2] = nan
    with pytest.raises(ReadingsError, match="sample 2"):
        paper_10(at, z)
