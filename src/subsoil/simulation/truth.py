"""What the soil of a field really is, as far as a simulation is concerned."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from subsoil.errors import ParameterError
from subsoil.field import Field
from subsoil.layers import Layers
from subsoil.simulation.soil import Soil
from subsoil.variogram import Fit

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Kriged:
    """Origin of a truth that was kriged from real readings.

    Attributes
    ----------
    fits
        (m,) variogram of each layer, and how it was come by.
    readings
        (m,) number of readings behind each layer.
    notes
        Layers that were not simply kriged with the fitted variogram, and why.
    """

    fits: tuple[Fit, ...]
    readings: tuple[int, ...]
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Truth:
    """The soil strength of every cell, and what a single push there would say.

    Parameters
    ----------
    field
        The land.
    layers
        Its depth bands, m of them.
    kpa
        (m, N) mean resistance of each layer in each cell in kPa: the map a survey is after.
    noise
        (m, N) deviation from it, in kPa, that a push in the cell carries: the soil between one
        hole and the next. All zero in the paper's protocol.
    origin
        What the soil was drawn as, or which readings it was kriged from.

    Raises
    ------
    ParameterError
        If shapes do not fit the field and layers, or soil or reading is below zero anywhere.
    """

    field: Field
    layers: Layers
    kpa: Floats
    noise: Floats
    origin: Soil | Kriged

    def __post_init__(self) -> None:
        shape = (len(self.layers), len(self.field.cells))
        for name, array in (("kpa", self.kpa), ("noise", self.noise)):
            array.setflags(write=False)
            if array.shape != shape:
                raise ParameterError(
                    f"{name} is {array.shape}, not {shape} for the layers and cells of the field",
                    where="truth",
                )
        lowest = np.minimum(self.kpa, self.kpa + self.noise).min(axis=1)
        bad = np.flatnonzero(~(lowest >= 0.0))
        if bad.size:
            raise ParameterError(
                f"the resistance falls to {lowest[bad[0]]:.3g} kPa, which no soil has",
                where=f"truth, layer {self.layers.names[bad[0]]}",
                remedy="leave that layer out",
            )

    def reading(self, cell: int) -> Floats:
        """(m,) layer means in kPa that a push in a cell would give."""
        return np.asarray(self.kpa[:, cell] + self.noise[:, cell])
