"""What must hold of kriging whatever the readings and the model."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from subsoil import (
    BoundedLinear,
    Circular,
    Exponential,
    Gaussian,
    Matern32,
    Matern52,
    Power,
    PureNugget,
    Spherical,
    Variogram,
    condition,
)
from subsoil.arrays import Floats
from subsoil.errors import ParameterError, ReadingsError, SingularSystemError
from subsoil.kriging import at_targets

MODELS: list[Callable[[float, float], Variogram]] = [
    lambda nugget, reach: Spherical(nugget, reach, 2.0),
    lambda nugget, reach: Exponential(nugget, reach, 2.0),
    lambda nugget, reach: Circular(nugget, reach, 2.0),
    lambda nugget, reach: Matern32(nugget, reach, 2.0),
    lambda nugget, reach: Matern52(nugget, reach, 2.0),
    lambda nugget, reach: Gaussian(nugget, reach, 2.0),
    lambda nugget, reach: Power(nugget, 2.0 / reach, 1.3),
    lambda nugget, _: PureNugget(nugget),
]
models = st.builds(
    lambda make, nugget, reach: make(nugget, reach),
    st.sampled_from(MODELS),
    st.floats(0.05, 2.0),
    st.floats(10.0, 200.0),
)
seeds = st.integers(0, 2**31)
exactness = st.booleans()


def readings(seed: int, n: int, m: int = 0) -> tuple[Floats, Floats, Floats]:
    """Places, values and targets; the first two targets are at readings."""
    rng = np.random.default_rng(seed)
    at = rng.uniform(0, 100, (n, 2))
    z = rng.normal(5, 2, (m, n) if m else n)
    return at, z, np.concatenate([at[:2], rng.uniform(-20, 120, (30, 2))])


@given(models, seeds, exactness, st.integers(1, 8), st.integers(0, 5))
def test_appending_equals_conditioning_on_everything(
    model: Variogram, seed: int, exact: bool, before: int, after: int
) -> None:
    at, z, targets = readings(seed, before + after, 2)
    whole = condition(model, at, z, exact=exact).predict(targets)
    start = condition(model, at[:before], z[:, :before], exact=exact)
    grown = start.append(at[before:], z[:, before:]) if after else start
    followed = at_targets(start, targets)
    for k in range(before, before + after):
        followed = followed.append(at[k], z[:, k])
    for each in (grown.predict(targets), followed.prediction):
        np.testing.assert_allclose(each.mean, whole.mean, rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(each.variance, whole.variance, rtol=1e-9, atol=1e-9)


@given(models, seeds, exactness, st.integers(2, 9))
def test_the_order_of_readings_does_not_matter(
    model: Variogram, seed: int, exact: bool, n: int
) -> None:
    at, z, targets = readings(seed, n)
    order = np.random.default_rng(seed).permutation(n)
    one = condition(model, at, z, exact=exact).predict(targets)
    other = condition(model, at[order], z[order], exact=exact).predict(targets)
    np.testing.assert_allclose(other.mean, one.mean, rtol=1e-8, atol=1e-8)
    np.testing.assert_allclose(other.variance, one.variance, rtol=1e-8, atol=1e-8)


@given(models, seeds, exactness, st.integers(1, 9))
def test_the_variance_rises_nowhere_when_a_reading_is_added(
    model: Variogram, seed: int, exact: bool, n: int
) -> None:
    at, z, targets = readings(seed, n + 1)
    before = condition(model, at[:n], z[:n], exact=exact).predict(targets).variance
    after = condition(model, at, z, exact=exact).predict(targets).variance
    assert np.all(after <= before + 1e-9 * before.max())


@given(models, seeds, exactness, st.integers(1, 9))
def test_the_foreseen_fall_of_the_variance_is_the_one_that_comes(
    model: Variogram, seed: int, exact: bool, n: int
) -> None:
    at, z, targets = readings(seed, n)
    estimate = at_targets(condition(model, at, z, exact=exact), targets)
    candidates = [5, 11]
    foreseen = estimate.variance_drop(candidates)
    for row, k in zip(foreseen, candidates, strict=True):
        after = estimate.append(targets[k], 99.0).prediction.variance
        np.testing.assert_allclose(estimate.prediction.variance - after, row, rtol=1e-7, atol=1e-8)


@given(models, seeds, exactness, st.floats(-100, 100), st.floats(0.1, 10))
def test_shifting_and_scaling_the_readings_shifts_and_scales_the_map(
    model: Variogram, seed: int, exact: bool, shift: float, scale: float
) -> None:
    at, z, targets = readings(seed, 7)
    plain = condition(model, at, z, exact=exact).predict(targets)
    moved = condition(model, at, shift + scale * z, exact=exact).predict(targets)
    np.testing.assert_allclose(moved.mean, shift + scale * plain.mean, rtol=1e-8, atol=1e-7)
    np.testing.assert_allclose(moved.variance, plain.variance, rtol=1e-12)


@given(models, seeds, st.integers(2, 6))
def test_repeats_count_as_one_reading_of_a_smaller_error(
    model: Variogram, seed: int, repeats: int
) -> None:
    at, z, targets = readings(seed, 5)
    rng = np.random.default_rng(seed)
    more = rng.normal(5, 2, repeats)
    all_of_them = condition(model, np.concatenate([at, [at[0]] * repeats]), np.append(z, more))
    mean = np.append(more, z[0]).mean()
    error = np.zeros(5)
    # The first place has the nugget over its number of readings; the others keep theirs.
    one_by_one = condition(model, at, z)
    for value in more:
        one_by_one = one_by_one.append(at[0], value)
    a, b = all_of_them.predict(targets), one_by_one.predict(targets)
    np.testing.assert_allclose(a.mean, b.mean, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(a.variance, b.variance, rtol=1e-8, atol=1e-9)
    quiet = without_nugget(model)
    noise = np.full(5, model.nugget)
    noise[0] /= repeats + 1
    joined = condition(quiet, at, np.append(mean, z[1:]), error_variance=error + noise)
    c = joined.predict(targets)
    np.testing.assert_allclose(a.mean, c.mean, rtol=1e-8, atol=1e-8)
    np.testing.assert_allclose(a.variance, c.variance, rtol=1e-7, atol=1e-8)


def without_nugget(model: Variogram) -> Variogram:
    from dataclasses import replace

    return replace(model, nugget=0.0)  # type: ignore[type-var]


@given(models, seeds, exactness)
def test_values_that_branch_from_one_another_do_not_touch_each_other(
    model: Variogram, seed: int, exact: bool
) -> None:
    at, z, targets = readings(seed, 8)
    root = at_targets(condition(model, at[:4], z[:4], exact=exact), targets)
    left = root.append(at[4], z[4])
    before = left.prediction.mean.copy(), left.prediction.variance.copy()
    right = root.append(at[5], z[5]).append(at[6], z[6])
    left_again = left.append(at[7], z[7])
    np.testing.assert_array_equal(left.prediction.mean, before[0])
    np.testing.assert_array_equal(left.prediction.variance, before[1])
    for branch, chosen in ((right, [0, 1, 2, 3, 5, 6]), (left_again, [0, 1, 2, 3, 4, 7])):
        fresh = condition(model, at[chosen], z[chosen], exact=exact).predict(targets)
        np.testing.assert_allclose(branch.prediction.mean, fresh.mean, rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(branch.prediction.variance, fresh.variance, atol=1e-9)


@given(models, seeds, st.integers(1, 4), exactness)
def test_layers_are_kriged_as_each_alone(model: Variogram, seed: int, m: int, exact: bool) -> None:
    at, z, targets = readings(seed, 6, m)
    together = condition(model, at, z, exact=exact).predict(targets)
    one_each = condition([model] * m, at, z, exact=exact).predict(targets)
    assert together.mean.shape == together.variance.shape == (m, len(targets))
    for k in range(m):
        alone = condition(model, at, z[k], exact=exact).predict(targets)
        for result in (together, one_each):
            np.testing.assert_allclose(result.mean[k], alone.mean, rtol=1e-10, atol=1e-10)
            np.testing.assert_allclose(result.variance[k], alone.variance, atol=1e-10)


def dense_models() -> st.SearchStrategy[Variogram]:
    linear = st.builds(lambda n, r: BoundedLinear(n, r, 2.0), st.floats(1, 2), st.floats(20, 80))
    return st.one_of(models, linear)


@settings(max_examples=25, deadline=None)
@given(
    dense_models(),
    seeds,
    exactness,
    st.integers(1, 40),
    st.integers(1, 150),
    st.integers(1, 150),
    st.floats(0.2, 5.0),
    st.floats(0.2, 5.0),
)
def test_a_dense_map_is_what_direct_kriging_gives(
    model: Variogram, seed: int, exact: bool, n: int, nx: int, ny: int, dx: float, dy: float
) -> None:
    at, z, _ = readings(seed, n, 2)
    easting, northing = -10.0 + dx * np.arange(nx), 5.0 + dy * np.arange(ny)
    at[0] = easting[nx // 2], northing[ny // 2]
    ok = condition(model, at, z, exact=exact)
    dense = ok.predict_grid(easting, northing)
    x, y = np.meshgrid(easting, northing)
    direct = ok.predict(np.column_stack([x.ravel(), y.ravel()]))
    sill = 4.0 if np.isfinite(model.sill) else float(np.max(direct.variance))
    assert dense.mean.shape == dense.variance.shape == (2, ny, nx)
    np.testing.assert_allclose(
        dense.mean.reshape(2, -1), direct.mean, rtol=0, atol=1e-9 * max(1.0, np.ptp(z))
    )
    np.testing.assert_allclose(
        dense.variance.reshape(2, -1), direct.variance, rtol=0, atol=1e-9 * max(1.0, sill)
    )


def test_one_layer_comes_back_without_a_layer_axis() -> None:
    at, z, targets = readings(1, 6)
    ok = condition(Spherical(0.1, 50, 1), at, z)
    assert ok.predict(targets).mean.shape == (len(targets),)
    assert ok.predict_grid([0, 1, 2], [0, 1]).variance.shape == (2, 3)


def test_exact_kriging_reproduces_the_readings_without_variance() -> None:
    at, z, _ = readings(3, 20)
    mean, variance = condition(Exponential(0.3, 50, 1), at, z, exact=True).predict(at)
    np.testing.assert_array_equal(mean, z)
    np.testing.assert_array_equal(variance, 0.0)


def test_filtered_kriging_does_not_and_says_how_sure_it_is_of_the_signal() -> None:
    at, z, _ = readings(3, 20)
    mean, variance = condition(Exponential(0.3, 50, 1), at, z).predict(at)
    assert np.abs(mean - z).max() > 0.01
    assert np.all((variance > 0) & (variance < 0.3))


def test_a_reading_with_a_greater_error_counts_less() -> None:
    at, z, _ = readings(4, 10)
    model = Exponential(0.1, 50, 1)
    sure = condition(model, at, z).predict(at[:1])
    error = np.zeros(10)
    error[0] = 5.0
    unsure = condition(model, at, z, error_variance=error).predict(at[:1])
    assert unsure.variance[0] > sure.variance[0]
    assert abs(unsure.mean[0] - z[0]) > abs(sure.mean[0] - z[0])


GRID = np.stack(np.meshgrid(np.arange(6.0), np.arange(6.0)), -1).reshape(-1, 2) * 10.0


def test_an_invalid_bounded_linear_model_gives_way_to_the_circular_one_and_says_so() -> None:
    z = np.random.default_rng(0).normal(size=len(GRID))
    linear = BoundedLinear(0.0, 10 * np.sqrt(2), 1.0)
    ok = condition(linear, GRID, z, exact=True)
    assert ok.variograms == (linear.circular(),)
    assert "circular" in ok.notes[0]
    fine = condition(linear.circular(), GRID, z, exact=True).predict(GRID + 3.0)
    ours = ok.predict(GRID + 3.0)
    np.testing.assert_allclose(ours.mean, fine.mean)
    np.testing.assert_allclose(ours.variance, fine.variance)


def test_a_valid_bounded_linear_system_is_kriged_as_published() -> None:
    at = np.array([[0.0, 0.0], [30.0, 0.0], [70.0, 0.0]])
    linear = BoundedLinear(0.1, 50.0, 1.0)
    ok = condition(linear, at, [1.0, 2.0, 3.0])
    assert ok.variograms == (linear,)
    assert ok.notes == ()


def test_strictly_an_invalid_model_gives_no_number() -> None:
    z = np.random.default_rng(0).normal(size=len(GRID))
    ok = condition(BoundedLinear(0.0, 10 * np.sqrt(2), 1.0), GRID, z, exact=True, invalid="nan")
    mean, variance = ok.predict(GRID + 3.0)
    assert np.isnan(mean).any()
    assert np.array_equal(np.isnan(mean), np.isnan(variance))


def test_a_singular_system_names_the_closest_readings() -> None:
    at = np.random.default_rng(5).uniform(0, 30, (40, 2))
    with pytest.raises(SingularSystemError, match=r"not positive definite.*nugget.*closest"):
        condition(Gaussian(0.0, 100.0, 1.0), at, np.arange(40.0), exact=True)


@pytest.mark.parametrize(
    ("at", "z", "message"),
    [
        (np.empty((0, 2)), np.empty(0), "no reading"),
        ([[0.0, 0.0]], [1.0, 2.0], "do not fit"),
        ([[0.0, np.nan]], [1.0], "coordinate is not a number.*|.*reading 1"),
        ([[0.0, 0.0], [1.0, 0.0]], [1.0, np.inf], "reading 2"),
    ],
)
def test_readings_that_cannot_be_kriged(at: Floats, z: Floats, message: str) -> None:
    with pytest.raises(ReadingsError, match=message):
        condition(Spherical(0.1, 10, 1), at, z)


def test_parameters_that_cannot_be() -> None:
    at, z = [[0.0, 0.0], [1.0, 0.0]], [1.0, 2.0]
    for bad in ({"nugget": -0.1}, {"range": -5.0}, {"range": 0.0}, {"psill": -1.0}):
        with pytest.raises(ParameterError, match=next(iter(bad))):
            Spherical(**({"nugget": 0.1, "range": 10.0, "psill": 1.0} | bad))
    with pytest.raises(ParameterError, match="zero or more"):
        condition(Spherical(0.1, 10, 1), at, z, error_variance=-1.0)
    with pytest.raises(ParameterError, match="3 variograms for 1 layers"):
        condition([Spherical(0.1, 10, 1)] * 3, at, z)
    ok = condition(Spherical(0.1, 10, 1), at, z)
    for grid in ([0.0, 2.0, 1.0], [0.0, 1.0, 3.0], [0.0, np.nan]):
        with pytest.raises(ParameterError):
            ok.predict_grid(grid, [0.0, 1.0])


@pytest.mark.parametrize("n", range(1, 6))
def test_few_readings_are_enough(n: int) -> None:
    at, z, targets = readings(9, n)
    mean, variance = condition(Exponential(0.1, 40, 1), at, z).predict(targets)
    assert np.isfinite(mean).all()
    assert (variance > 0).all()


def test_constant_readings_give_a_constant_map() -> None:
    at, _, targets = readings(9, 12)
    mean, variance = condition(Exponential(0.1, 40, 1), at, np.full(12, 7.0)).predict(targets)
    np.testing.assert_allclose(mean, 7.0)
    assert (variance > 0).all()
