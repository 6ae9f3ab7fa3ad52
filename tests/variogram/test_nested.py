"""A nested model is the sum of its structures, for every use that is made of a model."""

from __future__ import annotations

from math import inf, nan

import numpy as np
import pytest
from numpy.testing import assert_allclose

from subsoil.arrays import Floats
from subsoil.errors import ParameterError
from subsoil.kriging import condition
from subsoil.land.field import Field
from subsoil.layers import Layers, LayerState, Sample
from subsoil.mapping.soilmap import SoilMap
from subsoil.survey.events import Fitted, from_json, to_json
from subsoil.survey.records import FitRecord, model_record
from subsoil.variogram import (
    Bounded,
    Exponential,
    Gaussian,
    Matern32,
    Nested,
    Spherical,
    Structure,
    name_of,
    semivariance,
)
from subsoil.variogram.nested import without_traces

TERMS = (
    Structure(0.35, Exponential, 40.0),
    Structure(0.3, Matern32, 90.0),
    Structure(0.15, Gaussian, 25.0),
)
MODEL = Nested(400.0, TERMS)
PARTS: tuple[Bounded, ...] = tuple(s.kind(0.0, s.range, 400.0 * s.share) for s in TERMS)
NUGGET = 400.0 * 0.2
LAYERS = Layers((0.0, 0.1, 0.2, 0.4))


def lagged(a: Floats, b: Floats) -> Floats:
    return np.asarray(np.hypot(*(a[:, None] - b[None]).transpose(2, 0, 1)))


def by_hand(at: Floats, z: Floats, targets: Floats, scale: float = 1.0) -> tuple[Floats, Floats]:
    """Ordinary kriging of the signal by the textbook's system, rises summed by hand."""

    def covariance(a: Floats, b: Floats) -> Floats:
        total = np.zeros((len(a), len(b)))
        for part in PARTS:
            total += scale * (part.psill - part.rise(lagged(a, b)))
        return total

    n = len(at)
    system = np.ones((n + 1, n + 1))
    system[:n, :n] = covariance(at, at) + scale * NUGGET * np.eye(n)
    system[n, n] = 0.0
    right = np.vstack([covariance(at, targets), np.ones(len(targets))])
    weights = np.linalg.solve(system, right)
    return z @ weights[:n], scale * 320.0 - (weights * right).sum(axis=0)


def scene(seed: int, n: int = 30) -> tuple[Floats, Floats, Floats]:
    rng = np.random.default_rng(seed)
    return rng.uniform(0, 150, (n, 2)), rng.normal(900, 20, (3, n)), rng.uniform(0, 150, (40, 2))


def test_it_rises_as_the_sum_of_its_structures() -> None:
    lag = np.linspace(0.0, 300.0, 50)
    assert_allclose(MODEL.rise(lag), sum(part.rise(lag) for part in PARTS), atol=1e-10)
    assert_allclose(
        semivariance(MODEL, lag[1:]), NUGGET + sum(part.rise(lag[1:]) for part in PARTS)
    )
    assert_allclose((MODEL.nugget, MODEL.psill, MODEL.sill), (80.0, 320.0, 400.0))


def test_kriging_with_it_is_kriging_with_rises_summed_by_hand() -> None:
    at, z, targets = scene(1)
    found = condition(MODEL, at, z[0]).predict(targets)
    mean, variance = by_hand(at, z[0], targets)
    assert_allclose(found.mean, mean, rtol=1e-9)
    assert_allclose(found.variance, variance, rtol=1e-9)


def test_one_structure_is_the_bounded_model() -> None:
    at, z, targets = scene(2)
    nested = Nested(500.0, (Structure(0.9, Spherical, 60.0),))
    found, bounded = (
        condition(model, at, z).predict(targets) for model in (nested, Spherical(50.0, 60.0, 450.0))
    )
    assert_allclose(found.mean, bounded.mean, rtol=1e-10)
    assert_allclose(found.variance, bounded.variance, rtol=1e-10)
    assert_allclose(nested.range, Spherical(0.0, 60.0, 1.0).range, rtol=0.2)


def test_its_range_is_where_95_percent_of_the_rise_is_made() -> None:
    assert_allclose(MODEL.rise(np.array(MODEL.range)), 0.95 * MODEL.psill, rtol=1e-6)
    assert Nested(10.0, ()).range == 0.0
    assert_allclose(Nested(1.0, (Structure(1.0, Exponential, 70.0),)).range, 70.0, rtol=0.01)


@pytest.mark.parametrize(
    ("sill", "terms"),
    [
        (-1.0, ()),
        (nan, ()),
        (inf, ()),
        (1.0, (Structure(-0.1, Exponential, 9.0),)),
        (1.0, (Structure(0.5, Exponential, 0.0),)),
        (1.0, (Structure(0.5, Exponential, inf),)),
        (1.0, (Structure(nan, Exponential, 9.0),)),
        (1.0, (Structure(0.6, Exponential, 9.0), Structure(0.5, Gaussian, 9.0))),
    ],
)
def test_a_model_that_cannot_be_is_refused(sill: float, terms: tuple[Structure, ...]) -> None:
    with pytest.raises(ParameterError, match="nested variogram"):
        Nested(sill, terms)


def test_traces_are_left_out_and_the_nugget_stays() -> None:
    kept = without_traces([*TERMS, Structure(1e-5, Exponential, 9.0)], 1e-3)
    assert len(kept) == 3
    assert_allclose(sum(s.share for s in kept), 0.8 + 1e-5, rtol=1e-12)
    assert without_traces([], 1e-3) == ()


@pytest.mark.parametrize("model", [MODEL, Nested(0.1 + 0.2, TERMS[:1]), Nested(5.0, ())])
def test_the_journal_keeps_it_bit_for_bit(model: Nested) -> None:
    event = Fitted(id="a", samples=3, fits=(FitRecord(model=model_record(model), why="so"),))
    again = from_json(to_json(event))
    assert isinstance(again, Fitted)
    assert again.fits[0].model.variogram == model


def test_it_has_a_name_for_people() -> None:
    assert (name_of(MODEL), name_of(Spherical(0.0, 1.0, 1.0))) == ("nested", "spherical")


# Maps of layers that share a shape.


LAND = Field.from_metres([(0, 0), (150, 0), (150, 150), (0, 150)], cell_size=25.0)


def mapped(seed: int, sills: tuple[float, ...] = (90.0, 400.0, 7.0)) -> SoilMap:
    """Map of thirty samples, every third of which ended above the last layer."""
    at, z, _ = scene(seed)
    samples = []
    for k, (place, full) in enumerate(zip(at.tolist(), z.T, strict=True)):
        state, kpa = np.zeros(3, dtype=np.int8), full
        if k % 3 == 2:
            state[2] = LayerState.UNREACHED
            kpa = np.where(state == LayerState.UNREACHED, np.nan, full)
        samples.append(Sample(tuple(place), kpa, state))
    models = tuple(MODEL.with_sill(sill) for sill in sills)
    return SoilMap(LAND, LAYERS, models, tuple(samples))


def test_layers_of_one_shape_are_kriged_as_each_with_its_own_model() -> None:
    soil_map = mapped(3)
    for k, model in enumerate(soil_map.variograms):
        reached = np.isfinite(soil_map.kpa[k])
        at, z = soil_map.at[reached], soil_map.kpa[k, reached]
        mean, variance = by_hand(at, z, soil_map.cells, model.sill / 400.0)
        assert_allclose(soil_map.mean[k], mean, rtol=1e-9)
        assert_allclose(soil_map.variance[k], variance, rtol=1e-9)


def test_a_map_of_one_shape_grows_by_samples_and_equals_one_made_anew() -> None:
    whole = mapped(4)
    grown = SoilMap(whole.field, LAYERS, whole.variograms, whole.samples[:5])
    for sample in whole.samples[5:]:
        _ = grown.kv
        grown = grown.append(sample)
    assert_allclose(grown.mean, whole.mean, rtol=1e-9)
    assert_allclose(grown.variance, whole.variance, rtol=1e-9)
    candidates = [0, 11]
    assert_allclose(grown.kv_drop(candidates), whole.kv_drop(candidates), rtol=1e-7, atol=1e-9)


def test_the_fall_of_kv_is_in_the_layers_units() -> None:
    soil_map = mapped(5)
    (drop,) = soil_map.kv_drop([7])
    x, y = soil_map.cells[7].tolist()
    after = soil_map.append(Sample((x, y), np.zeros(3), np.zeros(3, dtype=np.int8)))
    assert_allclose(drop, soil_map.kv - after.kv, rtol=1e-6, atol=1e-9)


def test_errors_of_samples_are_in_units_of_the_data_whatever_the_sills() -> None:
    soil_map = mapped(6)
    noisy = tuple(Sample(s.at, s.kpa, s.state, 25.0) for s in soil_map.samples)
    found = SoilMap(soil_map.field, LAYERS, soil_map.variograms, noisy)
    for k, model in enumerate(soil_map.variograms):
        reached = np.isfinite(soil_map.kpa[k])
        ok = condition(model, soil_map.at[reached], soil_map.kpa[k, reached], error_variance=25.0)
        mean, variance = ok.predict(soil_map.cells)
        assert_allclose(found.mean[k], mean, rtol=1e-9)
        assert_allclose(found.variance[k], variance, rtol=1e-9)


def test_the_order_of_samples_does_not_matter() -> None:
    soil_map = mapped(7)
    turned = SoilMap(soil_map.field, LAYERS, soil_map.variograms, soil_map.samples[::-1])
    assert_allclose(soil_map.mean, turned.mean, rtol=1e-9)
    assert_allclose(soil_map.variance, turned.variance, rtol=1e-8)
