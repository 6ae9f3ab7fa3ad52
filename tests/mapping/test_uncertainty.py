"""How far a map may be off: what is said of it has to hold as often as it says."""

from __future__ import annotations

from functools import cache
from math import isnan, nan, sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.distance import cdist
from scipy.stats import f as f_distribution
from scipy.stats import norm

from subsoil.arrays import Floats
from subsoil.kriging import at_targets, condition
from subsoil.land.field import Field
from subsoil.layers import Layers, Sample
from subsoil.mapping.scores import rmse
from subsoil.mapping.soilmap import SoilMap
from subsoil.mapping.uncertainty import (
    MeanSquare,
    decided,
    mean_square_error,
    predicted_rmse,
    probability_above,
    subsample,
)
from subsoil.variogram import Exponential, Spherical
from subsoil.variogram.layer_correlation import layer_correlation

FIELD = Field.from_metres([(0, 0), (60, 0), (60, 45), (0, 45)])
CELLS = FIELD.cells
NUGGET, RANGE = 0.25, 12.0
REPEATS = 400


def sampled(
    at: Floats, kpa: Floats, variograms: tuple[Exponential, ...], subset: tuple[int, ...] = ()
) -> SoilMap:
    layers = Layers(tuple(np.linspace(0.0, 0.4, len(kpa) + 1)))
    state = np.where(np.isnan(kpa), 2, 0).astype(np.int8)
    samples = tuple(
        Sample((e, n), z, reached)
        for (e, n), z, reached in zip(at.tolist(), kpa.T, state.T, strict=True)
    )
    return SoilMap(FIELD, layers, variograms, samples, subset=subset)


@cache
def surveys(
    reach: tuple[int, ...], alike: float, seed: int, sds: tuple[float, ...] = (100.0,)
) -> list[tuple[MeanSquare, float]]:
    """What is said of the error and the error, over fields whose sills are told by the samples.

    Each layer was reached by the first few samples, and the soil has an SD of its own in each.
    """
    rng, layers, samples = np.random.default_rng(seed), len(reach), max(reach)
    smooth = Exponential(0.0, RANGE, 1.0).correlation(cdist(CELLS, CELLS) / RANGE)
    root = np.linalg.cholesky(smooth + 1e-9 * np.eye(len(CELLS)))
    between = np.linalg.cholesky(np.full((layers, layers), alike) + (1 - alike) * np.eye(layers))
    sd = np.resize(sds, layers)[:, None]
    result = []
    for _ in range(REPEATS):
        soil = between @ rng.standard_normal((layers, len(CELLS))) @ root.T
        soil = 1000.0 + sd * sqrt(1 - NUGGET) * soil
        probed = rng.choice(len(CELLS), samples, replace=False)
        noise = sd * sqrt(NUGGET) * (between @ rng.standard_normal((layers, samples)))
        kpa = soil[:, probed] + noise
        shape = (1 - NUGGET) * smooth[np.ix_(probed, probed)] + NUGGET * np.eye(samples)
        sills = [sill_of(shape[:n, :n], kpa[k : k + 1, :n])[0] for k, n in enumerate(reach)]
        models = tuple(Exponential(NUGGET * s, RANGE, (1 - NUGGET) * s) for s in sills)
        for layer, n in zip(kpa, reach, strict=True):
            layer[n:] = np.nan
        soil_map = sampled(CELLS[probed], kpa, models)
        result.append((mean_square_error(soil_map), rmse(soil_map.mean, soil)))
    return result


def sill_of(shape: Floats, kpa: Floats) -> Floats:
    """Restricted maximum-likelihood sills of (m, n) readings of known correlation."""
    inverse = np.linalg.inv(shape)
    one = inverse.sum(axis=1)
    contrasts = inverse - np.outer(one, one) / one.sum()
    return np.asarray(np.einsum("mi,ij,mj->m", kpa, contrasts, kpa) / (len(shape) - 1))


@pytest.mark.parametrize(
    ("samples", "layers", "alike"), [(12, 1, 0.0), (24, 1, 0.0), (24, 4, 0.5), (24, 4, 0.95)]
)
def test_the_error_is_below_what_is_said_of_it_as_often_as_is_said(
    samples: int, layers: int, alike: float
) -> None:
    outcomes = surveys((samples,) * layers, alike, seed=samples + layers)
    for probability in (0.5, 0.8, 0.9):
        below = sum(error <= said.rmse(probability) for said, error in outcomes)
        spread = sqrt(REPEATS * probability * (1 - probability))
        # Four standard deviations of chance, and 3 % for the two moments matched.
        assert abs(below - REPEATS * probability) <= 4 * spread + 0.03 * REPEATS


@pytest.mark.parametrize(
    ("reach", "alike", "sds"),
    [
        ((24, 6), 0.0, (30.0, 100.0)),
        pytest.param((24, 24, 12, 6), 0.5, (100.0,), marks=pytest.mark.slow),
    ],
)
def test_layers_that_fewer_samples_reached_make_it_less_sure_of_its_error(
    reach: tuple[int, ...], alike: float, sds: tuple[float, ...]
) -> None:
    outcomes = surveys(reach, alike, seed=1, sds=sds)
    for probability in (0.5, 0.8, 0.9):
        below = sum(error <= said.rmse(probability) for said, error in outcomes)
        spread = sqrt(REPEATS * probability * (1 - probability))
        # As above.
        assert abs(below - REPEATS * probability) <= 4 * spread + 0.03 * REPEATS


def test_each_layers_sill_rests_on_the_contrasts_of_the_samples_that_reached_it() -> None:
    rng = np.random.default_rng(6)
    at = CELLS[rng.choice(len(CELLS), 20, replace=False)]
    kpa = 900 + 30 * rng.standard_normal((3, 20))
    kpa[1, 7:] = kpa[2, 1:] = np.nan
    models = tuple(Exponential(100.0 * k, RANGE, 900.0 * k) for k in (1, 2, 3))
    soil_map = sampled(at, kpa, models)
    # A sum of independent scaled chi-squares has the degrees of freedom that give its variance:
    # a_k = kv of layer k, of n_k - 1 contrasts; the least that a single sample is taken for is one.
    kv, contrasts = soil_map.variance.mean(axis=1), np.array([19, 6, 1])
    likeness = layer_correlation(kpa) ** 2
    variance = sum(
        kv[j] * kv[k] * likeness[j, k] / sqrt(contrasts[j] * contrasts[k])
        for j in range(3)
        for k in range(3)
    )
    assert mean_square_error(soil_map).sills == pytest.approx(kv.sum() ** 2 / variance)


def test_errors_of_one_layer_have_the_freedom_of_its_error_covariance_over_all_cells() -> None:
    rng = np.random.default_rng(7)
    at = CELLS[rng.choice(len(CELLS), 15, replace=False)]
    model = Exponential(225.0, 2 * RANGE, 900.0)
    assert len(CELLS) <= 300
    soil_map = sampled(at, 900 + 30 * rng.standard_normal((1, 15)), (model,))

    def covariance(a: Floats, b: Floats) -> Floats:
        return np.asarray(900.0 * np.exp(-3 * cdist(a, b) / (2 * RANGE)))

    system = np.ones((16, 16))
    system[:15, :15], system[15, 15] = covariance(at, at) + 225.0 * np.eye(15), 0.0
    right = np.vstack([covariance(at, CELLS), np.ones(len(CELLS))])
    p = covariance(CELLS, CELLS) - right.T @ np.linalg.solve(system, right)
    error = mean_square_error(soil_map)
    assert error.kv == pytest.approx(np.trace(p) / len(CELLS))
    assert error.errors == pytest.approx(np.trace(p) ** 2 / (p * p).sum())


def test_the_mean_square_error_of_maps_is_their_mean_kriging_variance_on_average() -> None:
    outcomes = surveys((24,), 0.0, seed=25)
    # Error and sill are independent: with 23 contrasts the mean of true over estimated sill is
    # 23 / 21. Five standard errors.
    share = np.array([error**2 / said.kv for said, error in outcomes])
    assert abs(share.mean() - 23 / 21) <= 5 * share.std(ddof=1) / sqrt(REPEATS)


def test_a_chi_square_that_takes_the_sill_for_known_would_be_too_sure() -> None:
    outcomes = surveys((12,), 0.0, seed=5)
    known = [MeanSquare(said.kv, said.errors, 1e9) for said, _ in outcomes]
    below = sum(e <= k.rmse(0.9) for k, (_, e) in zip(known, outcomes, strict=True))
    assert below < 0.8 * REPEATS


@given(
    st.floats(1, 1e5), st.floats(2, 400), st.floats(3, 400), st.floats(0.01, 0.99),
)  # fmt: skip
def test_the_distribution_is_f_and_its_quantile_undoes_its_probability(
    kv: float, errors: float, sills: float, probability: float
) -> None:
    error = MeanSquare(kv, errors, sills)
    peer = sqrt(kv * f_distribution(errors, sills).ppf(probability))
    assert error.rmse(probability) == pytest.approx(peer, rel=1e-6)
    assert error.probability(error.rmse(probability)) == pytest.approx(probability, rel=1e-6)


def test_error_covariances_are_those_of_the_kriging_weights() -> None:
    rng = np.random.default_rng(3)
    at, to = rng.uniform(0, 60, (9, 2)), rng.uniform(0, 60, (5, 2))
    model = Spherical(nugget=30.0, range=40.0, psill=170.0)

    def signal(a: Floats, b: Floats) -> Floats:
        h = np.minimum(cdist(a, b) / 40.0, 1.0)
        return np.asarray(170.0 * (1.0 - 1.5 * h + 0.5 * h**3))

    system = np.block([[signal(at, at) + 30 * np.eye(9), np.ones((9, 1))], [np.ones(9), 0.0]])
    right = np.vstack([signal(at, to), np.ones((1, 5))])
    weights = np.linalg.solve(system, right)[:9]
    cross = weights.T @ signal(at, to)
    own = weights.T @ (signal(at, at) + 30 * np.eye(9)) @ weights
    peer = signal(to, to) - cross - cross.T + own
    kriging = condition(model, at, rng.standard_normal(9))
    found = at_targets(kriging, to).error_covariance(np.arange(5))
    assert np.allclose(found[0], peer, rtol=1e-9, atol=1e-9)
    assert np.allclose(np.diag(found[0]), kriging.predict(to).variance, rtol=1e-9)


def test_layers_that_say_the_same_tell_less_than_layers_of_their_own() -> None:
    rng = np.random.default_rng(4)
    at, one = CELLS[rng.choice(len(CELLS), 20, replace=False)], rng.standard_normal(20)
    models = (Exponential(100.0, RANGE, 900.0),) * 3
    same = mean_square_error(sampled(at, 900 + 30 * np.tile(one, (3, 1)), models))
    apart = mean_square_error(sampled(at, 900 + 30 * rng.standard_normal((3, 20)), models))
    assert same.sills < apart.sills <= 3 * 19
    assert same.errors < apart.errors
    assert same.sills == pytest.approx(19 / ((1 + 2 * 0.9**2) / 3))


def test_layers_without_variation_count_as_one() -> None:
    at = CELLS[::11]
    models = (Exponential(100.0, RANGE, 900.0),) * 2
    flat = mean_square_error(sampled(at, np.full((2, len(at)), 900.0), models))
    assert flat.sills == pytest.approx((len(at) - 1) / ((1 + 0.9**2) / 2))


def test_a_map_of_one_sample_says_nothing_of_its_error() -> None:
    soil_map = sampled(CELLS[:1], np.array([[900.0]]), (Exponential(0.0, RANGE, 900.0),))
    assert isnan(predicted_rmse(soil_map))
    assert isnan(mean_square_error(soil_map).probability(1e6))


def test_a_map_without_error_is_known_to_have_none() -> None:
    model = Exponential(0.0, RANGE, 900.0)
    soil_map = sampled(CELLS[:4], np.array([[900.0, 800.0, 850.0, 900.0]]), (model,), (0, 1, 2, 3))
    error = mean_square_error(soil_map)
    assert error.probability(1e-9) == 1.0
    assert error.rmse(0.99) == 0.0


@given(st.floats(0, 4000), st.floats(1, 500), st.floats(1, 4000))
def test_probabilities_of_a_threshold_are_gaussian(
    mean: float, deviation: float, threshold: float
) -> None:
    found = probability_above([mean], [deviation], threshold)
    assert found[0] == pytest.approx(norm.sf(threshold, mean, deviation), rel=1e-9, abs=1e-300)


def test_a_cell_above_in_one_layer_is_decided_and_one_unsure_layer_leaves_it_open() -> None:
    above = np.array([[0.99, 0.10, 0.10, np.nan], [0.50, 0.50, 0.05, 0.95]])
    assert decided(above, 0.9).tolist() == [True, False, True, True]


@given(
    st.lists(
        st.lists(st.floats(0, 1) | st.just(nan), min_size=3, max_size=3), min_size=1, max_size=4
    ),
    st.floats(0.5, 1.0),
)
def test_a_cell_is_decided_by_the_greatest_of_its_layers_and_by_none_where_none_tells(
    rows: list[list[float]], confidence: float
) -> None:
    expected = []
    for cell in zip(*rows, strict=True):
        known = [p for p in cell if not isnan(p)]
        expected.append(bool(known) and (max(known) >= confidence or 1 - max(known) >= confidence))
    assert decided(np.array(rows), confidence).tolist() == expected


def test_what_is_certain_is_above_a_threshold_or_not_and_what_is_unknown_stays_so() -> None:
    mean, deviation = [1999.0, 2000.0, 2001.0, nan, 2100.0], [0.0, 0.0, 0.0, 1.0, nan]
    found = probability_above(mean, deviation, 2000.0)
    assert found[:3].tolist() == [0.0, 0.0, 1.0]
    assert np.isnan(found[3:]).all()


@given(st.integers(1, 5000))
def test_spaced_cells_are_distinct_and_span_the_field(cells: int) -> None:
    index = subsample(cells)
    assert len(index) == min(cells, 300)
    assert len(set(index.tolist())) == len(index)
    assert index[0] == 0
    assert index[-1] in {0, cells - 1}
