"""Records: what a file of readings says, before anything is judged or converted."""

from __future__ import annotations

import re
from dataclasses import dataclass

from subsoil.arrays import Floats
from subsoil.errors import ReadingsError, brief
from subsoil.penetrometer import Cone
from subsoil.readings import Finding

KPA = {"kpa": 1.0, "mpa": 1000.0, "psi": 6.894757}
"""kPa in one of each unit of pressure; ``"n"``, newtons, needs a cone."""

HARDEST_KPA = 50_000.0
"""No soil is harder."""

_DEPTH = re.compile(r"(\d+(?:[.p]\d+)?)\s*(mm|cm|m|in)", re.IGNORECASE)
_METRES = {"mm": 0.001, "cm": 0.01, "m": 1.0, "in": 0.0254}


@dataclass(frozen=True)
class Record:
    """One reading as it stands in a file.

    Attributes
    ----------
    row
        As in :class:`~subsoil.readings.Finding`.
    x, y
        Longitude and latitude in degrees, or easting and northing in m.
    depth_m
        (k,) increasing depths in m.
    values
        (k,) pressure or force at each depth in the file's unit; NaN where nothing was read.
    """

    row: int
    x: float
    y: float
    depth_m: Floats
    values: Floats


@dataclass(frozen=True)
class Recording:
    """All that a file of readings says.

    Attributes
    ----------
    records
        Readings, top of the file first.
    refused
        Rows that do not even make a record.
    lonlat
        Whether positions are WGS84 longitude and latitude rather than metres.
    unit
        ``"kpa"``, ``"mpa"``, ``"psi"`` or ``"n"``; empty if the file does not say.
    notes
        What its owner should know of the file as a whole, a sentence each.
    """

    records: tuple[Record, ...]
    refused: tuple[Finding, ...]
    lonlat: bool
    unit: str
    notes: tuple[str, ...] = ()


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
    depth = round(float(found[1].lower().replace("p", ".")) * _METRES[found[2].lower()], 6)
    if depth > 3:
        raise ValueError(f"{brief(label)!r} is deeper than 3 m")
    return depth


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
        If nobody names the unit, the two disagree, it is unknown, or it is newtons without a cone.

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
    if unit == "n":
        if cone is None:
            raise ReadingsError(
                "no cone area: force in N is no pressure without one",
                where=where,
                remedy="--cone-area 130 for the small ASABE cone, 323 for the large one (mm2)",
            )
        return cone.pressure_kpa(1.0)
    if unit not in KPA:
        raise ReadingsError(
            f"unit {unit!r} is unknown" if unit else "it names no unit of pressure",
            where=where,
            remedy="name columns like kpa_10cm, or give --reading-unit kpa, mpa, psi or n",
        )
    return KPA[unit]
