"""Kriging with external drift: against textbook and PyKrige, and only where it helps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from pykrige.uk import UniversalKriging
from scipy.cluster.vq import kmeans2

from subsoil.arrays import Floats
from subsoil.errors import ParameterError, SingularSystemError
from subsoil.kriging import at_targets, condition
from subsoil.kriging.drift import NO_COVARIATE, Covariate, Drifted, leave_one_out_with
from subsoil.land.field import Field
from subsoil.layers import Layers, LayerState, Sample
from subsoil.mapping.drift_choice import FEWEST_SAMPLES, DriftRule, helped, learn
from subsoil.mapping.scores import rmse
from subsoil.mapping.soilmap import SoilMap
from subsoil.simulation import Truth, draw_field
from subsoil.variogram import (
    Bounded,
    Exponential,
    Matern32,
    Nested,
    Pooled,
    Spherical,
    Structure,
    estimator_named,
)

MODELS = (Exponential(20.0, 60.0, 300.0), Spherical(5.0, 45.0, 80.0), Matern32(9.0, 30.0, 700.0))
NESTED = Nested(400.0, (Structure(0.5, Exponential, 40.0), Structure(0.4, Matern32, 90.0)))


def lagged(a: Floats, b: Floats) -> Floats:
    return np.asarray(np.hypot(*(a[:, None] - b[None]).transpose(2, 0, 1)))


def field_of(seed: int, n: int = 25, cells: int = 60) -> tuple[Floats, Floats, Covariate]:
    """Readings of three layers at n of the places that a wavy covariate is known at, and cells."""
    rng = np.random.default_rng(seed)
    places = rng.uniform(0.0, 120.0, (n + cells, 2))
    x = 30.0 + 8.0 * np.sin(places[:, 0] / 20.0) + rng.normal(0.0, 2.0, len(places))
    z = 900.0 + np.array([[4.0], [0.0], [-2.0]]) * x[:n] + rng.normal(0.0, 15.0, (3, n))
    return places[:n], z, Covariate(places, x)


def textbook(
    model: Bounded | Nested,
    at: Floats,
    z: Floats,
    covariate: Covariate,
    targets: Floats,
    error: Floats | float = 0.0,
) -> tuple[Floats, Floats]:
    """Universal kriging of the signal by the system with two Lagrange multipliers."""
    n, signal = len(at), model.sill - model.nugget
    drift = np.column_stack([np.ones(n), covariate(at)])
    system = np.zeros((n + 2, n + 2))
    system[:n, :n] = signal - model.rise(lagged(at, at)) + np.eye(n) * (model.nugget + error)
    system[:n, n:], system[n:, :n] = drift, drift.T
    right = np.vstack(
        [signal - model.rise(lagged(at, targets)), np.ones(len(targets)), covariate(targets)]
    )
    weights = np.linalg.solve(system, right)
    return z @ weights[:n], signal - (weights * right).sum(axis=0)


@pytest.mark.parametrize("model", [*MODELS, NESTED], ids=lambda m: type(m).__name__)
def test_it_is_the_textbooks_universal_kriging(model: Bounded | Nested) -> None:
    at, z, covariate = field_of(1)
    targets = covariate.at[len(at) :]
    found = Drifted(at_targets(condition(model, at, z), targets), covariate).prediction
    for layer in range(3):
        mean, variance = textbook(model, at, z[layer], covariate, targets)
        assert_allclose(found.mean[layer], mean, rtol=1e-9)
        assert_allclose(found.variance[layer], variance, rtol=1e-9)


def test_layers_have_a_model_and_an_error_variance_each() -> None:
    at, z, covariate = field_of(2)
    error = np.random.default_rng(3).uniform(0.0, 50.0, len(at))
    targets = covariate.at[len(at) :]
    ok = condition(MODELS, at, z, error_variance=error)
    found = Drifted(at_targets(ok, targets), covariate).prediction
    for layer, model in enumerate(MODELS):
        mean, variance = textbook(model, at, z[layer], covariate, targets, error)
        assert_allclose(found.mean[layer], mean, rtol=1e-9)
        assert_allclose(found.variance[layer], variance, rtol=1e-9)


@pytest.mark.parametrize("seed", range(3))
def test_it_agrees_with_pykrige(seed: int) -> None:
    at, z, covariate = field_of(seed)
    targets, n = covariate.at[len(at) :], len(at)
    peer = UniversalKriging(
        *at.T, z[0], variogram_model="exponential",
        variogram_parameters={"psill": 300.0, "range": 60.0, "nugget": 20.0},
        drift_terms=["specified"], specified_drift=[covariate.values[:n]],
    )  # fmt: skip
    mean, variance = peer.execute(
        "points", *targets.T, specified_drift_arrays=[covariate.values[n:]]
    )
    ok = condition(Exponential(20.0, 60.0, 300.0), at, z[0], exact=True)
    found = Drifted(at_targets(ok, targets), covariate).prediction
    assert_allclose(found.mean, mean, rtol=1e-9)
    assert_allclose(found.variance, variance, rtol=1e-9)


@given(st.integers(0, 50), st.floats(-50.0, 50.0), st.sampled_from([-3.0, 0.01, 7.0]))
@settings(max_examples=20, deadline=None)
def test_the_covariates_unit_and_zero_do_not_matter(seed: int, shift: float, unit: float) -> None:
    at, z, covariate = field_of(seed, cells=10)
    other = Covariate(covariate.at, shift + unit * covariate.values)
    plain = at_targets(condition(MODELS, at, z), covariate.at[len(at) :])
    first, second = (Drifted(plain, x).prediction for x in (covariate, other))
    assert_allclose(first.mean, second.mean, rtol=1e-8)
    assert_allclose(first.variance, second.variance, rtol=1e-8)


@pytest.mark.parametrize("models", [MODELS, MODELS[0]], ids=["each", "one"])
def test_appending_equals_starting_again(models: Bounded | Sequence[Bounded]) -> None:
    at, z, covariate = field_of(4)
    targets = covariate.at[len(at) :]
    grown = Drifted(at_targets(condition(models, at[:9], z[:, :9]), targets), covariate)
    grown = grown.append(at[9:], z[:, 9:])
    anew = Drifted(at_targets(condition(models, at, z), targets), covariate)
    assert_allclose(grown.prediction.mean, anew.prediction.mean, rtol=1e-9)
    assert_allclose(grown.prediction.variance, anew.prediction.variance, rtol=1e-9)


@pytest.mark.parametrize("models", [MODELS, MODELS[0]], ids=["each", "one"])
def test_the_fall_of_variance_is_what_probing_there_gives(
    models: Bounded | Sequence[Bounded],
) -> None:
    at, z, covariate = field_of(5)
    before = Drifted(at_targets(condition(models, at, z), covariate.at[len(at) :]), covariate)
    candidates = [0, 17, 59]
    drop = before.variance_drop(candidates)
    for k, cell in enumerate(candidates):
        after = before.append(before.estimate.targets[cell], np.zeros(3))
        fall = before.prediction.variance - after.prediction.variance
        assert_allclose(drop[:, k], fall, rtol=1e-6, atol=1e-8)


@pytest.mark.parametrize("models", [MODELS, MODELS[0]], ids=["each", "one"])
def test_leaving_one_out_in_closed_form_equals_leaving_each_out(
    models: Bounded | Sequence[Bounded],
) -> None:
    at, z, covariate = field_of(6, n=12)
    ok = condition(models, at, z)
    found = leave_one_out_with(covariate, ok)
    each = MODELS if isinstance(models, tuple) else (MODELS[0],) * 3
    for out in range(12):
        rest = np.arange(12) != out
        for layer, model in enumerate(each):
            mean, variance = textbook(model, at[rest], z[layer, rest], covariate, at[out : out + 1])
            assert_allclose(found.residual[layer, out], z[layer, out] - mean[0], rtol=1e-7)
            assert_allclose(found.variance[layer, out], variance[0] + model.nugget, rtol=1e-7)


def test_a_reading_that_alone_tells_the_slope_cannot_be_left_out() -> None:
    at, z, covariate = field_of(7, n=6)
    step = Covariate(covariate.at, (np.arange(len(covariate)) == 2).astype(float))
    found = leave_one_out_with(step, condition(MODELS[0], at, z))
    assert np.isinf(found.residual[:, 2]).all()
    assert np.isfinite(np.delete(found.residual, 2, axis=1)).all()


def test_a_covariate_that_is_the_same_at_all_readings_is_named_in_an_error() -> None:
    at, z, covariate = field_of(8)
    flat = Covariate(covariate.at, np.full(len(covariate), 3.0))
    with pytest.raises(SingularSystemError, match="the same at all 25 readings"):
        _ = Drifted(at_targets(condition(MODELS, at, z), at), flat).prediction


@pytest.mark.parametrize("values", [np.array([1.0]), np.array([1.0, np.nan])])
def test_a_covariate_has_a_finite_value_a_place(values: Floats) -> None:
    with pytest.raises(ParameterError, match="covariate"):
        Covariate(np.zeros((2, 2)), values)


# The soil map.

LAYERS = Layers((0.0, 0.1, 0.2, 0.4))
SILLS = (90.0, 400.0, 7.0)


def samples_of(at: Floats, z: Floats) -> tuple[Sample, ...]:
    """Samples of which every fourth ended above the last layer."""
    state = np.zeros(3, dtype=np.int8)
    ended = np.array([LayerState.MEASURED, LayerState.MEASURED, LayerState.UNREACHED])
    return tuple(
        Sample((x, y), np.where(s == LayerState.UNREACHED, np.nan, kpa), s.astype(np.int8))
        for k, ((x, y), kpa) in enumerate(zip(at.tolist(), z.T, strict=True))
        for s in (ended if k % 4 == 3 else state,)
    )


LAND = Field.from_metres([(0, 0), (120, 0), (120, 120), (0, 120)], cell_size=12.0)


def mapped(seed: int, drift: tuple[int, ...], nested: bool = False) -> SoilMap:
    at, z, covariate = field_of(seed)
    models = tuple(NESTED.with_sill(sill) for sill in SILLS) if nested else MODELS
    return SoilMap(LAND, LAYERS, models, samples_of(at, z), covariate, drift)


@pytest.mark.parametrize("nested", [False, True])
def test_only_the_layers_that_follow_the_covariate_do(nested: bool) -> None:
    soil_map = mapped(9, (0, 2), nested)
    plain = replace(soil_map, drift=())
    models = [NESTED.with_sill(sill) for sill in SILLS] if nested else MODELS
    assert_allclose(soil_map.mean[1], plain.mean[1], rtol=1e-12)
    for layer in (0, 2):
        reached = np.isfinite(soil_map.kpa[layer])
        mean, variance = textbook(
            models[layer], soil_map.at[reached], soil_map.kpa[layer, reached],
            soil_map.covariate, soil_map.cells,
        )  # fmt: skip
        assert_allclose(soil_map.mean[layer], mean, rtol=1e-9)
        assert_allclose(soil_map.variance[layer], variance, rtol=1e-9)
    assert soil_map.notes == ("0.00-0.10 m, 0.20-0.40 m: the mean follows the covariate",)


@pytest.mark.parametrize("nested", [False, True])
def test_a_map_with_drift_grows_by_samples(nested: bool) -> None:
    whole = mapped(10, (0, 2), nested)
    grown = replace(whole, samples=whole.samples[:12])
    for sample in whole.samples[12:]:
        _ = grown.kv
        grown = grown.append(sample)
    assert_allclose(grown.mean, whole.mean, rtol=1e-9)
    assert_allclose(grown.variance, whole.variance, rtol=1e-9)


def test_the_fall_of_kv_counts_what_is_learnt_of_the_slope() -> None:
    soil_map = mapped(11, (0, 1))
    (drop,) = soil_map.kv_drop([7])
    x, y = soil_map.cells[7].tolist()
    after = soil_map.append(Sample((x, y), np.zeros(3), np.zeros(3, dtype=np.int8)))
    assert_allclose(drop, soil_map.kv - after.kv, rtol=1e-6, atol=1e-8)


def test_a_map_of_some_of_the_cells_follows_the_covariate_too() -> None:
    soil_map = mapped(12, (0, 1, 2))
    some = replace(soil_map, subset=tuple(range(0, len(soil_map.cells), 3)))
    assert_allclose(some.mean, soil_map.mean[:, ::3], rtol=1e-12)


def test_layers_cannot_follow_a_covariate_that_is_not_there() -> None:
    with pytest.raises(ParameterError, match="there is none"):
        replace(mapped(13, (0,)), covariate=NO_COVARIATE)


# Whether to follow.


def learnt(rule: DriftRule, seed: int = 20, n: int = 30) -> tuple[int, ...]:
    at, z, covariate = field_of(seed, n)
    return learn(at, z, covariate, estimator_named("exponential"), rule).drift


def test_layers_follow_where_the_covariate_tells_and_not_where_it_does_not() -> None:
    drifts = [learnt("auto", seed) for seed in range(20, 30)]
    assert all(0 in drift for drift in drifts), "layer 1 goes by four covariates"
    assert sum(1 in drift for drift in drifts) <= 4, "layer 2 has nothing to do with it"


def test_the_rule_is_obeyed() -> None:
    assert learnt("always") == (0, 1, 2)
    assert learnt("never") == ()
    with pytest.raises(ParameterError, match="no rule 'sometimes'"):
        learnt("sometimes")  # type: ignore[arg-type]


@pytest.mark.parametrize("rule", ["auto", "always"])
def test_few_samples_follow_nothing(rule: DriftRule) -> None:
    assert learnt(rule, n=FEWEST_SAMPLES - 1) == ()
    at, z, covariate = field_of(1)
    flat = Covariate(covariate.at, np.ones(len(covariate)))
    for x in (flat, NO_COVARIATE):
        assert learn(at, z, x, Pooled(), rule).drift == ()
    assert learn(at[:0], z[:, :0], covariate, Pooled(), rule).drift == ()


def test_layers_are_judged_on_the_samples_that_reached_them() -> None:
    at, z, covariate = field_of(21)
    z[0, FEWEST_SAMPLES - 1 :] = np.nan
    found = learn(at, z, covariate, estimator_named("exponential"), "always")
    assert found.drift == (1, 2)
    assert "follows the covariate: leave-one-out RMSE" in found.fits[1].why
    assert "covariate" not in found.fits[0].why


def test_errors_lower_by_less_than_their_standard_error_do_not_count() -> None:
    before = np.array([[4.0, 1.0, 4.0, 1.0]])
    assert helped(before, before - [1.0, -0.25, 1.0, -0.25]).all()
    assert not helped(before, before - [1.0, -0.29, 1.0, -0.29]).any()


def test_layers_witness_together_and_gain_each_for_itself() -> None:
    before = np.full((3, 6), 4.0)
    after = before - np.array([[1.5], [-0.1], [0.4]]) + 0.2 * np.cos(np.arange(6.0))
    assert helped(before, after).tolist() == [True, False, True]
    after[0, 2] = np.inf
    assert helped(before, after)[0] == False  # noqa: E712
    before[:, 5] = after[:, 5] = np.nan
    assert helped(before, after).tolist() == [False, False, True]


def test_readings_at_one_place_count_once() -> None:
    at, z, covariate = field_of(22)
    again = np.concatenate([at, at[:5]]), np.concatenate([z, z[:, :5]], axis=1)
    assert learn(*again, covariate, Pooled()).drift[0] == 0


# What it is worth.


def standardised(values: Floats) -> Floats:
    return np.asarray(
        (values - values.mean(axis=-1, keepdims=True)) / values.std(axis=-1)[..., None]
    )


def correlated(truth: Truth, other: Truth, r: float) -> Covariate:
    """Covariate that correlates by just r with the soil's mean over depth, and else is soil too."""
    soil, rest = (standardised(standardised(t.kpa).mean(axis=0)) for t in (truth, other))
    rest = standardised(rest - soil * np.mean(soil * rest))
    return Covariate(truth.field.cells, r * soil + np.sqrt(1.0 - r * r) * rest)


def changes(r: float, rule: DriftRule, fields: int, n: int = 30) -> tuple[Floats, Floats]:
    """By what share RMSE changes in fields of the test bed, and how many layers use drift."""
    truths = [draw_field(np.random.default_rng(7000 + k), "signal") for k in range(fields)]
    estimator, change, used = estimator_named("exponential"), [], []
    for k, truth in enumerate(truths):
        cells = truth.field.cells
        centres, _ = kmeans2(cells, n, seed=k, minit="++")
        probed = np.unique(np.argmin(lagged(centres, cells), axis=1)).tolist()
        flat = np.zeros(len(truth.layers), dtype=np.int8)
        samples = tuple(Sample(tuple(cells[c]), truth.reading(c), flat) for c in probed)
        x = correlated(truth, truths[k - 1], r)
        soil_map = SoilMap(truth.field, truth.layers, samples=(), covariate=x)
        at, z = cells[probed], np.array([s.kpa for s in samples]).T
        errors = []
        for which in ("never", rule):
            learnt = learn(at, z, x, estimator, which)
            models = tuple(fit.variogram for fit in learnt.fits)
            full = replace(soil_map, variograms=models, samples=samples, drift=learnt.drift)
            errors.append(rmse(full.mean, truth.kpa))
        change.append(errors[1] / errors[0] - 1.0)
        used.append(len(learnt.drift))
    return np.array(change), np.array(used)


def upper(change: Floats) -> float:
    """Upper end of the mean's 95 % interval."""
    return float(change.mean() + 1.96 * change.std(ddof=1) / np.sqrt(len(change)))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("rule", "least", "most"), [("auto", -0.12, -0.03), ("always", -0.15, -0.05)]
)
def test_a_covariate_that_correlates_by_0_7_lowers_rmse(
    rule: DriftRule, least: float, most: float
) -> None:
    change, _ = changes(0.7, rule, fields=30)
    assert least < change.mean() < most
    assert upper(change) < 0.0


@pytest.mark.slow
def test_a_covariate_that_has_nothing_to_do_with_the_soil_is_refused() -> None:
    change, used = changes(0.0, "auto", fields=30)
    assert np.mean(used == 0) > 0.8
    assert change.mean() < 0.01
