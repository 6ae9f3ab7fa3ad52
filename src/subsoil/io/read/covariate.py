"""What is known of a field beforehand: EC maps, yield maps, last year's map.

Rasters (``.tif``) are averaged over each cell, whatever their CRS and resolution. Points, as rows
of a table (``.csv``) or features of a layer (``.gpkg``, ``.shp``, ``.geojson``), are averaged in
each cell; a cell without one takes the nearest.
"""

from __future__ import annotations

import csv
import io
from pathlib import Path

import numpy as np
from scipy.spatial import KDTree

from subsoil.arrays import Bools, Floats
from subsoil.errors import ReadingsError, brief, listed
from subsoil.io.read.geotiff import read_geotiff
from subsoil.io.read.places import Places
from subsoil.io.read.points import read_points
from subsoil.io.read.text import POSITION_COLUMNS, check_file, number, read_text
from subsoil.land.crs import project
from subsoil.land.field import Field

FARTHEST_CELLS = 5.0
"""Distance from a cell to the nearest point, in cells, up to which that stands for it."""
_DEGREES, _METRES = ("longitude", "latitude"), ("easting", "northing")
_RASTERS, _LAYERS = (".tif", ".tiff"), (".gpkg", ".shp", ".geojson", ".json")


def read_covariate(
    path: str | Path, field: Field, *, column: str | None = None, crs: str | None = None
) -> Floats:
    """Read what a file says of each cell of a field.

    Parameters
    ----------
    path
        File, told apart by its suffix.
    field
        The field; its frame is what others are brought to.
    column
        Column of a table or layer, where it has several beside the position.
    crs
        Frame of a file in metres that does not name one, if not the field's.

    Returns
    -------
    ndarray
        (N,) values of the cells, not all the same.

    Raises
    ------
    ReadingsError
        If the file is missing, unreadable or without such a column, says nothing of some cells,
        or the same of all.
    BoundaryError
        If nothing leads from its CRS to the field's.
    MissingExtraError
        If rasterio or pyogrio is needed and not installed.
    """
    path = Path(path)
    check_file(path, ReadingsError)
    suffix = path.suffix.lower()
    if suffix in _RASTERS:
        values = read_geotiff(path, field, crs)
        _check_covers(np.isfinite(values), field, path.name)
    elif suffix == ".csv":
        values = _of_points(*_table(path, field, column, crs), field, path.name)
    elif suffix in _LAYERS:
        values = _of_points(*_layer(path, field, column, crs), field, path.name)
    else:
        raise ReadingsError(
            "nothing reads a covariate from files with this suffix",
            where=path.name,
            remedy=f"save it as one of {' '.join((*_RASTERS, '.csv', *_LAYERS))}",
        )
    if np.ptp(values) == 0:
        raise ReadingsError(
            f"it is {values[0]:g} in all {len(values)} cells and tells nothing",
            where=path.name,
            remedy="leave it out, or check that it is the right file or column",
        )
    return values


def _of_points(at: Floats, values: Floats, field: Field, file: str) -> Floats:
    """Average points (k, 2) with values (k,) in each cell, or take the nearest."""
    away, nearest = KDTree(at).query(field.cells)
    _check_covers(np.asarray(away) <= FARTHEST_CELLS * field.cell_size, field, file)
    half = field.cell_size / 2
    offset, cell = (np.asarray(a) for a in KDTree(field.cells).query(at, p=np.inf))
    inside = offset <= half
    count = np.bincount(cell[inside], minlength=len(field.cells))
    total = np.bincount(cell[inside], values[inside], minlength=len(field.cells))
    return np.asarray(np.where(count > 0, total / np.maximum(count, 1), values[nearest]))


def _table(path: Path, field: Field, column: str | None, crs: str | None) -> tuple[Floats, Floats]:
    """Places (k, 2) in the field's frame and values (k,) of a table; blank values left out."""
    text = read_text(path, ReadingsError)
    delimiter = max(";\t,", key=text.lstrip().split("\n", 1)[0].count)
    rows = [row for row in csv.reader(io.StringIO(text), delimiter=delimiter) if any(row)]
    header = [cell.strip().lower() for cell in rows[0]]
    meant = [POSITION_COLUMNS.get(name, "") for name in header]
    lonlat = set(_DEGREES) <= set(meant)
    if not lonlat and not set(_METRES) <= set(meant):
        raise ReadingsError(
            "no columns say where the values are",
            where=path.name,
            remedy="start the table with a header that has lat,lon or easting,northing",
        )
    others = [name for name, position in zip(header, meant, strict=True) if not position]
    value = header.index(_chosen(column.lower() if column else None, others, path.name))
    x, y = (meant.index(name) for name in (_DEGREES if lonlat else _METRES))
    decimal = "," if delimiter != "," and "." not in text.partition("\n")[2] else "."
    found = []
    for k, row in enumerate(rows[1:], 2):
        try:
            if row[value].strip():
                found.append([number(row[column], decimal) for column in (x, y, value)])
        except (ValueError, IndexError) as error:
            raise ReadingsError(
                str(error) if isinstance(error, ValueError) else "cells are missing",
                where=f"{path.name}, row {k}",
            ) from None
    return _placed(np.array(found).reshape(-1, 3), lonlat, field, crs, path.name)


def _layer(path: Path, field: Field, column: str | None, crs: str | None) -> tuple[Floats, Floats]:
    """Places (k, 2) in the field's frame and values (k,) of a layer of points."""
    at, numeric, home = read_points(path)
    values = numeric[_chosen(column, list(numeric), path.name)]
    known = np.isfinite(values)
    at, home = at[known], home or crs or ""
    if home:
        at = project(home, field.crs, *at.T)
    return at, values[known]


def _placed(
    rows: Floats, lonlat: bool, field: Field, crs: str | None, file: str
) -> tuple[Floats, Floats]:
    if not len(rows):
        raise ReadingsError("it holds no values", where=file, remedy="export it again")
    at, _ = Places(rows[:, 0], rows[:, 1], lonlat, file).metres(field, crs)
    return at, rows[:, 2]


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


def _check_covers(known: Bools, field: Field, file: str) -> None:
    if known.all():
        return
    missing = np.flatnonzero(~known)
    if len(missing) == len(known):
        raise ReadingsError(
            f"it does not cover {field.name or 'the field'}: nothing is known of any cell",
            where=file,
            remedy="check that file and field belong together, and the CRS of both",
        )
    east, north = field.cells[missing[0]].tolist()
    raise ReadingsError(
        f"nothing is known of {len(missing)} of {len(known)} cells, the first at "
        f"({east:.1f}, {north:.1f})",
        where=file,
        remedy="fill its holes, or cut the boundary to what it covers",
    )
