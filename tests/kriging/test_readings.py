"""Readings to krige from: repeats averaged by how sure they are, and a quiet one first."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from subsoil.arrays import Floats
from subsoil.errors import ParameterError, ReadingsError
from subsoil.kriging import condition
from subsoil.kriging.readings import (
    Readings,
    checked,
    checked_error,
    checked_targets,
    distinct,
)
from subsoil.variogram import Spherical

seeds = st.integers(0, 2**31)


def scene(seed: int, n: int = 12, places: int = 5) -> tuple[Floats, Floats, Floats]:
    """Places with repeats, values of two layers, and noise of two models, some of it zero."""
    rng = np.random.default_rng(seed)
    at = rng.uniform(0, 50, (places, 2))[rng.integers(places, size=n)]
    noise = rng.choice([0.0, 0.5, 2.0, 40.0], (2, n), p=[0.15, 0.35, 0.35, 0.15])
    return at, rng.normal(900, 50, (2, n)), noise


def by_hand(at: Floats, z: Floats, noise: Floats) -> list[tuple[tuple[float, ...], float, float]]:
    """Place, value and noise of each place in order, of one layer: the best linear estimate."""
    found = []
    for place in dict.fromkeys(map(tuple, at.tolist())):
        here = (at == place).all(axis=1)
        sure = here & (noise == 0.0)
        if sure.any():
            found.append((place, float(z[sure].mean()), 0.0))
        else:
            weight = 1.0 / noise[here]
            found.append((place, float(np.average(z[here], weights=weight)), 1 / weight.sum()))
    return found


@given(seeds, st.integers(1, 14), st.integers(1, 6))
def test_readings_at_one_place_count_by_how_sure_they_are(seed: int, n: int, places: int) -> None:
    at, z, noise = scene(seed, n, places)
    found = distinct(at, z, noise)
    assert found.certain.sum(axis=1).tolist() == (noise == 0.0).sum(axis=1).tolist()
    for layer in range(2):
        for k, (place, value, left) in enumerate(by_hand(at, z[layer], noise[layer])):
            assert tuple(found.at[k].tolist()) == place
            assert found.z[layer, k] == pytest.approx(value, rel=1e-12)
            assert found.noise[layer, k] == pytest.approx(left, rel=1e-12, abs=1e-300)


@given(seeds, st.integers(1, 10))
def test_readings_that_join_one_by_one_are_as_all_at_once(seed: int, n: int) -> None:
    at, z, noise = scene(seed, n, 4)
    grown = distinct(at[:1], z[:, :1], noise[:, :1])
    for k in range(1, n):
        grown = grown.joined(at[k], z[:, k], noise[:, k])
    whole = distinct(at, z, noise)
    assert grown.at.tolist() == whole.at.tolist()
    assert_allclose(grown.z, whole.z, rtol=1e-12)
    assert_allclose(grown.noise, whole.noise, rtol=1e-12, atol=1e-300)
    assert grown.certain.tolist() == whole.certain.tolist()


def test_joining_leaves_what_was_there_alone() -> None:
    at, z, noise = scene(3)
    before = distinct(at, z, noise)
    kept = before.z.copy(), before.noise.copy(), before.certain.copy()
    before.joined(before.at[1], np.array([0.0, 0.0]), np.array([1.0, 1.0]))
    for now, was in zip((before.z, before.noise, before.certain), kept, strict=True):
        assert (now == was).all()


@given(seeds, st.floats(0.0, 1e9))
def test_a_quiet_reading_leads_and_every_reading_keeps_what_is_its_own(
    seed: int, first: float
) -> None:
    rng = np.random.default_rng(seed)
    at, z, noise = rng.uniform(0, 9, (6, 2)), rng.normal(size=(2, 6)), rng.uniform(0.5, 2, (2, 6))
    noise[:, 0] = first
    given = Readings(at, z, noise, rng.integers(0, 3, (2, 6)).astype(float))
    led = given.led()
    assert led.leads(led.noise.min(axis=1))
    if first <= 100 * noise[:, 1:].min():
        assert led is given
    columns = [np.vstack([r.at.T, r.z, r.noise, r.certain]) for r in (given, led)]
    assert sorted(map(tuple, columns[0].T)) == sorted(map(tuple, columns[1].T))


# --- the best estimate there is -------------------------------------------------------------------


@given(seeds, st.booleans(), st.integers(2, 9))
def test_no_other_weights_that_sum_to_one_are_surer(seed: int, exact: bool, n: int) -> None:
    """Kriging is the best linear unbiased estimate: its weights, found by unit readings, sum to
    one, have the variance said, and any others that sum to one have a higher one."""
    rng = np.random.default_rng(seed)
    at, target = rng.uniform(0, 80, (n, 2)), rng.uniform(0, 80, (1, 2))
    model, error = Spherical(0.4, 60.0, 2.0), rng.uniform(0, 1, n)
    found = condition(model, at, np.eye(n), exact=exact, error_variance=error).predict(target)
    weights = found.mean[:, 0]

    def covariance(a: Floats, b: Floats) -> Floats:
        lag = np.hypot(*(a[:, None] - b[None]).transpose(2, 0, 1))
        return np.asarray(2.0 - model.rise(lag) + 0.4 * (lag == 0.0) * exact)

    readings = covariance(at, at) + np.diag(error + (0.0 if exact else 0.4))
    across, own = covariance(at, target)[:, 0], 2.4 if exact else 2.0

    def variance(w: Floats) -> float:
        return float(own - 2 * w @ across + w @ readings @ w)

    assert weights.sum() == pytest.approx(1.0, abs=1e-9)
    assert variance(weights) == pytest.approx(float(np.ravel(found.variance)[0]), rel=1e-8)
    for _ in range(5):
        away = rng.normal(size=n)
        away -= away.mean()
        assert variance(weights + 0.01 * away) > variance(weights)


# --- what cannot be kriged ------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("at", "z", "where", "what"),
    [
        ([[0, 0], [1, np.inf]], [[1.0, 2.0]], "reading 2", "a coordinate is not a number"),
        ([[0, 0], [1, 1]], [[1.0, np.nan]], "reading 2", "a value is not a number"),
        ([[0, 0]], [[1.0], [np.inf], [2.0]], "reading 1, layer 2", "a value is not a number"),
        ([[0, 0, 0]], [[1.0]], "", "do not fit for 1 layers"),
        ([[0, 0], [1, 1]], [[1.0]], "", "do not fit for 1 layers"),
    ],
)
def test_a_reading_that_cannot_be_is_named_by_its_number_and_layer(
    at: list[list[float]], z: list[list[float]], where: str, what: str
) -> None:
    with pytest.raises(ReadingsError) as raised:
        checked(np.array(at), np.array(z), len(z))
    assert raised.value.where == where
    assert what in raised.value.what


def test_one_reading_may_come_without_an_axis_of_its_own() -> None:
    at, z = checked([1.0, 2.0], [5.0, 6.0, 7.0], 3)
    assert (at.tolist(), z.tolist()) == ([[1.0, 2.0]], [[5.0], [6.0], [7.0]])
    assert checked([1.0, 2.0], 5.0, 1)[1].tolist() == [[5.0]]


def test_variances_of_readings_are_spread_over_models_or_refused() -> None:
    assert checked_error([1.0, 2.0], 3, 2).tolist() == [[1.0, 2.0]] * 3
    assert checked_error([[1.0], [2.0]], 2, 3).tolist() == [[1.0] * 3, [2.0] * 3]
    for bad in (-1e-9, np.inf, np.nan, [1.0, np.nan]):
        with pytest.raises(ParameterError, match="error_variance: variances must be zero or more"):
            checked_error(bad, 1, 2)
    with pytest.raises(ParameterError, match=r"variances \(2, 2\) do not fit 3 readings"):
        checked_error(np.ones((2, 2)), 2, 3)


@pytest.mark.parametrize("targets", [[1.0, 2.0, 3.0], [[np.nan, 1.0]], np.zeros((2, 2, 2))])
def test_places_to_predict_at_are_finite_pairs(targets: Floats) -> None:
    with pytest.raises(ParameterError, match=r"targets: places .* must be finite"):
        checked_targets(targets)
    assert checked_targets([1.0, 2.0]).shape == (1, 2)
