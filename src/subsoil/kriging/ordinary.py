"""Ordinary kriging as a value: condition on readings, predict, append, predict again."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from subsoil.arrays import Bools, Floats
from subsoil.errors import ParameterError, ReadingsError
from subsoil.kriging.covariance import Covariance, lags
from subsoil.kriging.direct import predicted
from subsoil.kriging.grid.dense import predicted_on_grid
from subsoil.kriging.prediction import Prediction
from subsoil.kriging.readings import (
    Readings,
    checked,
    checked_error,
    checked_targets,
    distinct,
)
from subsoil.kriging.system import Border, System, factorised
from subsoil.kriging.validity import (
    circular_note,
    ill_conditioned,
    replaceable,
    singular,
    with_circular,
)
from subsoil.variogram.models import Variogram

Invalid = Literal["circular", "nan"]
"""What to do where the bounded linear model gives no valid system: the circular model, or NaN."""

_ROUNDING = 1e-9
"""Share of the sill below which a negative variance is rounding and not a broken model."""


@dataclass(frozen=True)
class OrdinaryKriging:
    """Readings, conditioned on; made by :func:`condition`.

    Attributes
    ----------
    system
        The factorised kriging system.
    layered
        Whether values came as (m, n), so that predictions carry the m too.
    invalid
        What to do where the bounded linear model gives no valid system.
    notes
        What happened on the way.
    """

    system: System
    layered: bool
    invalid: Invalid
    notes: tuple[str, ...] = ()

    @property
    def at(self) -> Floats:
        """(n, 2) distinct places of the readings in m."""
        return self.system.readings.at

    @property
    def z(self) -> Floats:
        """(m, n) values there, repeats averaged."""
        return self.system.readings.z

    @property
    def variograms(self) -> tuple[Variogram, ...]:
        """The g models kriged with: one for all layers, or one a layer."""
        return self.system.covariance.variograms

    def append(
        self, at: ArrayLike, z: ArrayLike, *, error_variance: ArrayLike = 0.0
    ) -> OrdinaryKriging:
        """Condition on further readings as well; the same as conditioning on all at once.

        Parameters
        ----------
        at
            (2,) or (k, 2) places in m.
        z
            Scalar or (m,) for one place, (k,) or (m, k) for k.
        error_variance
            Scalar, (k,) or (g, k) variance of each reading beyond the nugget.

        Raises
        ------
        ReadingsError
            If shapes do not fit or a value is not finite.
        SingularSystemError
            If the system has no answer with the new readings.
        """
        grown = self
        for place, values, noise in self.incoming(at, z, error_variance):
            grown = grown.joined(place, values, noise)
        return grown

    def predict(self, targets: ArrayLike) -> Prediction:
        """Mean and variance at (N, 2) places in m, as (N,) or (m, N).

        Raises
        ------
        SingularSystemError
            If a variance is negative beyond rounding under a model that should forbid it.
        """
        places = checked_targets(targets)
        mean, variance = predicted(self.system, places)
        mended = self.mended(variance)
        return self.prediction(mean, variance) if mended is self else mended.predict(places)

    def predict_grid(self, easting: ArrayLike, northing: ArrayLike) -> Prediction:
        """Mean and variance on a dense grid, as (ny, nx) or (m, ny, nx).

        The same answer as :meth:`predict` to about 1e-9 standard deviations of the readings and
        sills, by :mod:`subsoil.kriging.grid.dense`, which compares every map with direct kriging at
        random cells and keeps the largest difference seen as ``spot_check``.

        Parameters
        ----------
        easting, northing
            (nx,) and (ny,) ascending, evenly spaced coordinates in m.

        Raises
        ------
        ParameterError
            If the coordinates are not such.
        SingularSystemError
            If a variance is negative beyond rounding under a model that should forbid it.
        """
        mean, variance, spot_check = predicted_on_grid(self.system, easting, northing)
        mended = self.mended(variance)
        if mended is not self:
            return mended.predict_grid(easting, northing)
        return replace(self.prediction(mean, variance), spot_check=spot_check)

    def joined(self, at: Floats, z: Floats, noise: Floats) -> OrdinaryKriging:
        """Condition on one more reading: (2,) place, (m,) values and (g,) noise."""
        system = self.system
        lag = lags(system.readings.at, at[None])[:, 0]
        border = system.border(lag, system.covariance(lag), noise)
        if border.sound:
            return self.grown(border, at, z, noise)
        readings = system.readings.joined(at, z, noise)
        return _conditioned(readings, system.covariance, self.layered, self.invalid, self.notes)

    def grown(self, border: Border, at: Floats, z: Floats, noise: Floats) -> OrdinaryKriging:
        """Condition on one more reading whose border is known and sound."""
        system = self.system.grown(border, at, z, noise)
        return OrdinaryKriging(system, self.layered, self.invalid, self.notes)

    def incoming(
        self, at: ArrayLike, z: ArrayLike, error_variance: ArrayLike
    ) -> Iterator[tuple[Floats, Floats, Floats]]:
        """Places (2,), values (m,) and noises (g,) of further readings, checked, one by one."""
        readings, covariance = self.system.readings, self.system.covariance
        places, values = checked(at, z, len(readings.z))
        error = checked_error(error_variance, len(covariance.variograms), len(places))
        noise = error + covariance.noise[:, None]
        return zip(places, values.T, noise.T, strict=True)

    def mended(self, variance: Floats) -> OrdinaryKriging:
        """Return this kriging, or with valid models for those that gave a negative variance.

        Parameters
        ----------
        variance
            (g, ...) predicted variances.

        Raises
        ------
        SingularSystemError
            If a model that is valid in the plane did so: the system is too ill-conditioned.
        """
        if not variance.size or not variance.min() < 0.0:
            return self
        lowest = variance.reshape(len(variance), -1).min(axis=1)
        broken = lowest < -_ROUNDING * self.system.scale
        wrong = np.flatnonzero(broken & ~replaceable(self.system.covariance))
        if wrong.size:
            raise ill_conditioned(lowest[wrong[0]], self.variograms, int(wrong[0]))
        return self.with_circular(broken) if self.invalid == "circular" and broken.any() else self

    def with_circular(self, models: Bools) -> OrdinaryKriging:
        """Krige the (g,) marked bounded linear models by the circular one of the same slope."""
        covariance = with_circular(self.system.covariance, models)
        notes = (*self.notes, circular_note(models))
        return _conditioned(self.system.readings, covariance, self.layered, self.invalid, notes)

    def prediction(self, mean: Floats, variance: Floats) -> Prediction:
        """Shape (m, ...) means and (g, ...) variances as the values came; NaN where not valid."""
        if self.invalid == "nan":
            threshold = -_ROUNDING * self.system.scale
            negative = variance < threshold.reshape(-1, *[1] * (variance.ndim - 1))
            variance = np.where(negative, np.nan, variance)
            mean = np.where(negative, np.nan, mean)
        return Prediction(self.shaped(mean), self.shaped(variance), self.notes)

    def shaped(self, values: Floats) -> Floats:
        """Shape (g, ...) or (m, ...) values as (m, ...), or (...) if the readings came as (n,)."""
        if not self.layered:
            values = values[0]
        elif len(values) < len(self.z):
            values = np.broadcast_to(values, (len(self.z), *values.shape[1:]))
        values.flags.writeable = False
        return values


def condition(
    variogram: Variogram | Sequence[Variogram],
    at: ArrayLike,
    z: ArrayLike,
    *,
    exact: bool = False,
    error_variance: ArrayLike = 0.0,
    invalid: Invalid = "circular",
) -> OrdinaryKriging:
    """Condition ordinary kriging on readings.

    By default the *signal* is predicted: the nugget and ``error_variance`` are what a reading
    differs by from the soil around it, and are filtered out. With ``exact`` the nugget is part of
    what is predicted and readings are reproduced, as in classic kriging. Readings at one place
    are averaged, with their variance over their number, and never make the system singular.

    Parameters
    ----------
    variogram
        One model for all layers, or one a layer.
    at
        (n, 2) easting and northing in m.
    z
        (n,) values, or (m, n) for m layers.
    exact
        Reproduce readings instead of filtering the nugget.
    error_variance
        Scalar, (n,) or (m, n) variance of each reading beyond the nugget, in squared units of z.
    invalid
        Where a bounded linear model gives no valid system in the plane: krige with the circular
        model of the same slope and say so in ``notes``, or return NaN there.

    Raises
    ------
    ReadingsError
        If shapes do not fit, there is no reading, or a value is not finite.
    ParameterError
        If there is not one variogram, or one a layer, or a variance is negative.
    SingularSystemError
        If the system is not positive definite.

    Examples
    --------
    >>> from subsoil import Spherical
    >>> at, z = [(0.0, 0.0), (10.0, 0.0), (0.0, 20.0)], [1.0, 2.0, 4.0]
    >>> ok = condition(Spherical(nugget=0.0, range=50.0, psill=1.0), at, z)
    >>> mean, variance = ok.predict([(10.0, 0.0), (5.0, 5.0)])
    >>> mean.round(3), variance.round(3)
    (array([2.   , 2.003]), array([0.   , 0.235]))
    """
    if np.size(z) == 0:
        raise ReadingsError("there is no reading to krige from", remedy="give at least one")
    layered = np.ndim(z) == 2
    layers = len(np.asarray(z)) if layered else 1
    places, values = checked(np.array(at, dtype=float), np.array(z, dtype=float), layers)
    variograms = tuple(variogram) if isinstance(variogram, Sequence) else (variogram,)
    if len(variograms) not in (1, len(values)):
        raise ParameterError(
            f"{len(variograms)} variograms for {len(values)} layers",
            where="variogram",
            remedy="give one for all layers or one a layer",
        )
    if np.ndim(error_variance) == 2 and len(variograms) == 1:
        variograms = variograms * len(values)
    covariance = Covariance(variograms, exact)
    error = checked_error(error_variance, len(variograms), len(places))
    readings = distinct(places, values, error + covariance.noise[:, None])
    return _conditioned(readings, covariance, layered, invalid, ())


def _conditioned(
    readings: Readings,
    covariance: Covariance,
    layered: bool,
    invalid: Invalid,
    notes: tuple[str, ...],
) -> OrdinaryKriging:
    system, failed = factorised(readings.led(), covariance)
    ok = OrdinaryKriging(system, layered, invalid, notes)
    if not failed.any():
        return ok
    wrong = np.flatnonzero(failed & ~replaceable(covariance))
    if wrong.size:
        raise singular(readings, ok.variograms, int(wrong[0]))
    return ok.with_circular(failed) if invalid == "circular" else ok
