"""Headings of a table of readings: which columns hold the place, and which a depth.

A heading that is neither is left alone, such as ``id`` or ``vwc_10cm``. One that seems to mean
strength at a depth and cannot be read, such as ``kpa_2,5cm`` or ``10 cm depth``, stops the file:
without that column the layers would be taken from other depths.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from subsoil.arrays import Floats
from subsoil.errors import ReadingsError, brief, listed
from subsoil.io.read.recording import KPA, depth_of
from subsoil.io.read.text import POSITION_COLUMNS

_DEPTH = re.compile(
    r"(?:(?P<unit>[a-z]+)[_ ])?(?P<depth>\d+(?:[.p]\d+)?)[_ ]?(?P<length>mm|cm|m|in)?"
)
_UNITS = {"kpa", "mpa", "psi"}
_PRESSURES = {"pa", "hpa", "bar", "mbar", "ksi"}
_FORCES = {"n", "newton", "newtons", "kn", "kgf", "lbf", "force", "load"}
_SOIL_WORDS = {"pressure", "resistance", "strength", "cone", "index", "penetration", "firmness"}
_STRENGTHS = _UNITS | _PRESSURES | _FORCES | _SOIL_WORDS | {"ci", "qc", "pr"}
_LENGTH = re.compile(r"\d\W*(mm|cm|dm|m|in|inch|inches|ft)(?![a-z])")
_ENDS_IN_LENGTH = re.compile(r"(mm|cm)(?![a-z])")
_OF_A_DEPTH = {"mm", "cm", "dm", "m", "in", "inch", "inches", "ft", "depth", "at", "to", "p", "d"}
_LETTER_FOR_DIGIT = re.compile(r"(?<=\d)o|o(?=\d)|(?<=\d)l|l(?=\d)")
_REMEDY = "name depth columns like kpa_10cm, mpa_10cm, psi_4in or n_10cm"


@dataclass(frozen=True)
class Columns:
    """What a header says.

    Attributes
    ----------
    names
        All headings, in small letters.
    x, y
        Columns of longitude and latitude, or of easting and northing.
    lonlat
        Which of the two.
    depths
        Columns of strength, shallowest first.
    depth_m
        (k,) their depths in m.
    unit
        ``"kpa"``, ``"mpa"``, ``"psi"`` or ``"n"``; empty if no heading says.
    """

    names: tuple[str, ...]
    x: int
    y: int
    lonlat: bool
    depths: tuple[int, ...]
    depth_m: Floats
    unit: str

    @property
    def others(self) -> tuple[str, ...]:
        """Headings of the columns that are left alone."""
        used = {self.x, self.y, *self.depths}
        return tuple(name for k, name in enumerate(self.names) if k not in used and name)


def columns_of(header: list[str], where: str) -> Columns:
    """Tell the columns of a table apart by their headings.

    Parameters
    ----------
    header
        The headings.
    where
        File and row of the header, for messages.

    Raises
    ------
    ReadingsError
        If no columns give the place or a depth, a coordinate or depth is there twice, units are
        mixed or unknown, or a heading looks like a depth and cannot be read.
    """
    names = tuple(cell.strip().lower() for cell in header)
    x, y, lonlat = _position(names, where)
    found = [(k, match) for k, name in enumerate(names) if (match := _depth_column(name))]
    read = {k for k, _ in found}
    unread = [name for k, name in enumerate(names) if k not in read and _looks_like_depth(name)]
    if unread:
        raise ReadingsError(
            f"{'columns' if len(unread) > 1 else 'column'} {listed(unread)} "
            f"{'look' if len(unread) > 1 else 'looks'} like a depth and cannot be read",
            where=where,
            remedy=f"{_REMEDY}, or take them out",
        )
    if not found:
        raise ReadingsError("no column names a depth", where=where, remedy=_REMEDY)
    units = sorted({_unit(match, where) for _, match in found})
    if len(units) > 1:
        raise ReadingsError(
            f"columns mix the units {', '.join(unit or 'none' for unit in units)}",
            where=where,
            remedy="use one unit for all depths",
        )
    depths = sorted((_depth(match, where), k) for k, match in found)
    depth_m = np.array([depth for depth, _ in depths])
    if np.any(np.diff(depth_m) == 0):
        raise ReadingsError("two columns have the same depth", where=where, remedy="drop one")
    return Columns(names, x, y, lonlat, tuple(k for _, k in depths), depth_m, units[0])


def _position(names: tuple[str, ...], where: str) -> tuple[int, int, bool]:
    found = [
        (POSITION_COLUMNS[name], k) for k, name in enumerate(names) if name in POSITION_COLUMNS
    ]
    places = dict(found)
    if len(places) < len(found):
        raise ReadingsError(
            "two columns hold the same coordinate",
            where=where,
            remedy="keep one of each of latitude, longitude, easting and northing",
        )
    if {"longitude", "latitude"} <= places.keys():
        return places["longitude"], places["latitude"], True
    if {"easting", "northing"} <= places.keys():
        return places["easting"], places["northing"], False
    raise ReadingsError(
        "no columns say where the readings were taken",
        where=where,
        remedy="start the table with a header that has lat,lon or easting,northing",
    )


def _depth_column(name: str) -> re.Match[str] | None:
    """Match of a heading of strength at a depth: not ``easting_27700``, nor ``vwc_10cm``."""
    match = _DEPTH.fullmatch(name)
    if match and match["length"]:
        return match if match["unit"] is None or match["unit"] in _STRENGTHS else None
    return match if match and match["unit"] in (None, "n", *KPA) else None


def _looks_like_depth(name: str) -> bool:
    """Whether a heading seems to mean strength at a depth, though it cannot be read as such."""
    plain = _LETTER_FOR_DIGIT.sub("0", name)
    words = set(re.findall(r"[a-z]+", plain))
    if words & _UNITS:
        return any(c.isdigit() for c in plain) or bool(_ENDS_IN_LENGTH.search(plain))
    if not _LENGTH.search(plain):
        return False
    return bool(words & _STRENGTHS) or words <= _OF_A_DEPTH


def _unit(match: re.Match[str], where: str) -> str:
    unit = match["unit"] or ""
    if unit not in ("", "n", *KPA):
        raise ReadingsError(
            f"unit {brief(unit)!r} is unknown",
            where=f"{where}, column {brief(match[0])}",
            remedy=_REMEDY,
        )
    return unit


def _depth(match: re.Match[str], where: str) -> float:
    try:
        return depth_of(f"{match['depth']} {match['length'] or ''}")
    except ValueError as error:
        raise ReadingsError(
            str(error), where=f"{where}, column {brief(match[0])}", remedy=_REMEDY
        ) from error
