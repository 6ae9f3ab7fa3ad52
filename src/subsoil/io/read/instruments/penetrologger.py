"""Readings of an Eijkelkamp Penetrologger, as Penetro Viewer exports them.

::

    Eijkelkamp Penetro Viewer Vs. 6.08

    Nr of pen done     :<tab>16
    Cone type          :<tab>2.0cm2<tab>60deg
    Depth meas unit    :    cm
    Pressure meas unit :    MPascal

    PENETRATION DATA
    PLOT-001.1<tab>N52 46.015 W002 25.678<tab>0<tab>0.1<tab>0.1 ...

Lines are told apart by their cells and units by their values, so the words may be in any language,
and decimals with a comma. A value a centimetre from the surface on; each stands for the soil since
the one above, so the first for none. -1 was not read.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from subsoil.errors import ReadingsError, brief
from subsoil.findings import Finding
from subsoil.io.read.instruments.coordinates import degrees
from subsoil.io.read.instruments.heads import text_of
from subsoil.io.read.recording import CellError, Frame, Record, Recording, unusable
from subsoil.io.read.text import number, read_text
from subsoil.penetrometer import Cone

NAME = "Eijkelkamp Penetrologger"

_STEP_M = 0.01
_DATA_CELLS = 5
"""Cells from which on a line holds readings; lines of the head have three at most."""
_PRESSURE = re.compile(r":\s*(?:([mk])pa(?:scal)?|(n/cm2|n/cm²))\s*$", re.IGNORECASE)
_LENGTH = re.compile(r":\s*(cm|mm|m|in|inch|inches)\s*$", re.IGNORECASE)
_CONE = re.compile(r"([\d.,]+)\s*cm[2²]\s+(\d+)\s*(?:deg|°)", re.IGNORECASE)
_DONE = re.compile(r"done\s*:\s*(\d+)", re.IGNORECASE)
_PLACE = re.compile(r"([NS]\s*\d+\s+[\d.,]+)\s+([EW]\s*\d+\s+[\d.,]+)", re.IGNORECASE)


def sniff(head: bytes, name: str) -> bool:  # noqa: ARG001 - its suffix says nothing
    """Whether a file is one, by its first bytes and its name."""
    first = text_of(head).partition("\n")[0]
    return "eijkelkamp" in first and "penetro" in first


def read(path: Path) -> Recording:
    """Read an export; rows count as lines of the file.

    Raises
    ------
    ReadingsError
        If it holds no readings, or its depths are not in cm. A row that does not hold what it
        should is left out instead.
    """
    lines = read_text(path, ReadingsError).splitlines()
    rows = [(row, [cell.strip() for cell in line.split("\t")]) for row, line in enumerate(lines, 1)]
    data = [(row, cells) for row, cells in rows if len(cells) >= _DATA_CELLS]
    if not data:
        raise ReadingsError("it holds no readings", where=path.name, remedy="export it again")
    head = lines[: data[0][0] - 1]
    _check_depth_unit(head, path.name)
    cone = _cone(head)
    records: list[Record] = []
    findings: list[Finding] = []
    for row, cells in data:
        try:
            records.append(_record(row, cells, cone))
        except ValueError as error:
            findings.append(unusable(error, path.name, row))
    records, cut = _without_cut(records, [cells for _, cells in data], path.name)
    findings += [*cut, *_lost(head, len(data), path.name)]
    placed = any(np.isfinite(record.x) for record in records)
    frame: Frame = "lonlat" if placed else "none"
    return Recording(tuple(records), tuple(findings), frame, _unit(head), instrument=NAME)


def _check_depth_unit(head: Sequence[str], file: str) -> None:
    unit = next((match[1].lower() for line in head if (match := _LENGTH.search(line))), "")
    if unit != "cm":
        raise ReadingsError(
            f"its depths are in {unit}, which nobody has seen of this instrument"
            if unit
            else "its head does not say that depths are in cm",
            where=file,
            remedy="export it in cm, or save it as a table with a heading",
        )


def _unit(head: Sequence[str]) -> str:
    """Unit of pressure by the head; empty if it does not say."""
    found = next((match for line in head if (match := _PRESSURE.search(line))), None)
    if not found:
        return ""
    return f"{found[1].lower()}pa" if found[1] else "n/cm2"


def _cone(head: Sequence[str]) -> Cone | None:
    found = next((match for line in head if (match := _CONE.search(line))), None)
    return Cone(number(found[1].replace(",", ".")) * 100, float(found[2])) if found else None


def _record(row: int, cells: Sequence[str], cone: Cone | None) -> Record:
    name, place, *numbers = cells
    values = np.array([_strength(cell, k) for k, cell in enumerate(numbers)])
    depth_m = np.round(np.arange(1, values.size) * _STEP_M, 6)
    return Record(row, *_lonlat(place), depth_m, values[1:], number=name, cone=cone)


def _lonlat(place: str) -> tuple[float, float]:
    """Longitude and latitude of a cell; NaN where the receiver had none."""
    if not place:
        return math.nan, math.nan
    found = _PLACE.fullmatch(place)
    if not found:
        raise ValueError(f"{brief(place)!r} is no place such as N52 46.015 W002 25.678")
    latitude, longitude = degrees(found[1]), degrees(found[2])
    return (math.nan, math.nan) if latitude == longitude == 0 else (longitude, latitude)


def _strength(cell: str, step: int) -> float:
    """Number of a cell, NaN where none was read."""
    try:
        value = number(cell.replace(",", ".")) if cell else -1.0
    except ValueError as error:
        raise CellError(str(error), f"{step} cm") from None
    return math.nan if value == -1 else value


def _without_cut(
    records: list[Record], cells: Sequence[Sequence[str]], file: str
) -> tuple[list[Record], list[Finding]]:
    """Records without the last number of a file that ends in the middle of its last row."""
    if len(cells) < 2 or not records or len(cells[-1]) >= max(map(len, cells)):
        return records, []
    last = records[-1]
    cut = Finding(
        "the file ends in the middle of this push",
        "its last number is left out",
        "left out",
        file,
        last.row,
        f"{last.values.size} cm",
    )
    shorter = replace(last, depth_m=last.depth_m[:-1], values=last.values[:-1])
    return [*records[:-1], shorter], [cut]


def _lost(head: Sequence[str], rows: int, file: str) -> Iterator[Finding]:
    """A finding if the head promises more pushes than there are."""
    promised = next((int(match[1]) for line in head if (match := _DONE.search(line))), rows)
    if promised > rows:
        seen = f"its head says {promised} pushes, and it holds {rows}"
        yield Finding(seen, "the others are lost; export it again", "left out", file)
