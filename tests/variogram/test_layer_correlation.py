"""How layers go together: against numpy's own correlation, sample by sample."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from subsoil.arrays import Floats
from subsoil.variogram.layer_correlation import independent_layers, layer_correlation
from subsoil.variogram.reach import by_reach

seeds = st.integers(0, 2**31)


def scene(seed: int, layers: int = 4, n: int = 14, missing: float = 0.3) -> Floats:
    """Layers with something in common that some of the samples did not reach."""
    rng = np.random.default_rng(seed)
    shared = rng.normal(size=n)
    kpa = 1500 + 300 * (shared + rng.uniform(0.2, 2.0, (layers, 1)) * rng.normal(size=(layers, n)))
    kpa[rng.random(kpa.shape) < missing] = np.nan
    return kpa


def pair_by_pair(z: Floats) -> Floats:
    """Numpy's correlation of the samples that reached both of two layers, shrunk by a tenth."""
    found = np.eye(len(z))
    for i, j in zip(*np.triu_indices(len(z), 1), strict=True):
        a, b = z[[i, j]][:, np.isfinite(z[[i, j]]).all(axis=0)]
        tells = len(a) >= 3 and len(set(a)) > 1 and len(set(b)) > 1
        found[i, j] = found[j, i] = 0.9 * (np.corrcoef(a, b)[0, 1] if tells else 1.0)
    return found


@given(seeds, st.integers(1, 6), st.integers(1, 20), st.sampled_from([0.0, 0.3, 0.7]))
def test_two_layers_correlate_by_the_samples_that_reached_both(
    seed: int, layers: int, n: int, missing: float
) -> None:
    z = scene(seed, layers, n, missing)
    assert_allclose(layer_correlation(z), pair_by_pair(z), rtol=0, atol=1e-9)


@given(seeds, st.integers(3, 9), st.floats(1.0, 1e5))
def test_a_layer_that_does_not_vary_where_the_other_was_read_counts_as_the_same(
    seed: int, both: int, flat: float
) -> None:
    z = scene(seed, 2, 14, missing=0.0)
    z[0, :both] = flat
    z[1, both:] = np.nan
    assert_allclose(layer_correlation(z), [[1.0, 0.9], [0.9, 1.0]])


@given(seeds, st.floats(-1e5, 1e5), st.floats(1e-3, 1e3))
def test_neither_zero_nor_unit_of_a_layer_matters_and_its_sign_turns_the_correlation(
    seed: int, zero: float, unit: float
) -> None:
    z = scene(seed, 3, 20, missing=0.2)
    other, turned = z.copy(), z.copy()
    other[1] = zero + unit * (z[1] - 1500.0)
    turned[1] = -z[1]
    assert_allclose(layer_correlation(other), layer_correlation(z), atol=1e-6)
    sign = np.array([1.0, -1.0, 1.0])
    assert_allclose(layer_correlation(turned), layer_correlation(z) * np.outer(sign, sign))


@given(seeds)
def test_the_order_of_layers_and_of_samples_does_not_matter(seed: int) -> None:
    z, rng = scene(seed), np.random.default_rng(seed)
    layers, samples = rng.permutation(len(z)), rng.permutation(z.shape[1])
    turned = layer_correlation(z[layers][:, samples])
    assert_allclose(turned, layer_correlation(z)[np.ix_(layers, layers)], atol=1e-12)
    assert independent_layers(z[layers][:, samples]) == pytest.approx(independent_layers(z))


@given(seeds, st.integers(1, 8))
def test_layers_are_worth_one_at_least_and_as_many_as_they_are_at_most(
    seed: int, layers: int
) -> None:
    z = scene(seed, layers, 12, missing=0.1)
    assert 1.0 <= independent_layers(z) <= layers
    twice = np.concatenate([z, z])
    assert independent_layers(twice) <= 2 * independent_layers(z) + 1e-9


@given(seeds, st.integers(1, 7), st.integers(0, 6))
def test_layers_are_grouped_by_just_the_samples_that_reached_them(
    seed: int, layers: int, n: int
) -> None:
    z = scene(seed, layers, n, missing=0.5)
    groups = by_reach(z)
    members = [group.tolist() for _, group in groups]
    held = [k for group in members for k in group]
    assert sorted(held) == [k for k in range(layers) if np.isfinite(z[k]).any()]
    assert all(group == sorted(group) for group in members)
    assert [group[0] for group in members] == sorted(group[0] for group in members)
    for reached, group in groups:
        assert (np.isfinite(z[group]) == reached).all()
    masks = {reached.tobytes() for reached, _ in groups}
    assert len(masks) == len(groups)


@pytest.mark.parametrize("z", [np.empty((0, 4)), np.empty((3, 0)), np.full((2, 3), np.nan)])
def test_where_nothing_was_read_there_is_no_group(z: Any) -> None:
    assert by_reach(z) == []
