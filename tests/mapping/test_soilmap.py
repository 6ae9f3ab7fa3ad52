"""The soil map equals kriging every layer from scratch with the samples that reached it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from subsoil.arrays import Floats
from subsoil.errors import ParameterError
from subsoil.land.field import Field
from subsoil.layers import Layers, LayerState, Sample
from subsoil.mapping.soilmap import SoilMap
from subsoil.variogram import (
    Bounded,
    BoundedLinear,
    Circular,
    Exponential,
    Spherical,
    Variogram,
    paper_10,
    semivariance,
)

MEASURED, AT_LEAST, UNREACHED = LayerState.MEASURED, LayerState.AT_LEAST, LayerState.UNREACHED
LAYERS = Layers((0.0, 0.1, 0.2, 0.4), (1.0, 2.0, 1.0))
MODELS: tuple[Bounded, ...] = (
    Spherical(50.0, 60.0, 950.0),
    Exponential(200.0, 40.0, 1800.0),
    Spherical(0.0, 35.0, 4000.0),
)
FIELD = Field.from_metres([(0, 0), (60, 0), (60, 50), (0, 50)], cell_size=10.0)
CELLS = FIELD.cells
DEPTHS = {
    "all": (MEASURED, MEASURED, MEASURED),
    "two": (MEASURED, MEASURED, AT_LEAST),
    "one": (MEASURED, AT_LEAST, UNREACHED),
    "none": (AT_LEAST, UNREACHED, UNREACHED),
}


def sample(cell: int, depth: str = "all", error: float = 0.0, aside: float = 0.0) -> Sample:
    """Sample near a cell that is told by the cell's number, down to some depth."""
    x, y = CELLS[cell]
    state = np.array(DEPTHS[depth], dtype=np.int8)
    kpa = np.array([300.0, 900.0, 1500.0]) + 40.0 * np.sin(cell + np.arange(3.0))
    kpa = np.where(state == UNREACHED, np.nan, kpa)
    return Sample((x + aside, y - aside), kpa, state, error)


def mapped(*samples: Sample, models: tuple[Variogram, ...] = MODELS) -> SoilMap:
    return SoilMap(FIELD, LAYERS, models, samples)


def kriged(layer: int, samples: tuple[Sample, ...]) -> tuple[Floats, Floats]:
    """Mean and variance of a layer's signal by the textbook's system with a Lagrange multiplier."""
    used = [s for s in samples if s.state[layer] == MEASURED]
    at, z = np.array([s.at for s in used]), np.array([s.kpa[layer] for s in used])
    model, n = MODELS[layer], len(used)

    def covariance(a: Floats, b: Floats) -> Floats:
        lag = np.hypot(*(a[:, None] - b[None]).transpose(2, 0, 1))
        rise = semivariance(model, np.maximum(lag, 1e-12)) - model.nugget
        return np.asarray(model.sill - model.nugget - rise)

    system = np.ones((n + 1, n + 1))
    error = np.array([s.error_variance for s in used])
    system[:n, :n] = covariance(at, at) + np.diag(model.nugget + error)
    system[n, n] = 0.0
    right = np.vstack([covariance(at, CELLS), np.ones(len(CELLS))])
    weights = np.linalg.solve(system, right)
    signal = model.sill - model.nugget
    return z @ weights[:n], signal - (weights * right).sum(axis=0)


readings = st.lists(
    st.tuples(st.integers(0, 29), st.sampled_from(list(DEPTHS)), st.sampled_from([0.0, 30.0])),
    min_size=1,
    max_size=7,
    unique_by=lambda reading: reading[0],
).map(lambda found: tuple(sample(cell, depth, error, aside=1.0) for cell, depth, error in found))


@given(readings)
@settings(max_examples=60, deadline=None)
def test_each_layer_is_kriged_from_the_samples_that_went_through_it(
    samples: tuple[Sample, ...],
) -> None:
    soil_map = mapped(*samples)
    for layer in range(3):
        if any(s.state[layer] == MEASURED for s in samples):
            mean, variance = kriged(layer, samples)
            assert soil_map.mean[layer] == pytest.approx(mean, rel=1e-9)
            assert soil_map.variance[layer] == pytest.approx(variance, rel=1e-6, abs=1e-6)
        else:
            assert np.isnan(soil_map.mean[layer]).all()
            assert np.isnan(soil_map.variance[layer]).all()


def same(one: SoilMap, other: SoilMap) -> None:
    for a, b in ((one.mean, other.mean), (one.variance, other.variance), (one.kv, other.kv)):
        assert np.allclose(a, b, rtol=1e-9, atol=1e-7, equal_nan=True)
    assert one.notes == other.notes


@given(readings, st.data())
@settings(max_examples=80, deadline=None)
def test_appending_equals_starting_again_whenever_results_were_asked_for(
    samples: tuple[Sample, ...], data: st.DataObject
) -> None:
    grown = mapped()
    for k, one in enumerate(samples):
        grown = grown.append(one)
        if data.draw(st.booleans()):
            same(grown, mapped(*samples[: k + 1]))
    same(grown, mapped(*samples))


@given(readings, st.randoms(use_true_random=False))
@settings(max_examples=40, deadline=None)
def test_the_order_of_samples_does_not_matter(
    samples: tuple[Sample, ...],
    chance: np.random.Generator,
) -> None:
    shuffled = list(samples)
    chance.shuffle(shuffled)
    same(mapped(*samples), mapped(*shuffled))


def test_two_maps_may_grow_from_one() -> None:
    stem = mapped(sample(0), sample(17))
    assert stem.field_kv > 0
    one, other = stem.append(sample(5)), stem.append(sample(29, "two"))
    same(one, mapped(sample(0), sample(17), sample(5)))
    same(other, mapped(sample(0), sample(17), sample(29, "two")))
    same(stem, mapped(sample(0), sample(17)))


def test_a_sample_at_a_place_already_sampled_is_averaged_with_it() -> None:
    stem = mapped(sample(0), sample(17))
    assert stem.field_kv > 0
    again = replace(sample(17), kpa=np.array([500.0, 500.0, 500.0]))
    same(stem.append(again), mapped(sample(0), sample(17), again))
    assert stem.append(again).field_kv < stem.field_kv


def test_a_map_with_other_samples_or_cells_knows_nothing_of_what_was_kriged() -> None:
    stem = mapped(sample(0), sample(17))
    assert stem.field_kv > 0
    grown = stem.append(sample(5))
    others = (sample(3), sample(4), sample(9))
    same(replace(grown, samples=others), mapped(*others))
    fewer = replace(grown, subset=(0, 1, 2, 3))
    assert fewer.kv == pytest.approx(grown.kv[:4])


def test_lower_bounds_are_not_used() -> None:
    low = sample(9, "two")
    high = replace(low, kpa=np.array([*low.kpa[:2], 9000.0]))
    same(mapped(sample(0), low), mapped(sample(0), high))


def test_a_map_without_samples_knows_nothing() -> None:
    empty = mapped()
    assert empty.stacks == ()
    assert np.isnan(empty.mean).all()
    assert np.isnan(empty.variance).all()
    assert np.isnan(empty.kv).all()
    assert np.isnan(empty.profile_mean).all()
    assert np.isnan(empty.field_kv)
    assert empty.kpa.shape == (3, 0)
    assert empty.at.shape == (0, 2)
    assert empty.notes == ()
    assert SoilMap(FIELD, LAYERS).notes == ()


def test_samples_without_a_variogram_a_layer_are_refused() -> None:
    with pytest.raises(ParameterError, match="2 variograms for 3 layers"):
        SoilMap(FIELD, LAYERS, MODELS[:2], (sample(0),))


def test_one_sample_is_the_mean_everywhere() -> None:
    soil_map = mapped(sample(8))
    assert soil_map.mean == pytest.approx(np.broadcast_to(soil_map.kpa, soil_map.mean.shape))


def test_kv_is_the_weighted_mean_over_the_layers_that_a_sample_reached() -> None:
    soil_map = mapped(sample(0), sample(20))
    assert soil_map.kv == pytest.approx(np.array([0.25, 0.5, 0.25]) @ soil_map.variance)
    assert soil_map.profile_mean == pytest.approx(np.array([0.25, 0.5, 0.25]) @ soil_map.mean)
    assert soil_map.field_kv == pytest.approx(soil_map.kv.mean())
    shallow = mapped(sample(0, "two"), sample(20, "two"))
    assert shallow.kv == pytest.approx((shallow.variance[0] + 2 * shallow.variance[1]) / 3)


def test_where_no_layer_that_counts_was_reached_there_is_no_kv() -> None:
    deep = Layers(LAYERS.edges_m, (0.0, 0.0, 1.0))
    soil_map = SoilMap(FIELD, deep, MODELS, (sample(0, "two"), sample(3, "two")))
    assert np.isfinite(soil_map.mean[:2]).all()
    assert np.isnan(soil_map.kv).all()
    assert (soil_map.kv_drop([4]) == 0).all()


@pytest.mark.parametrize("samples", [("all",), ("all", "all", "two"), ("one", "two", "all", "all")])
def test_the_drop_of_kv_is_what_the_next_sample_brings(samples: tuple[str, ...]) -> None:
    soil_map = mapped(*(sample(7 * k, depth, aside=1.5) for k, depth in enumerate(samples)))
    candidates = [3, 11, 24]
    drop = soil_map.kv_drop(candidates)
    assert drop.shape == (3, len(CELLS))
    for k, cell in enumerate(candidates):
        fall = soil_map.kv - soil_map.append(sample(cell)).kv
        assert drop[k] == pytest.approx(fall, rel=1e-8, abs=1e-7)
        assert drop[k, cell] == drop[k].max() > 0


def test_error_variance_counts_like_a_nugget_of_that_sample() -> None:
    exact, rough = (mapped(sample(0), sample(20, error=error)) for error in (0.0, 400.0))
    assert (rough.kv > exact.kv).all()
    noisier = tuple(replace(m, nugget=m.nugget + 400.0) for m in MODELS)
    both = mapped(sample(0, error=400.0), sample(20, error=400.0))
    same(both, mapped(sample(0), sample(20), models=noisier))


def test_a_refit_krige_anew_and_leaves_the_old_map_alone() -> None:
    soil_map = mapped(sample(0), sample(20), sample(29))
    before = soil_map.kv.copy()
    wider = tuple(replace(m, range=2 * m.range) for m in MODELS)
    same(soil_map.refit(wider), mapped(*soil_map.samples, models=wider))
    assert (soil_map.refit(wider).kv < before).all()
    assert np.array_equal(soil_map.kv, before)


@pytest.mark.parametrize("n", range(7))
def test_a_map_of_any_number_of_samples_can_be_fitted_and_kriged(n: int) -> None:
    soil_map = SoilMap(FIELD, LAYERS)
    samples = tuple(sample(4 * k) for k in range(n))
    read = replace(mapped(), samples=samples)
    models = [fit.variogram for fit in paper_10(read.at, read.kpa)]
    fitted = SoilMap(FIELD, LAYERS, tuple(models), samples)
    assert len(models) == 3
    assert np.isfinite(fitted.kv).all() == (n > 0)
    assert soil_map.samples == ()


def test_results_cannot_be_written_to() -> None:
    soil_map = mapped(sample(0), sample(20))
    for array in (soil_map.mean, soil_map.variance, soil_map.kv, soil_map.profile_mean):
        with pytest.raises(ValueError, match="read-only"):
            array[..., 0] = 0.0


# --- a bounded linear model in the plane ----------------------------------------------------------

WITH_LINEAR = (MODELS[0], BoundedLinear(1.0, 22.0, 900.0), MODELS[2])
DENSE = tuple(
    sample(int(cell), "all" if cell % 2 else "two", aside=0.3)
    for cell in np.random.default_rng(2).permutation(30)[:28]
)


def test_layers_that_cannot_be_kriged_with_the_linear_model_are_named() -> None:
    soil_map = mapped(*DENSE, models=WITH_LINEAR)
    assert isinstance(soil_map.kriged_with[1], Circular)
    assert soil_map.kriged_with[0::2] == WITH_LINEAR[0::2]
    (note,) = soil_map.notes
    assert note.startswith("0.10-0.20 m: bounded linear model not valid in the plane")
    assert (soil_map.variance[np.isfinite(soil_map.variance)] > -1e-6).all()


def test_growing_past_the_last_valid_linear_system_equals_starting_again() -> None:
    grown, replaced = mapped(models=WITH_LINEAR), []
    for k, one in enumerate(DENSE):
        grown = grown.append(one)
        same(grown, mapped(*DENSE[: k + 1], models=WITH_LINEAR))
        replaced.append(bool(grown.notes))
    assert replaced == sorted(replaced)
    assert not replaced[0]
    assert replaced[-1]


def test_a_valid_linear_model_is_left_as_it_is() -> None:
    soil_map = mapped(sample(0), sample(29), models=WITH_LINEAR)
    assert soil_map.notes == ()
    assert soil_map.kriged_with == WITH_LINEAR


def test_a_map_predicts_at_other_places_than_its_cells_with_what_it_knows() -> None:
    soil_map = SoilMap(FIELD, LAYERS, MODELS, tuple(sample(cell) for cell in (2, 9, 14, 21, 28)))
    mean, variance = soil_map.predict(FIELD.cells[3:9])
    assert_allclose(mean, soil_map.mean[:, 3:9], rtol=1e-10)
    assert_allclose(variance, soil_map.variance[:, 3:9], rtol=1e-10)
    between, _ = soil_map.predict([FIELD.cells[3:5].mean(axis=0)])
    low, high = np.sort(soil_map.mean[:, 3:5], axis=1).T
    assert ((between[:, 0] > low - 10) & (between[:, 0] < high + 10)).all()
