"""Kriging with external drift: a covariate known everywhere tells where the mean is higher.

The mean of a layer is ``a + b x(s)``, with x an EC map, a yield map or last year's map: universal
kriging with one drift function (Wackernagel, *Multivariate Geostatistics*, 2003, ch. 37-38). With
the whitened differences y = W (z - z1) and v(t) of :mod:`subsoil.kriging.system`, and x kriged
like one more layer, y_x = W (x - x1), it needs no other system than that of ordinary kriging::

    b           = y_x . y / (y_x . y_x)
    e(t)        = x(t) - x1 - y_x . v(t)
    mean(t)     = OK mean(t) + b e(t)
    variance(t) = OK variance(t) + e(t)^2 / (y_x . y_x)

A covariate that has nothing to do with the soil costs accuracy:
:mod:`subsoil.mapping.drift_choice` asks the readings first.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy
from numpy.typing import ArrayLike

from subsoil.arrays import Floats, Indices
from subsoil.errors import ParameterError, SingularSystemError
from subsoil.kriging.kriged_at import KrigedAt, variance_drop_of
from subsoil.kriging.leave_one_out import LeaveOneOut, leave_one_out
from subsoil.kriging.ordinary import OrdinaryKriging
from subsoil.kriging.prediction import Prediction
from subsoil.kriging.system import System
from subsoil.variogram import Variogram

_ROUNDING = 1e-9
"""Share of what tells the slope that is rounding: without it, the rest tells none."""


@dataclass(frozen=True)
class Covariate:
    """Something known all over a field that the soil may follow.

    Parameters
    ----------
    at
        (N, 2) places in m.
    values
        (N,) what is known there, in any unit.

    Raises
    ------
    ParameterError
        If shapes do not fit, or a number is not finite.

    Examples
    --------
    >>> ec = Covariate(np.array([[0.0, 0.0], [10.0, 0.0]]), np.array([30.0, 50.0]))
    >>> ec(np.array([[1.0, 0.5], [9.0, 0.0]]))
    array([30., 50.])
    """

    at: Floats
    values: Floats

    def __post_init__(self) -> None:
        if self.at.shape != (*self.values.shape, 2) or not (
            np.isfinite(self.at).all() and np.isfinite(self.values).all()
        ):
            raise ParameterError(
                f"{self.values.shape} values do not fit {self.at.shape} places, or are not finite",
                where="covariate",
                remedy="give one finite value a place",
            )
        self.at.setflags(write=False)
        self.values.setflags(write=False)

    def __len__(self) -> int:
        return len(self.values)

    def __call__(self, places: Floats) -> Floats:
        """(k,) values at the nearest known places of (k, 2) places in m."""
        return self.values[self._tree.query(places)[1]]

    @cached_property
    def _tree(self) -> scipy.spatial.KDTree:
        return scipy.spatial.KDTree(self.at)


NO_COVARIATE = Covariate(np.empty((0, 2)), np.empty(0))
"""That of a field of which nothing is known beforehand."""


@dataclass(frozen=True)
class Regression:
    """How the layers of a system follow a covariate; made by :func:`regression`.

    Attributes
    ----------
    y
        (g, n-1) W (x - x1).
    information
        (g,) y . y: the inverse variance of the slope.
    slope
        (m,) rise of a layer by unit of the covariate, by generalised least squares.
    """

    y: Floats
    information: Floats
    slope: Floats


def regression(system: System, x: Floats) -> Regression:
    """Regress the layers of a system on a covariate's (n,) values at its readings.

    Raises
    ------
    SingularSystemError
        If the covariate is the same at all readings.
    """
    y = system.whitened(x[1:] - x[0])
    information: Floats = np.einsum("gn,gn->g", y, y)
    if not information.all():
        raise SingularSystemError(
            f"the covariate is the same at all {len(x)} readings",
            where="external drift",
            remedy="sample where it differs, or leave it out",
        )
    each = len(system.y) // len(y)
    slope = np.einsum("mn,mn->m", system.y, np.repeat(y, each, axis=0))
    return Regression(y, information, slope / np.repeat(information, each))


@dataclass(frozen=True)
class Drifted:
    """Kriging with external drift at fixed targets: an ordinary estimate and what drift adds.

    A :class:`~subsoil.kriging.kriged.Kriged` at the cost of ordinary kriging.

    Attributes
    ----------
    estimate
        Ordinary kriging of the readings.
    covariate
        What their mean follows.
    """

    estimate: KrigedAt
    covariate: Covariate

    @property
    def at(self) -> Floats:
        """(n, 2) distinct places of the readings in m."""
        return self.estimate.at

    @property
    def targets(self) -> Floats:
        """(N, 2) places kriged at in m."""
        return self.estimate.targets

    @property
    def variograms(self) -> tuple[Variogram, ...]:
        """The g models kriged with."""
        return self.estimate.variograms

    @cached_property
    def regression(self) -> Regression:
        """How the layers follow the covariate."""
        return regression(self.estimate.kriging.system, self.covariate(self.at))

    @cached_property
    def residual(self) -> Floats:
        """(g, N) covariate at the targets minus what kriging makes of it from the readings'."""
        x1 = self.covariate(self.at[:1])
        kriged = self.estimate.combined(self.regression.y)
        return np.asarray(self.covariate(self.targets) - x1 - kriged)

    @cached_property
    def prediction(self) -> Prediction:
        """Mean and variance, (N,) or (m, N)."""
        found, e = self.regression, self.residual
        each = len(found.slope) // len(e)
        mean = self.estimate.mean + found.slope[:, None] * np.repeat(e, each, axis=0)
        variance = self.estimate.variance + e**2 / found.information[:, None]
        return self.estimate.kriging.prediction(mean, variance)

    def append(self, at: ArrayLike, z: ArrayLike, *, error_variance: ArrayLike = 0.0) -> Drifted:
        """Follow further readings; see :meth:`KrigedAt.append`."""
        grown = self.estimate.append(at, z, error_variance=error_variance)
        return Drifted(grown, self.covariate)

    def at_targets(self, targets: ArrayLike) -> Drifted:
        """Krige from the same readings at (k, 2) other targets in m."""
        return Drifted(self.estimate.at_targets(targets), self.covariate)

    def variance_drop(self, candidates: ArrayLike) -> Floats:
        """By how much the variance falls everywhere if one of these targets were probed next.

        Exact, as is :meth:`KrigedAt.variance_drop`; what a reading there tells of the slope is in.

        Parameters
        ----------
        candidates
            (k,) indices of targets.

        Returns
        -------
        ndarray
            (k, N), or (m, k, N) for layers.
        """
        index = np.asarray(candidates, dtype=np.intp)
        ok = self.estimate.kriging
        joint = self.error_covariance(index)
        return ok.shaped(variance_drop_of(joint, index, ok.system.covariance.noise))

    def error_covariance(self, rows: Indices, columns: Indices | slice = slice(None)) -> Floats:
        """(g, k, l) covariance of the kriging errors, those of the slope included."""
        e = self.residual
        joint = self.estimate.error_covariance(rows, columns)
        of_slope = e[:, rows, None] * e[:, None, columns]
        joint += of_slope / self.regression.information[:, None, None]
        return joint

    def leave_one_out(self) -> LeaveOneOut:
        """Each reading predicted from the others, and from what they tell of the slope."""
        return leave_one_out_with(self.covariate, self.estimate.kriging)


def leave_one_out_with(covariate: Covariate, ok: OrdinaryKriging) -> LeaveOneOut:
    """Leave-one-out residuals and variances of kriging with external drift, in closed form.

    As :func:`~subsoil.kriging.leave_one_out.leave_one_out`, with B - B x x' B / (x' B x) for B.
    Residual and variance are infinite where the other readings have one and the same value of the
    covariate.

    Raises
    ------
    ReadingsError
        With fewer than three readings.
    SingularSystemError
        If the covariate is the same at all readings.
    """
    plain, system = leave_one_out(ok), ok.system
    found = regression(system, covariate(ok.at))
    bx = system.precision_times(found.y)
    each = len(found.slope) // len(bx)
    bx = np.repeat(bx, each, axis=0)
    information = np.repeat(found.information, each)[:, None]
    left = 1.0 - bx**2 * plain.variance / information
    known = left > _ROUNDING
    residual = plain.residual - found.slope[:, None] * bx * plain.variance
    infinite = np.full_like(left, np.inf)
    return LeaveOneOut(
        np.divide(residual, left, out=infinite.copy(), where=known),
        np.divide(plain.variance, left, out=infinite, where=known),
        plain.mean_residual,
    )
