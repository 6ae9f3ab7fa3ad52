"""Outlines as lists of corners: ``.coords`` in degrees, ``.csv`` and ``.txt`` in metres.

Blank lines and everything after a ``#`` do not count; corners go in order around the field, and
the last joins the first.
"""

from __future__ import annotations

import re
from pathlib import Path

from subsoil.errors import BoundaryError, brief
from subsoil.io.read.outlines.outlines import Feature, Outlines, frame, outlines_of
from subsoil.io.read.tables.marks import check_marks
from subsoil.io.read.text import POSITION_COLUMNS, number, read_text
from subsoil.land.crs import WGS84
from subsoil.land.outline import polygon

_BLANK = re.compile(r"[;\s]+")
_APART = re.compile(r"[;,\s]+")
_DECIMAL_COMMAS = re.compile(r"([+-]?\d+),(\d+)[;,\s]+([+-]?\d+),(\d+)")
_HEADER = "write the header easting,northing (metres) or lat,lon (degrees)"

Lines = list[tuple[int, str]]


def read_coords(path: Path) -> Outlines:
    """Read lines of WGS84 ``latitude, longitude`` in decimal degrees.

    Raises
    ------
    BoundaryError
        If a row is not that, or there are fewer than three different corners.
    """
    return _outline(_lines(path), ["latitude", "longitude"], WGS84, path.name)


def read_corners(path: Path, crs: str | None) -> Outlines:
    """Read two columns under a header ``easting,northing`` or ``lat,lon``.

    A file without a header holds easting and northing in m in the frame ``crs``.

    Raises
    ------
    BoundaryError
        If neither header nor CRS says what the numbers are, a row is not two numbers, or there
        are fewer than three different corners.
    """
    lines = _lines(path)
    home = frame(crs, path.name) if crs else ""
    row, first = lines[0]
    words = [word.strip("\"'").lower() for word in _APART.split(first)]
    if not words[0].isalpha():
        if not home:
            raise BoundaryError(
                "nothing says what its columns are", where=path.name, remedy=_HEADER
            )
        return _outline(lines, ["easting", "northing"], home, path.name)
    columns = [POSITION_COLUMNS.get(word, "") for word in words]
    if sorted(columns) == ["latitude", "longitude"]:
        return _outline(lines[1:], columns, WGS84, path.name)
    if sorted(columns) == ["easting", "northing"]:
        return _outline(lines[1:], columns, home, path.name)
    raise BoundaryError(
        f"columns {brief(first)!r} are not known", where=f"{path.name}, row {row}", remedy=_HEADER
    )


def _lines(path: Path) -> Lines:
    text = read_text(path, BoundaryError)
    lines = [line.split("#")[0].strip(" \t,;") for line in text.splitlines()]
    kept = [(row, line) for row, line in enumerate(lines, 1) if line]
    if not kept:
        raise BoundaryError("there are only comments", where=path.name, remedy="export it again")
    return kept


def _outline(lines: Lines, columns: list[str], crs: str, file: str) -> Outlines:
    _check_marks(lines, crs, file)
    corners = []
    for row, line in lines:
        where = f"{file}, row {row}"
        x, y = _pair(line, where)
        if columns[0] in ("latitude", "northing"):
            x, y = y, x
        if crs == WGS84:
            _check_degrees(x, y, where)
        corners.append((x, y))
    if not corners:
        raise BoundaryError("there is no corner below the header", where=file)
    return outlines_of([Feature(file, polygon(corners, file))], crs, file)


def _check_marks(lines: Lines, crs: str, file: str) -> None:
    most = 180.0 if crs == WGS84 else None
    try:
        check_marks((text for _, line in lines for text in _numbers(line)), most=most)
    except ValueError as error:
        raise BoundaryError(
            str(error), where=file, remedy="write numbers without thousands marks, 1500 or 1500.0"
        ) from error


def _numbers(line: str) -> list[str]:
    """Numbers of a line with their commas, where something else parts them."""
    return (
        [word.strip(",") for word in _BLANK.split(line)] if _BLANK.search(line) else line.split(",")
    )


def _pair(line: str, where: str) -> tuple[float, float]:
    commas = _DECIMAL_COMMAS.fullmatch(line)
    if commas:
        a, b, c, d = commas.groups()
        raise BoundaryError(
            f"{brief(line)!r} has decimal commas",
            where=where,
            remedy=f"write {brief(f'{a}.{b}, {c}.{d}')}",
        )
    words = _APART.split(line)
    try:
        first, second = (number(word) for word in words)
    except ValueError as error:
        what = str(error) if len(words) == 2 else f"{brief(line)!r} is not two numbers"
        raise BoundaryError(
            what, where=where, remedy="write a corner a line, 52.1, -0.5"
        ) from error
    return first, second


def _check_degrees(longitude: float, latitude: float, where: str) -> None:
    if abs(latitude) <= 90 and abs(longitude) <= 180:
        return
    metres = max(abs(latitude), abs(longitude)) > 360
    raise BoundaryError(
        f"latitude {latitude:g}, longitude {longitude:g} is no place on Earth",
        where=where,
        remedy="metres go into a .csv file with the header easting,northing"
        if metres
        else "latitude and longitude look swapped: .coords files want latitude first",
    )
