"""A push of the simulated rod says what the soil is, up to the limits of the machine."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from subsoil.errors import ParameterError
from subsoil.layers import Layers, LayerState
from subsoil.penetrometer import LARGE_CONE, SMALL_CONE
from subsoil.simulation import Machine, push
from subsoil.simulation.probe import mean_resistance

QUIET = Machine(SMALL_CONE, force_sd_n=0.0, stone_probability=0.0)
LAYERS = Layers()
SOIL = np.array([400.0, 800.0, 1200.0, 1500.0, 1600.0, 1700.0, 1800.0, 2000.0])

soils = st.lists(st.floats(0.0, 4000.0, width=32), min_size=8, max_size=8).map(np.array)


@given(soils)
def test_layer_means_of_a_quiet_push_are_the_soils(kpa: np.ndarray) -> None:
    insertion = push(QUIET, LAYERS, 0.9 * kpa, np.random.default_rng(0))
    if insertion.ending == "force":  # a steep rise may overshoot the layer's mean
        return
    sample = LAYERS.sample(insertion.profile(SMALL_CONE), (0.0, 0.0))
    assert sample.kpa == pytest.approx(0.9 * kpa, rel=1e-9, abs=1e-6)
    assert np.all(sample.state == LayerState.MEASURED)


@given(
    st.lists(
        st.tuples(st.floats(0.03, 0.2), st.floats(0.0, 4000.0, width=32)), min_size=1, max_size=6
    ),
    st.sampled_from([0.0, 0.01, 0.1]),
)
def test_resistance_keeps_the_mean_of_layers_of_any_thickness(
    bands: list[tuple[float, float]], top: float
) -> None:
    thickness, kpa = np.array(bands).T
    edges = top + np.concatenate([[0.0], np.cumsum(thickness)])
    layers = Layers(tuple(edges))
    depth = np.union1d(edges, np.linspace(0.0, edges[-1] + 0.1, 200))
    depth = depth[depth > 0]
    got = mean_resistance(layers, kpa, depth)
    step = np.diff(depth, prepend=0.0)
    assert got.min() >= -1e-6
    for k in range(len(kpa)):
        here = (depth > edges[k]) & (depth <= edges[k + 1])
        mean = np.sum(got[here] * step[here]) / thickness[k]
        assert mean == pytest.approx(kpa[k], rel=1e-6, abs=1e-4)


def test_unevenly_read_layers_are_recovered_within_one_percent() -> None:
    layers = Layers((0.0, 0.07, 0.18, 0.33))
    kpa = np.array([500.0, 1200.0, 1700.0])
    insertion = push(QUIET, layers, kpa, np.random.default_rng(0))
    sample = layers.sample(insertion.profile(SMALL_CONE), (0.0, 0.0))
    assert sample.kpa == pytest.approx(kpa, rel=0.01)


def test_below_the_last_layer_its_value_goes_on() -> None:
    depth = np.array([0.40, 0.499, 0.50])
    assert mean_resistance(LAYERS, np.full(8, 900.0), depth) == pytest.approx([900.0] * 3)


def test_a_push_is_300_readings_to_half_a_metre() -> None:
    insertion = push(QUIET, LAYERS, SOIL, np.random.default_rng(0))
    assert len(insertion.depth_m) == 300
    assert insertion.depth_m[-1] == 0.50
    assert insertion.ending == "stroke"


def test_600_n_on_the_large_cone_end_a_push_at_1858_kpa() -> None:
    machine = Machine(LARGE_CONE, force_sd_n=0.0, stone_probability=0.0)
    insertion = push(machine, LAYERS, SOIL, np.random.default_rng(0))
    profile = insertion.profile(LARGE_CONE)
    assert insertion.ending == "force"
    assert profile.kpa[-1] == pytest.approx(1858, abs=0.5)
    assert np.all(profile.kpa[:-1] < profile.kpa[-1])
    state = LAYERS.sample(profile, (0.0, 0.0)).state
    assert np.all(state[:6] == LayerState.MEASURED)
    assert state[6:].tolist() == [LayerState.AT_LEAST, LayerState.UNREACHED]


def test_a_stone_ends_the_push_within_millimetres() -> None:
    machine = Machine(SMALL_CONE, force_sd_n=0.0, stone_probability=1.0)
    ends = []
    for seed in range(50):
        stone_depth = np.random.default_rng(seed).random(2)[1] * machine.stroke_m
        insertion = push(machine, LAYERS, SOIL, np.random.default_rng(seed))
        if stone_depth > 0.49:
            continue
        assert insertion.ending == "force"
        assert insertion.force_n[-1] == machine.force_limit_n
        assert -1e-9 < insertion.depth_m[-1] - stone_depth < 0.006
        ends.append(insertion.depth_m[-1])
    assert np.ptp(ends) > 0.3


def test_the_load_cell_says_no_more_than_its_range_and_no_less_than_zero() -> None:
    machine = Machine(
        SMALL_CONE, force_limit_n=5000.0, load_cell_n=200.0, force_sd_n=20.0, stone_probability=0.0
    )
    soil = SOIL.copy()
    soil[0] = 0.0
    force = push(machine, LAYERS, soil, np.random.default_rng(0)).force_n
    assert force.max() == 200.0
    assert force.min() == 0.0


def test_force_readings_scatter_as_told() -> None:
    noisy = Machine(SMALL_CONE, force_sd_n=2.0, stone_probability=0.0)
    rng = np.random.default_rng(5)
    quiet = push(QUIET, LAYERS, SOIL, rng).force_n
    off = np.concatenate([push(noisy, LAYERS, SOIL, rng).force_n - quiet for _ in range(20)])
    assert np.std(off) == pytest.approx(2.0, abs=4 * 2.0 / np.sqrt(2 * off.size))


def test_a_machine_says_which_number_is_wrong() -> None:
    with pytest.raises(ParameterError, match="force_limit_n must be greater than zero, not -1"):
        Machine(SMALL_CONE, force_limit_n=-1.0)
    with pytest.raises(ParameterError, match="stone_probability must be between 0 and 1"):
        Machine(SMALL_CONE, stone_probability=1.5)
