"""Designs judged before they are probed, against kriging itself."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.spatial.distance import cdist

from subsoil.kriging import condition
from subsoil.kriging.designs import Designs
from subsoil.land.field import Field
from subsoil.variogram import Exponential, Gaussian, Matern32, Nested, Structure

FIELD = Field.from_metres(
    [(0, 0), (90, 0), (90, 40), (45, 40), (45, 70), (0, 70)],
    keep_outs=[[(20, 20), (35, 20), (35, 35), (20, 35)]],
)
SHAPE = Nested(
    1.0,
    (
        Structure(0.4, Exponential, 45.0),
        Structure(0.3, Matern32, 30.0),
        Structure(0.1, Gaussian, 80),
    ),
)
N = len(FIELD.cells)


def kriged(cells: list[int], weights: NDArray[np.float64]) -> float:
    ok = condition(SHAPE, FIELD.cells[cells], np.zeros(len(cells)))
    return float(np.average(ok.predict(FIELD.cells).variance, weights=weights))


@settings(max_examples=25)
@given(
    cells=st.lists(st.integers(0, N - 1), min_size=1, max_size=25, unique=True),
    seed=st.integers(0, 99),
)
def test_the_mean_variance_of_a_design_is_that_of_the_map_kriged_from_it(
    cells: list[int], seed: int
) -> None:
    weights = np.random.default_rng(seed).uniform(0.1, 1.0, N)
    designs = Designs(FIELD, SHAPE, weights)
    assert designs.mean_variance(cells) == pytest.approx(kriged(cells, weights), rel=1e-9)


def test_a_probe_in_a_cell_again_halves_its_noise() -> None:
    designs = Designs(FIELD, SHAPE, np.ones(N))
    ok = condition(SHAPE, FIELD.cells[[3, 3, 90]], np.zeros(3))
    mean = ok.predict(FIELD.cells).variance.mean()
    assert designs.mean_variance([3, 3, 90]) == pytest.approx(mean, rel=1e-9)


def test_rows_are_those_of_the_dense_matrices() -> None:
    designs = Designs(FIELD, SHAPE, np.ones(N))
    c = SHAPE.correlation(cdist(FIELD.cells, FIELD.cells))
    rows, products = designs.covariances(range(0, N, 7))
    np.testing.assert_allclose(rows, c[::7], atol=1e-14)
    np.testing.assert_allclose(products, (c @ c / N)[::7], atol=1e-14)
    np.testing.assert_allclose(designs.squares, np.diag(c @ c) / N, atol=1e-14)
    np.testing.assert_allclose(designs.average, c.mean(axis=0), atol=1e-14)
