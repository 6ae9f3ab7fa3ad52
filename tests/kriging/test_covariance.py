"""Covariances of one or several models at once are those of each model, written out."""

from __future__ import annotations

from math import inf

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.spatial.distance import cdist

from subsoil.kriging import condition
from subsoil.kriging.covariance import AT_A_TIME, Covariance, lags, strips
from subsoil.variogram import (
    MODELS,
    Circular,
    Exponential,
    Gaussian,
    Nested,
    Power,
    PureNugget,
    Spherical,
    Structure,
    Variogram,
)

NESTED = Nested(9.0, (Structure(0.5, Exponential, 70.0), Structure(0.3, Gaussian, 25.0)))
BARE = Nested(9.0, ())
EVERY: dict[str, Variogram] = {
    **{name: kind(0.3, 40.0, 2.0) for name, kind in MODELS.items()},
    "power": Power(0.3, 0.02, 1.4),
    "nugget": PureNugget(0.3),
    "nested": NESTED,
    "nested, nugget alone": BARE,
}
every_model = pytest.mark.parametrize("model", EVERY.values(), ids=EVERY)
LAG = np.concatenate([[0.0], np.geomspace(1e-6, 500.0, 40)])


def written_out(model: Variogram, *, exact: bool) -> np.ndarray:
    top = model.sill - model.nugget if model.sill < inf else 0.0
    return np.asarray(top - model.rise(LAG) + (model.nugget * (LAG == 0.0) if exact else 0.0))


@pytest.mark.parametrize("exact", [False, True])
@every_model
def test_it_falls_from_the_partial_sill_and_jumps_at_zero_only_where_kriging_is_exact(
    model: Variogram, *, exact: bool
) -> None:
    covariance = Covariance((model,), exact)
    assert_allclose(covariance(LAG)[0], written_out(model, exact=exact), rtol=1e-12, atol=1e-14)
    assert covariance.origin == pytest.approx(written_out(model, exact=exact)[0])
    assert covariance.noise + covariance.jump == pytest.approx(model.nugget)


@given(st.lists(st.sampled_from(sorted(EVERY)), min_size=1, max_size=4), st.booleans())
def test_several_models_together_are_as_each_alone(names: list[str], exact: bool) -> None:
    models = tuple(EVERY[name] for name in names)
    lag = np.stack([LAG, LAG[::-1]])
    together = Covariance(models, exact)
    for k, model in enumerate(models):
        alone = Covariance((model,), exact)
        assert_allclose(together(lag)[k], alone(lag)[0], rtol=1e-13, atol=1e-15)
        assert together.of(k) == alone


def test_models_of_one_kind_keep_their_own_range_and_sill() -> None:
    models = tuple(Spherical(0.1 * k, 20.0 * k, 3.0 * k) for k in (1, 2, 3))
    found = Covariance(models, exact=True)(LAG)
    for row, model in zip(found, models, strict=True):
        assert_allclose(row, written_out(model, exact=True), rtol=1e-12, atol=1e-14)


@pytest.mark.parametrize("extent", [30.0, 400.0])
@every_model
def test_in_units_of_its_own_it_is_the_same_covariance(model: Variogram, extent: float) -> None:
    covariance = Covariance((model,), exact=False)
    shape = covariance.shape(extent)
    here = covariance.smooth(LAG)[0]
    assert_allclose(shape.height * shape.at(LAG / shape.length), here, rtol=1e-9, atol=1e-12)
    beyond = LAG[shape.end * shape.length <= LAG]
    assert (covariance.smooth(beyond) == 0.0).all()
    if shape.breaks:
        assert shape.end * shape.length == pytest.approx(40.0)


def test_a_model_of_nugget_alone_has_dense_maps_that_are_the_mean() -> None:
    rng = np.random.default_rng(1)
    at, z = rng.uniform(0, 100, (9, 2)), rng.normal(900, 50, 9)
    axis = np.arange(0.0, 150.0)
    mean, variance = condition(BARE, at, z).predict_grid(axis, axis)
    assert_allclose(mean, z.mean())
    assert_allclose(variance, 1.0)


@given(st.integers(0, 5000), st.integers(0, 10**8))
def test_strips_are_every_row_once_and_hold_what_may_be_held_at_a_time(
    rows: int, columns: int
) -> None:
    found = list(strips(rows, columns))
    assert [row for part in found for row in range(part.start, part.stop)] == list(range(rows))
    assert len(found) >= 1
    for part in found:
        held = part.stop - part.start
        assert held <= 1 or held * columns <= AT_A_TIME
    if rows * columns <= AT_A_TIME:
        assert len(found) == 1


@pytest.mark.parametrize("shift", [0.0, 5.9e6])
def test_lags_are_distances_near_the_origin_and_far_from_it(shift: float) -> None:
    rng = np.random.default_rng(2)
    a, b = rng.uniform(0, 100, (7, 2)) + shift, rng.uniform(0, 100, (5, 2)) + shift
    assert_allclose(lags(a, b), cdist(a, b), rtol=1e-14)
    assert (np.diagonal(lags(a, a)) == 0.0).all()
    assert lags(a[:0], b).shape == (0, 5)


def test_circular_models_end_at_their_range_and_exponential_ones_nowhere() -> None:
    ends = [
        Covariance((model,), exact=False).shape(99.0).end
        for model in (Circular(0.0, 30.0, 1.0), Exponential(0.0, 30.0, 1.0), NESTED)
    ]
    assert ends == [1.0, inf, inf]
