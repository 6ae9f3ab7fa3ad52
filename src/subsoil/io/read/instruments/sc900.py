"""Readings of a FieldScout SC 900, as its program exports them.

::

    Name: My meter
    Serial #:  2543
    Datum: WGS 84
    Soil Compation In KPa
    Longitude,Latitude,Number,0.0 cm,2.5 cm,...,45.0 cm,Cone Size
    ,,Logger Started
    -93.6,42.0,N= 1 , 34 , 414 , 552 , ... , 0 ,1/2 Inch

The layout in kPa and cm is that of files of the instrument. That in PSI and inches is written from
what its maker publishes, without such a file at hand. Exports that Excel saved again are read too:
with semicolons, with decimal commas in coordinates and depths, or each line in one cell.

A value stands for the soil since the depth above, so the first one, at the surface, for none.
Zeros at the end of a row were not reached; any other zero is a bad reading. ``N`` starts anew when
the instrument is switched on, and then names no push.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from subsoil.arrays import Floats
from subsoil.errors import ReadingsError, brief
from subsoil.findings import Finding
from subsoil.io.read.instruments.coordinates import degrees
from subsoil.io.read.instruments.heads import text_of
from subsoil.io.read.recording import METRES, CellError, Record, Recording, unusable
from subsoil.io.read.text import number, read_text
from subsoil.penetrometer import LARGE_CONE, SMALL_CONE, Cone

NAME = "FieldScout SC 900"

_UNIT = re.compile(r"soil comp\w* in (kpa|psi)", re.IGNORECASE)
_DEPTH = re.compile(r"(\d+(?:[.,]\d+)?)\s*(cm|in|inch|inches|\")?", re.IGNORECASE)
_PUSH = re.compile(r"n\s*=\s*(\d+)", re.IGNORECASE)
_CONES = {"1/2 inch": SMALL_CONE, "3/4 inch": LARGE_CONE}
_FIRST_DEPTH = 3
_CUT = ("the file ends in the middle of this push", "its last cell is left out")


@dataclass(frozen=True)
class _Layout:
    """What the head of a file says of the rows below it; the first depths may be the surface."""

    line: str
    delimiter: str
    unit: str
    names: tuple[str, ...]
    depth_m: Floats
    has_cone: bool


def sniff(head: bytes, name: str) -> bool:  # noqa: ARG001 - its suffix says nothing
    """Whether a file is one, by its first bytes and its name."""
    return bool(_UNIT.search(text_of(head)))


def read(path: Path) -> Recording:
    """Read an export; rows count as lines of the file.

    Raises
    ------
    ReadingsError
        If it has no unit or no heading, or a second heading that differs from the first. A row
        that does not hold what the heading promises is left out instead.
    """
    lines = read_text(path, ReadingsError).splitlines()
    top = next((k for k, line in enumerate(lines) if _is_heading(line)), len(lines))
    layout = _layout(lines[: top + 1], path.name)
    records: list[Record] = []
    findings: list[Finding] = []
    rest = [(row, line) for row, line in enumerate(lines[top + 1 :], top + 2) if line.strip()]
    for row, line in rest:
        cells = _cells(line, layout.delimiter)
        cut = row == rest[-1][0] and _is_cut(cells, layout)
        cells = cells[:-1] if cut else cells
        if any(_PUSH.fullmatch(cell) for cell in cells[:_FIRST_DEPTH]):
            findings += [Finding(*_CUT, "left out", path.name, row)] if cut else []
            try:
                records.append(_record(row, cells, layout))
            except ValueError as error:
                findings.append(unusable(error, path.name, row))
        elif _is_heading(line) and line.strip() != layout.line:
            raise ReadingsError(
                "a second heading differs from the first",
                where=f"{path.name}, row {row}",
                remedy="export each layout to a file of its own",
            )
        elif not _is_known(line, lines[: top + 1]):
            seen = f"{brief(line.strip())!r} is no reading of this instrument"
            findings.append(Finding(seen, "left out", "left out", path.name, row))
    return _recording(records, findings, layout, path.name)


def _is_cut(cells: Sequence[str], layout: _Layout) -> bool:
    """Whether the last row of a file ends before the name of the cone does."""
    return layout.has_cone and _cone(cells) is None


def _is_heading(line: str) -> bool:
    return "longitude" in line.lower() and "latitude" in line.lower()


def _is_known(line: str, head: Sequence[str]) -> bool:
    """Whether a line between readings is one that the instrument writes there."""
    return "logger started" in line.lower() or line in head


def _layout(lines: Sequence[str], file: str) -> _Layout:
    found = next((match for line in lines if (match := _UNIT.search(line))), None)
    if not found or not _is_heading(lines[-1]):
        raise ReadingsError(
            "its head names no pressure unit, or no columns",
            where=file,
            remedy="export it again from the instrument's program, with all its lines",
        )
    unit, line = found[1].lower(), lines[-1].strip()
    delimiter = max(";\t,", key=line.count)
    cells = _cells(line, delimiter)
    has_cone = any("cone" in cell.lower() for cell in cells)
    names = [cell for cell in cells[_FIRST_DEPTH:] if cell and "cone" not in cell.lower()]
    matches = [_DEPTH.fullmatch(name) for name in names]
    depth_m = np.array([_depth_m(match, unit) for match in matches if match])
    if not names or None in matches or (np.diff(depth_m) <= 0).any():
        raise ReadingsError(
            "its depths are not understood, or do not increase",
            where=f"{file}, row {len(lines)}",
            remedy="export it again from the instrument's program",
        )
    return _Layout(line, delimiter, unit, tuple(names), depth_m, has_cone)


def _depth_m(match: re.Match[str], unit: str) -> float:
    inches = match[2].lower() != "cm" if match[2] else unit == "psi"
    return round(float(match[1].replace(",", ".")) * METRES["in" if inches else "cm"], 6)


def _cells(line: str, delimiter: str) -> list[str]:
    """Cells of a line, also of one that a spreadsheet took for a single cell; none of no table."""
    try:
        cells: list[str] = next(csv.reader([line], delimiter=delimiter), [])
        if cells and "," in cells[0] and not any(cells[1:]):
            cells = next(csv.reader([cells[0]]))
    except csv.Error:
        return []
    return [cell.strip() for cell in cells]


def _record(row: int, cells: Sequence[str], layout: _Layout) -> Record:
    push = _PUSH.fullmatch(cells[_FIRST_DEPTH - 1])
    if not push:
        raise ValueError("it needs longitude, latitude and N= before the readings")
    values = list(cells[_FIRST_DEPTH:])
    while values and not values[-1]:
        values.pop()
    cone = _cone(values)
    values = values[:-1] if cone else values
    if len(values) > len(layout.names):
        raise ValueError(f"{len(values)} values do not pair with {len(layout.names)} depths")
    kpa = np.full(len(layout.names), np.nan)
    for k, (cell, name) in enumerate(zip(values, layout.names, strict=False)):
        kpa[k] = _strength(cell, name) or np.nan
    soil = layout.depth_m > 0
    x, y = degrees(cells[0]), degrees(cells[1])
    place = (np.nan, np.nan) if x == y == 0 else (x, y)
    depth_m = layout.depth_m[soil]
    return Record(row, *place, depth_m, kpa[soil], number=str(int(push[1])), cone=cone)


def _strength(cell: str, name: str) -> float:
    """Whole number of a cell; 0 where it is blank."""
    try:
        value = number(cell) if cell else 0.0
    except ValueError as error:
        raise CellError(str(error), name) from None
    if value != int(value):
        what = f"{brief(cell)!r} is no whole number, as this instrument writes: a thousands mark?"
        raise CellError(what, name)
    return value


def _cone(cells: Sequence[str]) -> Cone | None:
    """Cone that a row ends with."""
    last = next((cell for cell in reversed(cells) if cell), "")
    return _CONES.get(" ".join(last.lower().split()))


def _recording(
    records: list[Record], findings: list[Finding], layout: _Layout, file: str
) -> Recording:
    if len({record.number for record in records}) < len(records):
        records = [replace(record, number=str(k)) for k, record in enumerate(records, 1)]
        seen = "N starts anew when the instrument is switched on"
        done = f"pushes are numbered from 1 to {len(records)} as they stand in the file"
        findings.append(Finding(seen, done, file=file))
    findings += _cones(records, file)
    placed = any(np.isfinite(record.x) for record in records)
    return Recording(
        tuple(records),
        tuple(findings),
        "lonlat" if placed else "none",
        layout.unit,
        instrument=NAME,
    )


def _cones(records: Sequence[Record], file: str) -> Iterator[Finding]:
    """A finding if the cone was changed or misnamed on the way."""
    counts: dict[Cone, int] = {}
    for record in records:
        if record.cone:
            counts[record.cone] = counts.get(record.cone, 0) + 1
    if len(counts) > 1:
        each = " and ".join(f"{n} with {cone.area_mm2:g} mm2" for cone, n in counts.items())
        done = "if that is no change of cones but a wrong setting, their pressures are wrong"
        yield Finding(f"{each} cones", done, "doubt", file)
