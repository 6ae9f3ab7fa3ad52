"""What every kind of kriging keeps to, whatever it makes of the readings.

A kind is added by a line in ``KINDS``: how to krige values at places, at targets.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from subsoil.arrays import Floats
from subsoil.kriging import Kriged, at_targets, condition
from subsoil.kriging.drift import Covariate, Drifted
from subsoil.variogram import Exponential, Matern32, Nested, Spherical, Structure

Kind = Callable[[Floats, Floats], Kriged]

rng = np.random.default_rng(7)
TARGETS = rng.uniform(0, 100, (40, 2))
AT = rng.uniform(0, 100, (16, 2))
Z = rng.normal(1000, 200, (3, 16)) + 4 * AT[:, 0]
PLACES = np.concatenate([TARGETS, AT, rng.uniform(0, 100, (60, 2))])
COVARIATE = Covariate(PLACES, 30 + 10 * np.sin(PLACES[:, 0] / 20) + 0.1 * PLACES[:, 1])
POOLED = Nested(1.0, (Structure(0.6, Exponential, 50.0), Structure(0.3, Matern32, 30.0)))
EACH = (Exponential(900.0, 40.0, 9e3), Spherical(2e3, 60.0, 3e4), Matern32(5e3, 35.0, 1e4))


def ordinary(at: Floats, z: Floats) -> Kriged:
    return at_targets(condition(POOLED, at, z), TARGETS)


def ordinary_by_layer(at: Floats, z: Floats) -> Kriged:
    return at_targets(condition(EACH, at, z), TARGETS)


def with_drift(at: Floats, z: Floats) -> Kriged:
    return Drifted(at_targets(condition(POOLED, at, z), TARGETS), COVARIATE)


def with_drift_by_layer(at: Floats, z: Floats) -> Kriged:
    return Drifted(at_targets(condition(EACH, at, z), TARGETS), COVARIATE)


KINDS = [ordinary, ordinary_by_layer, with_drift, with_drift_by_layer]
every_kind = pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
CELLS = np.arange(len(TARGETS))


@every_kind
def test_it_has_a_mean_and_a_variance_of_every_layer_and_target(kind: Kind) -> None:
    kriged = kind(AT, Z)
    mean, variance = kriged.prediction
    assert mean.shape == variance.shape == (3, 40)
    assert (variance > 0).all()
    assert np.array_equal(kriged.targets, TARGETS)
    assert np.array_equal(kriged.at, AT)


@every_kind
@given(first=st.integers(4, 15), seed=st.integers(0, 99))
def test_appending_readings_is_kriging_from_all_at_once_in_any_order(
    kind: Kind, first: int, seed: int
) -> None:
    order = np.random.default_rng(seed).permutation(16)
    kriged = kind(AT[order[:first]], Z[:, order[:first]])
    for k in order[first:]:
        kriged = kriged.append(AT[k], Z[:, k])
    for one, other in zip(kriged.prediction, kind(AT, Z).prediction, strict=True):
        assert np.allclose(one, other, rtol=1e-8)


@every_kind
def test_look_ahead_is_what_the_variance_falls_by(kind: Kind) -> None:
    kriged = kind(AT, Z)
    drop = kriged.variance_drop([3, 17])
    assert drop.shape == (2, 3, 40) or drop.shape == (3, 2, 40)
    for k, cell in enumerate((3, 17)):
        after = kriged.append(TARGETS[cell], np.zeros(3)).prediction.variance
        fallen = kriged.prediction.variance - after
        assert np.allclose(drop[:, k], fallen, rtol=1e-7, atol=1e-9 * fallen.max())


@every_kind
def test_error_covariances_are_the_variance_where_a_target_meets_itself(kind: Kind) -> None:
    kriged = kind(AT, Z)
    variance = kriged.prediction.variance
    p = kriged.error_covariance(CELLS)
    assert np.allclose(np.diagonal(p, axis1=1, axis2=2), variance[: len(p)], rtol=1e-9)
    assert np.allclose(p, p.transpose(0, 2, 1), rtol=1e-9, atol=1e-9 * p.max())
    assert (np.linalg.eigvalsh(p) > -1e-9 * p.max()).all()


@every_kind
def test_error_covariances_of_some_targets_are_those_among_all(kind: Kind) -> None:
    kriged, rows, columns = kind(AT, Z), np.array([2, 9]), np.array([5, 2, 30])
    whole = kriged.error_covariance(CELLS)
    some = kriged.error_covariance(rows, columns)
    assert np.allclose(some, whole[:, rows][:, :, columns], rtol=1e-12)


@every_kind
def test_other_targets_are_kriged_from_the_same_readings(kind: Kind) -> None:
    kriged, part = kind(AT, Z), TARGETS[5:12]
    elsewhere = kriged.at_targets(part)
    assert np.array_equal(elsewhere.targets, part)
    for some, every in zip(elsewhere.prediction, kriged.prediction, strict=True):
        assert np.allclose(some, every[..., 5:12], rtol=1e-10)
    one, other = (k.append((3.0, 4.0), np.ones(3)).prediction for k in (elsewhere, kriged))
    assert np.allclose(one.mean, other.mean[..., 5:12], rtol=1e-9)


@every_kind
def test_leaving_a_reading_out_is_kriging_without_it(kind: Kind) -> None:
    score = kind(AT, Z).leave_one_out()
    for k in (0, 5, 15):
        rest = np.delete(np.arange(16), k)
        here = Drifted if kind.__name__.startswith("with_drift") else None
        models = EACH if kind.__name__.endswith("by_layer") else POOLED
        plain = at_targets(condition(models, AT[rest], Z[:, rest]), AT[k : k + 1])
        without: Kriged = here(plain, COVARIATE) if here else plain
        mean, variance = (values[:, 0] for values in without.prediction)
        noise = np.array([m.nugget for m in EACH]) if models is EACH else np.full(3, POOLED.nugget)
        assert score.residual[:, k] == pytest.approx(Z[:, k] - mean, rel=1e-7)
        assert score.variance[:, k] == pytest.approx(variance + noise, rel=1e-7)


def test_a_drift_is_in_every_answer() -> None:
    """What is uncertain about the slope widens the errors, and their covariances too."""
    plain, drifted = ordinary(AT, Z), with_drift(AT, Z)
    p, q = plain.error_covariance(CELLS), drifted.error_covariance(CELLS)
    assert np.diagonal(q, axis1=1, axis2=2).mean() > np.diagonal(p, axis1=1, axis2=2).mean()
    assert (drifted.prediction.variance >= plain.prediction.variance).all()
