"""From readings to a map."""

from __future__ import annotations

import numpy as np

from subsoil.errors import ReadingsError
from subsoil.kriging.memory import check_memory
from subsoil.land.field import Field
from subsoil.mapping.fit import Fits
from subsoil.mapping.soilmap import SoilMap
from subsoil.readings import Readings


def krige(field: Field, readings: Readings, fits: Fits) -> SoilMap:
    """Krige every layer of readings at every cell of a field.

    Parameters
    ----------
    field
        The field of N cells.
    readings
        Readings in the frame of the field.
    fits
        Variograms of m layers, from :func:`fit`.

    Returns
    -------
    SoilMap
        ``mean`` and ``variance``, (m, N) in kPa and kPa2.

    Raises
    ------
    ReadingsError
        If readings are in another frame, or too many for the memory of this machine.
    """
    if readings.crs != field.crs:
        raise ReadingsError(
            f"readings are in {readings.crs or 'a local frame'}, the field in "
            f"{field.crs or 'a local frame'}",
            where=readings.source or "readings",
            remedy="read them with field=",
        )
    reached = np.isfinite(readings.layer_means(fits.layers)).sum(axis=1)
    check_memory(
        len(readings),
        systems=[int(reached.max(initial=0))],
        cells=len(field.cells),
        layers=len(fits.layers),
    )
    return SoilMap(
        field,
        fits.layers,
        fits.variograms,
        readings.samples(fits.layers),
        fits.covariate,
        fits.drift,
        readings.simulated,
    )
