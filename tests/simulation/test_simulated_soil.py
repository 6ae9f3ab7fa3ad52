"""The recipe of a random soil draws what it says and grows what was drawn."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import binom, kstest

from subsoil.errors import SingularSystemError
from subsoil.land.field import Field
from subsoil.layers import Layers
from subsoil.simulation.soil import FLOOR_KPA, Soil, draw_soil, floored, grow

DEPTH = Layers().centre_m
RECTANGLE = Field.from_metres([(0, 0), (180, 0), (180, 130), (0, 130)])
PLAIN = Soil("exponential", 40.0, 0.25, 0.15, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0)
SEEDS = 400
LEAST_P = 1e-4


@pytest.fixture(scope="module")
def drawn() -> list[Soil]:
    return [draw_soil(np.random.default_rng(seed)) for seed in range(SEEDS)]


@pytest.mark.parametrize(
    ("name", "low", "high"),
    [
        ("range_m", 20.0, 60.0),
        ("nugget_share", 0.10, 0.40),
        ("vertical_m", 0.08, 0.25),
        ("level", 0.8, 1.2),
        ("drift", 0.0, 1.0),
        ("drift_bearing", 0.0, 2 * np.pi),
        ("tramline_offset_m", 0.0, 24.0),
    ],
)
def test_drawn_parameters_are_uniform_over_their_range(
    drawn: list[Soil], name: str, low: float, high: float
) -> None:
    values = np.array([getattr(soil, name) for soil in drawn])
    assert low <= values.min() <= values.max() <= high
    assert kstest(values, "uniform", (low, high - low)).pvalue > LEAST_P


@pytest.mark.parametrize(
    ("name", "share", "low"), [("headland", 0.5, 0.5), ("tramlines", 0.3, 0.5)]
)
def test_headlands_and_tramlines_come_as_often_as_they_should(
    drawn: list[Soil], name: str, share: float, low: float
) -> None:
    values = np.array([getattr(soil, name) for soil in drawn])
    assert (
        binom.ppf(LEAST_P, SEEDS, share) <= (values > 0).sum() <= binom.isf(LEAST_P, SEEDS, share)
    )
    present = values[values > 0]
    high = {"headland": 1.5, "tramlines": 1.0}[name]
    assert kstest(present, "uniform", (low, high - low)).pvalue > LEAST_P


def test_every_model_is_drawn_a_third_of_the_time(drawn: list[Soil]) -> None:
    names, counts = np.unique([soil.model for soil in drawn], return_counts=True)
    assert names.tolist() == ["exponential", "matern-3/2", "spherical"]
    assert np.all(binom.ppf(LEAST_P, SEEDS, 1 / 3) <= counts)


def test_layer_means_rise_from_a_soft_surface_to_2_mpa() -> None:
    assert PLAIN.mean_kpa(np.array([0.0, 0.375])) == pytest.approx([250.0, 2066.67], abs=0.01)
    assert PLAIN.sd_kpa(np.array([0.0])) == pytest.approx([95.0])


@pytest.mark.parametrize("model", ["exponential", "spherical", "matern-3/2"])
def test_deviations_correlate_along_the_ground_and_down_as_drawn(model: str) -> None:
    soil, pairs, lag = replace(PLAIN, model=model), 600, 12.0
    west = np.column_stack([np.arange(pairs) * 1000.0, np.zeros(pairs)])
    at = np.concatenate([west, west + np.array([lag, 0.0])])
    kpa, noise = grow(soil, RECTANGLE, at, DEPTH, np.random.default_rng(3))
    z = (kpa - soil.mean_kpa(DEPTH)[:, None]) / soil.sd_kpa(DEPTH)[:, None]
    e = noise / soil.sd_kpa(DEPTH)[:, None]

    def bound(rho: float, n: int) -> float:
        """Four standard errors of a mean product of n pairs of unit normals."""
        return 4.0 * float(np.sqrt((1.0 + rho * rho) / n))

    rho = 1.0 - float(soil.variogram().rise(np.array(lag)))
    for layer in range(len(DEPTH)):
        assert np.mean(z[layer] ** 2) == pytest.approx(1.0, abs=bound(1.0, pairs))
        together = np.mean(z[layer, :pairs] * z[layer, pairs:])
        assert together == pytest.approx(rho, abs=bound(rho, pairs))
    nugget = 0.25 / 0.75
    assert soil.variogram().nugget == pytest.approx(nugget)
    for step in (1, 2, 5):
        down = float(np.exp(-0.05 * step / soil.vertical_m))
        assert np.mean(z[0] * z[step]) == pytest.approx(down, abs=bound(down, pairs))
        shared = np.mean(e[0] * e[step]) / nugget
        assert shared == pytest.approx(0.5 * down, abs=bound(0.5 * down, 2 * pairs))
    assert np.mean(e[2] ** 2) == pytest.approx(nugget, abs=nugget * bound(1.0, 2 * pairs))
    assert np.mean(e[2, :pairs] * e[2, pairs:]) == pytest.approx(
        0.0, abs=nugget * bound(0.0, pairs)
    )
    assert np.mean(e[2] * z[2]) == pytest.approx(0.0, abs=bound(0.0, pairs))


def _added(field: Field, **features: float) -> np.ndarray:
    """(m, N) what features add to the plain soil of a field, in layer SDs."""
    grown = [
        grow(soil, field, field.cells, DEPTH, np.random.default_rng(0))[0]
        for soil in (PLAIN, replace(PLAIN, **features))  # type: ignore[arg-type]
    ]
    return np.asarray((grown[1] - grown[0]) / PLAIN.sd_kpa(DEPTH)[:, None])


def test_the_headland_is_the_outer_12_m_and_hardest_at_22_cm() -> None:
    added = _added(RECTANGLE, headland=1.0)
    x, y = RECTANGLE.cells.T
    outer = np.minimum.reduce([x, 180 - x, y, 130 - y]) < 12
    assert np.all(np.abs(added[:, ~outer]) < 1e-9)
    assert added[4, outer] == pytest.approx(np.exp(-0.5 * 0.05**2))
    assert np.argmax(added[:, 0]) == 4


def test_the_drift_crosses_the_field_and_fades_with_depth() -> None:
    added = _added(RECTANGLE, drift=1.0)
    east = (RECTANGLE.cells[:, 0] - 90) / 90
    assert added[0] == pytest.approx(east)
    assert added[-1] == pytest.approx(0.5 * east)


@pytest.mark.parametrize("turn", [0.0, 0.4, 2.9])
def test_tramlines_run_along_the_long_side_and_cover_an_eighth(turn: float) -> None:
    turned = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    outline = np.array([(0, 0), (144, 0), (144, 72), (0, 72)]) @ turned
    field = Field.from_metres(outline, cell_size=3.0)
    hit = _added(field, tramlines=1.0, tramline_offset_m=5.0)[4] > 0.5
    across = field.cells @ turned[1]
    assert hit.mean() == pytest.approx(1 / 8, abs=0.02)
    lines = np.unique(across[hit] // 1.5)
    assert len(lines) <= 3 * 3


def test_deviations_are_cut_where_they_would_leave_no_resistance() -> None:
    kpa, noise = floored(np.array([[-50.0, 100.0, 300.0]]), np.array([[10.0, -150.0, -40.0]]))
    assert kpa.tolist() == [[FLOOR_KPA, 100.0, 300.0]]
    assert (kpa + noise).tolist() == [[FLOOR_KPA + 10.0, FLOOR_KPA, 260.0]]


def test_places_too_close_together_are_an_error_and_not_a_jitter() -> None:
    at = np.array([(10.0, 10.0), (10.0, 10.0)])
    with pytest.raises(SingularSystemError, match="larger cells"):
        grow(PLAIN, RECTANGLE, at, DEPTH, np.random.default_rng(0))
