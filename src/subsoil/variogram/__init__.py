"""Variograms: how much soil differs, by the distance between two places.

From samples to a model: :func:`empirical` bins the differences of all pairs of samples,
:func:`fit` fits a :class:`Bounded` model to the bins and reports how that went. A survey has an
:data:`Estimator` do both for all layers after a reading, such as :class:`LeastSquares`.

Examples
--------
>>> import numpy as np
>>> at = np.random.default_rng(1).uniform(0, 100, (60, 2))
>>> kpa = 1500 + 300 * np.sin(at[:, 0] / 20)
>>> found = fit(empirical(at, kpa), Spherical)
>>> found.variogram.range > 30, found.is_prior
(True, False)
"""

from subsoil.variogram.empirical import EmpiricalVariogram, Formula, empirical, empirical_layers
from subsoil.variogram.estimators import (
    ESTIMATORS,
    Estimator,
    LeastSquares,
    bins_of,
    estimator_named,
    paper_10,
)
from subsoil.variogram.fitting import Fit, Weights, fit, fit_layers
from subsoil.variogram.models import (
    MODELS,
    Bounded,
    BoundedLinear,
    Circular,
    Exponential,
    Gaussian,
    Matern32,
    Matern52,
    Power,
    PureNugget,
    Spherical,
    Variogram,
    model_named,
    name_of_kind,
    semivariance,
)
from subsoil.variogram.nested import Nested, Structure, name_of
from subsoil.variogram.own import Own
from subsoil.variogram.pooled import Pooled
from subsoil.variogram.posterior import Posterior
from subsoil.variogram.reml import Reml

__all__ = [
    "ESTIMATORS",
    "MODELS",
    "Bounded",
    "BoundedLinear",
    "Circular",
    "EmpiricalVariogram",
    "Estimator",
    "Exponential",
    "Fit",
    "Formula",
    "Gaussian",
    "LeastSquares",
    "Matern32",
    "Matern52",
    "Nested",
    "Own",
    "Pooled",
    "Posterior",
    "Power",
    "PureNugget",
    "Reml",
    "Spherical",
    "Structure",
    "Variogram",
    "Weights",
    "bins_of",
    "empirical",
    "empirical_layers",
    "estimator_named",
    "fit",
    "fit_layers",
    "model_named",
    "name_of",
    "name_of_kind",
    "paper_10",
    "semivariance",
]
