"""What the posterior says of the correlogram is true as often as it says, and its words too."""

from __future__ import annotations

from math import sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.spatial.distance import cdist
from scipy.stats import kstest, t

from subsoil.arrays import Floats
from subsoil.kriging import condition
from subsoil.variogram import (
    Exponential,
    Gaussian,
    Matern32,
    Nested,
    Pooled,
    Posterior,
    Structure,
    name_of_kind,
)
from subsoil.variogram.nested import without_traces

KINDS = (Exponential, Matern32, Gaussian)


def any_posterior(seed: int, ranges: int = 5, shares: int = 4) -> Posterior:
    """Posterior of uneven weights over grids in no order."""
    rng = np.random.default_rng(seed)
    weights = rng.dirichlet(np.full(3 * ranges * shares, 0.3)).reshape(3, ranges, shares)
    return Posterior(
        KINDS,
        tuple(rng.permutation(np.geomspace(10.0, 200.0, ranges)).tolist()),
        tuple(rng.permutation(np.linspace(0.01, 0.8, shares)).tolist()),
        weights,
        2.0,
    )


# --- what it says of itself -----------------------------------------------------------------------


@given(st.integers(0, 2**31), st.floats(0.001, 0.999))
def test_a_quantile_is_the_least_value_that_so_much_weight_lies_at_or_below(
    seed: int, probability: float
) -> None:
    posterior = any_posterior(seed)
    for values, axes, found in (
        (posterior.ranges, (0, 2), posterior.range_at(probability)),
        (posterior.nugget_shares, (0, 1), posterior.nugget_at(probability)),
    ):
        weight = posterior.weights.sum(axis=axes)
        enough = [v for v in values if weight[np.array(values) <= v].sum() >= probability - 1e-12]
        assert found == min(enough)


@given(st.integers(0, 2**31))
def test_quantiles_rise_and_end_on_the_grid_that_has_weight(seed: int) -> None:
    posterior = any_posterior(seed)
    at = np.linspace(0.0, 1.0, 21).tolist()
    ranges = [posterior.range_at(p) for p in at]
    assert ranges == sorted(ranges)
    assert set(ranges) <= set(posterior.ranges)
    assert posterior.range_at(1.0) <= max(posterior.ranges)
    assert posterior.nugget_at(0.0) == min(posterior.nugget_shares)


@given(st.integers(0, 2**31))
def test_structures_keep_the_mean_share_of_the_nugget_and_leave_out_traces_only(seed: int) -> None:
    posterior = any_posterior(seed)
    nugget = float((posterior.weights.sum(axis=(0, 1)) * posterior.nugget_shares).sum())
    assert Nested(1.0, posterior.structures).nugget == pytest.approx(nugget, abs=1e-12)
    whole = posterior.weights @ (1.0 - np.array(posterior.nugget_shares))
    kept = {(s.kind, s.range) for s in posterior.structures}
    for (kind, reach), share in np.ndenumerate(whole):
        name = posterior.kinds[kind], posterior.ranges[reach]
        assert (name in kept) == (share >= 1e-3 * whole.sum())


@given(st.lists(st.floats(0.0, 1.0), max_size=9), st.sampled_from([0.0, 0.01, 0.3]))
def test_what_stays_keeps_its_proportions_and_its_sum(shares: list[float], trace: float) -> None:
    terms = [Structure(share, Exponential, 10.0 + k) for k, share in enumerate(shares)]
    kept = without_traces(terms, trace)
    before = {term.range: term.share for term in terms}
    assert sum(s.share for s in kept) == pytest.approx(sum(shares))
    growth = [s.share / before[s.range] for s in kept if before[s.range] > 1e-300]
    assert_allclose(growth, growth[:1] * len(growth), rtol=1e-9)
    gone = [before[reach] for reach in before.keys() - {s.range for s in kept}]
    assert all(share < trace * sum(shares) for share in gone)
    assert sum(gone) <= 0.05 * sum(shares)


def test_terms_of_a_fine_grid_that_are_all_small_are_not_all_left_out() -> None:
    rng = np.random.default_rng(5)
    at = rng.uniform(0.0, 100.0, (8, 2))
    posterior = Pooled(ranges=1200).posterior(at, rng.normal(900.0, 50.0, (1, 8)))
    whole = posterior.weights @ (1.0 - np.array(posterior.nugget_shares))
    assert whole.max() < 1e-3 * whole.sum()
    lag = np.linspace(0.0, 200.0, 60)
    mean = np.zeros_like(lag)
    for (kind, reach), share in np.ndenumerate(whole):
        mean += share * posterior.kinds[kind].correlation(lag / posterior.ranges[reach])
    found = Nested(1.0, posterior.structures).correlation(lag)
    assert found[0] == pytest.approx(mean[0]), "the nugget stays"
    # What is left out comes to a twentieth at most.
    assert_allclose(found, mean, atol=0.05 * mean[0])


def test_kinds_weigh_what_their_part_of_the_grid_does_by_their_names() -> None:
    posterior = any_posterior(3)
    assert list(posterior.kind_weights) == [name_of_kind(kind) for kind in KINDS]
    assert_allclose(list(posterior.kind_weights.values()), posterior.weights.sum(axis=(1, 2)))


def test_in_words_it_gives_the_median_and_nine_tenths_of_range_and_nugget_and_every_kind() -> None:
    weights = np.zeros((2, 3, 2))
    weights[0, :, 0], weights[1, :, 1] = (0.1, 0.4, 0.1), (0.1, 0.2, 0.1)
    posterior = Posterior((Exponential, Gaussian), (20.0, 50.0, 90.0), (0.05, 0.3), weights, 1.0)
    assert str(posterior) == (
        "range 50 m (90 % between 20 and 90), nugget 5% (5% to 30%), exponential 60%, gaussian 40%"
    )


# --- whether it is true ---------------------------------------------------------------------------


def roots(pooled: Pooled, at: Floats, ranges: Floats) -> Floats:
    """(a, b, c, n, n) Cholesky factors of the correlations of readings over the grid."""
    lag = cdist(at, at)
    share = np.array(pooled.nugget_shares)[:, None, None]
    return np.array(
        [
            [
                np.linalg.cholesky(
                    (1 - share) * kind.correlation(lag / reach) + share * np.eye(len(at))
                )
                for reach in ranges
            ]
            for kind in pooled.kinds
        ]
    )


def test_correlograms_drawn_from_the_prior_are_found_with_the_probabilities_said() -> None:
    """Over fields drawn from the prior, a probability said is how often that is so.

    Sill and mean may be anything: the restricted likelihood does not depend on them. The count of
    what is so, minus the sum of the probabilities said of it, has a mean of zero and the sum of
    the conditional variances for its variance; 4.5 of its standard deviations are passed by chance
    once in 150 000 times.
    """
    n, rng = 40, np.random.default_rng(12)
    pooled = Pooled(
        kinds=(Exponential, Gaussian), shortest_range=15.0, longest_range=120.0, ranges=4,
        nugget_shares=(0.02, 0.2, 0.6), nugget_weights=(0.5, 0.3, 0.2),
    )  # fmt: skip
    at = rng.uniform(0.0, 100.0, (n, 2))
    empty = pooled.posterior(at, np.full((1, n), np.nan))
    factors = roots(pooled, at, np.array(empty.ranges))
    prior = empty.weights.ravel()
    off, spread = np.zeros(prior.size + 1), np.zeros(prior.size + 1)
    for _ in range(800):
        true = int(rng.choice(prior.size, p=prior))
        z = rng.uniform(-1e3, 1e3) + 50.0 * (
            factors.reshape(-1, n, n)[true] @ rng.standard_normal(n)
        )
        said = pooled.posterior(at, z[None]).weights.ravel()
        # Of the truth itself, the probability said is on average the sum of squares: no more, as
        # of weights too vague, and no less, as of weights too sure.
        off += np.append(-said, said[true] - (said**2).sum())
        off[true] += 1.0
        spread += np.append(said * (1 - said), (said**3).sum() - (said**2).sum() ** 2)
    assert (np.abs(off) <= 4.5 * np.sqrt(spread)).all()


@pytest.mark.parametrize("n", [5, 9])
def test_with_the_correlogram_known_predictions_are_off_as_students_t_with_n_less_one_says(
    n: int,
) -> None:
    """The sill estimated is the variance of that t, SS / (n - 3), times its (n - 3) / (n - 1).

    Kolmogorov's statistic of N draws passes 2.2 / sqrt(N) by chance once in 8 000 times.
    """
    share, reach, fields = 0.2, 60.0, 1200
    rng = np.random.default_rng(n)
    pooled = Pooled(
        kinds=(Exponential,), shortest_range=reach, longest_range=reach, median_range=reach,
        ranges=1, nugget_shares=(share,), nugget_weights=(1.0,),
    )  # fmt: skip
    at = rng.uniform(0.0, 100.0, (n + 1, 2))
    root = np.linalg.cholesky(
        (1 - share) * np.exp(-3 * cdist(at, at) / reach) + 1e-12 * np.eye(n + 1)
    )
    soil = 700.0 + 30.0 * rng.standard_normal((fields, n + 1)) @ root.T
    kpa = soil[:, :n] + 30.0 * sqrt(share) * rng.standard_normal((fields, n))
    fits = pooled(at[:n], kpa)
    sill = np.array([fit.variogram.sill for fit in fits])
    shape = Nested(1.0, (Structure(1 - share, Exponential, reach),))
    mean, variance = condition(shape, at[:n], kpa).predict(at[n:])
    off = (soil[:, n] - mean[:, 0]) / np.sqrt(sill * variance[:, 0] * (n - 3) / (n - 1))
    assert kstest(off, t(n - 1).cdf).statistic < 2.2 / sqrt(fields)
