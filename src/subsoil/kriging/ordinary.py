"""Ordinary kriging as a value: condition on readings, predict, append, predict again.

With the covariance C of the correlated part, N the variance of the readings around it and
L L' = C + N, keep W = L^-1, f = W 1 and y = W z. Then for targets with covariances C0 and
V = W C0 (METHODS of Pulido Fentanes et al. 2018, eq. 1-3, with the Lagrange term the paper's
eq. 3 leaves out; Chilès & Delfiner 2012, sec. 3.4)::

    mu       = f.y / f.f
    u        = 1 - f V
    mean     = mu u + y V
    variance = C00 - sum(V^2) + u^2 / f.f

A further reading appends one row to W and V and one entry to f and y, which costs
O(n^2 + n N) and gives what conditioning on everything gives.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg.lapack import dpotrf, dtrtri

from subsoil.errors import KrigingError, ParameterError, ReadingsError, SingularSystemError
from subsoil.kriging.covariance import Covariance, covariance_of, lags
from subsoil.kriging.rows import Rows
from subsoil.variogram.models import BoundedLinear, Variogram

Floats = NDArray[np.float64]
Invalid = Literal["circular", "nan"]
"""What to do where the bounded linear model gives no valid system: the circular model, or NaN."""

_ROUNDING = 1e-9
"""Share of the sill below which a negative variance is rounding and not a broken model."""


@dataclass(frozen=True)
class Prediction:
    """Kriged values; unpacks as ``mean, variance``.

    Attributes
    ----------
    mean, variance
        (...) or (m, ...) kriged values and their variances.
    notes
        What happened on the way that the reader of a map should know.
    spot_check
        Largest difference, in standard deviations (means) or sills (variances), to a direct
        solution at random targets; 0 where the solution was direct.
    """

    mean: Floats
    variance: Floats
    notes: tuple[str, ...] = ()
    spot_check: float = 0.0

    def __iter__(self) -> Iterator[Floats]:
        return iter((self.mean, self.variance))


@dataclass(frozen=True)
class OrdinaryKriging:
    """Readings, conditioned on; made by :func:`condition`.

    Attributes
    ----------
    at
        (n, 2) distinct places in m.
    z
        (m, n) values there, repeats averaged.
    noise
        (g, n) variance of each value around what is predicted; g is 1 or m.
    count
        (n,) readings behind each value.
    covariance
        Models of the correlated part, g of them.
    exact
        Whether the nugget belongs to what is predicted.
    layered
        Whether values came as (m, n), so that predictions carry the m too.
    invalid
        What to do where the bounded linear model gives no valid system.
    notes
        What happened on the way.
    """

    at: Floats
    z: Floats
    noise: Floats
    count: Floats
    covariance: Covariance
    exact: bool
    layered: bool
    invalid: Invalid
    inverse: Rows
    y: Floats
    f: Floats
    notes: tuple[str, ...] = ()

    @property
    def variograms(self) -> tuple[Variogram, ...]:
        """The g models kriged with: one for all layers, or one a layer."""
        return self.covariance.variograms

    @property
    def ff(self) -> Floats:
        """(g,) f.f, the information on the mean."""
        return np.einsum("gn,gn->g", self.f, self.f)

    @property
    def mu(self) -> Floats:
        """(m,) generalised least-squares means."""
        return (self.f * self.y).sum(axis=-1) / self.ff

    @property
    def target_variance(self) -> Floats:
        """(g,) variance of what is predicted: with the nugget if exact, without if not."""
        plateau = self.covariance.plateau
        return plateau + self.covariance.nugget if self.exact else plateau

    def target_covariance(self, lag: Floats) -> Floats:
        """(g, ...) covariance between a reading's place and a target at a lag in m."""
        c = self.covariance(lag)
        if self.exact:
            here = lag == 0.0
            if here.any():
                c[:, here] += self.covariance.nugget[:, None]
        return c

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
        at, z, error = self._check_new(at, z, error_variance)
        grown = self
        for k in range(len(at)):
            noise = error[:, k] if self.exact else error[:, k] + self.covariance.nugget
            grown, _ = grown.border(at[k], z[:, k], noise)
        return grown

    def predict(self, targets: ArrayLike) -> Prediction:
        """Mean and variance at (N, 2) places in m, as (N,) or (m, N).

        Raises
        ------
        SingularSystemError
            If a variance is negative beyond rounding under a model that should forbid it.
        """
        from subsoil.kriging.estimate import predict_direct

        return predict_direct(self, np.atleast_2d(np.asarray(targets, dtype=float)))

    def predict_grid(self, easting: ArrayLike, northing: ArrayLike) -> Prediction:
        """Mean and variance on a dense grid, as (ny, nx) or (m, ny, nx).

        The same answer as :meth:`predict` to better than 1e-9 standard deviations and sills, by
        Chebyshev interpolation of the far readings' part over tiles; each map compares itself
        with direct kriging at random cells and records the difference as ``spot_check``.

        Parameters
        ----------
        easting, northing
            (nx,) and (ny,) ascending, evenly spaced coordinates in m.
        """
        from subsoil.kriging.dense import predict_on_grid

        return predict_on_grid(
            self, np.asarray(easting, dtype=float), np.asarray(northing, dtype=float)
        )

    def border(self, at: Floats, z: Floats, noise: Floats) -> tuple[OrdinaryKriging, Border | None]:
        """Append one reading: the grown value, and how it grew.

        Parameters
        ----------
        at
            (2,) place in m.
        z
            (m,) values.
        noise
            (g,) variance around what is predicted.

        Returns
        -------
        tuple
            The border is ``None`` where the system had to be factorised anew: at a place already
            in it, or beyond the extent an unbounded model was set up for.
        """
        lag = np.sqrt(((self.at - at) ** 2).sum(axis=1))
        here = np.flatnonzero(lag == 0.0)
        if here.size:
            return self._merged(int(here[0]), z, noise), None
        grown_at = np.concatenate([self.at, at[None]])
        grown = replace(
            self,
            at=grown_at,
            z=np.concatenate([self.z, z[:, None]], axis=1),
            noise=np.concatenate([self.noise, noise[:, None]], axis=1),
            count=np.append(self.count, 1.0),
        )
        if not self.covariance.bounded and lag.max() > self.covariance.extent:
            return _factorised(replace(grown, covariance=covariance_of(self.variograms, grown_at))), None
        n = len(self.at)
        inverse = self.inverse.array[:, :, :n]
        k = self.covariance(lag)
        row = np.matmul(inverse, k[:, :, None])[:, :, 0]
        diagonal = self.covariance.plateau + noise + (self.covariance.nugget if self.exact else 0.0)
        pivot = diagonal - np.einsum("gn,gn->g", row, row)
        if np.any(pivot <= _least_pivot(n + 1) * diagonal):
            return _factorised(grown), None
        d = np.sqrt(pivot)
        y_new = (z - (row * self.y).sum(axis=-1)) / d
        f_new = (1.0 - np.einsum("gn,gn->g", row, self.f)) / d
        last = np.concatenate(
            [np.matmul(row[:, None, :], inverse)[:, 0] / -d[:, None], 1.0 / d[:, None]], axis=1
        )
        grown = replace(
            grown,
            inverse=self.inverse.append(last),
            y=np.concatenate([self.y, y_new[:, None]], axis=1),
            f=np.concatenate([self.f, f_new[:, None]], axis=1),
        )
        return grown, Border(row, d, y_new, f_new)

    def with_circular(self, layers: NDArray[np.bool_]) -> OrdinaryKriging:
        """Krige the (g,) marked bounded linear models by the circular one of the same slope."""
        variograms = tuple(
            v.circular() if swap and isinstance(v, BoundedLinear) else v
            for v, swap in zip(self.variograms, layers, strict=True)
        )
        note = _circular_note(layers, self.layered)
        covariance = Covariance(variograms, self.covariance.extent)
        return _factorised(replace(self, covariance=covariance, notes=(*self.notes, note)))

    def _merged(self, index: int, z: Floats, noise: Floats) -> OrdinaryKriging:
        pair = np.stack([self.noise[:, index], noise], axis=1)
        weight, merged = _merge(pair, np.array([self.count[index], 1.0]))
        values, noises, count = self.z.copy(), self.noise.copy(), self.count.copy()
        values[:, index] = (weight * np.stack([values[:, index], z], axis=1)).sum(axis=1)
        noises[:, index] = merged
        count[index] += 1
        return _factorised(replace(self, z=values, noise=noises, count=count))

    def _check_new(
        self, at: ArrayLike, z: ArrayLike, error_variance: ArrayLike
    ) -> tuple[Floats, Floats, Floats]:
        places = np.asarray(at, dtype=float)
        values = np.asarray(z, dtype=float)
        if places.ndim == 1:
            values = values[..., None]
        places = np.atleast_2d(places)
        values = np.atleast_2d(values)
        if values.shape != (len(self.z), len(places)):
            raise ReadingsError(
                f"values {values.shape} do not fit {len(self.z)} layers at {len(places)} places",
                where="append",
            )
        _check_readings(places, values)
        return places, values, _check_error(error_variance, len(self.noise), len(places))


@dataclass(frozen=True)
class Border:
    """How a system grew by one reading: the new row of L left of its diagonal, and the diagonal."""

    row: Floats
    d: Floats
    y: Floats
    f: Floats


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
    SingularSystemError
        If the system is not positive definite.

    Examples
    --------
    >>> from subsoil import Spherical
    >>> at, z = [(0.0, 0.0), (10.0, 0.0), (0.0, 20.0)], [1.0, 2.0, 4.0]
    >>> ok = condition(Spherical(nugget=0.0, range=50.0, psill=1.0), at, z)
    >>> mean, variance = ok.predict([(10.0, 0.0), (5.0, 5.0)])
    >>> mean.round(3), variance.round(3)
    (array([2.   , 1.868]), array([0.   , 0.213]))
    """
    places, values = np.array(at, dtype=float), np.array(z, dtype=float)
    layered = values.ndim == 2
    values = np.atleast_2d(values)
    variograms = tuple(variogram) if isinstance(variogram, Sequence) else (variogram,)
    if places.ndim != 2 or places.shape[1:] != (2,) or values.shape[1:] != places.shape[:1]:
        raise ReadingsError(
            f"places {places.shape} and values {np.shape(z)} do not fit",
            remedy="give places (n, 2) in metres and values (n,) or (m, n)",
        )
    if not len(places):
        raise ReadingsError("there is no reading to krige from", remedy="give at least one")
    if len(variograms) not in (1, len(values)):
        raise ParameterError(
            f"{len(variograms)} variograms for {len(values)} layers",
            where="variogram",
            remedy="give one for all layers or one a layer",
        )
    _check_readings(places, values)
    if np.ndim(error_variance) == 2 and len(variograms) == 1:
        variograms = variograms * len(values)
    error = _check_error(error_variance, len(variograms), len(places))
    nugget = np.array([v.nugget for v in variograms])
    noise = error if exact else error + nugget[:, None]
    places, values, noise, count = _averaged(places, values, noise)
    covariance = covariance_of(variograms, places)
    empty = np.empty((len(variograms), 0))
    return _factorised(
        OrdinaryKriging(
            places, values, noise, count, covariance, exact, layered, invalid,
            Rows(np.empty((len(variograms), 0, 0))), empty, empty,
        )
    )  # fmt: skip


def _factorised(ok: OrdinaryKriging) -> OrdinaryKriging:
    """Solve the system anew from its places, values and noise."""
    n = len(ok.at)
    k = ok.covariance(lags(ok.at, ok.at))
    diagonal = ok.covariance.plateau[:, None] + ok.noise
    if ok.exact:
        diagonal = diagonal + ok.covariance.nugget[:, None]
    k[:, np.arange(n), np.arange(n)] = diagonal
    inverse = np.zeros_like(k)
    failed = np.zeros(len(k), dtype=bool)
    for g, matrix in enumerate(k):
        factor, info = dpotrf(matrix, lower=1, clean=1)
        pivots = np.diag(factor) ** 2
        failed[g] = info != 0 or np.any(pivots <= _least_pivot(n) * diagonal[g])
        if not failed[g]:
            inverse[g] = dtrtri(factor, lower=1)[0]
    if failed.any():
        linear = np.array([isinstance(v, BoundedLinear) for v in ok.variograms])
        if ok.invalid == "circular" and np.all(linear[failed]):
            return ok.with_circular(failed)
        if ok.invalid == "nan" and np.all(linear[failed]):
            inverse[failed] = np.nan
        else:
            raise _singular(ok, int(np.flatnonzero(failed)[0]))
    y = np.matmul(inverse, ok.z[:, :, None])[:, :, 0]
    return replace(ok, inverse=Rows(inverse), y=y, f=inverse.sum(axis=2))


def _singular(ok: OrdinaryKriging, group: int) -> KrigingError:
    spacing = lags(ok.at, ok.at) + np.diag(np.full(len(ok.at), np.inf))
    i, j = np.unravel_index(int(np.argmin(spacing)), spacing.shape)
    layer = f"layer {group + 1}, " if len(ok.variograms) > 1 else ""
    return SingularSystemError(
        f"the kriging system of {len(ok.at)} readings is not positive definite",
        where=f"{layer}{ok.variograms[group]}",
        remedy="add a nugget, or choose a rougher model; "
        f"the closest readings are {int(i) + 1} and {int(j) + 1}, {spacing[i, j]:.3g} m apart",
    )


def _circular_note(layers: NDArray[np.bool_], layered: bool) -> str:
    which = ", ".join(str(k + 1) for k in np.flatnonzero(layers))
    place = f" in layer {which}" if layered and len(layers) > 1 else ""
    return (
        f"bounded linear model not valid in the plane for these readings{place}: "
        "kriged with the circular model of the same slope"
    )


def _least_pivot(n: int) -> float:
    return 8.0 * n * float(np.finfo(float).eps)


def _averaged(at: Floats, z: Floats, noise: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """Join readings at one place into one, in the order of their first appearance."""
    _, first, inverse = np.unique(at, axis=0, return_index=True, return_inverse=True)
    if len(first) == len(at):
        return at, z, noise, np.ones(len(at))
    order = np.argsort(first)
    members = [np.flatnonzero(inverse.ravel() == k) for k in order]
    merged = [_merge(noise[:, m], np.ones(len(m))) for m in members]
    values = np.stack(
        [(w * z[:, m]).sum(axis=1) for (w, _), m in zip(merged, members, strict=True)], axis=1
    )
    noises = np.stack([joint for _, joint in merged], axis=1)
    return at[first[order]], values, noises, np.array([float(len(m)) for m in members])


def _merge(noise: Floats, count: Floats) -> tuple[Floats, Floats]:
    """Weights (g, k) of k readings at one place by their precision, and their joint noise (g,)."""
    certain = noise == 0.0
    any_certain = certain.any(axis=1, keepdims=True)
    precision = np.where(any_certain, certain * count, 1.0 / np.where(certain, 1.0, noise))
    total = precision.sum(axis=1, keepdims=True)
    return precision / total, np.where(any_certain, 0.0, 1.0 / total)[:, 0]


def _check_readings(at: Floats, z: Floats) -> None:
    bad = np.flatnonzero(~np.isfinite(at).all(axis=1))
    if bad.size:
        raise ReadingsError("a coordinate is not a number", where=f"reading {bad[0] + 1}")
    layer, reading = np.nonzero(~np.isfinite(z))
    if layer.size:
        raise ReadingsError(
            "a value is not a number",
            where=f"reading {reading[0] + 1}" + (f", layer {layer[0] + 1}" if len(z) > 1 else ""),
            remedy="leave readings out that were not taken",
        )


def _check_error(error_variance: ArrayLike, groups: int, n: int) -> Floats:
    error = np.asarray(error_variance, dtype=float)
    if not np.all(np.isfinite(error)) or np.any(error < 0):
        raise ParameterError("variances must be zero or more", where="error_variance")
    try:
        return np.broadcast_to(error, (groups, n))
    except ValueError:
        raise ParameterError(
            f"variances {error.shape} do not fit {n} readings", where="error_variance"
        ) from None


def rounding(ok: OrdinaryKriging) -> Floats:
    """(g,) size of a negative variance that is still rounding."""
    return _ROUNDING * np.maximum(ok.target_variance, ok.noise.max(axis=1, initial=0.0))
