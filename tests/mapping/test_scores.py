"""Scores mean what they say: closed forms equal leaving out for real, and calibration is one."""

from __future__ import annotations

from dataclasses import replace
from math import isnan

import numpy as np
import pytest

from subsoil.arrays import Floats
from subsoil.errors import ParameterError, ReadingsError
from subsoil.kriging import block_out, condition, leave_one_out
from subsoil.kriging.leave_one_out import skill
from subsoil.layers import Layers
from subsoil.mapping.fit import fit
from subsoil.mapping.scores import rmse
from subsoil.mapping.skill import block_skills, layer_skills, unskilled
from subsoil.readings import Readings
from subsoil.variogram import (
    MODELS,
    Bounded,
    BoundedLinear,
    Exponential,
    Matern32,
    Nested,
    Power,
    PureNugget,
    Spherical,
    Structure,
    Variogram,
    semivariance,
)

AT = np.random.default_rng(3).uniform(0.0, 100.0, (14, 2))
Z = np.random.default_rng(4).normal(1500.0, 200.0, (3, 14))


def left_out(
    variogram: Variogram, at: Floats, z: Floats, error: Floats, *, exact: bool
) -> tuple[Floats, Floats]:
    """Residual and variance of each reading by kriging from the others."""
    residual, variance = np.empty((2, len(z)))
    for i in range(len(z)):
        rest = np.arange(len(z)) != i
        ok = condition(variogram, at[rest], z[rest], exact=exact, error_variance=error[rest])
        mean, kv = ok.predict(at[[i]])
        residual[i] = z[i] - mean[0]
        variance[i] = kv[0] + error[i] + (0.0 if exact else variogram.nugget)
    return residual, variance


@pytest.mark.parametrize("exact", [False, True])
@pytest.mark.parametrize("kind", MODELS.values(), ids=lambda kind: kind.__name__)
def test_leave_one_out_equals_kriging_without_the_reading(
    kind: type[Bounded], *, exact: bool
) -> None:
    variogram = kind(nugget=4000.0, range=45.0, psill=30_000.0)
    score = leave_one_out(condition(variogram, AT, Z, exact=exact))
    assert score.residual.shape == score.variance.shape == score.mean_residual.shape == (3, 14)
    for layer, z in enumerate(Z):
        residual, variance = left_out(variogram, AT, z, np.zeros(14), exact=exact)
        assert score.residual[layer] == pytest.approx(residual, rel=1e-8)
        assert score.variance[layer] == pytest.approx(variance, rel=1e-8)


@pytest.mark.parametrize("variogram", [Power(4000.0, 120.0, 1.2), PureNugget(4000.0)])
def test_leave_one_out_holds_without_a_range_too(variogram: Variogram) -> None:
    score = leave_one_out(condition(variogram, AT, Z[0]))
    residual, variance = left_out(variogram, AT, Z[0], np.zeros(14), exact=False)
    assert score.residual[0] == pytest.approx(residual, rel=1e-6)
    assert score.variance[0] == pytest.approx(variance, rel=1e-6)


def test_leave_one_out_takes_each_layer_by_its_own_model_and_error() -> None:
    models = [Spherical(1000.0 * k, 30.0 * k, 20_000.0) for k in (1, 2, 3)]
    error = np.random.default_rng(5).uniform(0.0, 5000.0, 14)
    score = leave_one_out(condition(models, AT, Z, error_variance=error))
    for layer, (model, z) in enumerate(zip(models, Z, strict=True)):
        residual, variance = left_out(model, AT, z, error, exact=False)
        assert score.residual[layer] == pytest.approx(residual, rel=1e-8)
        assert score.variance[layer] == pytest.approx(variance, rel=1e-8)


def test_repeats_at_a_place_are_left_out_together() -> None:
    model = Spherical(4000.0, 45.0, 30_000.0)
    twice, again = np.vstack([AT, AT[:1]]), np.append(Z[0], Z[0, 0] + 100.0)
    score = leave_one_out(condition(model, twice, again))
    assert score.residual.shape == (1, 14)
    mean, kv = condition(model, AT[1:], Z[0, 1:]).predict(AT[:1])
    assert score.residual[0, 0] == pytest.approx(Z[0, 0] + 50.0 - mean[0])
    assert score.variance[0, 0] == pytest.approx(kv[0] + 2000.0)


def test_leave_one_out_needs_three_places() -> None:
    with pytest.raises(ReadingsError, match="three readings or more, not 2"):
        leave_one_out(condition(Spherical(1.0, 30.0, 9.0), AT[:2], Z[0, :2]))
    assert leave_one_out(condition(Spherical(1.0, 30.0, 9.0), AT[:3], Z[0, :3])).rmse.shape == (1,)


def test_the_mean_to_beat_is_that_of_the_other_readings() -> None:
    score = leave_one_out(condition(Spherical(4000.0, 45.0, 30_000.0), AT, Z))
    others = [Z[1, 5] - np.delete(Z[1], 5).mean()]
    assert score.mean_residual[1, 5] == pytest.approx(others[0])


def test_skill_and_rmse_of_leave_one_out_are_by_layer() -> None:
    score = leave_one_out(condition(Spherical(4000.0, 45.0, 30_000.0), AT, Z))
    mse = (score.residual**2).mean(axis=1)
    assert score.rmse == pytest.approx(np.sqrt(mse))
    assert score.skill == pytest.approx(1 - mse / (score.mean_residual**2).mean(axis=1))


def test_a_pure_nugget_is_as_good_as_the_mean_and_no_better() -> None:
    assert leave_one_out(condition(PureNugget(9.0), AT, Z)).skill == pytest.approx(np.zeros(3))


def test_layers_are_scored_from_readings_and_fits_with_what_they_are_like() -> None:
    readings, layers = Readings.of(AT, [0.05, 0.15, 0.25], Z.T), Layers((0.0, 0.1, 0.2, 0.3))
    fits, (_, kpa, _) = fit(readings, layers, "spherical"), readings.layer_means(layers)
    done: list[str] = []
    found = layer_skills(readings, fits, lambda _, name: done.append(name))
    score = leave_one_out(condition(fits.variograms[1], AT, kpa[None]))
    assert done == [each.layer for each in found] == list(fits.layers.names)
    assert found[1].samples == 14
    assert found[1].mean_kpa == pytest.approx(kpa.mean())
    assert found[1].loo_rmse_kpa == pytest.approx(score.rmse[0])
    assert found[1].loo_skill == pytest.approx(score.skill[0])
    (left,) = block_out(fits.variograms[1], AT, kpa, 40.0).rmse
    assert block_skills(readings, fits, 40.0)[1].block_rmse_kpa == pytest.approx(left)
    assert [words.split(":")[0] for words in unskilled(found)] == [
        each.layer for each in found if each.loo_skill <= 0
    ]


def test_a_layer_that_too_few_readings_reached_is_refused_by_name() -> None:
    kpa = Z.T.copy()
    kpa[2:, 2] = np.nan
    readings = Readings.of(AT, [0.05, 0.15, 0.25], kpa)
    fits = fit(readings, Layers((0.0, 0.1, 0.2, 0.3)), "spherical")
    with pytest.raises(ParameterError, match=r"0\.20-0\.30 m: 2 readings reached the layer"):
        layer_skills(readings, fits)


def test_skill_is_one_for_no_error_zero_for_the_mean_and_below_for_worse() -> None:
    mean = np.array([4.0, 16.0])
    assert skill(np.zeros(2), mean) == 1.0
    assert skill(mean, mean) == 0.0
    assert skill(2 * mean, mean) == -1.0


def test_where_readings_do_not_vary_there_is_no_skill() -> None:
    assert isnan(skill(np.zeros(3), np.zeros(3)))
    flat = leave_one_out(condition(Spherical(1.0, 30.0, 9.0), AT, np.full(14, 7.0)))
    assert np.isnan(flat.skill).all()


def test_rmse_is_over_layers_and_cells_alike() -> None:
    assert rmse(np.zeros((2, 3)), [[3.0, 0.0, 0.0], [0.0, 0.0, 3.0]]) == pytest.approx(3**0.5)
    assert isnan(rmse([[1.0], [np.nan]], [[1.0], [2.0]]))


# --- calibration ----------------------------------------------------------------------------------


def drawn(variogram: Variogram, at: Floats, fields: int, seed: int) -> Floats:
    """(fields, n) readings of Gaussian fields with a mean of 1000."""
    lag = np.hypot(*(at[:, None] - at[None]).transpose(2, 0, 1))
    covariance = variogram.sill - semivariance(variogram, np.maximum(lag, 1e-12))
    np.fill_diagonal(covariance, variogram.sill)
    root = np.linalg.cholesky(covariance)
    return 1000.0 + np.random.default_rng(seed).standard_normal((fields, len(at))) @ root.T


def standard_errors_from_one(calibration: Floats) -> float:
    error = calibration.std(ddof=1) / np.sqrt(len(calibration))
    return float(abs(calibration.mean() - 1.0) / error)


def test_calibration_is_one_on_fields_drawn_from_the_model_and_not_from_another() -> None:
    variogram = Exponential(1000.0, 60.0, 8000.0)
    at = np.random.default_rng(8).uniform(0.0, 120.0, (40, 2))
    z = drawn(variogram, at, 400, seed=9)
    right = leave_one_out(condition(variogram, at, z)).calibration
    assert standard_errors_from_one(right) < 5.0
    for wrong in (replace(variogram, psill=6000.0), replace(variogram, range=120.0)):
        assert standard_errors_from_one(leave_one_out(condition(wrong, at, z)).calibration) > 10.0


def test_calibration_of_left_out_blocks_is_one_too() -> None:
    variogram = Spherical(1000.0, 50.0, 8000.0)
    at = np.random.default_rng(8).uniform(-60.0, 60.0, (30, 2))
    fields = drawn(variogram, at, 150, seed=10)
    found = np.array([block_out(variogram, at, z, 40.0).calibration[0] for z in fields])
    assert standard_errors_from_one(found) < 5.0


# --- blocks ---------------------------------------------------------------------------------------


def test_a_block_is_predicted_from_the_others_alone() -> None:
    model = Spherical(4000.0, 45.0, 30_000.0)
    at, z = AT - 50.0, Z[0]
    score = block_out(model, at, z, 50.0)
    assert score.residual.shape == score.variance.shape == score.mean_residual.shape == (1, 14)
    for east, north in ((-50.0, -50.0), (-50.0, 0.0), (0.0, -50.0), (0.0, 0.0)):
        out = ((at >= (east, north)) & (at < (east + 50.0, north + 50.0))).all(axis=1)
        assert 0 < out.sum() < 14
        mean, kv = condition(model, at[~out], z[~out]).predict(at[out])
        assert score.residual[0, out] == pytest.approx(z[out] - mean)
        assert score.variance[0, out] == pytest.approx(kv + 4000.0)
        assert score.mean_residual[0, out] == pytest.approx(z[out] - z[~out].mean())


@pytest.mark.parametrize(
    "model",
    [
        Spherical(4000.0, 45.0, 30_000.0),
        Exponential(0.0, 80.0, 30_000.0),
        Power(100.0, 20.0, 1.5),
        PureNugget(500.0),
        BoundedLinear(100.0, 60.0, 30_000.0),
        Nested(4e4, (Structure(0.6, Exponential, 50.0), Structure(0.3, Matern32, 120.0))),
    ],
    ids=lambda model: type(model).__name__,
)
@pytest.mark.parametrize("block", [30.0, 120.0])
def test_blocks_in_closed_form_are_kriging_from_the_others_anew(
    model: Variogram, block: float
) -> None:
    rng = np.random.default_rng(12)
    at, z = rng.uniform(-100.0, 150.0, (80, 2)), rng.normal(1000.0, 200.0, 80)
    at[40:44] = at[[7, 3, 3, 0]]
    score = block_out(model, at, z, block)
    corners = np.floor(at / block)
    for corner in np.unique(corners, axis=0):
        out = (corners == corner).all(axis=1)
        mean, kv = condition(model, at[~out], z[~out]).predict(at[out])
        assert score.residual[0, out] == pytest.approx(z[out] - mean, rel=1e-9, abs=1e-6)
        assert score.variance[0, out] == pytest.approx(kv + model.nugget, rel=1e-9)
        assert score.mean_residual[0, out] == pytest.approx(z[out] - z[~out].mean(), rel=1e-9)


def test_a_linear_model_that_a_block_shows_to_be_invalid_gives_way_to_the_circular_one() -> None:
    cells = np.stack(np.meshgrid(np.arange(8.0), np.arange(8.0)), -1).reshape(-1, 2) * 10.0
    z = np.random.default_rng(0).normal(size=64)
    linear = BoundedLinear(0.1007, 14.14, 1.0)
    assert condition(linear, cells, z).variograms == (linear,)
    score, circular = (block_out(model, cells, z, 10.0) for model in (linear, linear.circular()))
    assert score.residual == pytest.approx(circular.residual)
    assert score.variance == pytest.approx(circular.variance)


def test_tiny_blocks_are_leave_one_out() -> None:
    model = Spherical(4000.0, 45.0, 30_000.0)
    blocks, single = block_out(model, AT, Z[0], 0.01), leave_one_out(condition(model, AT, Z[0]))
    assert blocks.residual == pytest.approx(single.residual)
    assert blocks.variance == pytest.approx(single.variance)
    assert blocks.mean_residual == pytest.approx(single.mean_residual)


def test_blocks_are_harder_than_single_readings() -> None:
    variogram = Spherical(500.0, 80.0, 9000.0)
    at = np.random.default_rng(8).uniform(0.0, 120.0, (50, 2))
    fields = drawn(variogram, at, 20, seed=11)
    single = [leave_one_out(condition(variogram, at, z)).rmse[0] for z in fields]
    blocks = [block_out(variogram, at, z, 40.0).rmse[0] for z in fields]
    assert np.mean(blocks) > 1.1 * np.mean(single)


def test_one_block_of_everything_is_refused() -> None:
    with pytest.raises(ReadingsError, match="one block of 500 m"):
        block_out(Spherical(1.0, 45.0, 9.0), AT, Z[0], 500.0)
