"""What is said and done where a model gives no valid system."""

from __future__ import annotations

import numpy as np

from subsoil.arrays import Bools, Floats
from subsoil.errors import SingularSystemError
from subsoil.kriging.covariance import Covariance, lags
from subsoil.kriging.readings import Readings
from subsoil.variogram.models import BoundedLinear, Variogram


def replaceable(covariance: Covariance) -> Bools:
    """(g,) whether a model is the bounded linear one, which is not valid in the plane."""
    return np.array([isinstance(v, BoundedLinear) for v in covariance.variograms])


def with_circular(covariance: Covariance, models: Bools) -> Covariance:
    """Covariance with the (g,) marked bounded linear models made circular, of the same slope."""
    variograms = tuple(
        v.circular() if swap and isinstance(v, BoundedLinear) else v
        for v, swap in zip(covariance.variograms, models, strict=True)
    )
    return Covariance(variograms, covariance.exact)


def circular_note(models: Bools) -> str:
    """What a reader of the map should know of the models that were made circular."""
    which = ", ".join(str(k + 1) for k in np.flatnonzero(models))
    place = f" in layer {which}" if len(models) > 1 else ""
    return (
        f"bounded linear model not valid in the plane for these readings{place}: "
        "kriged with the circular model of the same slope"
    )


def singular(
    readings: Readings, variograms: tuple[Variogram, ...], model: int
) -> SingularSystemError:
    """Error of a system that is not positive definite; it names the closest readings."""
    return SingularSystemError(
        f"the kriging system of {len(readings)} readings is not positive definite",
        where=_named(variograms, model),
        remedy=f"add a nugget, or choose a rougher model; {_closest(readings)}",
    )


def not_determined(
    readings: Readings, variograms: tuple[Variogram, ...], model: int, at: Floats
) -> SingularSystemError:
    """Error of a mean that rounding decides; it names the closest readings."""
    return SingularSystemError(
        f"the mean at ({at[0]:g}, {at[1]:g}) is not determined to 1e-6 by {len(readings)} readings",
        where=_named(variograms, model),
        remedy=f"add a nugget, or choose a rougher model; {_closest(readings)}",
    )


def _closest(readings: Readings) -> str:
    at = readings.at
    spacing = lags(at, at)
    np.fill_diagonal(spacing, np.inf)
    i, j = np.unravel_index(int(np.argmin(spacing)), spacing.shape)
    return (
        f"the closest readings are those at ({at[i, 0]:g}, {at[i, 1]:g}) and "
        f"({at[j, 0]:g}, {at[j, 1]:g}), {spacing[i, j]:.3g} m apart"
    )


def ill_conditioned(
    variance: float, variograms: tuple[Variogram, ...], model: int
) -> SingularSystemError:
    """Error of a variance that fell below zero under a model that should forbid it."""
    return SingularSystemError(
        f"kriging variance fell to {variance:.3g}: the system is too ill-conditioned",
        where=_named(variograms, model),
        remedy="add a nugget or choose a rougher model",
    )


def _named(variograms: tuple[Variogram, ...], model: int) -> str:
    layer = f"layer {model + 1}, " if len(variograms) > 1 else ""
    return f"{layer}{variograms[model]}"
