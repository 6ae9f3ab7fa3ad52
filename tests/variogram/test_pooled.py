"""The pooled correlogram is the weighted mean of its grid, with the weights that it should have."""

from __future__ import annotations

from dataclasses import replace
from math import inf

import numpy as np
import pytest
from numpy.testing import assert_allclose

from subsoil.arrays import Floats
from subsoil.errors import ParameterError
from subsoil.variogram import Exponential, Gaussian, Matern32, Nested, Pooled
from subsoil.variogram.layer_correlation import independent_layers
from subsoil.variogram.likelihood import blocks
from subsoil.variogram.models import BoundedLinear

SMALL = Pooled(
    kinds=(Exponential, Matern32), ranges=3, nugget_shares=(0.05, 0.4), nugget_weights=(2.0, 1.0)
)


def scene(seed: int, n: int = 20, layers: int = 4) -> tuple[Floats, Floats]:
    """Places, and values of layers that have something in common."""
    rng = np.random.default_rng(seed)
    at = rng.uniform(0.0, 150.0, (n, 2))
    shared = np.sin(at[:, 0] / 25.0) + np.cos(at[:, 1] / 30.0)
    own = rng.normal(0.0, 0.6, (layers, n))
    return at, 900.0 + np.arange(1.0, layers + 1)[:, None] * 20.0 * (shared + own)


def log_likelihood(r: Floats, z: Floats) -> float:
    one, inverse, n = np.ones(len(z)), np.linalg.inv(r), len(z)
    q = one @ inverse @ one
    squares = z @ inverse @ z - (one @ inverse @ z) ** 2 / q
    return float(-0.5 * ((n - 1) * np.log(squares) + np.linalg.slogdet(r)[1] + np.log(q)))


def brute_force(pooled: Pooled, at: Floats, z: Floats) -> Floats:
    """Probabilities by a loop over the grid, the layers, and their blocks."""
    telling = [k for k in range(len(z)) if np.isfinite(z[k]).sum() >= 3]
    share = independent_layers(z[telling]) / len(telling)
    ranges = np.geomspace(pooled.shortest_range, pooled.longest_range, pooled.ranges)
    log = np.zeros((len(pooled.kinds), pooled.ranges, len(pooled.nugget_shares)))
    for (a, b, c), _ in np.ndenumerate(log):
        total = 0.0
        for k in telling:
            here = np.flatnonzero(np.isfinite(z[k]))
            for block in blocks(at[here]):
                use = here[block]
                lag = np.hypot(*(at[use][:, None] - at[use][None]).transpose(2, 0, 1))
                tau = pooled.nugget_shares[c]
                rho = pooled.kinds[a].correlation(lag / ranges[b])
                total += log_likelihood((1 - tau) * rho + tau * np.eye(len(use)), z[k, use])
        away = (np.log(ranges[b]) - np.log(pooled.median_range)) / pooled.log_sd
        log[a, b, c] = share * total - away**2 / 2 + np.log(pooled.nugget_weights[c])
    weights = np.exp(log - log.max())
    return np.asarray(weights / weights.sum())


@pytest.mark.parametrize("n", [3, 9, 40])
def test_the_posterior_is_that_of_a_loop_over_the_grid(n: int) -> None:
    at, z = scene(n, n)
    assert_allclose(SMALL.posterior(at, z).weights, brute_force(SMALL, at, z), rtol=1e-7)


def test_layers_that_samples_did_not_reach_count_by_those_that_did() -> None:
    at, z = scene(1, 30)
    z[1, 20:] = np.nan
    z[2, ::3] = np.nan
    z[3, 2:] = np.nan
    assert_allclose(SMALL.posterior(at, z).weights, brute_force(SMALL, at, z), rtol=1e-7)


def test_many_samples_count_by_blocks() -> None:
    at, z = scene(2, 130, 2)
    assert len(blocks(at)) == 2
    assert_allclose(SMALL.posterior(at, z).weights, brute_force(SMALL, at, z), rtol=1e-6, atol=1e-9)


def test_layers_count_for_as_many_as_their_eigenvalues_say() -> None:
    _, z = scene(3)
    eigenvalues = np.linalg.eigvalsh(0.9 * np.corrcoef(z) + 0.1 * np.eye(len(z)))
    expected = eigenvalues.sum() ** 2 / (eigenvalues**2).sum()
    assert_allclose(independent_layers(z), expected, rtol=1e-12)
    assert independent_layers(z[:1]) == pytest.approx(1.0)
    alike = np.repeat(z[:1], 6, axis=0)
    assert 1.0 < independent_layers(alike) < 1.3
    noise = np.random.default_rng(0).normal(size=(6, 4000))
    assert 5.9 < independent_layers(noise) <= 6.0


@pytest.mark.parametrize(("layers", "expected"), [(1, 1.0), (2, 2.0), (8, 2.0)])
def test_layers_of_few_samples_count_for_two(layers: int, expected: float) -> None:
    _, z = scene(4, 3, layers)
    assert independent_layers(z) == expected


def test_the_mean_correlogram_is_the_weighted_sum_of_the_grid() -> None:
    at, z = scene(5)
    posterior = SMALL.posterior(at, z)
    lag = np.linspace(0.5, 300.0, 40)
    expected = np.zeros_like(lag)
    for (a, b, c), weight in np.ndenumerate(posterior.weights):
        rho = posterior.kinds[a].correlation(lag / posterior.ranges[b])
        expected += weight * (1.0 - posterior.nugget_shares[c]) * rho
    found = Nested(1.0, posterior.structures).correlation(lag)
    assert_allclose(found, expected, atol=2e-3)
    nugget = posterior.weights.sum(axis=(0, 1)) @ np.array(posterior.nugget_shares)
    assert_allclose(Nested(1.0, posterior.structures).nugget, nugget, rtol=1e-9)


def test_all_layers_have_one_shape_and_a_sill_each() -> None:
    at, z = scene(6)
    fits = SMALL(at, z)
    (structures,) = {fit.variogram.structures for fit in fits if isinstance(fit.variogram, Nested)}
    shape = Nested(1.0, structures)
    lag = np.hypot(*(at[:, None] - at[None]).transpose(2, 0, 1))
    r = shape.correlation(lag)
    np.fill_diagonal(r, 1.0)
    one, inverse = np.ones(len(at)), np.linalg.inv(r)
    for fit, layer in zip(fits, z, strict=True):
        q = one @ inverse @ one
        squares = layer @ inverse @ layer - (one @ inverse @ layer) ** 2 / q
        assert_allclose(fit.variogram.sill, squares / (len(at) - 3), rtol=1e-8)
        assert not fit.is_prior


def test_the_order_of_samples_and_of_layers_does_not_matter() -> None:
    at, z = scene(7)
    z[2, :9] = np.nan
    rng = np.random.default_rng(1)
    samples, layers = rng.permutation(len(at)), rng.permutation(len(z))
    first = Pooled().posterior(at, z)
    second = Pooled().posterior(at[samples], z[np.ix_(layers, samples)])
    assert_allclose(first.weights, second.weights, rtol=1e-7, atol=1e-12)
    sills = [fit.variogram.sill for fit in Pooled()(at, z)]
    turned = [fit.variogram.sill for fit in Pooled()(at[samples], z[np.ix_(layers, samples)])]
    assert_allclose(np.array(sills)[layers], turned, rtol=1e-7)


@pytest.mark.parametrize("n", [0, 1, 2])
def test_before_the_third_sample_there_is_the_prior_alone(n: int) -> None:
    at, z = scene(8, 3)
    posterior = SMALL.posterior(at[:n], z[:, :n])
    ranges = np.geomspace(SMALL.shortest_range, SMALL.longest_range, SMALL.ranges)
    prior = np.exp(-0.5 * (np.log(ranges / SMALL.median_range) / SMALL.log_sd) ** 2)
    expected = np.broadcast_to(prior[:, None] * np.array([2.0, 1.0]), (2, 3, 2))
    assert_allclose(posterior.weights, expected / expected.sum(), rtol=1e-12)
    assert posterior.layers == 0.0
    fits = SMALL(at[:n], z[:, :n])
    assert len(fits) == 4
    assert all(fit.is_prior and "prior mean" in fit.why for fit in fits)


def test_without_a_sample_the_sill_is_the_one_assumed() -> None:
    at, z = scene(9, 3)
    fits = replace(SMALL, prior_sill=77.0)(at[:0], z[:, :0])
    assert [fit.variogram.sill for fit in fits] == [77.0] * 4
    assert all("an assumed one" in fit.why for fit in fits)


def test_a_layer_that_nothing_tells_of_takes_the_shape_and_mean_sill_of_the_others() -> None:
    at, z = scene(10)
    z[1], z[3, 1:] = np.nan, np.nan
    fits = Pooled()(at, z)
    known = (fits[0].variogram.sill + fits[2].variogram.sill) / 2
    for k in (1, 3):
        assert fits[k].is_prior
        assert_allclose(fits[k].variogram.sill, known, rtol=1e-12)
        assert "that of the other layers, a guess" in fits[k].why
    assert not fits[0].is_prior


def test_values_that_do_not_differ_tell_nothing() -> None:
    at, z = scene(11)
    flat = np.vstack([z, np.full(len(at), 500.0)])
    assert_allclose(Pooled().posterior(at, flat).weights, Pooled().posterior(at, z).weights)
    assert Pooled()(at, flat)[-1].is_prior


def test_long_and_short_ranges_are_told_apart() -> None:
    rng = np.random.default_rng(12)
    at = rng.uniform(0, 180, (60, 2))
    lag = np.hypot(*(at[:, None] - at[None]).transpose(2, 0, 1))
    medians = []
    for reach in (20.0, 120.0):
        covariance = 0.95 * Exponential.correlation(lag / reach) + 0.05 * np.eye(60)
        z = rng.multivariate_normal(np.zeros(60), covariance, 8, method="cholesky")
        medians.append(Pooled().posterior(at, z).range_at(0.5))
    assert medians[0] < 40.0 < 80.0 < medians[1]


def test_a_larger_field_has_longer_ranges_in_proportion() -> None:
    at, z = scene(13)
    scaled = Pooled().scaled_to(444.0)
    assert (scaled.shortest_range, scaled.longest_range, scaled.median_range) == (24.0, 320.0, 90.0)
    assert_allclose(
        scaled.posterior(2 * at, z).weights, Pooled().posterior(at, z).weights, rtol=1e-7
    )


@pytest.mark.parametrize(
    "settings",
    [
        {"kinds": ()},
        {"kinds": (BoundedLinear,)},
        {"shortest_range": 0.0},
        {"shortest_range": 200.0},
        {"longest_range": 40.0},
        {"longest_range": inf},
        {"ranges": 0},
        {"median_range": 11.0},
        {"median_range": 161.0},
        {"log_sd": 0.0},
        {"nugget_shares": (0.0, 0.1, 0.2, 0.3, 0.4, 0.5)},
        {"nugget_shares": (0.1,)},
        {"nugget_weights": (0.0,) * 6},
        {"prior_sill": 0.0},
    ],
    ids=str,
)
def test_settings_that_cannot_be_are_refused(settings: dict[str, object]) -> None:
    with pytest.raises(ParameterError, match="estimator pmc"):
        Pooled(**settings)  # type: ignore[arg-type]


def test_a_grid_of_one_correlogram_is_that_correlogram() -> None:
    at, z = scene(14)
    one = Pooled(
        kinds=(Gaussian,), shortest_range=50.0, longest_range=50.0, ranges=1, median_range=50.0,
        nugget_shares=(0.2,), nugget_weights=(1.0,),
    )  # fmt: skip
    (structure,) = one.posterior(at, z).structures
    assert (structure.kind, structure.range) == (Gaussian, 50.0)
    assert structure.share == pytest.approx(0.8)
