"""Covariates of points: rows of a table, features of a layer."""

from __future__ import annotations

import csv
import io
from pathlib import Path

import numpy as np

from subsoil.arrays import Floats
from subsoil.errors import ReadingsError, brief, listed
from subsoil.io.read.places import Places
from subsoil.io.read.points import read_points
from subsoil.io.read.strays import elsewhere
from subsoil.io.read.text import POSITION_COLUMNS, number, read_text
from subsoil.land.crs import is_degrees
from subsoil.land.field import Field

_DEGREES, _METRES = ("longitude", "latitude"), ("easting", "northing")
_BLANK = {"", "-", "na", "n/a", "nan", "null", "none", "nodata"}
_BESIDE_CELLS = 5.0

Points = tuple[Floats, Floats, int]
"""(k, 2) places in the frame of the field, (k,) values, and how many have none."""


def of_table(path: Path, field: Field, column: str | None, crs: str | None) -> Points:
    """Places and values of the rows of a table.

    Raises
    ------
    ReadingsError
        If it has no such columns, a row is no numbers, or nothing lies at the field.
    """
    text = read_text(path, ReadingsError)
    delimiter = max(";\t,", key=text.lstrip().split("\n", 1)[0].count)
    rows = [row for row in csv.reader(io.StringIO(text), delimiter=delimiter) if any(row)]
    header = [cell.strip().lower() for cell in rows[0]]
    meant = [POSITION_COLUMNS.get(name, "") for name in header]
    lonlat = set(_DEGREES) <= set(meant)
    if not lonlat and not set(_METRES) <= set(meant):
        raise ReadingsError(
            f"no columns say where the values are, among {listed(header)}",
            where=path.name,
            remedy="start the table with a header that has lat,lon or easting,northing",
        )
    others = [name for name, position in zip(header, meant, strict=True) if not position]
    value = header.index(_chosen(column.lower() if column else None, others, path.name))
    x, y = (meant.index(name) for name in (_DEGREES if lonlat else _METRES))
    decimal = "," if delimiter != "," and "." not in text.partition("\n")[2] else "."
    found, blank = [], 0
    for k, row in enumerate(rows[1:], 2):
        try:
            if row[value].strip().lower() in _BLANK:
                blank += 1
            else:
                found.append([number(row[column], decimal) for column in (x, y, value)])
        except (ValueError, IndexError) as error:
            raise ReadingsError(
                str(error) if isinstance(error, ValueError) else "cells are missing",
                where=f"{path.name}, row {k}",
            ) from None
    known = np.array(found).reshape(-1, 3)
    return _at_field(known[:, :2], known[:, 2], blank, lonlat, field, crs, path.name)


def of_layer(path: Path, field: Field, column: str | None, crs: str | None) -> Points:
    """Places and values of the points of a layer.

    Raises
    ------
    ReadingsError
        If it has no such column, or nothing lies at the field.
    """
    at, numeric, home = read_points(path)
    values = numeric[_chosen(column, list(numeric), path.name)]
    known = np.isfinite(values)
    home, blank = home or crs or "", int((~known).sum())
    lonlat = is_degrees(home)
    return _at_field(at[known], values[known], blank, lonlat, field, home, path.name)


def _at_field(
    xy: Floats, values: Floats, blank: int, lonlat: bool, field: Field, crs: str | None, file: str
) -> Points:
    """Points in the frame of the field, of which some lie at it."""
    if not len(values):
        raise ReadingsError("it holds no values", where=file, remedy="export it again")
    places = Places(xy[:, 0], xy[:, 1], lonlat, file)
    at, _ = places.metres(field, crs or None)
    if (field.metres_away(at) > _BESIDE_CELLS * field.cell_size).all():
        raise elsewhere(places, field, at, crs or None, "values")
    return at, values, blank


def _chosen(column: str | None, names: list[str], file: str) -> str:
    """Name of the column to follow."""
    if column in names and column is not None:
        return column
    if column is None and len(names) == 1:
        return names[0]
    raise ReadingsError(
        f"there is no column {brief(column)!r}" if column else f"{len(names)} columns may be meant",
        where=file,
        remedy=f"name one with --column: {listed(names, 20) or 'there is none'}",
    )
