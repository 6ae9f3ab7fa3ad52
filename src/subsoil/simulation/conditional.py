"""Soils as rough as the real one that agree with its readings.

A kriged map is the mean of all soils that readings allow, and smoother than any of them. A
conditional simulation is one of those soils: an unconditional one, moved by what kriging makes of
the difference between real and simulated readings (Chilès & Delfiner, *Geostatistics*, 2012,
sec. 7.3). Over many simulations the mean is the kriged map, and the variance the kriging variance.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import ArrayLike
from threadpoolctl import threadpool_limits

from subsoil.arrays import Floats
from subsoil.errors import ReadingsError
from subsoil.kriging import condition
from subsoil.land.field import Field
from subsoil.layers import Layers
from subsoil.simulation.gaussian import covariance_factor
from subsoil.simulation.soil import FLOOR_KPA, floored
from subsoil.simulation.surrogate import SPHERICAL, check_readings, fitted
from subsoil.simulation.truth import Conditioned, Truth
from subsoil.variogram import Estimator
from subsoil.variogram.models import Variogram

_FEWEST_WHOLE = 3
"""Readings of all layers without which their correlation is not known at all."""


def conditional_truth(
    field: Field,
    at: ArrayLike,
    kpa: ArrayLike,
    layers: Layers,
    rng: np.random.Generator,
    *,
    estimator: Estimator = SPHERICAL,
) -> Truth:
    """Draw a soil of a field that its real readings allow.

    Every layer has a variogram of its own. What lies below its nugget is soil; the nugget is what
    a push differs by from it, and becomes the deviation of pushes (``noise``). Both are correlated
    between layers as the readings that reached all layers are. A reading is met exactly where
    there is no nugget.

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
    rng
        Source of the soil.
    estimator
        What finds the variograms.

    Returns
    -------
    Truth
        Its ``origin`` says with which variograms and correlation, and how often soil or pushes
        came out below 20 kPa, which :func:`subsoil.simulation.soil.floored` then makes of them.

    Raises
    ------
    ReadingsError
        If shapes do not fit, a layer has too few readings for a variogram, fewer than three
        readings reached all layers, or those are all the same in a layer.
    SingularSystemError
        If a variogram is not valid in the plane, or places are too close together for it.
    """
    places, values = np.asarray(at, dtype=float), np.asarray(kpa, dtype=float)
    check_readings(places, values, layers)
    fits = fitted(estimator, places, values, layers)
    mixing = _mixing(values, layers)
    nodes, inverse = np.unique(np.concatenate([field.cells, places]), axis=0, return_inverse=True)
    node_of = inverse.ravel()
    white = mixing @ rng.standard_normal((len(mixing.T), len(nodes)))
    deviation = mixing @ rng.standard_normal((len(mixing.T), len(node_of)))
    cells = len(field.cells)
    soil, noise = np.empty((2, len(layers), cells))
    with threadpool_limits(1, user_api="blas"):
        for k, (fit, z) in enumerate(zip(fits, values, strict=True)):
            signal = _grown(fit.variogram, nodes, white[k], layers.names[k])[node_of]
            push = np.sqrt(fit.variogram.nugget) * deviation[k]
            here = ~np.isnan(z)
            missed = z[here] - (signal + push)[cells:][here]
            kriged = condition(fit.variogram, places[here], missed).predict(field.cells)
            soil[k], noise[k] = signal[:cells] + kriged.mean, push[:cells]
    reached = tuple((~np.isnan(values)).sum(axis=1).tolist())
    origin = Conditioned(fits, reached, mixing @ mixing.T, tuple(_too_soft(soil, noise, layers)))
    return Truth(field, layers, *floored(soil, noise), origin)


def _mixing(kpa: Floats, layers: Layers) -> Floats:
    """(m, r) factor of the layers' correlation: itself times its transpose.

    By QR decomposition of the standardised readings, which needs no matrix of correlations and
    takes fewer readings than layers as well.
    """
    whole = kpa[:, ~np.isnan(kpa).any(axis=0)]
    if whole.shape[1] < _FEWEST_WHOLE:
        raise ReadingsError(
            f"{whole.shape[1]} readings reached all layers, too few to say how layers go together",
            where="conditional simulation",
            remedy="leave out layers that few readings reached",
        )
    off = whole - whole.mean(axis=1, keepdims=True)
    size = np.sqrt((off**2).sum(axis=1, keepdims=True))
    for name, spread in zip(layers.names, size[:, 0], strict=True):
        if not spread > 0.0:
            raise ReadingsError(
                "all readings are the same",
                where=f"conditional simulation, layer {name}",
                remedy="leave that layer out",
            )
    return np.asarray(np.linalg.qr((off / size).T, mode="r")).T


def _grown(model: Variogram, at: Floats, white: Floats, layer: str) -> Floats:
    """(n,) values at (n, 2) distinct places with a variogram, of (n,) independent ones."""
    spread = model.sill - model.nugget
    if spread == 0.0:
        return np.zeros(len(at))
    factor = covariance_factor(
        at,
        lambda lag: spread - model.rise(lag),
        what=str(model),
        where=f"conditional simulation, layer {layer}",
    )
    return np.asarray(factor @ white)


def _too_soft(soil: Floats, noise: Floats, layers: Layers) -> Iterator[str]:
    """One note for each layer in which soil or pushes came out below the floor."""
    for name, under, push in zip(layers.names, soil, soil + noise, strict=True):
        cells, pushes = int((under < FLOOR_KPA).sum()), int((push < FLOOR_KPA).sum())
        if cells or pushes:
            yield (
                f"{name}: simulated below {FLOOR_KPA:g} kPa in {cells} and pushed below it in "
                f"{pushes} of {under.size} cells, taken as {FLOOR_KPA:g}"
            )
