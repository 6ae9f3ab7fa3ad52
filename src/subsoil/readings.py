"""Readings to be mapped: how hard the soil is by depth, place by place, and what was left out."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime

import numpy as np
from numpy.typing import ArrayLike

from subsoil.arrays import Floats, Integers
from subsoil.errors import ReadingsError
from subsoil.findings import Finding, left_out
from subsoil.land.field import Field
from subsoil.layers import Layers, Sample
from subsoil.penetrometer import Profile

_TOUCH_M = 1e-9
"""Lengths that differ by less are equal."""


@dataclass(frozen=True)
class Readings:
    """Usable readings, and what was left out on the way.

    Attributes
    ----------
    at
        (n, 2) easting and northing in m.
    profiles
        Soil strength by depth of each reading.
    extent_m
        Diagonal in m of the field that they are of, or of the box around them: what ranges of
        variograms are taken in proportion to.
    rows
        (n,) row or record number of each reading in its file, or its number from 1 on.
    crs
        Frame of ``at``; empty for a local frame.
    source
        Where they come from.
    findings
        What their owner should know of them, and of what was left out.
    simulated
        Whether they are of a soil that was drawn.
    numbers, times
        What the instrument or its owner calls each push, and when it was taken as far as that is
        known; empty where no file says.
    instrument
        What wrote the file, in words; empty for a table.
    """

    at: Floats
    profiles: tuple[Profile, ...]
    extent_m: float
    rows: Integers
    crs: str = ""
    source: str = ""
    findings: tuple[Finding, ...] = ()
    simulated: bool = False
    numbers: tuple[str, ...] = ()
    times: tuple[datetime | None, ...] = ()
    instrument: str = ""

    def __post_init__(self) -> None:
        for array in (self.at, self.rows):
            array.setflags(write=False)

    @classmethod
    def of(
        cls, at: ArrayLike, depth_m: ArrayLike, kpa: ArrayLike, *, field: Field | None = None
    ) -> Readings:
        """Readings from arrays.

        Parameters
        ----------
        at
            (n, 2) easting and northing in m, in the frame of the field if there is one.
        depth_m
            (d,) increasing depths in m, positive down. A reading stands for the soil since the
            depth above it: layer means go in at the lower edges of their layers.
        kpa
            (n, d) cone index in kPa; NaN below the last depth that a push reached.
        field
            The field that they are of.

        Raises
        ------
        ReadingsError
            If shapes do not fit, a place is not finite, or a push has a hole or nothing in it.

        Examples
        --------
        >>> readings = Readings.of([(5, 5), (15, 5)], [0.1, 0.2], [[800, 900], [750, np.nan]])
        >>> readings.layer_means(Layers((0.0, 0.1, 0.2)))
        array([[800., 750.],
               [900.,  nan]])
        """
        places = np.array(at, dtype=float)
        depth, values = np.array(depth_m, dtype=float), np.array(kpa, dtype=float)
        if values.ndim != 2 or places.shape != (len(values), 2) or depth.shape != values.shape[1:]:
            raise ReadingsError(
                f"places {places.shape}, depths {depth.shape} and pressures {values.shape} do not "
                "fit together",
                where="readings",
                remedy="give (n, 2) places, (d,) depths and (n, d) pressures",
            )
        for row, (place, push) in enumerate(zip(places, values, strict=True), start=1):
            if not np.isfinite(place).all():
                raise ReadingsError(
                    f"its place ({place[0]:g}, {place[1]:g}) is not finite",
                    where=f"readings, row {row}",
                    remedy="leave out readings without a place",
                )
            _check_push(row, depth, push)
        return cls(
            places,
            tuple(Profile(depth[: np.isfinite(p).sum()], p[np.isfinite(p)]) for p in values),
            extent_of(places) if field is None else field.extent_m,
            np.arange(1, len(values) + 1),
            crs="" if field is None else field.crs,
        )

    def __len__(self) -> int:
        return len(self.profiles)

    def __repr__(self) -> str:
        refused = left_out(self.findings)
        without = f", {len(refused)} left out" if refused else ""
        deepest = max((p.depth_m[-1] for p in self.profiles if len(p.depth_m)), default=0.0)
        origin = f" of {self.source}" if self.source else ""
        return f"<{len(self)} readings{origin}, down to {deepest:.2f} m{without}>"

    def samples(self, layers: Layers) -> tuple[Sample, ...]:
        """Layer values of every reading."""
        pairs = zip(self.profiles, self.at, strict=True)
        return tuple(layers.sample(profile, place) for profile, place in pairs)

    def layer_means(self, layers: Layers) -> Floats:
        """(m, n) means in kPa of every layer at every reading, NaN where not measured through."""
        rows = [sample.measured_kpa for sample in self.samples(layers)]
        return np.array(rows, dtype=float).reshape(-1, len(layers)).T


def finer_than_readings(readings: Readings, layers: Layers) -> tuple[Finding, ...]:
    """Layers of which several are told by one and the same reading, if there are such.

    Examples
    --------
    >>> two = Readings.of([(5, 5)], [0.2, 0.4], [[800, 900]])
    >>> finer_than_readings(two, Layers((0.0, 0.2, 0.4)))
    ()
    >>> print(*finer_than_readings(two, Layers((0.0, 0.1, 0.2, 0.4))))
    2 layers are finer than the readings, some 0.2 m apart; give layers as thick as that
    """
    steps = np.concatenate([[0.0], *(p.depth_m - p.top_m for p in readings.profiles)])
    thick = steps[steps > 0.0]
    step = float(np.median(thick)) if thick.size else 0.0
    fine = int((layers.bottom_m - layers.top_m < step - _TOUCH_M).sum())
    if not fine:
        return ()
    which = f"{fine} layers are" if fine > 1 else "a layer is"
    seen = f"{which} finer than the readings, some {step:.2g} m apart"
    return (Finding(seen, "give layers as thick as that"),)


def extent_of(at: Floats) -> float:
    """Diagonal in m of the box around (n, 2) places, one metre at least."""
    return max(float(np.hypot(*np.ptp(at, axis=0))), 1.0) if len(at) else 1.0


def _check_push(row: int, depth: Floats, push: Floats) -> None:
    known = np.isfinite(push)
    where = f"readings, row {row}"
    if not known.any():
        raise ReadingsError("no depth was reached", where=where, remedy="leave the reading out")
    if not known[: known.sum()].all():
        hole = depth[int(np.argmin(known))]
        raise ReadingsError(
            f"nothing was read at {hole:g} m, yet below it",
            where=where,
            remedy="leave the reading out, or fill the hole with what you know",
        )
