"""Readings to krige from: checked, and repeats at one place averaged."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from subsoil.arrays import Floats
from subsoil.errors import ParameterError, ReadingsError

_MUCH_NOISIER = 100.0
"""How many times another reading's noise the first reading's may be."""


@dataclass(frozen=True)
class Readings:
    """Values at distinct places.

    Attributes
    ----------
    at
        (n, 2) places in m.
    z
        (m, n) values, repeats averaged.
    noise
        (g, n) variance of each value around what is predicted; g is 1 or m.
    certain
        (g, n) readings without noise behind each value: where there are some, no other counts.
    """

    at: Floats
    z: Floats
    noise: Floats
    certain: Floats

    def __len__(self) -> int:
        return len(self.at)

    def joined(self, at: Floats, z: Floats, noise: Floats) -> Readings:
        """Readings with one more: (2,) place, (m,) values and (g,) noise."""
        here = np.flatnonzero((self.at == at).all(axis=1))
        if not here.size:
            return self.appended(at, z, noise)
        index = int(here[0])
        pair = np.stack([self.noise[:, index], noise], axis=1)
        sure = np.stack([self.certain[:, index], noise == 0.0], axis=1)
        weight, merged = _merged(pair, sure)
        values, noises, certain = self.z.copy(), self.noise.copy(), self.certain.copy()
        values[:, index] = (weight * np.stack([values[:, index], z], axis=1)).sum(axis=1)
        noises[:, index] = merged
        certain[:, index] = sure.sum(axis=1)
        return Readings(self.at, values, noises, certain)

    def appended(self, at: Floats, z: Floats, noise: Floats) -> Readings:
        """Readings with one more, at a place that has none."""
        return Readings(
            np.concatenate([self.at, at[None]]),
            np.concatenate([self.z, z[:, None]], axis=1),
            np.concatenate([self.noise, noise[:, None]], axis=1),
            np.concatenate([self.certain, noise[:, None] == 0.0], axis=1),
        )

    def leads(self, noise: Floats) -> bool:
        """Whether the first reading may stay first beside one of (g,) noise.

        Values are kriged by how they differ from the first reading's, which costs digits where
        that one is far noisier than the rest.
        """
        return bool((self.noise[:, 0] <= _MUCH_NOISIER * noise).all())

    def led(self) -> Readings:
        """Readings with a quiet one first."""
        if self.leads(self.noise.min(axis=1)):
            return self
        order = np.argsort(self.noise.max(axis=0), kind="stable")
        noise, certain = self.noise[:, order], self.certain[:, order]
        return Readings(self.at[order], self.z[:, order], noise, certain)


def distinct(at: Floats, z: Floats, noise: Floats) -> Readings:
    """Readings at (n, 2) places, those at one place averaged, in order of first appearance."""
    _, first, inverse = np.unique(at, axis=0, return_index=True, return_inverse=True)
    certain = (noise == 0.0).astype(float)
    if len(first) == len(at):
        return Readings(at, z, noise, certain)
    order = np.argsort(first)
    members = [np.flatnonzero(inverse.ravel() == k) for k in order]
    merged = [_merged(noise[:, m], certain[:, m]) for m in members]
    values = [(w * z[:, m]).sum(axis=1) for (w, _), m in zip(merged, members, strict=True)]
    return Readings(
        at[first[order]],
        np.stack(values, axis=1),
        np.stack([joint for _, joint in merged], axis=1),
        np.stack([certain[:, m].sum(axis=1) for m in members], axis=1),
    )


def _merged(noise: Floats, certain: Floats) -> tuple[Floats, Floats]:
    """Weights (g, k) of k readings at one place by their precision, and their joint noise (g,).

    Each may stand for (g, k) readings without noise.
    """
    any_certain = certain.any(axis=1, keepdims=True)
    precision = np.where(any_certain, certain, 1.0 / np.where(certain > 0.0, 1.0, noise))
    total = precision.sum(axis=1, keepdims=True)
    return precision / total, np.where(any_certain, 0.0, 1.0 / total)[:, 0]


def checked(at: ArrayLike, z: ArrayLike, layers: int) -> tuple[Floats, Floats]:
    """Places (k, 2) and values (layers, k) of one or several readings.

    Raises
    ------
    ReadingsError
        If shapes do not fit or a number is not finite.
    """
    places, values = np.asarray(at, dtype=float), np.asarray(z, dtype=float)
    if places.ndim == 1:
        places, values = places[None], values[..., None]
    if values.ndim == 1:
        values = values[None]
    if places.ndim != 2 or places.shape[1] != 2 or values.shape != (layers, len(places)):
        raise ReadingsError(
            f"places {np.shape(at)} and values {np.shape(z)} do not fit for {layers} layers",
            remedy="give places (n, 2) in metres and values (n,), or (m, n) for m layers",
        )
    if not (np.isfinite(places).all() and np.isfinite(values).all()):
        raise _not_finite(places, values)
    return places, values


def _not_finite(at: Floats, z: Floats) -> ReadingsError:
    bad = np.flatnonzero(~np.isfinite(at).all(axis=1))
    if bad.size:
        return ReadingsError("a coordinate is not a number", where=f"reading {bad[0] + 1}")
    layer, reading = np.argwhere(~np.isfinite(z))[0]
    return ReadingsError(
        "a value is not a number",
        where=f"reading {reading + 1}" + (f", layer {layer + 1}" if len(z) > 1 else ""),
        remedy="leave readings out that were not taken",
    )


def checked_error(error_variance: ArrayLike, groups: int, n: int) -> Floats:
    """(groups, n) variances of readings.

    Raises
    ------
    ParameterError
        If one is negative or not finite, or shapes do not fit.
    """
    error = np.asarray(error_variance, dtype=float)
    if not ((error >= 0.0) & (error < np.inf)).all():
        raise ParameterError("variances must be zero or more", where="error_variance")
    each = np.empty((groups, n))
    try:
        each[:] = error
    except ValueError:
        raise ParameterError(
            f"variances {error.shape} do not fit {n} readings", where="error_variance"
        ) from None
    return each


def checked_targets(targets: ArrayLike) -> Floats:
    """(N, 2) places to predict at.

    Raises
    ------
    ParameterError
        If they are not (N, 2) or not finite.
    """
    places = np.atleast_2d(np.asarray(targets, dtype=float))
    if places.ndim != 2 or places.shape[1] != 2 or not np.isfinite(places).all():
        raise ParameterError(
            f"places {places.shape} to predict at must be finite (N, 2) metres", where="targets"
        )
    return places
