"""A recording: what a file of readings says, before anything is judged or converted."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from datetime import datetime
from typing import Literal

import numpy as np

from subsoil.arrays import Floats
from subsoil.errors import ReadingsError, brief
from subsoil.findings import Finding
from subsoil.penetrometer import Cone
from subsoil.reports import Ending

KPA = {
    "kpa": 1.0,
    "mpa": 1000.0,
    "psi": 6.894757,
    "bar": 100.0,
    "n/cm2": 10.0,
    "kgf/cm2": 98.0665,
}
"""kPa in one of each unit of pressure."""
NEWTONS = {"n": 1.0, "kn": 1000.0, "lbf": 4.448222, "kgf": 9.80665}
"""N in one of each unit of force, which needs a cone."""
UNITS = (*KPA, *NEWTONS)
"""Units of soil strength."""

HARDEST_KPA = 50_000.0
"""No soil is harder."""

Frame = Literal["lonlat", "metres", "none"]
"""Longitude and latitude in degrees, easting and northing in m, or no places at all."""

_DEPTH = re.compile(r"(\d+(?:[.p]\d+)?)\s*(mm|cm|m|in)", re.IGNORECASE)
METRES = {"mm": 0.001, "cm": 0.01, "dm": 0.1, "m": 1.0, "in": 0.0254, "ft": 0.3048}
"""m in one of each unit of depth."""


@dataclass(frozen=True, slots=True)
class Record:
    """One push as it stands in a file.

    Attributes
    ----------
    row
        As in :class:`~subsoil.findings.Finding`.
    x, y
        Longitude and latitude in degrees, or easting and northing in m; NaN without a place.
    depth_m
        (k,) increasing depths in m to which each value stands for the soil.
    values
        (k,) pressure or force at each depth in the file's unit; NaN where nothing was read.
    top_m
        (k,) depths in m from which on it does, where it is not the depth above; else empty.
    number
        What the instrument or its owner calls the push; empty if nothing.
    time
        When it was taken, in the time of the instrument; ``None`` if the file does not say.
    cone
        What it was taken with; ``None`` if the file does not say.
    ending
        What ended it; ``"force"`` where the file says of its last value that it is that or more.
    seconds
        (k,) times in s at which each depth was reached, if the file says so; else empty.
    """

    row: int
    x: float
    y: float
    depth_m: Floats
    values: Floats
    top_m: Floats = field(default_factory=lambda: np.empty(0))
    number: str = ""
    time: datetime | None = None
    cone: Cone | None = None
    ending: Ending = "stroke"
    seconds: Floats = field(default_factory=lambda: np.empty(0))


@dataclass(frozen=True)
class Recording:
    """All that a file of readings says.

    Attributes
    ----------
    records
        Pushes, top of the file first.
    findings
        Rows that do not even make a record, and what else is to be known of the file.
    frame
        What positions are in.
    unit
        One of :data:`UNITS`; empty if the file does not say.
    crs
        Frame of eastings and northings; empty if the file does not say.
    instrument
        What wrote the file, in words; empty for a table.
    """

    records: tuple[Record, ...]
    findings: tuple[Finding, ...]
    frame: Frame
    unit: str
    crs: str = ""
    instrument: str = ""


class CellError(ValueError):
    """A cell that does not hold what it should.

    Attributes
    ----------
    column
        Its heading.
    """

    def __init__(self, what: str, column: str) -> None:
        super().__init__(what)
        self.column = column


def unusable(error: ValueError, file: str, row: int) -> Finding:
    """Finding about a row that makes no record."""
    column = error.column if isinstance(error, CellError) else ""
    return Finding(str(error), "left out", "left out", file, row, column)


def depth_of(label: str) -> float:
    """Depth in m of a label such as ``"2.5 cm"`` or ``"2p5cm"``.

    Raises
    ------
    ValueError
        If it is no depth with a unit, or deeper than 3 m.

    Examples
    --------
    >>> depth_of("2.5 cm"), depth_of("0.15 m"), depth_of("7p5cm")
    (0.025, 0.15, 0.075)
    """
    found = _DEPTH.fullmatch(label.strip())
    if not found:
        raise ValueError(f"{brief(label)!r} is not a depth with its unit, such as 2.5 cm")
    depth = round(float(found[1].lower().replace("p", ".")) * METRES[found[2].lower()], 6)
    if depth > 3:
        raise ValueError(f"{brief(label)!r} is deeper than 3 m")
    return depth


def points(depth_m: Floats) -> tuple[Floats, Floats]:
    """(k,) tops and bottoms in m of the soil that readings at points in (k,) depths stand for.

    Half the way to the next reading above and below; the first from the surface where that is
    nearer, and the last as far down as up.

    Examples
    --------
    >>> [edge.tolist() for edge in points(np.array([0.1, 0.2, 0.4]))]
    [[0.05, 0.15, 0.3], [0.15, 0.3, 0.5]]
    """
    halves = np.diff(depth_m) / 2
    first = halves[:1] if halves.size else depth_m[:1]
    last = halves[-1:] if halves.size else np.zeros(1)
    edges = np.concatenate([depth_m[:1] - first, depth_m[:-1] + halves, depth_m[-1:] + last])
    edges = np.maximum(edges, 0.0)
    return edges[:-1].round(6), edges[1:].round(6)


def kpa_per_unit(said: str, given: str | None, cone: Cone | None, where: str) -> float:
    """Factor from a file's unit to kPa.

    Parameters
    ----------
    said
        Unit by the file, empty if it does not say.
    given
        Unit by the user, for files that do not say.
    cone
        Cone that forces were measured with.
    where
        File, for messages.

    Raises
    ------
    ReadingsError
        If nobody names the unit, the two disagree, it is unknown, or it is a force without a cone.

    Examples
    --------
    300 psi are not 300 kPa:

    >>> round(300 * kpa_per_unit("psi", None, None, "readings.csv"))
    2068
    """
    unit = said or (given or "").lower()
    if said and given and given.lower() != said:
        raise ReadingsError(
            f"it says {said}, and you say {given}", where=where, remedy="leave the unit out"
        )
    if unit in NEWTONS:
        if cone is None:
            raise ReadingsError(
                f"no cone area: force in {unit} is no pressure without one",
                where=where,
                remedy="--cone-area 130 for the small ASABE cone, 323 for the large one (mm2)",
            )
        return cone.pressure_kpa(NEWTONS[unit])
    if unit not in KPA:
        raise ReadingsError(
            f"unit {unit!r} is unknown" if unit else "it names no unit of pressure",
            where=where,
            remedy="name columns like kpa_10cm, or give --reading-unit, one of " + " ".join(UNITS),
        )
    return KPA[unit]
