"""The restricted likelihood is the textbook's, and blocks leave no sample out."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from subsoil.arrays import Floats
from subsoil.variogram import Exponential, Matern32
from subsoil.variogram.likelihood import LARGEST_BLOCK, blocks, lags_of, restricted


def correlations(at: Floats) -> Floats:
    lag = np.hypot(*(at[:, None] - at[None]).transpose(2, 0, 1))
    return np.stack(
        [
            0.9 * Exponential.correlation(lag / 40.0) + 0.1 * np.eye(len(at)),
            0.5 * Matern32.correlation(lag / 70.0) + 0.5 * np.eye(len(at)),
            np.eye(len(at)),
        ]
    )


def textbook(r: Floats, z: Floats) -> tuple[float, float]:
    """Log likelihood up to a constant of the layer, and SS, by inverse and determinant."""
    n, one, inverse = len(z), np.ones(len(z)), np.linalg.inv(r)
    q = one @ inverse @ one
    squares = z @ inverse @ z - (one @ inverse @ z) ** 2 / q
    return (
        -0.5 * ((n - 1) * np.log(squares) + np.linalg.slogdet(r)[1] + np.log(q)),
        float(squares),
    )


@pytest.mark.parametrize("n", [2, 3, 12, 80])
def test_it_is_the_textbooks(n: int) -> None:
    rng = np.random.default_rng(n)
    at, z = rng.uniform(0, 120, (n, 2)), rng.normal(30.0, 20.0, (4, n))
    r = correlations(at)
    found = restricted(r, z)
    expected = np.array([[textbook(each, layer) for layer in z] for each in r])
    assert_allclose(found.squares, expected[:, :, 1], rtol=1e-9)
    # Constants of a layer cancel in what one correlation has over another.
    ours, theirs = found.log - found.log[:1], expected[:, :, 0] - expected[:1, :, 0]
    assert_allclose(ours, theirs, rtol=1e-9, atol=1e-9)


@given(st.integers(0, 99), st.floats(-1e4, 1e4), st.sampled_from([1e-3, 1.0, 1e3]))
@settings(max_examples=25, deadline=None)
def test_a_layers_zero_and_unit_do_not_matter(seed: int, shift: float, unit: float) -> None:
    rng = np.random.default_rng(seed)
    at, z = rng.uniform(0, 120, (15, 2)), rng.normal(0.0, 1.0, (2, 15))
    first, second = restricted(correlations(at), z), restricted(correlations(at), shift + unit * z)
    assert_allclose(first.log, second.log, rtol=1e-6, atol=1e-6)
    assert_allclose(first.squares * unit**2, second.squares, rtol=1e-5)


def test_the_order_of_samples_does_not_matter() -> None:
    rng = np.random.default_rng(1)
    at, z, order = rng.uniform(0, 120, (20, 2)), rng.normal(size=(3, 20)), rng.permutation(20)
    first, second = (restricted(correlations(a), b) for a, b in ((at, z), (at[order], z[:, order])))
    assert_allclose(first.log, second.log, rtol=1e-10)


def test_a_correlation_that_is_not_positive_definite_is_not_taken() -> None:
    with pytest.raises(np.linalg.LinAlgError):
        restricted(np.array([[[1.0, 2.0], [2.0, 1.0]]]), np.array([[1.0, 2.0]]))


@given(st.integers(1, 450), st.integers(0, 99))
@settings(max_examples=40, deadline=None)
def test_blocks_hold_every_sample_once_and_none_is_too_large(n: int, seed: int) -> None:
    at = np.random.default_rng(seed).uniform(0, 300, (n, 2))
    found = blocks(at)
    assert sorted(np.concatenate(found).tolist()) == list(range(n))
    assert max(map(len, found)) <= LARGEST_BLOCK
    assert min(map(len, found)) >= min(n, LARGEST_BLOCK // 2)


def test_blocks_are_compact() -> None:
    at = np.column_stack([np.random.default_rng(2).uniform(0, 900, 400), np.zeros(400)])
    spans = sorted((float(at[b, 0].min()), float(at[b, 0].max())) for b in blocks(at))
    assert all(end <= start for (_, end), (start, _) in pairwise(spans))


def test_samples_at_one_place_are_split_too() -> None:
    assert [len(block) for block in blocks(np.zeros((150, 2)))] == [75, 75]


def test_lags_are_distances() -> None:
    assert_allclose(lags_of(np.array([[0.0, 0.0], [3.0, 4.0]])), [[0.0, 5.0], [5.0, 0.0]])
