"""Dense maps agree with direct kriging whatever the grid, and say how closely."""

from __future__ import annotations

import tracemalloc
from collections.abc import Callable
from math import inf

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
    OrdinaryKriging,
    Power,
    Spherical,
    Variogram,
    condition,
)
from subsoil.arrays import Floats
from subsoil.kriging.covariance import Covariance
from subsoil.kriging.grid.chebyshev import Stretch, squared_lags
from subsoil.kriging.grid.smoothness import smoothness
from subsoil.kriging.grid.tiles import Tiler
from subsoil.variogram.models import Bounded

KINDS: list[type[Bounded]] = [Spherical, Exponential, Circular, Matern32, Matern52, Gaussian]


def field(n: int, m: int, seed: int = 0) -> tuple[Floats, Floats]:
    """Places and values of n readings of m layers on 150 x 155 m."""
    rng = np.random.default_rng(seed)
    return rng.uniform(0, 1, (n, 2)) * [150.0, 155.0], rng.normal(2.0, 0.5, (m, n))


def largest_difference(
    ok: OrdinaryKriging, easting: Floats, northing: Floats, cells: int = 2000
) -> float:
    """From a dense map to direct kriging at random cells, in standard deviations and sills."""
    dense = ok.predict_grid(easting, northing)
    rng = np.random.default_rng(1)
    row, column = rng.integers(len(northing), size=cells), rng.integers(len(easting), size=cells)
    direct = ok.predict(np.column_stack([easting[column], northing[row]]))
    sd = ok.z.std(axis=1, keepdims=True)
    sill = ok.system.scale[:, None]
    off_mean = np.abs(
        dense.mean.reshape(len(sd), *dense.mean.shape[-2:])[:, row, column] - direct.mean
    )
    variance = dense.variance.reshape(len(sd), *dense.variance.shape[-2:])[:, row, column]
    return float(max((off_mean / sd).max(), (np.abs(variance - direct.variance) / sill).max()))


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_a_million_cells_are_within_1e_9_of_direct_kriging(kind: type[Bounded]) -> None:
    at, z = field(286, 2)
    ok = condition([kind(0.05, 40.0, 0.6), kind(0.2, 110.0, 1.3)], at, z)
    assert largest_difference(ok, np.linspace(0, 150, 1000), np.linspace(0, 155, 1000)) < 1e-9


@pytest.mark.parametrize("exact", [True, False])
@pytest.mark.parametrize("model", [Power(0.1, 0.02, 0.6), Power(0.1, 1e-3, 1.5), *(
    kind(0.1, reach, 1.0) for kind in KINDS for reach in (4.0, 60.0)
)])  # fmt: skip
def test_every_model_is_mapped_as_direct_kriging_does(model: Variogram, exact: bool) -> None:
    at, z = field(60, 1)
    ok = condition(model, at, z, exact=exact)
    assert largest_difference(ok, np.linspace(-20, 170, 130), np.linspace(0, 155, 110)) < 1e-9


@settings(max_examples=20, deadline=None)
@given(
    st.sampled_from(KINDS),
    st.floats(-1.0, 1.0),
    st.floats(-1.0, 1.0),
    st.sampled_from([(1, 1), (1, 1500), (1500, 1), (2, 900), (300, 15), (120, 90)]),
    st.sampled_from([(0.0, 0.0), (5e5, 5.9e6)]),
)
def test_any_spacing_aspect_and_origin_of_a_grid_will_do(
    kind: type[Bounded],
    log_dx: float,
    log_dy: float,
    shape: tuple[int, int],
    origin: tuple[float, float],
) -> None:
    easting = origin[0] + float(10**log_dx) * np.arange(float(shape[0]))
    northing = origin[1] + float(10**log_dy) * np.arange(float(shape[1]))
    at, z = field(40, 1)
    at = np.array(origin) + at / [150, 155] * [np.ptp(easting) + 1, np.ptp(northing) + 1]
    ok = condition(kind(0.1, 30.0, 1.0), at, z[0])
    assert largest_difference(ok, easting, northing, 500) < 1e-9


def test_a_map_says_how_far_it_is_from_direct_kriging() -> None:
    at, z = field(60, 1)
    ok = condition(Exponential(0.1, 60.0, 1.0), at, z[0])
    tiled = ok.predict_grid(np.linspace(0, 150, 120), np.linspace(0, 155, 110))
    assert 0.0 < tiled.spot_check < 1e-9
    assert ok.predict_grid(np.linspace(0, 150, 20), np.linspace(0, 155, 20)).spot_check == 0.0


def test_an_ill_conditioned_map_is_kriged_directly_rather_than_wrongly() -> None:
    at, z = field(120, 1)
    ok = condition(Gaussian(1e-8, 60.0, 1.0), at, z[0])
    axes = np.linspace(0, 150, 60), np.linspace(0, 155, 50)
    dense = ok.predict_grid(*axes)
    direct = ok.predict(np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2))
    assert dense.spot_check == 0.0
    np.testing.assert_allclose(dense.mean.ravel(), direct.mean, rtol=0, atol=1e-6)
    np.testing.assert_allclose(dense.variance.ravel(), direct.variance, rtol=0, atol=1e-12)


def test_readings_on_grid_cells_are_reproduced_where_kriging_is_exact() -> None:
    easting, northing = 0.5 * np.arange(200), 0.5 * np.arange(180)
    rng = np.random.default_rng(3)
    row, column = rng.integers(180, size=40), rng.integers(200, size=40)
    at, z = np.column_stack([easting[column], northing[row]]), rng.normal(size=(2, 40))
    kept = np.unique(at, axis=0, return_index=True)[1]
    at, z, row, column = at[kept], z[:, kept], row[kept], column[kept]
    mean, variance = condition(Spherical(0.4, 30.0, 1.0), at, z, exact=True).predict_grid(
        easting, northing
    )
    np.testing.assert_array_equal(mean[:, row, column], z)
    np.testing.assert_array_equal(variance[:, row, column], 0.0)
    beside = variance[:, row, np.minimum(column + 1, 199)]
    assert (beside[:, column < 199] > 0.4).all()


def test_layers_that_share_a_variogram_share_the_variance() -> None:
    at, z = field(50, 3)
    axes = np.linspace(0, 150, 90), np.linspace(0, 155, 80)
    shared = condition(Spherical(0.1, 50.0, 1.0), at, z).predict_grid(*axes)
    assert shared.mean.shape == shared.variance.shape == (3, 80, 90)
    assert np.shares_memory(shared.variance[0], shared.variance[2])
    one_each = condition([Spherical(0.1, 50.0, 1.0)] * 3, at, z).predict_grid(*axes)
    np.testing.assert_allclose(shared.mean, one_each.mean, rtol=0, atol=1e-9)
    np.testing.assert_allclose(shared.variance, one_each.variance, rtol=0, atol=1e-9)


def test_a_map_under_an_invalid_linear_model_is_the_circular_one_and_says_so() -> None:
    rng = np.random.default_rng(3)
    at, z = rng.uniform(0, 100, (50, 2)), rng.normal(size=50)
    axes = np.linspace(0, 100, 80), np.linspace(0, 100, 80)
    linear = BoundedLinear(0.0, 45.0, 1.0)
    # The readings' own system is valid, but not together with every cell of the map.
    assert condition(linear, at, z).notes == ()
    dense = condition(linear, at, z).predict_grid(*axes)
    assert "circular" in dense.notes[0]
    assert (dense.variance >= 0).all()
    circular = condition(linear.circular(), at, z).predict_grid(*axes)
    np.testing.assert_array_equal(dense.mean, circular.mean)
    strict = condition(linear, at, z, invalid="nan").predict_grid(*axes)
    assert np.isnan(strict.variance).any()
    assert not np.isnan(strict.variance).all()
    np.testing.assert_array_equal(np.isnan(strict.mean), np.isnan(strict.variance))


def test_a_large_map_takes_little_memory_beyond_itself() -> None:
    at, z = field(200, 2)
    ok = condition([Spherical(0.1, 40.0, 1.0), Exponential(0.1, 60.0, 1.0)], at, z)
    easting, northing = np.linspace(0, 150, 400), np.linspace(0, 155, 400)
    ok.predict_grid(easting[:50], northing[:50])
    tracemalloc.start()
    mean, variance = ok.predict_grid(easting, northing)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak - mean.nbytes - variance.nbytes < 60e6


@pytest.mark.parametrize("kind", [*KINDS, BoundedLinear])
@pytest.mark.parametrize("half", [0.01, 0.05, 0.2, 1.0])
def test_covariances_said_to_be_smooth_over_a_box_are_interpolated_to_the_error_asked(
    kind: Callable[[float, float, float], Variogram], half: float
) -> None:
    shape = Covariance((kind(0.0, 1.0, 1.0),), exact=False).shape(1.0)
    found = smoothness(shape, half, 1e-10)
    side = Stretch(np.linspace(-half, half, 25), 0, 25)
    at = np.random.default_rng(0).uniform(-1, 1, (400, 2)) * max(4 * half, 1.3)
    at = at[~found.rough_from(at)]
    weights = side.weights(side.at)
    sampled = shape.at(np.sqrt(squared_lags(at, side.nodes, side.nodes)))
    wanted = shape.at(np.sqrt(squared_lags(at, side.at, side.at)))
    error = np.abs(weights @ sampled @ weights.T - wanted).max(initial=0.0)
    assert error < 3e-10
    assert found.reach < inf


@pytest.mark.parametrize("reach", [25.0, 60.0, 90.0, 150.0])
@pytest.mark.parametrize("kind", KINDS)
def test_a_map_is_as_exact_as_its_covariances_are_asked_to_be(
    kind: type[Bounded], reach: float
) -> None:
    at, z = field(100, 1)
    ok = condition(kind(0.3, reach, 1.0), at, z)
    easting, northing = np.linspace(0, 150, 200), np.linspace(0, 155, 200)
    mean, variance = np.empty((1, 200, 200)), np.empty((200, 200))
    tiler = Tiler(ok.system, easting, northing, 1e-13)
    for tile in tiler.tiles():
        tiler.fill(tile, mean, variance)
    row, column = np.random.default_rng(1).integers(200, size=(2, 3000))
    direct = ok.predict(np.column_stack([easting[column], northing[row]]))
    np.testing.assert_allclose(mean[:, row, column], direct.mean, rtol=0, atol=1e-11)
    np.testing.assert_allclose(variance[row, column], direct.variance[0], rtol=0, atol=1e-11)
