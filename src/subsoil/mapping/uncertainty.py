"""What kriging variances say: how far the map may be off, and where it is sure enough."""

from __future__ import annotations

from dataclasses import dataclass
from math import nan

import numpy as np
import scipy
from numpy.typing import ArrayLike

from subsoil.arrays import Bools, Floats, Integers
from subsoil.mapping.soilmap import SoilMap
from subsoil.variogram.layer_correlation import layer_correlation


def standard_deviation(variance: ArrayLike) -> Floats:
    """Standard deviation of a kriging variance, in any shape; kPa of kPa2.

    A variance that rounding left a hair below zero has no root and is not made into zero: its
    standard deviation is NaN, as is that of NaN.

    Examples
    --------
    >>> standard_deviation([10_000.0, 0.0, -1e-12])
    array([100.,   0.,  nan])
    """
    values = np.asarray(variance, dtype=float)
    root = np.full(values.shape, np.nan)
    np.sqrt(values, out=root, where=values >= 0.0)
    return root


@dataclass(frozen=True)
class MeanSquare:
    """What is known of the mean square error of a map: a scaled F distribution.

    Attributes
    ----------
    kv
        Mean kriging variance in kPa2.
    errors
        Degrees of freedom of the errors: on how many independent ones the mean square rests.
    sills
        Degrees of freedom of the sills: on how many independent contrasts of readings they rest.

    Examples
    --------
    >>> error = MeanSquare(kv=1600.0, errors=60.0, sills=46.0)
    >>> round(error.rmse(0.8), 1), round(error.probability(45.0), 2)
    (45.1, 0.8)
    """

    kv: float
    errors: float
    sills: float

    def probability(self, rmse: float) -> float:
        """Probability that the root mean square error is at or below a value in kPa."""
        if self.kv == 0:
            return 1.0
        return float(scipy.special.fdtr(self.errors, self.sills, rmse * rmse / self.kv))

    def rmse(self, probability: float) -> float:
        """Root mean square error in kPa that is not passed with a probability."""
        if self.kv == 0:
            return 0.0
        return float(
            standard_deviation(self.kv * scipy.special.fdtri(self.errors, self.sills, probability))
        )


def predicted_rmse(soil_map: SoilMap) -> float:
    """RMSE in kPa that a map expects of itself: the root of its mean kriging variance.

    NaN before the second sample: one tells nothing of how much the soil varies.
    """
    return float(standard_deviation(soil_map.field_kv)) if len(soil_map.samples) > 1 else nan


def mean_square_error(soil_map: SoilMap) -> MeanSquare:
    """Distribution of the mean square error of a map over its cells and layers.

    Errors of a layer are Gaussian with the kriging covariance P between cells, so their mean
    square over k cells has the mean tr P / k and the variance 2 tr(P P) / k2 (Mathai & Provost,
    *Quadratic Forms in Random Variables*, 1992, sec. 3.2b): about a chi-square of as many degrees
    of freedom as give this variance (Satterthwaite, *Biometrics Bulletin* 2, 1946). P is in units
    of a sill that n readings, that is n - 1 contrasts, tell: the true sill over the estimated one
    is n - 1 over a chi-square of n - 1. Both together are an F distribution. Mean squares of two
    layers correlate with the square of the correlation r of their errors, for which 0.9 of that
    of their readings stands. For m layers alike, of equal weight and all reached by n samples, the
    degrees of freedom are::

        errors = (tr P)^2 / tr(P P) * m^2 / sum r^2
        sills  = (n - 1)            * m^2 / sum r^2

    A layer that fewer samples reached rests on fewer contrasts, on one at least. P is taken on at
    most 300 cells spread over the field. Ranges and shares of nugget are taken
    for known: it holds as far as the variograms do, with the estimator ``pmc`` on the test bed,
    but not with least squares, which take the soil for smoother than it is. NaN before the second
    sample.
    """
    if len(soil_map.samples) < 2:
        return MeanSquare(nan, nan, nan)
    if not soil_map.field_kv > 0:
        return MeanSquare(soil_map.field_kv, nan, nan)
    mean, square = np.zeros(len(soil_map.layers)), np.zeros(len(soil_map.layers))
    cells = subsample(len(soil_map.cells))
    for stack in soil_map.stacks:
        p = stack.unit[:, None, None] * stack.estimate.error_covariance(cells, cells)
        mean[list(stack.layers)] = np.diagonal(p, axis1=1, axis2=2).mean(axis=1)
        square[list(stack.layers)] = np.mean(p * p, axis=(1, 2))
    kpa = soil_map.kpa
    weights, likeness = np.asarray(soil_map.layers.weights), layer_correlation(kpa) ** 2
    contrasts = np.maximum(np.isfinite(kpa).sum(axis=1) - 1, 1)
    of_errors, of_sills = weights * np.sqrt(square), weights * mean / np.sqrt(contrasts)
    total = float(weights @ mean) ** 2
    errors = total / float(of_errors @ likeness @ of_errors)
    sills = total / float(of_sills @ likeness @ of_sills)
    return MeanSquare(soil_map.field_kv, errors, sills)


def probability_above(mean: ArrayLike, deviation: ArrayLike, threshold: float) -> Floats:
    """Probability that a value is above a threshold, Gaussian around its kriged mean.

    Parameters
    ----------
    mean, deviation
        Kriged value and its standard deviation in kPa, of one shape. A deviation of 0 is a
        certainty; NaN stays NaN.
    threshold
        Threshold in kPa.

    Examples
    --------
    >>> probability_above([2000.0, 2100.0, 1900.0], [100.0, 100.0, 0.0], 2000.0).round(3)
    array([0.5  , 0.841, 0.   ])
    """
    over_it = np.asarray(mean, dtype=float) - threshold
    spread = np.asarray(deviation, dtype=float)
    certain = np.where(over_it > 0, np.inf, -np.inf)
    ratio = np.divide(over_it, spread, out=certain, where=spread != 0.0)
    result: Floats = scipy.special.ndtr(ratio)
    return result


def decided(above: Floats, confidence: float) -> Bools:
    """(N,) cells known to be above a threshold in some layer, or in none, with a confidence.

    The probability that some layer is above is at least the greatest of the layers' own, which
    stands for it: exact where a cell's layers are in error together. "Above" therefore keeps its
    confidence whatever the layers do; "in none" is the less sure the less they have in common.

    Parameters
    ----------
    above
        (m, N) probabilities of the layers; NaN in layers that tell nothing.
    confidence
        Probability from which on a cell is decided.

    Examples
    --------
    >>> decided(np.array([[0.1, 0.9, 0.1], [0.1, 0.2, 0.5]]), 0.8)
    array([ True,  True, False])
    """
    greatest = np.fmax.reduce(above, axis=0)
    return np.asarray(np.maximum(greatest, 1.0 - greatest) >= confidence)


def subsample(cells: int, most: int = 300) -> Integers:
    """Indices of at most so many of a number of cells, evenly spaced in their order."""
    return np.linspace(0, cells - 1, min(cells, most)).round().astype(np.int64)
