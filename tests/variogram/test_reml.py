"""Restricted maximum likelihood: against an independent optimum, and on fields of known soil."""

from __future__ import annotations

from math import exp, inf, log

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import minimize

from subsoil.arrays import Floats
from subsoil.errors import ParameterError
from subsoil.variogram import Bounded, BoundedLinear, Exponential, Matern32, Nested, Spherical
from subsoil.variogram.estimators import ESTIMATORS
from subsoil.variogram.reml import FEWEST_SAMPLES, Reml


def drawn(model: Bounded, seed: int, n: int = 60, layers: int = 1) -> tuple[Floats, Floats]:
    """Places, and readings of independent layers under a model."""
    rng = np.random.default_rng(seed)
    at = rng.uniform(0.0, 180.0, (n, 2))
    lag = np.hypot(*(at[:, None] - at[None]).transpose(2, 0, 1))
    covariance = model.sill - model.nugget - model.rise(lag) + model.nugget * np.eye(n)
    z = rng.multivariate_normal(np.full(n, 900.0), covariance, layers, method="cholesky")
    return at, z


def textbook(model: type[Bounded], at: Floats, z: Floats, nugget: float, reach: float,
             psill: float) -> float:  # fmt: skip
    """Twice the negative restricted log likelihood, with the sill not profiled out."""
    lag = np.hypot(*(at[:, None] - at[None]).transpose(2, 0, 1))
    v = psill * model.correlation(lag / reach) + nugget * np.eye(len(z))
    inverse, one = np.linalg.inv(v), np.ones(len(z))
    q = one @ inverse @ one
    p = inverse - np.outer(inverse @ one, one @ inverse) / q
    return float(np.linalg.slogdet(v)[1] + log(q) + z @ p @ z)


@pytest.mark.parametrize("model", [Exponential, Spherical, Matern32])
@pytest.mark.parametrize("seed", range(6))
def test_no_independent_search_finds_a_likelier_variogram(model: type[Bounded], seed: int) -> None:
    at, z = drawn(model(100.0, 50.0, 400.0), seed, n=50)
    (fit,) = Reml(model)(at, z)
    lag = np.hypot(*(at[:, None] - at[None]).transpose(2, 0, 1))
    low, high = lag[lag > 0].min(), lag.max()

    def loss(p: Floats) -> float:
        sill, share = exp(p[0]), p[2]
        return textbook(model, at, z[0], share * sill, exp(p[1]), (1 - share) * sill)

    best = min(
        minimize(
            loss, [log(z.var()), log(reach), share], method="L-BFGS-B",
            bounds=[(None, None), (log(low), log(high)), (1e-3, 0.999)],
        ).fun
        for reach in (10.0, 20.0, 40.0, 90.0)
        for share in (0.1, 0.5)
    )  # fmt: skip
    found = fit.variogram
    ours = textbook(model, at, z[0], found.nugget, found.range, found.sill - found.nugget)
    assert ours <= best + 1e-4


def test_the_sill_is_the_likeliest_given_range_and_share() -> None:
    at, z = drawn(Exponential(100.0, 50.0, 400.0), 4)
    (fit,) = Reml()(at, z)
    found = fit.variogram
    ours, less, more = (
        textbook(
            Exponential, at, z[0], f * found.nugget, found.range, f * (found.sill - found.nugget)
        )
        for f in (1.0, 0.98, 1.02)
    )
    assert ours < min(less, more)


def test_the_truth_is_found_within_its_interval_in_nineteen_fields_of_twenty() -> None:
    at, z = drawn(Exponential(60.0, 50.0, 400.0), 5, n=70, layers=60)
    fits = Reml()(at, z)
    inside = sum(_holds(fit.why, 50.0) for fit in fits)
    # 57 expected; three binomial SDs, 1.7 each, and one field for the asymptotic chi-square.
    assert inside >= 57 - 6
    # The median of estimates of a log range: its standard error is 1.25 SD / sqrt(60).
    logs = np.log([fit.variogram.range / 50.0 for fit in fits])
    assert abs(np.median(logs)) < 3 * 1.25 * logs.std(ddof=1) / np.sqrt(60)
    sills = np.array([fit.variogram.sill for fit in fits])
    assert abs(np.median(sills) / 460.0 - 1.0) < 3 * 1.25 * sills.std(ddof=1) / 460.0 / np.sqrt(60)


def _holds(why: str, truth: float) -> bool:
    """Whether the interval said contains a range."""
    said = why.split(", 95 % ")[1].split(";", maxsplit=1)[0]
    words = said.split()
    low = 0.0 if words[0] in ("up", "anywhere") else float(words[1])
    high = inf if words[0] in ("from", "anywhere") else float(words[-2])
    return low - 0.5 <= truth <= high + 0.5


def test_layers_together_are_fitted_as_each_alone() -> None:
    at, z = drawn(Exponential(100.0, 50.0, 400.0), 6, n=40, layers=3)
    together = Reml()(at, z)
    for k, fit in enumerate(together):
        (alone,) = Reml()(at, z[k : k + 1])
        assert_allclose(fit.variogram.range, alone.variogram.range, rtol=1e-6)
        assert_allclose(fit.variogram.sill, alone.variogram.sill, rtol=1e-6)


def test_a_layer_that_few_samples_reached_is_fitted_on_those() -> None:
    at, z = drawn(Exponential(100.0, 50.0, 400.0), 7, n=40, layers=3)
    z[1, 25:] = np.nan
    z[2, FEWEST_SAMPLES - 1 :] = np.nan
    first, second, third = Reml()(at, z)
    (alone,) = Reml()(at[:25], z[1:2, :25])
    assert_allclose(second.variogram.range, alone.variogram.range, rtol=1e-6)
    assert "25 samples" in second.why
    assert isinstance(third.variogram, Nested)
    assert third.why.startswith("7 samples only: pooled")
    assert not first.is_prior


@pytest.mark.parametrize("n", [0, 1, 2, 3, 7])
def test_too_few_samples_get_the_pooled_correlogram(n: int) -> None:
    at, z = drawn(Exponential(100.0, 50.0, 400.0), 8, n=max(n, 1), layers=2)
    fits = Reml()(at[:n], z[:, :n])
    assert all(isinstance(fit.variogram, Nested) for fit in fits)
    assert all(f"{n} sample" in fit.why for fit in fits)


def test_values_that_do_not_differ_and_places_that_do_not_get_the_pooled_correlogram() -> None:
    at, z = drawn(Exponential(100.0, 50.0, 400.0), 9, n=20)
    (flat,) = Reml()(at, np.full((1, 20), 800.0))
    assert flat.why.startswith("no pair of values differs")
    (spot,) = Reml()(np.repeat(at[:2], 10, axis=0), z)
    assert spot.why.startswith("fewer than 3 places")


@pytest.mark.parametrize("n", [FEWEST_SAMPLES, 30, 101, 230])
def test_any_number_of_samples_gives_a_model(n: int) -> None:
    at, z = drawn(Matern32(100.0, 60.0, 400.0), 10, n=n)
    (fit,) = Reml()(at, z)
    assert fit.variogram.sill > 0
    assert f"{n} samples" in fit.why


def test_repeats_at_one_place_are_no_trouble() -> None:
    at, z = drawn(Exponential(100.0, 50.0, 400.0), 11, n=30)
    rng = np.random.default_rng(2)
    again = z + rng.normal(0.0, 10.0, z.shape)
    (fit,) = Reml()(np.concatenate([at, at]), np.concatenate([z, again], axis=1))
    assert fit.variogram.nugget < 150.0


def test_pure_nugget_is_said_to_be_on_a_bound() -> None:
    rng = np.random.default_rng(14)
    at = rng.uniform(0.0, 150.0, (60, 2))
    fits = Reml()(at, rng.normal(800.0, 30.0, (12, 60)))
    bound = [fit for fit in fits if "psill" in fit.at_bound]
    assert bound
    assert all("on the bound of" in fit.why for fit in bound)


def test_a_strong_prior_wins_over_few_samples() -> None:
    at, z = drawn(Exponential(100.0, 50.0, 400.0), 12, n=12)
    (fit,) = Reml(median_range=80.0, log_sd=0.001, nugget_beta=(300.0, 700.0))(at, z)
    assert_allclose(fit.variogram.range, 80.0, rtol=0.01)
    assert_allclose(fit.variogram.nugget / fit.variogram.sill, 0.3, atol=0.05)


@pytest.mark.parametrize(
    "settings",
    [
        {"model": BoundedLinear},
        {"log_sd": 0.0},
        {"median_range": -1.0},
        {"nugget_beta": (0.5, 1.0)},
    ],
)
def test_settings_that_cannot_be_are_refused(settings: dict[str, object]) -> None:
    with pytest.raises(ParameterError, match="estimator reml"):
        Reml(**settings)  # type: ignore[arg-type]


def test_it_goes_by_its_name() -> None:
    assert ESTIMATORS["reml"] == Reml()
