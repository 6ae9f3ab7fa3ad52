"""What the soil of a field really is, as far as a simulation is concerned."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from subsoil.arrays import Floats
from subsoil.errors import ParameterError
from subsoil.land.field import Field
from subsoil.layers import Layers
from subsoil.readings import Readings
from subsoil.simulation.soil import Soil
from subsoil.variogram import Fit


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
class Conditioned:
    """Origin of a truth that was simulated to agree with real readings.

    Attributes
    ----------
    fits
        (m,) variogram of each layer, and how it was come by.
    readings
        (m,) number of readings behind each layer.
    correlation
        (m, m) correlation of the layers, of the soil as of pushes.
    notes
        Layers that came out softer than soil is, and how often.
    """

    fits: tuple[Fit, ...]
    readings: tuple[int, ...]
    correlation: Floats
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
        (m, N) deviation from it, in kPa, that the first push in the cell carries: the soil
        between one hole and the next. All zero in the paper's protocol.
    origin
        What the soil was drawn as, or which readings it was kriged from or simulated to agree
        with.

    Raises
    ------
    ParameterError
        If shapes do not fit the field and layers, or soil or reading is below zero anywhere.
    """

    field: Field
    layers: Layers
    kpa: Floats
    noise: Floats
    origin: Soil | Kriged | Conditioned

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

    def reading(self, cell: int, push: int = 0) -> Floats:
        """(m,) layer means in kPa that a push in a cell would give.

        A further push (``push`` of 1 or more) carries the deviation that another cell's first one
        does, a cell that is drawn for each push in each cell: as large as those are, with the same
        correlation of layers, and independent of them. Soil softer than none reads zero.
        """
        if push == 0:
            return np.asarray(self.kpa[:, cell] + self.noise[:, cell])
        stream = np.random.default_rng(np.random.SeedSequence((cell, push)))
        other = stream.integers(self.kpa.shape[1])
        return np.maximum(self.kpa[:, cell] + self.noise[:, other], 0.0)

    def readings(self, cells: ArrayLike) -> Readings:
        """Readings of a first push in each of (k,) cells, which say that they are simulated.

        Examples
        --------
        >>> from subsoil.simulation import draw_field
        >>> truth = draw_field(np.random.default_rng(1), "signal")
        >>> readings = truth.readings([0, 100, 200])
        >>> len(readings), readings.simulated
        (3, True)
        """
        index = np.asarray(cells, dtype=np.int64)
        kpa = (self.kpa + self.noise)[:, index].T
        depth = self.layers.bottom_m
        found = Readings.of(self.field.cells[index], depth, kpa, field=self.field)
        return replace(found, simulated=True)
