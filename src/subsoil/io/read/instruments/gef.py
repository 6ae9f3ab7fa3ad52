"""Cone penetration tests as GEF (Geotechnical Exchange Format), one test a file.

::

    #GEFID= 1, 1, 0
    #COLUMNINFO= 1, m, penetration length, 1
    #COLUMNINFO= 2, MPa, cone resistance, 2
    #COLUMNVOID= 2, -9999
    #XYID= 31000, 132127.18, 458102.35
    #EOH=
    0.020 1.21
    0.040 1.34

Written from the published format (GEF-CPT-Report), without files of many makers at hand. The last
number of a column's line says what it is: 1 length, 11 depth (better than length, as the rod may
lean), 2 cone resistance, 12 seconds. A cone resistance is one at a point: it stands for the soil
half way to its neighbours. Of a deep test the first 3 m count.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from datetime import datetime
from pathlib import Path

import numpy as np

from subsoil.arrays import Bools, Floats
from subsoil.errors import ReadingsError, brief
from subsoil.findings import Finding
from subsoil.io.read.instruments.heads import text_of
from subsoil.io.read.recording import KPA, METRES, Frame, Record, Recording, points
from subsoil.io.read.text import read_text
from subsoil.penetrometer import DEEPEST_M, LARGEST_MM2, SLIGHT_KPA, SMALLEST_MM2, Cone

NAME = "GEF cone penetration test"

Head = Mapping[str, Sequence[Sequence[str]]]
"""Values of each line of the head, by its keyword."""

_KEY = re.compile(r"#\s*(\w+)\s*=?\s*(.*)")
_LENGTH, _RESISTANCE, _DEPTH, _SECONDS = "1", "2", "11", "12"
_AREA, _DUG = "1", "13"
_FRAMES = {"31000": "EPSG:28992", "28992": "EPSG:28992"}
"""CRS by the code of ``#XYID``: the Dutch grid."""


def sniff(head: bytes, name: str) -> bool:  # noqa: ARG001 - its suffix says nothing
    """Whether a file is one, by its first bytes and its name."""
    return bool(re.match(r"\s*#\s*gefid\s*=", text_of(head)))


def read(path: Path) -> Recording:
    """Read a test; it is one record, its row 1.

    Raises
    ------
    ReadingsError
        If it has no end of its head, does not say which columns are depth and cone resistance and
        in which units, or holds no row of them.
    """
    head, rows = _parts(read_text(path, ReadingsError), path.name)
    table, findings = _table(head, rows, path.name)
    info = {
        line[3]: (int(line[0]) - 1, line[1]) for line in head.get("COLUMNINFO", ()) if _ok(line)
    }
    length = info.get(_DEPTH) or info.get(_LENGTH)
    if not length or _RESISTANCE not in info:
        raise ReadingsError(
            "it does not say which columns are depth and cone resistance",
            where=path.name,
            remedy="export it again as GEF-CPT-Report",
        )
    depth_m = _column(table, length, METRES, path.name)
    kpa = _column(table, info[_RESISTANCE], KPA, path.name)
    seconds = table[:, info[_SECONDS][0]] if _SECONDS in info else np.full(len(table), np.nan)
    dug_m = _variable(head, _DUG)
    kept = _deeper(depth_m) & (depth_m > dug_m) & (depth_m <= DEEPEST_M)
    if not kept.any():
        raise ReadingsError("it holds no readings", where=path.name, remedy="export it again")
    kpa = np.where((kpa < 0) & (kpa >= -SLIGHT_KPA), 0.0, kpa)
    top_m, bottom_m = points(depth_m[kept])
    (x, y), frame, crs = _place(head)
    record = Record(
        row=1,
        x=x,
        y=y,
        depth_m=bottom_m,
        values=kpa[kept],
        top_m=top_m,
        number=_first(head, "TESTID"),
        time=_time(head),
        cone=_cone(head),
        seconds=seconds[kept] if np.isfinite(seconds[kept]).all() else np.empty(0),
    )
    notes = _notes(depth_m, dug_m, _first(head, "XYID") if frame == "metres" and not crs else "")
    findings += [Finding(each, file=path.name) for each in notes]
    return Recording((record,), tuple(findings), frame, "kpa", crs, NAME)


def _parts(text: str, file: str) -> tuple[Head, list[str]]:
    """Head by keyword, and rows."""
    head: dict[str, list[list[str]]] = {}
    lines = text.splitlines()
    for k, line in enumerate(lines):
        found = _KEY.match(line.strip())
        if found and found[1].upper() == "EOH":
            return head, _rows(head, lines[k + 1 :])
        if found:
            values = [value.strip() for value in found[2].split(",")]
            head.setdefault(found[1].upper(), []).append(values)
    raise ReadingsError("its head has no end, #EOH=", where=file, remedy="export it again")


def _rows(head: Head, lines: Sequence[str]) -> list[str]:
    separator = _first(head, "RECORDSEPARATOR")
    parts = [line.split(separator) if separator else [line] for line in lines]
    return [row for part in parts for row in part if row.strip()]


def _table(head: Head, rows: Sequence[str], file: str) -> tuple[Floats, list[Finding]]:
    """(k, c) numbers, NaN where void, of rows that hold as many as the head says."""
    infos = head.get("COLUMNINFO", ())
    width = max((int(line[0]) for line in infos if _ok(line)), default=0)
    if not width:
        raise ReadingsError("its head names no columns", where=file, remedy="export it again")
    separator = _first(head, "COLUMNSEPARATOR") or None
    found: list[list[float]] = []
    findings: list[Finding] = []
    for k, row in enumerate(rows, 1):
        try:
            numbers = [float(cell) for cell in row.split(separator) if cell.strip()]
        except ValueError:
            numbers = []
        if len(numbers) < width or not np.isfinite(numbers).all():
            seen = f"line {k} after the head does not hold {width} numbers"
            findings.append(Finding(seen, "left out", "left out", file, 1))
            continue
        found.append(numbers[:width])
    promised = _first(head, "LASTSCAN")
    if promised.isdigit() and int(promised) > len(rows):
        seen = f"its head says {promised[:9]} lines, and it holds {len(rows)}"
        findings.append(Finding(seen, "the rest is lost; export it again", "left out", file))
    table = np.array(found, dtype=float).reshape(-1, width)
    for column, void in (line[:2] for line in head.get("COLUMNVOID", ()) if len(line) > 1):
        if column.isdigit() and 1 <= int(column) <= width and _is_number(void):
            values = table[:, int(column) - 1]
            values[values == float(void)] = np.nan
    return table, findings


def _ok(line: Sequence[str]) -> bool:
    """Whether a line of a column says its number, its unit and what it is."""
    return len(line) >= 4 and line[0].isdigit() and 1 <= int(line[0][:9]) <= 100


def _column(
    table: Floats, column: tuple[int, str], units: Mapping[str, float], file: str
) -> Floats:
    k, unit = column
    if unit.lower() not in units:
        raise ReadingsError(
            f"unit {brief(unit)!r} of column {k + 1} is unknown",
            where=file,
            remedy="export it again in m and MPa",
        )
    return np.asarray(table[:, k] * units[unit.lower()])


def _deeper(depth_m: Floats) -> Bools:
    """(k,) whether the cone was deeper than ever before."""
    known = np.where(np.isfinite(depth_m), depth_m, -np.inf)
    before = np.concatenate([[-np.inf], np.maximum.accumulate(known)[:-1]])
    return (known > before) & (known >= 0)


def _notes(depth_m: Floats, dug_m: float, code: str) -> Iterator[str]:
    if np.nanmax(depth_m, initial=0.0) > DEEPEST_M:
        yield f"readings below {DEEPEST_M:g} m are left alone"
    if np.isfinite(dug_m):
        yield f"the hole was dug to {dug_m:g} m, and readings count from there"
    if code:
        yield f"its frame has the code {brief(code)}, which is not known here; name it by --crs"


def _place(head: Head) -> tuple[tuple[float, float], Frame, str]:
    line = next(iter(head.get("XYID", ())), ())
    if len(line) < 3 or not (_is_number(line[1]) and _is_number(line[2])):
        return (np.nan, np.nan), "none", ""
    x, y = float(line[1]), float(line[2])
    if x == y == 0:
        return (np.nan, np.nan), "none", ""
    return (x, y), "metres", _FRAMES.get(line[0], "")


def _time(head: Head) -> datetime | None:
    date, clock = (next(iter(head.get(key, ())), ()) for key in ("STARTDATE", "STARTTIME"))
    try:
        return datetime(*(int(float(part)) for part in (*date[:3], *clock[:3])))  # type: ignore[arg-type]
    except (ValueError, TypeError, OverflowError):
        return None


def _cone(head: Head) -> Cone | None:
    area = _variable(head, _AREA)
    return Cone(area, 60.0) if SMALLEST_MM2 <= area <= LARGEST_MM2 else None


def _variable(head: Head, number: str) -> float:
    """Number of a ``#MEASUREMENTVAR``, minus infinity if it is not said."""
    lines = (line for line in head.get("MEASUREMENTVAR", ()) if line[0] == number)
    values = [float(line[1]) for line in lines if len(line) > 1 and _is_number(line[1])]
    return values[0] if values and values[0] > 0 else -np.inf


def _first(head: Head, key: str) -> str:
    return head[key][0][0] if key in head else ""


def _is_number(text: str) -> bool:
    try:
        return bool(np.isfinite(float(text)))
    except ValueError:
        return False
