"""Readings as a plain table: one row a push, one column a depth.

The header is required. It names the position, ``lat,lon``, ``latitude,longitude`` or
``easting,northing`` (metres), and each depth with its units::

    lat,lon,kpa_2.5cm,kpa_5.0cm,kpa_7.5cm
    53.26092,-0.52711,17.2,123.3,459.9
    53.26092,-0.52681,2.2,209.0,

Depth columns are ``kpa_``, ``mpa_``, ``psi_`` or ``n_`` (force) and a depth in mm, cm, m or in;
or a depth alone, ``15 cm``, and the caller names the unit. An empty cell, or a code such as
``NA``, was not reached. Other columns are left alone, and the notes name them. Cells part at
commas, semicolons or tabs; with semicolons or tabs the numbers may have decimal commas. Numbers
have no thousands marks.
"""

from __future__ import annotations

import csv
import io
import math
from pathlib import Path

import numpy as np

from subsoil.errors import ReadingsError, brief, listed
from subsoil.findings import Finding
from subsoil.io.read.headings import Columns, columns_of
from subsoil.io.read.marks import check_marks
from subsoil.io.read.missing import is_missing
from subsoil.io.read.recording import (
    HARDEST_KPA,
    KPA,
    CellError,
    Frame,
    Record,
    Recording,
    unusable,
)
from subsoil.io.read.text import number, read_text

Row = tuple[int, list[str]]

_DEGREES = 180.0


def read_table(path: Path) -> Recording:
    """Read a table of readings; the header is row 1.

    Raises
    ------
    ReadingsError
        If the header does not say what the columns are, or numbers may have thousands marks. A
        row that does not hold the numbers it promises is refused instead.
    """
    text = read_text(path, ReadingsError)
    delimiter = max(";\t,", key=text.lstrip().split("\n", 1)[0].count)
    (row, header), *body = _table(text, delimiter, path.name)
    columns = columns_of(header, f"{path.name}, row {row}")
    _check_marks(body, columns, path.name)
    decimal = "." if delimiter == "," else _decimal(body, columns)
    records: list[Record] = []
    findings: list[Finding] = []
    if columns.others:
        findings.append(Finding(f"columns left alone: {listed(columns.others)}", file=path.name))
    for row, cells in body:
        try:
            records.append(_record(row, cells, columns, decimal))
        except ValueError as error:
            findings.append(unusable(error, path.name, row))
    frame: Frame = "lonlat" if columns.lonlat else "metres"
    return Recording(tuple(records), tuple(findings), frame, columns.unit)


def looks_like_table(_head: bytes, name: str) -> bool:
    """Whether a file is one, by its name: its heading is asked for later."""
    return name.lower().endswith((".csv", ".txt", ".tsv"))


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


def _cells(body: list[Row], columns: set[int]) -> list[str]:
    return [cell for _, row in body for k, cell in enumerate(row) if k in columns]


def _decimal(body: list[Row], columns: Columns) -> str:
    cells = _cells(body, {columns.x, columns.y, *columns.depths})
    return "," if not any("." in cell for cell in cells) else "."


def _check_marks(body: list[Row], columns: Columns, file: str) -> None:
    hardest = HARDEST_KPA / KPA.get(columns.unit, 1.0)
    try:
        check_marks(_cells(body, set(columns.depths)), most=hardest)
        check_marks(_cells(body, {columns.x, columns.y}), most=_DEGREES if columns.lonlat else None)
    except ValueError as error:
        raise ReadingsError(
            str(error),
            where=file,
            remedy="write numbers without thousands marks, 1119 or 1119.5",
        ) from error


def _record(row: int, cells: list[str], columns: Columns, decimal: str) -> Record:
    width = len(columns.names)
    if len(cells) < width or any(cell.strip() for cell in cells[width:]):
        comma = ", as a decimal comma makes" if len(cells) > width else ""
        raise ValueError(f"{len(cells)} cells do not pair with {width} columns{comma}")

    def read(k: int) -> float:
        try:
            return number(cells[k], decimal)
        except ValueError as error:
            raise CellError(str(error), brief(columns.names[k])) from None

    values = [math.nan if is_missing(cells[k]) else read(k) for k in columns.depths]
    return Record(row, read(columns.x), read(columns.y), columns.depth_m, np.array(values))
