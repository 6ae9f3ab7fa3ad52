"""Simulated soils vary between places as the variogram they were drawn with says.

The semivariance of a Gaussian field over a number of pairs is a quadratic form z' A z, with A the
Laplacian of the pairs over twice their number. Over the covariance C it has the mean tr(A C) and
the variance 2 tr(A C A C) (Mathai & Provost 1992, sec. 3.2b), from which the bounds here come:
4.5 standard errors, over layers or draws that are independent.
"""

from __future__ import annotations

from dataclasses import replace
from math import sqrt

import numpy as np
import pytest
from scipy.spatial.distance import cdist
from scipy.stats import kstest

from subsoil.arrays import Floats, Integers
from subsoil.errors import SingularSystemError
from subsoil.land.field import Field
from subsoil.layers import Layers
from subsoil.simulation import Soil, Truth, conditional_truth
from subsoil.simulation.gaussian import covariance_factor
from subsoil.simulation.soil import grow
from subsoil.variogram import Estimator, Fit, LeastSquares, Spherical
from subsoil.variogram.models import Bounded

FIELD = Field.from_metres([(0, 0), (100, 0), (100, 80), (0, 80)])
STEPS = [(1, 0), (0, 1), (2, 2), (5, 0), (3, -4), (0, 9)]
"""Cells from one place of a pair to the other, east and north: 5 to 45 m in six directions."""


def correlation_of(model: str, lag: Floats, practical_range: float) -> Floats:
    """Correlation by distance of the models that soils are drawn with, written down anew."""
    h = lag / practical_range
    if model == "spherical":
        return np.asarray(np.where(h < 1, 1 - 1.5 * h + 0.5 * h**3, 0.0))
    if model == "exponential":
        return np.asarray(np.exp(-3 * h))
    # Matern 3/2 that has come down to 5 % at the practical range: (1 + s) e^-s = 0.05.
    s = 4.743864518390607 * h
    return np.asarray((1 + s) * np.exp(-s))


def pairs(step: tuple[int, int]) -> tuple[Integers, Integers]:
    """Cells a step apart."""
    index = {(x, y): k for k, (x, y) in enumerate(FIELD.cells.tolist())}
    ends = [
        (k, index[x + 5.0 * step[0], y + 5.0 * step[1]])
        for (x, y), k in index.items()
        if (x + 5.0 * step[0], y + 5.0 * step[1]) in index
    ]
    one, other = np.array(ends).T
    return one, other


def laplacian(one: Integers, other: Integers) -> Floats:
    """(N, N) matrix A by which z' A z is the semivariance over pairs."""
    n = len(FIELD.cells)
    adjacent = np.zeros((n, n))
    np.add.at(adjacent, (one, other), 1.0)
    adjacent += adjacent.T
    return np.asarray((np.diag(adjacent.sum(axis=1)) - adjacent) / (2 * len(one)))


def semivariance(z: Floats, one: Integers, other: Integers) -> Floats:
    return np.asarray(0.5 * np.mean((z[..., one] - z[..., other]) ** 2, axis=-1))


@pytest.mark.parametrize("model", ["spherical", "exponential", "matern-3/2"])
def test_a_soil_has_the_semivariance_asked_for_at_every_lag_and_in_every_direction(
    model: str,
) -> None:
    """Layers far apart for their vertical correlation are draws of their own."""
    soil = Soil(model, 40.0, 0.2, 0.01, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    depth = np.linspace(0.1, 2.0, 12)
    rng = np.random.default_rng(6)
    grown = [grow(soil, FIELD, FIELD.cells, depth, rng)[0] for _ in range(10)]
    mean, sd = soil.mean_kpa(depth)[:, None], soil.sd_kpa(depth)[:, None]
    z = np.concatenate([(kpa - mean) / sd for kpa in grown])
    covariance = correlation_of(model, cdist(FIELD.cells, FIELD.cells), 40.0)
    for step in STEPS:
        one, other = pairs(step)
        lag = 5.0 * np.hypot(*step)
        expected = 1.0 - float(correlation_of(model, np.array(lag), 40.0))
        assert float(soil.variogram().rise(np.array(lag))) == pytest.approx(expected, abs=1e-9)
        product = laplacian(one, other) @ covariance
        assert np.trace(product) == pytest.approx(expected, abs=1e-9)
        spread = sqrt(2 * float(np.sum(product * product.T)) / len(z))
        found = float(semivariance(z, one, other).mean())
        assert found == pytest.approx(expected, abs=4.5 * spread), step


def test_a_push_adds_the_nugget_to_the_semivariance_at_every_lag_alike() -> None:
    """Of independent layers, pairs of cells that share a cell included."""
    soil = Soil("spherical", 40.0, 0.4, 0.01, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    depth = np.linspace(0.1, 2.0, 20)
    _, noise = grow(soil, FIELD, FIELD.cells, depth, np.random.default_rng(7))
    z = noise / soil.sd_kpa(depth)[:, None]
    nugget = 0.4 / 0.6
    for step in STEPS:
        one, other = pairs(step)
        a = laplacian(one, other) * nugget
        spread = sqrt(2 * float(np.sum(a * a.T)) / len(depth))
        found = float(semivariance(z, one, other).mean())
        assert found == pytest.approx(nugget, abs=4.5 * spread), step


def test_soil_and_pushes_are_gaussian_before_features_are_added() -> None:
    """Places a kilometre apart and layers without correlation are independent."""
    soil = Soil("matern-3/2", 30.0, 0.25, 0.01, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    at = np.column_stack([1000.0 * np.arange(60), np.zeros(60)])
    depth = np.linspace(0.1, 2.0, 20)
    kpa, noise = grow(soil, FIELD, at, depth, np.random.default_rng(8))
    sd = soil.sd_kpa(depth)[:, None]
    z = ((kpa - soil.mean_kpa(depth)[:, None]) / sd).ravel()
    assert kstest(z, "norm").pvalue > 1e-4
    assert kstest((noise / sd).ravel(), "norm", (0, sqrt(0.25 / 0.75))).pvalue > 1e-4


def test_a_harder_soil_of_the_same_chance_is_the_same_in_units_of_its_own_layers() -> None:
    plain = Soil("spherical", 30.0, 0.2, 0.15, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    depth, usual = Layers().centre_m, plain.mean_kpa(Layers().centre_m)[:, None]
    standard = []
    for level in (0.8, 1.2):
        rng = np.random.default_rng(3)
        kpa, noise = grow(replace(plain, level=level), FIELD, FIELD.cells, depth, rng)
        sd = 0.22 * level * usual + 40.0
        standard.append(((kpa - level * usual) / sd, noise / sd))
    for soft, hard in zip(*standard, strict=True):
        assert np.allclose(soft, hard, atol=1e-9)


def test_the_factor_of_a_covariance_times_itself_is_the_covariance() -> None:
    rng = np.random.default_rng(1)
    at = rng.uniform(0, 100, (40, 2))
    factor = covariance_factor(at, lambda lag: 7.0 * np.exp(-lag / 20.0), what="it", where="here")
    assert np.allclose(np.triu(factor, 1), 0.0)
    assert np.allclose(factor @ factor.T, 7.0 * np.exp(-cdist(at, at) / 20.0), rtol=1e-12)


def test_what_is_no_covariance_is_named_with_how_many_places_and_what_to_do() -> None:
    at = np.array([(0.0, 0.0), (1.0, 0.0), (2.0, 0.0)])
    with pytest.raises(SingularSystemError) as caught:
        covariance_factor(at, lambda lag: 1.0 + lag, what="a rising soil", where="layer 3")
    assert str(caught.value) == (
        "layer 3: a rising soil at 3 places is not positive definite "
        "(remedy: use the spherical model, or larger cells)"
    )


# Soils that agree with readings

SMALL = Field.from_metres([(0, 0), (40, 0), (40, 30), (0, 30)])
MODELS = (Spherical(400.0, 30.0, 3600.0), Spherical(900.0, 30.0, 8100.0))
DRAWS = 160


def told(*models: Bounded) -> Estimator:
    """Estimator that knows the variograms."""
    fit = LeastSquares(Spherical)

    def estimate(at: Floats, z: Floats) -> tuple[Fit, ...]:
        return tuple(replace(f, variogram=m) for f, m in zip(fit(at, z), models, strict=True))

    return estimate


def test_conditional_soils_are_wrong_together_as_kriging_errors_are() -> None:
    """Deviations from the kriged map covary between cells as the errors of ordinary kriging.

    The mean product of two zero-mean normal values over n draws has the variance
    (P_ii P_jj + P_ij^2) / n.
    """
    rng = np.random.default_rng(8)
    at = rng.uniform((0, 0), (40, 30), (14, 2))
    kpa = np.array([[2000.0], [4000.0]]) + rng.normal(0, 60, (2, 14))
    soils = [
        conditional_truth(
            SMALL, at, kpa, Layers((0.0, 0.2, 0.4)), np.random.default_rng(k),
            estimator=told(*MODELS),
        )
        for k in range(DRAWS)
    ]  # fmt: skip
    near = [0, 1, 8, 9, 20, 21, 47]
    to = SMALL.cells[near]
    for layer, model in enumerate(MODELS):
        sill, nugget, n = model.sill - model.nugget, model.nugget, len(at)
        system = np.ones((n + 1, n + 1))
        system[:n, :n] = sill * correlation_of("spherical", cdist(at, at), 30.0)
        system[:n, :n] += nugget * np.eye(n)
        system[n, n] = 0.0
        right = np.vstack([sill * correlation_of("spherical", cdist(at, to), 30.0), np.ones(7)])
        weights = np.linalg.solve(system, right)[:n]
        cross = weights.T @ right[:n]
        own = weights.T @ system[:n, :n] @ weights
        prior = sill * correlation_of("spherical", cdist(to, to), 30.0)
        p = prior - cross - cross.T + own
        off = np.array([soil.kpa[layer, near] for soil in soils]) - weights.T @ kpa[layer]
        spread = np.sqrt((np.outer(np.diag(p), np.diag(p)) + p**2) / DRAWS)
        assert np.all(np.abs(off.T @ off / DRAWS - p) <= 4.5 * spread)
        # In units of their own spread they are independent: a chi-square of 7 a draw.
        squares = float((np.linalg.solve(np.linalg.cholesky(p), off.T) ** 2).mean())
        assert squares == pytest.approx(1.0, abs=4.5 * sqrt(2 / (7 * DRAWS)))
        # Nearby cells are wrong together: the test would see it if they were not.
        assert p[0, 1] > 5 * spread[0, 1]


def test_pushes_beyond_the_first_come_from_other_cells_and_each_again_the_same() -> None:
    """Deviations of further pushes are those of cells chosen evenly over the field."""
    rng = np.random.default_rng(2)
    noise = rng.permutation(np.arange(48.0)) - 24.0
    truth = Truth(
        SMALL, Layers((0.0, 0.4)), np.full((1, 48), 900.0), noise[None],
        Soil("spherical", 30.0, 0.2, 0.15, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    )  # fmt: skip
    drawn = np.array(
        [truth.reading(c, push)[0] - 900.0 for c in range(48) for push in range(1, 41)]
    )
    again = np.array(
        [truth.reading(c, push)[0] - 900.0 for c in range(48) for push in range(1, 41)]
    )
    assert np.array_equal(drawn, again)
    values, counts = np.unique(drawn, return_counts=True)
    assert set(values) == set(noise)
    # Each of 48 cells is drawn 40 times on average: chi-square of 47 degrees of freedom.
    statistic = float(np.sum((counts - 40.0) ** 2 / 40.0))
    assert statistic <= 47 + 4.5 * sqrt(2 * 47)
