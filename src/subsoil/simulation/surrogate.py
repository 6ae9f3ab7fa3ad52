"""A truth kriged from real readings, as in the paper (sec. IV-C)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike
from threadpoolctl import threadpool_limits

from subsoil.arrays import Floats
from subsoil.errors import ReadingsError
from subsoil.kriging import condition
from subsoil.land.field import Field
from subsoil.layers import Layers
from subsoil.simulation.truth import Kriged, Truth
from subsoil.variogram import Estimator, Fit, LeastSquares, Spherical

SPHERICAL = LeastSquares(Spherical)
"""Spherical model by least squares, layer by layer."""


def surrogate(
    field: Field,
    at: ArrayLike,
    kpa: ArrayLike,
    layers: Layers,
    *,
    estimator: Estimator = SPHERICAL,
) -> Truth:
    """Take the kriged map of real readings for the truth of a field.

    Every layer is kriged with a variogram of its own from the readings that reached it, with the
    nugget filtered out. The map is far smoother than the soil was, and a push in it carries no
    deviation: every method looks better on it than in the field.

    Parameters
    ----------
    field
        The land, in the frame of the readings.
    at
        (n, 2) easting and northing of the readings in m.
    kpa
        (m, n) layer means in kPa, NaN where a push did not reach the layer.
    layers
        Depth bands, m of them.
    estimator
        What finds the variograms.

    Returns
    -------
    Truth
        Its ``origin`` says from how many readings and with which variogram each layer came, and
        where the map fell below zero, as it may beside the near-zero readings of a soft surface:
        there the soil is taken to resist nothing.

    Raises
    ------
    ReadingsError
        If shapes do not fit, or a layer has too few readings for a variogram.
    """
    places, values = np.asarray(at, dtype=float), np.asarray(kpa, dtype=float)
    check_readings(places, values, layers)
    kriged, origin = krige_layers(estimator, places, values, field.cells, layers)
    origin = replace(origin, notes=(*origin.notes, *_below_zero(kriged, layers)))
    return Truth(field, layers, np.maximum(kriged, 0.0), np.zeros_like(kriged), origin)


def krige_layers(
    estimator: Estimator, at: Floats, kpa: Floats, targets: Floats, layers: Layers
) -> tuple[Floats, Kriged]:
    """Krige each layer's signal from the readings that reached it.

    Parameters
    ----------
    estimator
        What finds the variograms.
    at, kpa
        (n, 2) places in m and (m, n) readings in kPa, NaN where unreached.
    targets
        (N, 2) places in m.
    layers
        Depth bands, m of them.

    Returns
    -------
    tuple
        (m, N) kriged means in kPa, and what they were kriged from and with.

    Raises
    ------
    ReadingsError
        If a layer has too few readings for a variogram.
    """
    fits = fitted(estimator, at, kpa, layers)
    reached = ~np.isnan(kpa)
    with threadpool_limits(1, user_api="blas"):
        maps = [
            condition(fit.variogram, at[here], z[here]).predict(targets)
            for fit, z, here in zip(fits, kpa, reached, strict=True)
        ]
    notes = tuple(
        f"{name}: {note}"
        for name, layer in zip(layers.names, maps, strict=True)
        for note in layer.notes
    )
    origin = Kriged(fits, tuple(reached.sum(axis=1).tolist()), notes)
    return np.stack([layer.mean for layer in maps]), origin


def check_readings(at: Floats, kpa: Floats, layers: Layers) -> None:
    """Check that readings (m, n) fit their places (n, 2) and layers.

    Raises
    ------
    ReadingsError
        If they do not.
    """
    if kpa.shape != (len(layers), len(at)):
        raise ReadingsError(
            f"readings {kpa.shape} do not fit {len(layers)} layers at {len(at)} places",
            where="soil from readings",
            remedy="give readings (m, n), one row a layer",
        )


def fitted(estimator: Estimator, at: Floats, kpa: Floats, layers: Layers) -> tuple[Fit, ...]:
    """Variogram of each layer of readings (m, n) at places (n, 2).

    Raises
    ------
    ReadingsError
        If a layer has too few readings for one.
    """
    fits = estimator(at, kpa)
    for name, fit in zip(layers.names, fits, strict=True):
        if fit.is_prior:
            raise ReadingsError(
                f"too little to krige from: {fit.why}",
                where=f"soil from readings, layer {name}",
                remedy="leave that layer out",
            )
    return fits


def _below_zero(kriged: Floats, layers: Layers) -> Iterator[str]:
    """One note for each layer that was kriged below zero somewhere."""
    for name, layer in zip(layers.names, kriged, strict=True):
        if layer.min() < 0.0:
            yield (
                f"{name}: kriged below zero in {(layer < 0.0).sum()} of {layer.size} cells, "
                f"down to {layer.min():.3g} kPa, taken as 0"
            )
