"""Places of the rows of a table: degrees, angles in parts, metres, or x and y of either."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from subsoil.arrays import Floats
from subsoil.errors import ReadingsError, brief, listed
from subsoil.io.read.recording import Frame
from subsoil.io.read.tables.columns import MAP, Columns
from subsoil.io.read.tables.degrees import EAST_WEST, NORTH_SOUTH, angles, has_parts
from subsoil.io.read.tables.marks import Writing, writing_of
from subsoil.io.read.tables.numbers import numbers_of
from subsoil.io.read.tables.sheet import Row

_WIDEST_DEG = 180.0
_FIELD_DEG, _FIELD_M = 1.0, 3.0
"""A field is narrower than this in degrees, and wider than that in metres."""


@dataclass(frozen=True)
class Positions:
    """Places of rows.

    Attributes
    ----------
    x, y
        (n,) longitude and latitude, or easting and northing; NaN where a row has none.
    frame
        Which of the two.
    wrong
        Column and reason, by the position of a row whose place cannot be read.
    decimal
        Decimal mark of the numbers, where they have one.
    """

    x: Floats
    y: Floats
    frame: Frame
    wrong: dict[int, tuple[str, str]]
    decimal: str = ""


def positions_of(body: Sequence[Row], columns: Columns, where: str, *, program: bool) -> Positions:
    """Places of rows, by the columns that say them.

    Raises
    ------
    ReadingsError
        If numbers may have thousands marks, or x and y may be degrees or metres.
    """
    if not columns.place:
        none = np.full(len(body), np.nan)
        return Positions(none, none, "none", {})
    sides = [[cells[k] for _, cells in body] for k in columns.place]
    halves = [_halves(body, columns, axis) for axis in (EAST_WEST, NORTH_SOUTH)]
    degrees = columns.kind == "longitude"
    if columns.kind != "easting" and (any(map(has_parts, sides)) or any(map(any, halves))):
        return _in_parts(sides, halves, columns)
    most = _WIDEST_DEG if degrees else None
    try:
        writing = Writing() if program else writing_of([*sides[0], *sides[1]], most=most)
    except ValueError as error:
        raise ReadingsError(
            str(error), where=where, remedy="write numbers without thousands marks, 1119 or 1119.5"
        ) from error
    x, y = (numbers_of(texts, writing) for texts in sides)
    wrong = {}
    for k, found in zip(reversed(columns.place), (y, x), strict=True):
        missing = {int(i): "a number is missing" for i in np.flatnonzero(np.isnan(found.values))}
        bounds = dict.fromkeys(found.at_least, "a place is not at least something")
        for i, why in {**missing, **bounds, **found.wrong}.items():
            wrong[i] = columns.names[k], _hinted(sides[columns.place.index(k)][i], why)
    frame: Frame = "lonlat" if degrees else "metres"
    if columns.kind == "x":
        frame = _frame(x.values, y.values, columns, where)
    return Positions(x.values, y.values, frame, wrong, "," if writing.decimal == "," else "")


def _hinted(text: str, why: str) -> str:
    """Reason why a cell is no place, which a code such as NA is not either."""
    return f"{brief(text.strip())!r} is not a number" if text.strip() and "missing" in why else why


def _halves(body: Sequence[Row], columns: Columns, axis: str) -> list[str]:
    """Hemispheres of rows: of the column that says so, or beside a place without a heading."""
    column = columns.first("east or west" if axis == EAST_WEST else "north or south")
    if column is None:
        beside = columns.place[0 if axis == EAST_WEST else 1] + 1
        unnamed = beside < len(columns.names) and not columns.names[beside]
        letters = {cells[beside].strip().upper() for _, cells in body} if unnamed else set()
        column = beside if letters and letters <= {"", *axis} and letters != {""} else None
    return [""] * len(body) if column is None else [cells[column] for _, cells in body]


def _in_parts(sides: list[list[str]], halves: list[list[str]], columns: Columns) -> Positions:
    (x, wrong_x), (y, wrong_y) = (
        angles(texts, half, axis)
        for texts, half, axis in zip(sides, halves, (EAST_WEST, NORTH_SOUTH), strict=True)
    )
    names = [columns.names[k] for k in columns.place]
    wrong = {
        **{k: (names[1], why) for k, why in wrong_y.items()},
        **{k: (names[0], why) for k, why in wrong_x.items()},
    }
    return Positions(x, y, "lonlat", wrong)


def _frame(x: Floats, y: Floats, columns: Columns, where: str) -> Frame:
    """Whether x and y are degrees or metres, by how large they are and how far apart."""
    x, y = x[np.isfinite(x)], y[np.isfinite(y)]
    if not (x.size and y.size):
        return "metres"
    if np.abs(x).max() > _WIDEST_DEG or np.abs(y).max() > _WIDEST_DEG / 2:
        return "metres"
    span = max(float(np.ptp(x)), float(np.ptp(y)))
    if 0 < span <= _FIELD_DEG:
        return "lonlat"
    if span >= _FIELD_M:
        return "metres"
    names = listed([columns.names[k] for k in columns.place])
    raise ReadingsError(
        f"columns {names} may be degrees or metres",
        where=where,
        remedy=f"{MAP} with the meanings longitude and latitude, or easting and northing",
    )
