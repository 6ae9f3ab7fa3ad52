"""Conditional simulations are soils that readings allow: right on average, and as rough as told."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2, norm

from subsoil.arrays import Floats
from subsoil.datasets import riseholme
from subsoil.errors import ReadingsError, SingularSystemError
from subsoil.kriging import condition
from subsoil.land.field import Field
from subsoil.layers import Layers
from subsoil.simulation import Conditioned, Truth, conditional_truth
from subsoil.simulation.soil import FLOOR_KPA
from subsoil.variogram import Estimator, Fit, LeastSquares, Spherical
from subsoil.variogram.models import Bounded, BoundedLinear

FIELD = Field.from_metres([(0, 0), (40, 0), (40, 30), (0, 30)])
LAYERS = Layers((0.0, 0.2, 0.4))
MODELS = (Spherical(400.0, 30.0, 3600.0), Spherical(900.0, 30.0, 8100.0))
"""In proportion, so that the layers' kriging weights are the same."""
DRAWS, ALPHA = 400, 1e-5


def readings() -> tuple[Floats, Floats]:
    """Twenty places, four of them cell centres and two the same, and two layers there."""
    rng = np.random.default_rng(8)
    at = np.vstack([FIELD.cells[[3, 20, 33, 46]], rng.uniform((0, 0), (40, 30), (15, 2))])
    at = np.vstack([at, at[-1]])
    common = rng.normal(0, 1, len(at))
    own = rng.normal(0, 1, (2, len(at)))
    return at, np.array([[2000.0], [4000.0]]) + [[60.0], [90.0]] * (common + own)


def told(*models: Bounded) -> Estimator:
    """Estimator that knows the variograms."""
    fit = LeastSquares(Spherical)

    def estimate(at: Floats, z: Floats) -> tuple[Fit, ...]:
        return tuple(replace(f, variogram=m) for f, m in zip(fit(at, z), models, strict=True))

    return estimate


def drawn(seed: int, *models: Bounded) -> Truth:
    at, kpa = readings()
    return conditional_truth(
        FIELD, at, kpa, LAYERS, np.random.default_rng(seed), estimator=told(*models)
    )


@pytest.fixture(scope="module")
def soils() -> list[Truth]:
    return [drawn(seed, *MODELS) for seed in range(DRAWS)]


def test_their_mean_and_spread_are_the_kriged_map_and_its_variance(soils: list[Truth]) -> None:
    """Deviations from the kriged map are normal with the kriging variance."""
    at, kpa = readings()
    off = np.array([soil.kpa for soil in soils])
    each = ALPHA / off[0].size
    for k, model in enumerate(MODELS):
        mean, variance = condition(model, at, kpa[k]).predict(FIELD.cells)
        z = (off[:, k] - mean) / np.sqrt(variance)
        assert np.abs(z.mean(axis=0)).max() <= norm.isf(each / 2) / np.sqrt(DRAWS)
        squares = (z**2).sum(axis=0)
        assert squares.min() >= chi2.ppf(each / 2, DRAWS)
        assert squares.max() <= chi2.isf(each / 2, DRAWS)


def test_soil_and_pushes_go_together_between_layers_as_readings_do(soils: list[Truth]) -> None:
    at, kpa = readings()
    r = float(np.asarray(np.corrcoef(kpa))[0, 1])
    assert 0.2 < r < 0.8
    origin = soils[0].origin
    assert isinstance(origin, Conditioned)
    assert origin.correlation == pytest.approx(np.corrcoef(kpa))
    pushes = np.array([soil.noise for soil in soils]) / np.sqrt([[m.nugget] for m in MODELS])
    maps = [condition(m, at, z).predict(FIELD.cells) for m, z in zip(MODELS, kpa, strict=True)]
    mean = np.array([mean for mean, _ in maps])
    sd = np.sqrt([variance for _, variance in maps])
    soil = (np.array([soil.kpa for soil in soils]) - mean) / sd
    # A mean of products of two normal values with correlation r; cells of one soil go together.
    for values, independent in ((pushes, pushes[:, 0].size), (soil, DRAWS)):
        product = float((values[:, 0] * values[:, 1]).mean())
        assert product == pytest.approx(r, abs=4.5 * np.sqrt((1 + r * r) / independent))


def test_pushes_scatter_by_the_nugget_and_know_nothing_of_each_other(soils: list[Truth]) -> None:
    pushes = np.array([soil.noise for soil in soils])
    for layer, model in zip(pushes.transpose(1, 0, 2), MODELS, strict=True):
        share = float((layer**2).mean()) / model.nugget
        assert share == pytest.approx(1.0, abs=4.5 * np.sqrt(2 / layer.size))
        beside = float((layer[:, 1:] * layer[:, :-1]).mean()) / model.nugget
        assert beside == pytest.approx(0.0, abs=4.5 / np.sqrt(layer.size))


def test_a_reading_without_nugget_is_met_and_pushes_do_not_scatter() -> None:
    at, kpa = readings()
    soil = drawn(1, Spherical(0.0, 30.0, 3600.0), Spherical(0.0, 50.0, 8100.0))
    cells = [FIELD.nearest_cell(place) for place in at[:4]]
    assert np.array_equal(FIELD.cells[cells], at[:4])
    assert soil.kpa[:, cells] == pytest.approx(kpa[:, :4], abs=1e-6)
    assert not soil.noise.any()


def test_a_layer_of_nugget_only_is_its_mean_and_pushes_around_it() -> None:
    _, kpa = readings()
    soil = drawn(2, Spherical(3600.0, 30.0, 0.0), MODELS[1])
    assert np.ptp(soil.kpa[0]) < 1e-6
    assert soil.kpa[0, 0] == pytest.approx(kpa[0].mean(), abs=4.5 * 60.0 / np.sqrt(20))
    assert soil.noise[0].std() == pytest.approx(60.0, rel=0.5)


def test_the_same_seed_gives_the_same_soil_and_another_another() -> None:
    one, same, other = drawn(3, *MODELS), drawn(3, *MODELS), drawn(4, *MODELS)
    assert np.array_equal(one.kpa, same.kpa)
    assert np.array_equal(one.noise, same.noise)
    assert not np.isclose(one.kpa, other.kpa).any()


def test_layers_are_conditioned_on_the_readings_that_reached_them() -> None:
    at, kpa = readings()
    kpa[1, [0, 5]] = np.nan
    estimator = told(Spherical(0.0, 30.0, 3600.0), Spherical(0.0, 30.0, 8100.0))
    soil = conditional_truth(FIELD, at, kpa, LAYERS, np.random.default_rng(1), estimator=estimator)
    assert isinstance(soil.origin, Conditioned)
    assert soil.origin.readings == (20, 18)
    whole = ~np.isnan(kpa[1])
    assert soil.origin.correlation == pytest.approx(np.corrcoef(kpa[:, whole]))
    cells = [FIELD.nearest_cell(place) for place in at[:4]]
    assert soil.kpa[0, cells] == pytest.approx(kpa[0, :4], abs=1e-6)
    assert soil.kpa[1, cells[1:]] == pytest.approx(kpa[1, 1:4], abs=1e-6)
    assert abs(soil.kpa[1, cells[0]] - 4000.0) > 1.0


def test_soil_softer_than_soil_is_floored_and_counted() -> None:
    at, kpa = readings()
    kpa[0] -= 1900.0
    estimator = told(*MODELS)
    soil = conditional_truth(FIELD, at, kpa, LAYERS, np.random.default_rng(1), estimator=estimator)
    assert min(soil.kpa.min(), (soil.kpa + soil.noise).min() + 1e-9) >= FLOOR_KPA
    assert isinstance(soil.origin, Conditioned)
    (note,) = soil.origin.notes
    floored = int((soil.kpa[0] == FLOOR_KPA).sum())
    assert floored > 0
    assert note.startswith(f"0.00-0.20 m: simulated below 20 kPa in {floored} and pushed below it")


def test_what_cannot_be_simulated_is_refused_by_layer() -> None:
    at, kpa = readings()
    with pytest.raises(SingularSystemError, match=r"layer 0\.00-0\.20 m: BoundedLinear"):
        drawn(1, BoundedLinear(0.0, 30.0, 3600.0), MODELS[1])
    rng = np.random.default_rng(1)
    with pytest.raises(ReadingsError, match="do not fit 2 layers"):
        conditional_truth(FIELD, at, kpa[:1], LAYERS, rng)
    apart = kpa.copy()
    apart[0, :9], apart[1, 9:18] = np.nan, np.nan
    with pytest.raises(ReadingsError, match="2 readings reached all layers"):
        conditional_truth(FIELD, at, apart, LAYERS, rng, estimator=told(*MODELS))
    same = kpa.copy()
    same[0, :6], same[1, 6:] = np.nan, 900.0
    with pytest.raises(ReadingsError, match=r"layer 0\.20-0\.40 m: all readings are the same"):
        conditional_truth(FIELD, at, same, LAYERS, rng, estimator=told(*MODELS))
    few = kpa.copy()
    few[1, 3:] = np.nan
    with pytest.raises(ReadingsError, match=r"layer 0\.20-0\.40 m.*3 samples only"):
        conditional_truth(FIELD, at, few, LAYERS, rng)


@pytest.mark.usefixtures("real_data")
def test_riseholme_can_be_drawn_as_rough_as_it_was_read() -> None:
    survey, layers = riseholme(), Layers()
    kpa = survey.readings.layer_means(layers)
    soils = [
        conditional_truth(survey.half_field, survey.readings.at, kpa, layers, rng)
        for rng in map(np.random.default_rng, range(3))
    ]
    pushes = np.mean([(soil.kpa + soil.noise).std(axis=1) for soil in soils], axis=0)
    assert soils[0].kpa.shape == (8, 935)
    assert pushes[1:] == pytest.approx(np.nanstd(kpa, axis=1)[1:], rel=0.25)
