"""Weighted least squares: optimality, bounds, honesty of the report, and what it cannot fit."""

from __future__ import annotations

from math import isnan

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.optimize import differential_evolution, nnls
from scipy.spatial.distance import cdist

from subsoil.errors import ParameterError, ReadingsError
from subsoil.variogram import (
    MODELS,
    Bounded,
    BoundedLinear,
    EmpiricalVariogram,
    Exponential,
    Fit,
    Gaussian,
    Spherical,
    Weights,
    empirical,
    empirical_layers,
    fit,
    fit_layers,
    semivariance,
)
from subsoil.variogram.least_squares import solve

Floats = NDArray[np.float64]
LAG = np.arange(5.0, 115.0, 10.0)
PAIRS = np.array([12, 31, 55, 72, 80, 88, 90, 84, 71, 60, 41])
every_model = pytest.mark.parametrize("model", MODELS.values(), ids=MODELS)
every_weight = pytest.mark.parametrize("weights", ["pairs", "pairs/lag2", "pairs/gamma2"])


def bins(gamma: Floats | list[float]) -> EmpiricalVariogram:
    gamma = np.array(gamma, dtype=float)
    return EmpiricalVariogram(LAG[: gamma.size].copy(), gamma, PAIRS[: gamma.size].copy())


def noisy_bins(seed: int, model: type[Bounded] = Spherical) -> EmpiricalVariogram:
    rng = np.random.default_rng(seed)
    curve = semivariance(model(rng.uniform(0, 5), rng.uniform(15, 150), rng.uniform(0, 10)), LAG)
    return bins(curve * rng.uniform(0.6, 1.4, LAG.size))


def weighted_squares(curve: EmpiricalVariogram, model: Bounded, weights: Weights) -> float:
    weight = {
        "pairs": curve.pairs,
        "pairs/lag2": curve.pairs / curve.lag**2,
        "pairs/gamma2": curve.pairs / semivariance(model, curve.lag) ** 2,
    }[weights]
    return float(weight @ (curve.semivariance - semivariance(model, curve.lag)) ** 2)


gammas = st.lists(st.floats(0.0, 1e6), min_size=1, max_size=LAG.size).filter(lambda g: max(g) > 1e-6)


@every_model
@every_weight
@pytest.mark.parametrize(("nugget", "reach", "psill"), [(2.0, 41.0, 6.0), (0.0, 63.0, 4e4), (9.0, 27.0, 1.0)])
def test_an_exact_curve_gives_back_its_parameters(
    model: type[Bounded], weights: Weights, nugget: float, reach: float, psill: float
) -> None:
    truth = model(nugget, reach, psill)
    found = fit(bins(semivariance(truth, LAG)), model, weights=weights)
    assert found.variogram.nugget == pytest.approx(nugget, rel=1e-4, abs=1e-5 * psill)
    assert found.variogram.range == pytest.approx(reach, rel=1e-4)
    assert found.variogram.psill == pytest.approx(psill, rel=1e-4)
    assert found.r2 == pytest.approx(1.0)
    assert found.sse < 1e-10 * weighted_squares(bins(semivariance(truth, LAG)), model(0, 1, 1e-9), "pairs")
