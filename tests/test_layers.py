"""Layers: means of profiles, and the three things a push can say about a layer."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from subsoil.errors import ParameterError
from subsoil.layers import Layers, LayerState, Sample
from subsoil.penetrometer import profile

MEASURED, AT_LEAST, UNREACHED = LayerState
EVERY_25_MM = np.arange(1, 17) * 0.025
HERE = (10.0, 20.0)

pressures = st.floats(0.0, 6000.0)


def test_the_default_is_the_papers_eight_bands_of_5_cm_that_weigh_the_same() -> None:
    layers = Layers()
    assert len(layers) == 8
    np.testing.assert_allclose(layers.bottom_m - layers.top_m, 0.05)
    np.testing.assert_allclose(layers.centre_m, np.arange(8) * 0.05 + 0.025)
    assert layers.weights == (0.125,) * 8


def test_weights_are_scaled_to_sum_to_one() -> None:
    assert Layers((0.0, 0.1, 0.2), (3.0, 1.0)).weights == (0.75, 0.25)


@pytest.mark.parametrize(
    "weights", [(1.0,), (1.0, -1.0), (0.0, 0.0), (1.0, math.nan), (1.0, math.inf)]
)
def test_weights_that_make_no_mean_are_refused(weights: tuple[float, ...]) -> None:
    with pytest.raises(ParameterError, match="layer weights"):
        Layers((0.0, 0.1, 0.2), weights)


@pytest.mark.parametrize(
    ("edges", "message"),
    [
        ((), "at least two"),
        ((0.1,), "at least two"),
        ((0.0, math.nan), "finite"),
        ((-0.1, 0.1), "from the surface down"),
        ((0.0, 0.2, 0.1), "do not increase"),
        ((0.0, 0.1, 0.1), "do not increase"),
        ((0.0, 10.0, 20.0), "not centimetres"),
    ],
)
def test_edges_that_make_no_bands_are_refused(edges: tuple[float, ...], message: str) -> None:
    with pytest.raises(ParameterError, match=rf"layer edges: .*{message}"):
        Layers(edges)


def test_every_layer_has_its_own_name() -> None:
    assert Layers().names[3] == "0.15-0.20 m"
    assert Layers((0.0, 0.05 * 3, 0.1 + 0.2)).names == ("0.00-0.15 m", "0.15-0.30 m")
    fine = Layers(tuple(0.025 * k for k in range(9))).names
    assert fine[:2] == ("0.000-0.025 m", "0.025-0.050 m")
    assert len(set(fine)) == 8


def test_a_layers_value_is_the_mean_of_the_readings_below_its_top_down_to_its_bottom() -> None:
    kpa = np.arange(16.0) * 100
    sample = Layers().sample(profile(EVERY_25_MM, kpa), HERE, error_variance=4.0)
    np.testing.assert_allclose(sample.kpa, kpa.reshape(8, 2).mean(axis=1))
    assert (sample.state == MEASURED).all()
    assert (sample.at, sample.error_variance) == (HERE, 4.0)


@pytest.mark.parametrize(
    "depths",
    [
        np.arange(1, 17) * 0.0254,
        np.arange(1, 301) * 0.0015,
        np.arange(1, 5) * 0.107,
        np.array([0.004, 0.01, 0.033, 0.06, 0.11, 0.118, 0.2, 0.29, 0.31, 0.405]),
    ],
    ids=["inches", "1.5 mm", "coarse", "irregular"],
)
def test_a_reading_weighs_by_the_part_of_the_layer_it_stands_for(depths: np.ndarray) -> None:
    kpa = 6000.0 * depths
    fine = (np.arange(400_000) + 0.5) * 1e-6
    soil = kpa[np.searchsorted(depths, fine)]
    sample = Layers().sample(profile(depths, kpa), HERE)
    np.testing.assert_allclose(sample.kpa, soil.reshape(8, -1).mean(axis=1), rtol=1e-4)


def test_readings_in_inches_give_the_layers_of_the_soil_to_a_hundredth() -> None:
    depths = np.arange(1, 17) * 0.0254
    middle = 6000.0 * (depths - 0.0127)
    sample = Layers().sample(profile(depths, middle), HERE)
    np.testing.assert_allclose(sample.kpa, np.arange(150.0, 2251.0, 300.0), rtol=0.01)


def test_a_bound_of_uneven_readings_weighs_them_and_its_rest_by_metres() -> None:
    seen = profile([0.02, 0.03, 0.07], [100.0, 500.0, 2000.0], "force")
    sample = Layers((0.0, 0.1)).sample(seen, HERE)
    assert sample.state.tolist() == [AT_LEAST]
    assert sample.kpa[0] == pytest.approx(0.2 * 100 + 0.1 * 500 + (0.4 + 0.3) * 2000)


def test_a_push_that_only_touches_a_layer_knows_nothing_of_it() -> None:
    sample = Layers((0.0, 0.1, 0.11)).sample(profile([0.1 + 1e-12], [100.0], "force"), HERE)
    assert sample.state.tolist() == [MEASURED, UNREACHED]


def test_a_reading_at_the_very_surface_belongs_to_no_layer() -> None:
    seen = profile([0.0, 0.025, 0.05], [9999.0, 100.0, 300.0])
    assert Layers((0.0, 0.05)).sample(seen, HERE).kpa.tolist() == [200.0]


def test_a_push_that_ends_early_leaves_the_layers_below_unknown_not_zero() -> None:
    sample = Layers().sample(profile(EVERY_25_MM[:8], np.full(8, 500.0)), HERE)
    assert sample.state.tolist() == [MEASURED] * 4 + [UNREACHED] * 4
    assert np.isnan(sample.kpa[4:]).all()


def test_a_push_stopped_by_force_inside_a_layer_gives_a_lower_bound() -> None:
    layers = Layers((0.0, 0.1, 0.2, 0.3))
    seen = profile([0.05, 0.1, 0.15], [400.0, 600.0, 3000.0], "force")
    sample = layers.sample(seen, HERE)
    assert sample.state.tolist() == [MEASURED, AT_LEAST, UNREACHED]
    np.testing.assert_allclose(sample.kpa, [500.0, 3000.0, np.nan])
    np.testing.assert_allclose(sample.measured_kpa, [500.0, np.nan, np.nan])


def test_the_unreached_rest_of_a_bound_counts_with_the_last_reading() -> None:
    seen = profile([0.01, 0.02, 0.03, 0.04], [100.0, 200.0, 300.0, 1000.0], "force")
    sample = Layers((0.0, 0.1)).sample(seen, HERE)
    assert sample.state.tolist() == [AT_LEAST]
    assert sample.kpa[0] == pytest.approx(0.4 * 400.0 + 0.6 * 1000.0)


def test_a_push_that_ends_inside_a_layer_by_itself_says_nothing_of_that_layer() -> None:
    sample = Layers((0.0, 0.1)).sample(profile([0.02, 0.04], [100.0, 200.0]), HERE)
    assert sample.state.tolist() == [UNREACHED]


def test_half_a_step_short_of_the_bottom_still_measures_the_layer() -> None:
    layers = Layers((0.0, 0.1))
    near = profile([0.03, 0.06, 0.086], [100.0, 200.0, 300.0])
    short = profile([0.03, 0.06, 0.084], [100.0, 200.0, 300.0])
    assert layers.sample(near, HERE).state.tolist() == [MEASURED]
    assert layers.sample(short, HERE).state.tolist() == [UNREACHED]


def test_a_layer_between_two_readings_takes_the_lower_one_for_that_soil() -> None:
    seen = profile([0.1, 0.2, 0.3], [100.0, 200.0, 300.0])
    sample = Layers((0.0, 0.05, 0.1, 0.15, 0.2, 0.25)).sample(seen, HERE)
    assert sample.state.tolist() == [MEASURED] * 5
    np.testing.assert_allclose(sample.kpa, [100.0, 100.0, 200.0, 200.0, 300.0])


def test_a_push_without_a_reading_knows_no_layer() -> None:
    sample = Layers().sample(profile([], [], "force"), HERE)
    assert (sample.state == UNREACHED).all()
    assert np.isnan(sample.kpa).all()


@given(st.lists(pressures, min_size=1, max_size=16), st.sampled_from(["stroke", "force"]))
def test_a_value_lies_between_the_extremes_of_the_push_and_unknown_means_nan(
    kpa: list[float], ending: str
) -> None:
    seen = profile(EVERY_25_MM[: len(kpa)], kpa, "force" if ending == "force" else "stroke")
    sample = Layers().sample(seen, HERE)
    known = sample.state != UNREACHED
    assert (np.isnan(sample.kpa) == ~known).all()
    slack = 1e-9 * max(kpa)
    assert (sample.kpa[known] >= min(kpa) - slack).all()
    assert (sample.kpa[known] <= max(kpa) + slack).all()
    assert (np.diff(sample.state) >= 0).all(), "what is known ends once, going down"


@given(st.lists(pressures, min_size=16, max_size=16))
def test_the_thickness_weighted_mean_of_layers_is_the_mean_of_the_whole_push(
    kpa: list[float],
) -> None:
    edges = (0.0, 0.05, 0.2, 0.3, 0.4)
    layers = Layers(edges)
    whole = np.average(layers.sample(profile(EVERY_25_MM, kpa), HERE).kpa, weights=np.diff(edges))
    assert whole == pytest.approx(np.mean(kpa), rel=1e-9, abs=1e-9)


def test_a_sample_cannot_be_changed() -> None:
    sample = Sample(HERE, np.array([1.0]), np.array([MEASURED], dtype=np.int8))
    with pytest.raises(ValueError, match="read-only"):
        sample.kpa[0] = 2.0
