"""Which layers share a system, in which units, and which layers follow a covariate."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.stats import ttest_1samp

from subsoil.arrays import Floats
from subsoil.errors import ParameterError, ReadingsError
from subsoil.kriging import condition, leave_one_out
from subsoil.kriging.drift import Covariate, leave_one_out_with
from subsoil.land.field import Field
from subsoil.layers import Layers, LayerState, Sample
from subsoil.mapping.drift_choice import helped, learn, residuals
from subsoil.mapping.fit import fit
from subsoil.mapping.krige import krige
from subsoil.mapping.skill import layer_scores, no_better_than_mean
from subsoil.mapping.soilmap import SoilMap
from subsoil.mapping.stack import in_units, measured
from subsoil.readings import Readings
from subsoil.variogram import (
    Exponential,
    Fit,
    LeastSquares,
    Nested,
    Spherical,
    Structure,
    Variogram,
)

SHAPE = (Structure(0.6, Exponential, 50.0), Structure(0.2, Spherical, 20.0))
NO_ERROR, ERROR = np.zeros(4), np.array([0.0, 0.0, 25.0, 0.0])
seeds = st.integers(0, 2**31)


# --- in one system --------------------------------------------------------------------------------


def test_nested_models_of_one_shape_are_one_of_sill_one_and_their_sills_its_units() -> None:
    model, unit = in_units((Nested(400.0, SHAPE), Nested(900.0, SHAPE)), NO_ERROR)
    assert model == Nested(1.0, SHAPE)
    assert unit.tolist() == [400.0, 900.0]


@pytest.mark.parametrize(
    ("models", "error"),
    [
        ((Nested(400.0, SHAPE), Nested(900.0, SHAPE)), ERROR),
        ((Nested(400.0, SHAPE), Nested(900.0, SHAPE[:1])), NO_ERROR),
        ((Nested(400.0, SHAPE), Nested(0.0, SHAPE)), NO_ERROR),
        ((Nested(400.0, SHAPE), Spherical(0.0, 9.0, 1.0)), NO_ERROR),
        ((Spherical(0.0, 9.0, 1.0), Nested(400.0, SHAPE)), NO_ERROR),
        ((Spherical(0.0, 9.0, 1.0), Spherical(0.0, 9.0, 2.0)), NO_ERROR),
    ],
)
def test_models_that_differ_in_more_than_their_sill_keep_a_system_each(
    models: tuple[Variogram, ...], error: Floats
) -> None:
    found, unit = in_units(models, error)
    assert found == models
    assert unit.tolist() == [1.0]


@pytest.mark.parametrize("error", [NO_ERROR, ERROR])
def test_one_model_for_all_layers_is_one_system(error: Floats) -> None:
    model = Spherical(1.0, 30.0, 9.0)
    assert in_units((model, model, model), error)[0] == model


def test_samples_that_did_not_go_through_a_layer_are_not_among_its_readings() -> None:
    all_, two, one = LayerState.MEASURED, LayerState.AT_LEAST, LayerState.UNREACHED
    samples = (
        Sample((1.0, 2.0), np.array([1.0, 2.0, 3.0]), np.array([all_] * 3, dtype=np.int8), 4.0),
        Sample((3.0, 4.0), np.array([5.0, 6.0, np.nan]), np.array([all_, two, one], dtype=np.int8)),
    )
    at, kpa, error = measured(samples, (0,))
    assert (at.tolist(), kpa.tolist(), error.tolist()) == (
        [[1.0, 2.0], [3.0, 4.0]], [[1.0, 5.0]], [4.0, 0.0],
    )  # fmt: skip
    at, kpa, error = measured(samples, (1, 2))
    assert (at.tolist(), kpa.tolist(), error.tolist()) == ([[1.0, 2.0]], [[2.0], [3.0]], [4.0])


@given(seeds)
@settings(max_examples=25)
def test_a_map_whose_samples_get_errors_on_the_way_is_that_of_all_of_them(seed: int) -> None:
    rng = np.random.default_rng(seed)
    field, layers = Field.from_metres([(0, 0), (40, 0), (40, 30), (0, 30)], cell_size=10.0), 2
    models = tuple(Nested(sill, SHAPE) for sill in (400.0, 2500.0))
    state = np.zeros(layers, dtype=np.int8)
    samples = tuple(
        Sample((e, n), rng.normal(900, 50, layers), state, error)
        for (e, n), error in zip(
            rng.uniform(0, 30, (6, 2)).tolist(), rng.choice([0.0, 0.0, 90.0], 6), strict=True
        )
    )
    grown = SoilMap(field, Layers((0.0, 0.2, 0.4)), models, samples[:2])
    for sample in samples[2:]:
        assert np.isfinite(grown.kv).all()
        grown = grown.append(sample)
    for k, model in enumerate(models):
        at, z = np.array([s.at for s in samples]), np.array([s.kpa[k] for s in samples])
        noise = np.array([s.error_variance for s in samples])
        mean, variance = condition(model, at, z, error_variance=noise).predict(field.cells)
        assert_allclose(grown.mean[k], mean, rtol=1e-8)
        assert_allclose(grown.variance[k], variance, rtol=1e-8)


# --- along a covariate ----------------------------------------------------------------------------


@given(seeds, st.integers(3, 20))
def test_what_a_covariate_leaves_is_what_a_straight_line_through_the_readings_does(
    seed: int, n: int
) -> None:
    rng = np.random.default_rng(seed)
    x, z = rng.normal(30, 9, n), rng.normal(900, 50, n)
    z[rng.choice(n, n - 3, replace=False)[: n // 3]] = np.nan
    known = np.isfinite(z)
    line = np.polyval(np.polyfit(x[known], z[known], 1), x)
    assert_allclose(residuals(x, z), z - line, atol=1e-6)


@given(seeds, st.integers(1, 4), st.floats(-1.0, 2.0))
def test_layers_gain_where_students_t_of_all_together_and_of_their_own_say_so(
    seed: int, layers: int, shift: float
) -> None:
    rng = np.random.default_rng(seed)
    without, with_it = rng.gamma(1.0, 4.0, (2, layers, 9))
    with_it = np.maximum(with_it - shift, 0.01)
    missing = rng.random((layers, 9)) < 0.2
    missing[:, :3] = False
    without[missing] = with_it[missing] = np.nan
    gain = (without - with_it) / np.nanmean(without, axis=1, keepdims=True)
    columns = [column[np.isfinite(column)] for column in gain.T]
    together = ttest_1samp([column.mean() for column in columns if column.size], 0.0).statistic
    own = [ttest_1samp(row[np.isfinite(row)], 0.0).statistic for row in gain]
    assert helped(without, with_it).tolist() == [together > 1.0 and t > 0.5 for t in own]


def test_a_gain_that_is_the_same_everywhere_is_certain_and_none_at_all_is_none() -> None:
    before = np.full((2, 5), 4.0)
    assert helped(before, before - 0.5).tolist() == [True, True]
    assert helped(before, before + 0.5).tolist() == [False, False]
    assert helped(before, np.full((2, 5), inf)).tolist() == [False, False]


def fixed(at: Floats, z: Floats) -> tuple[Fit, ...]:
    bins = LeastSquares(Exponential)(at, z)
    return tuple(Fit(Exponential(300.0, 60.0, 2000.0), b.empirical, False, "fixed") for b in bins)


def test_layers_are_judged_by_leaving_each_reading_out_with_and_without_and_it_is_said() -> None:
    rng = np.random.default_rng(3)
    at = rng.uniform(0, 100, (15, 2))
    x = rng.normal(size=15)
    z = 1000 + np.array([[80.0], [1.0]]) * x + rng.normal(0, 30, (2, 15))
    covariate = Covariate(at, x)
    found = learn(at, z, covariate, fixed)
    assert found.drift == (0,)
    ok = condition(Exponential(300.0, 60.0, 2000.0), at, z[0])
    scores = leave_one_out_with(covariate, ok).rmse[0], leave_one_out(ok).rmse[0]
    said = f"leave-one-out RMSE {scores[0]:.4g}, without it {scores[1]:.4g}"
    assert found.fits[0].why == f"fixed; follows the covariate: {said}"
    assert found.fits[1].why == "fixed"
    assert learn(at, z, covariate, fixed, "always").drift == (0, 1)
    assert learn(at, z, covariate, fixed, "never").drift == ()


def test_a_covariate_that_is_noise_is_seldom_followed() -> None:
    """Of layers drawn alone, a mean gain above one standard error is had by chance in a sixth of
    cases, were gains even about zero; a covariate that tells nothing costs, so in fewer."""
    followed = 0
    for seed in range(120):
        rng = np.random.default_rng(seed)
        at = rng.uniform(0, 100, (14, 2))
        z = rng.normal(1000, 50, (1, 14))
        followed += len(learn(at, z, Covariate(at, rng.normal(size=14)), fixed).drift)
    # A sixth of 120, and three standard deviations of so many.
    assert followed <= 20 + 3 * np.sqrt(120 * (1 / 6) * (5 / 6))


def test_a_rule_that_there_is_not_is_answered_with_those_there_are() -> None:
    at = np.random.default_rng(1).uniform(0, 9, (9, 2))
    with pytest.raises(ParameterError) as raised:
        learn(at, at.T, Covariate(at, at[:, 0]), fixed, "sometimes")  # type: ignore[arg-type]
    assert str(raised.value) == (
        "drift: there is no rule 'sometimes' (remedy: one of auto, always, never)"
    )


# --- what it is worth -----------------------------------------------------------------------------


def test_layers_are_scored_on_the_readings_that_reached_them_with_drift_where_they_follow() -> None:
    rng = np.random.default_rng(4)
    at, kpa = rng.uniform(0, 90, (12, 2)), rng.normal(900, 60, (4, 12))
    kpa[1, 5:] = kpa[2, 2:] = np.nan
    models = [Exponential(100.0 * k, 50.0, 3000.0) for k in (1, 2, 3, 4)]
    covariate = Covariate(at, rng.normal(size=12))
    found = list(layer_scores(at, kpa, models, covariate, drift=(3,)))
    assert found[2] is None
    plain = [condition(models[k], at[:n], kpa[k, :n]) for k, n in ((0, 12), (1, 5), (3, 12))]
    expected = [*map(leave_one_out, plain[:2]), leave_one_out_with(covariate, plain[2])]
    for score, own in zip((found[0], found[1], found[3]), expected, strict=True):
        assert score is not None
        assert_allclose(score.residual, own.residual, rtol=1e-12)
        assert_allclose(score.variance, own.variance, rtol=1e-12)
    worse = [k for k in (0, 1, 3) if found[k].skill[0] <= 0]  # type: ignore[union-attr]
    said = list(no_better_than_mean("abcd", found))
    assert [line[0] for line in said] == ["abcd"[k] for k in worse]
    assert all("does not beat the field's mean" in line for line in said)


# --- what cannot be mapped ------------------------------------------------------------------------


def readings(field: Field | None = None, samples: int = 5) -> Readings:
    at = np.random.default_rng(1).uniform(1, 30, (samples, 2))
    return Readings.of(at, [0.1], np.full((samples, 1), 900.0), field=field)


def test_readings_of_another_frame_are_refused_with_both_named() -> None:
    corners = np.array([(0, 0), (40, 0), (40, 30), (0, 30)]) + np.array([681_000, 5_900_000])
    field = Field.from_metres(corners, crs="EPSG:32630")
    fits = fit(readings(), Layers((0.0, 0.2)), "spherical")
    with pytest.raises(ReadingsError) as raised:
        krige(field, readings(), fits)
    assert raised.value.what == "readings are in a local frame, the field in EPSG:32630"
    assert raised.value.remedy == "read them with field="


@pytest.mark.parametrize("models", [(), (Spherical(0.0, 9.0, 1.0),) * 3])
def test_a_map_of_another_number_of_variograms_than_layers_is_refused(
    models: Sequence[Variogram],
) -> None:
    field = Field.from_metres([(0, 0), (40, 0), (40, 30), (0, 30)])
    sample = Sample((1.0, 1.0), np.array([900.0, 900.0]), np.zeros(2, dtype=np.int8))
    with pytest.raises(ParameterError) as raised:
        SoilMap(field, Layers((0.0, 0.1, 0.2)), tuple(models), (sample,))
    assert raised.value.what == f"{len(models)} variograms for 2 layers"
    assert (raised.value.where, raised.value.remedy) == ("soil map", "give one a layer")
