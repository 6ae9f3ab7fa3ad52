"""A constant sill is rejected where it is not, and seldom where it is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.distance import cdist
from scipy.stats import binom

from subsoil.errors import ParameterError
from subsoil.field import Field
from subsoil.layers import Layers, Sample
from subsoil.soilmap import SoilMap
from subsoil.strategies import View
from subsoil.strategies.joint_plans import designs_for, joint_adaptive
from subsoil.strategies.value import SIGNIFICANCE, evidence, local_sills
from subsoil.variogram import Exponential, Nested, Pooled, Structure

Floats = NDArray[np.float64]
Look = Callable[..., View]

FIELD = Field.from_metres([(0, 0), (180, 0), (180, 130), (0, 130)])
EAST = FIELD.cells[:, 0] > 90.0
LAYERS = Layers()
SHAPE = Nested(1.0, (Structure(0.8, Exponential, 45.0),))


@pytest.fixture(scope="module")
def factor() -> Floats:
    """Factor of the covariance of readings in all cells: a fifth of the sill is nugget."""
    return np.asarray(
        np.linalg.cholesky(
            SHAPE.correlation(cdist(FIELD.cells, FIELD.cells))
            + SHAPE.nugget * np.eye(len(FIELD.cells))
        )
    )


def _map(rng: np.random.Generator, factor: Floats, n: int, ratio: float) -> SoilMap:
    """Map of n samples of a soil whose SD in the east is so many times that in the west."""
    down = np.exp(-np.abs(LAYERS.centre_m[:, None] - LAYERS.centre_m) / 0.15)
    deviation = np.linalg.cholesky(down) @ rng.standard_normal((8, len(EAST))) @ factor.T
    kpa = 1500.0 + 100.0 * deviation * np.where(EAST, ratio, 1.0)
    cells = rng.choice(len(EAST), n, replace=False)
    fits = Pooled()(FIELD.cells[cells], kpa[:, cells])
    state = np.zeros(8, dtype=np.int8)
    samples = tuple(
        Sample((float(x), float(y)), values.copy(), state.copy())
        for (x, y), values in zip(FIELD.cells[cells], kpa[:, cells].T, strict=True)
    )
    return SoilMap(FIELD.cells, LAYERS, tuple(fit.variogram for fit in fits), samples)


def _view(look: Look, soil_map: SoilMap, seed: int) -> View:
    view = look(FIELD, visited=(0, 1), plan=(5, 400))
    return replace(view, soil_map=soil_map, rng=np.random.default_rng(seed))


def test_a_constant_sill_is_rejected_no_more_often_than_its_level_allows(factor: Floats) -> None:
    n, alpha = 120, 1e-3
    rejected = sum(
        evidence(_map(np.random.default_rng([1, k]), factor, 30, 1.0), np.random.default_rng(k))
        .probability < SIGNIFICANCE
        for k in range(n)
    )  # fmt: skip
    # Not above the 5 % of the test; 8 % would be too many.
    assert rejected <= binom.isf(alpha, n, SIGNIFICANCE)
    assert rejected / n <= 0.08


def test_an_sd_that_doubles_in_one_half_is_found_with_forty_samples(
    factor: Floats, look: Look
) -> None:
    n = 30
    found = 0
    for k in range(n):
        soil_map = _map(np.random.default_rng([2, k]), factor, 40, 2.0)
        sills = local_sills(_view(look, soil_map, k))
        assert sills.min() > 0.0
        if np.ptp(sills) > 0.0:
            found += 1
            assert sills.mean() == pytest.approx(1.0)
            assert sills[EAST].mean() > 1.2 * sills[~EAST].mean()
    # Power above 80 %: fewer than these would come up once in a thousand times.
    assert found >= binom.ppf(1e-3, n, 0.8)


def test_weights_are_one_where_nothing_speaks_against_it(factor: Floats, look: Look) -> None:
    few = _map(np.random.default_rng(3), factor, 11, 2.0)
    assert np.array_equal(local_sills(_view(look, few, 0)), np.ones(len(EAST)))
    assert evidence(SoilMap(FIELD.cells, LAYERS), np.random.default_rng(0)).probability == 1.0
    flat = replace(few, samples=few.samples[:1] * 20)
    assert evidence(flat, np.random.default_rng(0)).probability == 1.0


def test_probabilities_are_not_too_small_on_soils_of_a_constant_sill(factor: Floats) -> None:
    # An exact test finds all of them as likely: their mean is a half, with an SD of 1 / sqrt(12).
    n = 60
    seen = [
        evidence(_map(np.random.default_rng([4, k]), factor, 30, 1.0), np.random.default_rng(k))
        .probability
        for k in range(n)
    ]  # fmt: skip
    assert np.mean(seen) > 0.5 - 4 * np.sqrt(1 / 12 / n)


def test_the_same_seed_gives_the_same_weights(factor: Floats, look: Look) -> None:
    soil_map = _map(np.random.default_rng(5), factor, 40, 2.0)
    once, again = (local_sills(_view(look, soil_map, 7)) for _ in range(2))
    assert np.array_equal(once, again)


def test_value_weights_reach_the_designs_of_the_joint_plan(factor: Floats, look: Look) -> None:
    view = _view(look, _map(np.random.default_rng(5), factor, 40, 2.0), 7)
    equal, value = (
        designs_for(replace(view, rng=np.random.default_rng(7)), w) for w in ("equal", "value")
    )
    assert not np.allclose(equal.average, value.average)
    with pytest.raises(ParameterError, match="no weights 'squared'"):
        joint_adaptive(view, weights="squared")
