"""Readings that come one by one, with their errors, at places already known and far away."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from subsoil import BoundedLinear, Exponential, Power, PureNugget, Spherical, condition
from subsoil.arrays import Floats
from subsoil.errors import ParameterError, ReadingsError, SingularSystemError
from subsoil.kriging import at_targets
from subsoil.kriging.growing_stack import GrowingStack

seeds = st.integers(0, 2**31)


def readings(seed: int, n: int, m: int = 1) -> tuple[Floats, Floats, Floats]:
    """Places, values (m, n) and targets, the first three at readings."""
    rng = np.random.default_rng(seed)
    at, z = rng.uniform(0, 100, (n, 2)), rng.normal(5, 2, (m, n))
    return at, z, np.concatenate([at[:3], rng.uniform(-20, 120, (20, 2))])


@given(seeds, st.booleans(), st.floats(0.0, 1e8))
def test_following_equals_starting_again_whatever_the_errors(
    seed: int, exact: bool, first_error: float
) -> None:
    at, z, targets = readings(seed, 9, 2)
    error = np.random.default_rng(seed).uniform(0, 2, (2, 9))
    error[:, 0] = first_error
    models = Spherical(0.2, 60.0, 2.0), Exponential(0.1, 40.0, 1.0)
    whole = condition(models, at, z, exact=exact, error_variance=error).predict(targets)
    estimate = at_targets(
        condition(models, at[:1], z[:, :1], exact=exact, error_variance=error[:, :1]), targets
    )
    for k in range(1, 9):
        estimate = estimate.append(at[k], z[:, k], error_variance=error[:, k : k + 1])
    np.testing.assert_allclose(estimate.prediction.mean, whole.mean, rtol=0, atol=1e-8)
    np.testing.assert_allclose(estimate.prediction.variance, whole.variance, rtol=0, atol=1e-9)


def test_a_reading_of_boundless_error_is_as_none() -> None:
    at, z, targets = readings(1, 8)
    error = np.zeros(8)
    error[0] = 1e12
    model = Exponential(0.1, 50.0, 1.0)
    with_it = condition(model, at, z[0], error_variance=error).predict(targets)
    without = condition(model, at[1:], z[0, 1:]).predict(targets)
    np.testing.assert_allclose(with_it.mean, without.mean, rtol=1e-9)
    np.testing.assert_allclose(with_it.variance, without.variance, rtol=1e-9)


def test_a_known_error_of_all_readings_is_the_same_as_a_nugget() -> None:
    at, z, targets = readings(2, 8)
    nugget = condition(Spherical(0.3, 50.0, 1.0), at, z[0]).predict(targets)
    error = condition(Spherical(0.0, 50.0, 1.0), at, z[0], error_variance=0.3).predict(targets)
    np.testing.assert_allclose(error.mean, nugget.mean, rtol=1e-12)
    np.testing.assert_allclose(error.variance, nugget.variance, rtol=1e-12)


@given(seeds, st.booleans())
def test_reading_a_place_again_is_followed(seed: int, exact: bool) -> None:
    at, z, targets = readings(seed, 6)
    model = Exponential(0.3, 50.0, 1.0)
    estimate = at_targets(condition(model, at, z[0], exact=exact), targets).append(at[1], 7.0)
    again = condition(
        model, np.concatenate([at, at[1:2]]), np.append(z[0], 7.0), exact=exact
    ).predict(targets)
    np.testing.assert_allclose(estimate.prediction.mean, again.mean, rtol=0, atol=1e-9)
    np.testing.assert_allclose(estimate.prediction.variance, again.variance, rtol=0, atol=1e-9)
    expected = (z[0, 1] + 7.0) / 2
    if exact:
        assert again.mean[1] == pytest.approx(expected, abs=1e-12)
        assert again.variance[1] == 0.0


def test_an_unbounded_model_follows_readings_far_beyond_the_first() -> None:
    at, z, targets = readings(3, 6)
    far = np.concatenate([at, at[:3] + 1e4])
    values = np.append(z[0], [1.0, 2.0, 3.0])
    model = Power(0.1, 0.02, 1.4)
    whole = condition(model, far, values).predict(targets)
    followed = at_targets(condition(model, at[:2], z[0, :2]), targets)
    followed = followed.append(far[2:], values[2:])
    np.testing.assert_allclose(followed.prediction.mean, whole.mean, rtol=0, atol=1e-8)
    np.testing.assert_allclose(followed.prediction.variance, whole.variance, rtol=1e-9)


def test_without_correlation_the_map_is_the_mean_of_the_readings() -> None:
    at, z, targets = readings(4, 10)
    mean, variance = condition(PureNugget(0.5), at, z[0]).predict(targets)
    np.testing.assert_allclose(mean, z.mean())
    np.testing.assert_allclose(variance, 0.05)


def test_a_followed_linear_model_gives_way_when_it_turns_out_invalid() -> None:
    cells = np.stack(np.meshgrid(np.arange(6.0), np.arange(6.0)), -1).reshape(-1, 2) * 10.0
    z = np.random.default_rng(0).normal(size=36)
    linear = BoundedLinear(0.0, 10 * np.sqrt(2), 1.0)
    estimate = at_targets(condition(linear, cells[:2], z[:2]), cells + 3.0)
    assert estimate.kriging.notes == ()
    for k in range(2, 36):
        estimate = estimate.append(cells[k], z[k])
        assert (estimate.prediction.variance > -1e-12).all()
    assert estimate.kriging.variograms == (linear.circular(),)
    assert estimate.prediction.notes == estimate.kriging.notes
    assert len(estimate.kriging.notes) == 1
    expected = condition(linear.circular(), cells, z).predict(cells + 3.0)
    np.testing.assert_allclose(estimate.prediction.mean, expected.mean, rtol=0, atol=1e-9)


def test_a_negative_variance_under_a_valid_model_is_an_error_and_not_a_zero() -> None:
    at, z, _ = readings(5, 4)
    ok = condition(Spherical(0.1, 50.0, 1.0), at, z[0])
    with pytest.raises(SingularSystemError, match=r"Spherical.*fell to -0\.5.*nugget"):
        ok.mended(np.array([[0.2, -0.5]]))
    assert ok.mended(np.array([[0.2, -1e-16]])) is ok


def test_a_place_known_for_certain_has_nothing_to_tell() -> None:
    at, z, targets = readings(7, 8)
    estimate = at_targets(condition(Spherical(0.2, 60.0, 1.0), at, z[0], exact=True), targets)
    assert np.abs(estimate.variance_drop([0, 1, 2])).max() < 1e-12
    assert estimate.variance_drop([5]).max() > 0.1
    filtered = at_targets(condition(Spherical(0.2, 60.0, 1.0), at, z[0]), targets)
    again = filtered.append(targets[1], 3.0).prediction.variance
    foreseen = filtered.variance_drop([1])[0]
    np.testing.assert_allclose(filtered.prediction.variance - again, foreseen, rtol=0, atol=1e-12)


@given(seeds)
def test_kriging_errors_are_as_large_as_the_variance_says(seed: int) -> None:
    model = Exponential(0.2, 40.0, 1.0)
    rng = np.random.default_rng(seed)
    places = rng.uniform(0, 60, (13, 2))
    lag = np.hypot(*(places[:, None] - places).transpose(2, 0, 1))
    signal = np.linalg.cholesky(np.exp(-3 * lag / 40.0)) @ rng.normal(size=(13, 400))
    noisy = 3.0 + signal[:12] + np.sqrt(0.2) * rng.normal(size=(12, 400))
    mean, variance = condition(model, places[:12], noisy.T).predict(places[12:])
    standardised = (3.0 + signal[12] - mean[:, 0]) ** 2 / variance[:, 0]
    # The mean of 400 squared normal errors is 1 within sqrt(2 / 400); 7 of these for 100 seeds.
    assert abs(standardised.mean() - 1.0) < 7 * np.sqrt(2 / 400)


@given(st.lists(st.integers(0, 30), min_size=1, max_size=30), st.integers(1, 40))
def test_rows_that_share_a_buffer_keep_what_they_were_given(branches: list[int], n: int) -> None:
    known = [(GrowingStack(np.zeros((2, n, 3))), [0.0] * n)]
    for value, choice in enumerate(branches, start=1):
        rows, expected = known[choice % len(known)]
        grown, last = rows.grown(3)
        last[:] = value
        known.append((grown, [*expected, float(value)]))
    for rows, expected in known:
        array = rows.array
        np.testing.assert_array_equal(array[1, :, :3], np.tile(expected, (3, 1)).T)
        assert not array.flags.writeable


def test_readings_that_cannot_be_followed() -> None:
    at, z, targets = readings(6, 4, 2)
    estimate = at_targets(condition(Spherical(0.1, 50.0, 1.0), at, z), targets)
    with pytest.raises(ReadingsError, match="do not fit for 2 layers"):
        estimate.append(at[0], 3.0)
    with pytest.raises(ReadingsError, match="reading 1, layer 2: a value is not a number"):
        estimate.append([1.0, 2.0], [3.0, np.nan])
    with pytest.raises(ParameterError, match="error_variance: variances must be zero or more"):
        estimate.append([1.0, 2.0], [3.0, 4.0], error_variance=np.nan)
    with pytest.raises(ParameterError, match=r"error_variance: variances \(3,\) do not fit"):
        estimate.append([1.0, 2.0], [3.0, 4.0], error_variance=[1.0, 2.0, 3.0])
    with pytest.raises(ParameterError, match="targets"):
        estimate.kriging.predict([[0.0, np.inf]])
