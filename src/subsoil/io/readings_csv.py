"""Readings as a plain table: one row a push, one column a depth.

The header is required. It names the position, ``lat,lon``, ``latitude,longitude`` or
``easting,northing`` (metres), and each depth with its units::

    lat,lon,kpa_2.5cm,kpa_5.0cm,kpa_7.5cm
    53.26092,-0.52711,17.2,123.3,459.9
    53.26092,-0.52681,2.2,209.0,

Depth columns are ``kpa_``, ``mpa_``, ``psi_`` or ``n_`` (force) and a depth in mm, cm, m or in;
or a depth alone, ``15 cm``, and the caller names the unit. An empty cell was not reached. Other
columns are left alone. Cells part at commas, semicolons or tabs; with semicolons or tabs the
numbers may have decimal commas.
"""

from __future__ import annotations

import csv
import io
import math
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from subsoil.errors import ReadingsError
from subsoil.io.records import KPA, Finding, Floats, Record, Recording, depth_of
from subsoil.io.text import POSITION_COLUMNS, number, read_text

_COLUMN = re.compile(
    r"(?:(?P<unit>[a-z]+)[_ ])?(?P<depth>\d+(?:[.p]\d+)?)[_ ]?(?P<length>mm|cm|m|in)?"
)
_REMEDY = "name depth columns like kpa_10cm, mpa_10cm, psi_4in or n_10cm"

Row = tuple[int, list[str]]


@dataclass(frozen=True)
class _Columns:
    """What the header says: which columns hold x, y and each depth, shallowest first."""

    names: tuple[str, ...]
    x: int
    y: int
    lonlat: bool
    depths: tuple[int, ...]
    depth_m: Floats
    unit: str


def read_readings_csv(path: Path) -> Recording:
    """Read a table of readings; the header is row 1.

    Raises
    ------
    ReadingsError
        If the header does not say what the columns are. A row that does not hold the numbers it
        promises is refused instead.
    """
    text = read_text(path, ReadingsError)
    delimiter = max(";\t,", key=text.lstrip().split("\n", 1)[0].count)
    (row, header), *body = _table(text, delimiter, path.name)
    columns = _columns(tuple(cell.strip().lower() for cell in header), f"{path.name}, row {row}")
    decimal = "." if delimiter == "," else _decimal(body, columns)
    records: list[Record] = []
    refused: list[Finding] = []
    for row, cells in body:
        try:
            records.append(_record(row, cells, columns, decimal))
        except ValueError as error:
            refused.append(Finding(row, str(error)))
    return Recording(tuple(records), tuple(refused), columns.lonlat, columns.unit)


def _table(text: str, delimiter: str, file: str) -> list[Row]:
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=delimiter)
    try:
        rows = [(reader.line_num, cells) for cells in reader]
    except csv.Error as error:
        raise ReadingsError(
            f"this is not a table: {error}", where=f"{file}, row {reader.line_num}"
        ) from error
    rows = [(row, cells) for row, cells in rows if any(cell.strip() for cell in cells)]
    if not rows:
        raise ReadingsError("all its cells are blank", where=file, remedy="export it again")
    return rows


def _decimal(body: list[Row], columns: _Columns) -> str:
    used = {columns.x, columns.y, *columns.depths}
    cells = [cell for _, row in body for k, cell in enumerate(row) if k in used]
    return "," if not any("." in cell for cell in cells) else "."


def _columns(names: tuple[str, ...], where: str) -> _Columns:
    x, y, lonlat = _position(names, where)
    found = [(k, match) for k, name in enumerate(names) if (match := _depth_column(name))]
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
    return _Columns(names, x, y, lonlat, tuple(k for _, k in depths), depth_m, units[0])


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
    """Match of a heading that is meant as a depth: not ``easting_27700``, but ``bar_10cm``."""
    match = _COLUMN.fullmatch(name)
    meant = match and (match["length"] or match["unit"] in (None, "n", *KPA))
    return match if meant else None


def _unit(match: re.Match[str], where: str) -> str:
    unit = match["unit"] or ""
    if unit not in ("", "n", *KPA):
        raise ReadingsError(
            f"unit {unit!r} is unknown", where=f"{where}, column {match[0]}", remedy=_REMEDY
        )
    return unit


def _depth(match: re.Match[str], where: str) -> float:
    try:
        return depth_of(f"{match['depth']} {match['length'] or ''}")
    except ValueError as error:
        raise ReadingsError(
            str(error), where=f"{where}, column {match[0]}", remedy=_REMEDY
        ) from error


def _record(row: int, cells: list[str], columns: _Columns, decimal: str) -> Record:
    width = len(columns.names)
    if len(cells) < width or any(cell.strip() for cell in cells[width:]):
        comma = ", as a decimal comma makes" if len(cells) > width else ""
        raise ValueError(f"{len(cells)} cells do not pair with {width} columns{comma}")

    def read(k: int) -> float:
        try:
            return number(cells[k], decimal)
        except ValueError as error:
            raise ValueError(f"{error} (column {columns.names[k]})") from None

    values = [read(k) if cells[k].strip() else math.nan for k in columns.depths]
    return Record(row, read(columns.x), read(columns.y), columns.depth_m, np.array(values))
