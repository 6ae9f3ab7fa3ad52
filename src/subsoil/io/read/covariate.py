"""What is known of a field beforehand: EC maps, yield maps, last year's map.

Rasters (``.tif``) are averaged over each cell, whatever their CRS and resolution. Points, as rows
of a table (``.csv``) or features of a layer (``.gpkg``, ``.shp``, ``.geojson``), are averaged in
each cell. A cell without a value takes the nearest, up to 5 cells away. Numbers such as -9999 that
stand for no data and do not say so are left out and named.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import scipy

from subsoil.arrays import Floats
from subsoil.errors import ReadingsError
from subsoil.findings import Finding
from subsoil.io.read.covariate_points import of_layer, of_table
from subsoil.io.read.geotiff import read_geotiff
from subsoil.io.read.sentinels import Sentinels, sentinels_in
from subsoil.io.read.text import check_file
from subsoil.land.field import Field

FARTHEST_CELLS = 5.0
"""Distance from a cell to the nearest value, in cells, up to which that stands for it."""
_RASTERS, _LAYERS = (".tif", ".tiff"), (".gpkg", ".shp", ".geojson", ".json")


@dataclass(frozen=True)
class Beforehand:
    """What a file says of the cells of a field.

    Attributes
    ----------
    values
        (N,) values of the cells, not all the same.
    findings
        What of the file was left out, and what looks odd.
    """

    values: Floats
    findings: tuple[Finding, ...] = ()


def read_covariate(
    path: str | Path, field: Field, *, column: str | None = None, crs: str | None = None
) -> Beforehand:
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
        known = _of_raster(path, field, crs)
    elif suffix in (".csv", *_LAYERS):
        known = _of_points(path, field, column, crs)
    else:
        raise ReadingsError(
            "nothing reads a covariate from files with this suffix",
            where=path.name,
            remedy=f"save it as one of {' '.join((*_RASTERS, '.csv', *_LAYERS))}",
        )
    if np.ptp(known.values) == 0:
        raise ReadingsError(
            f"it is {known.values[0]:g} in all {len(known.values)} cells and tells nothing",
            where=path.name,
            remedy="leave it out, or check that it is the right file or column",
        )
    return known


def _of_raster(path: Path, field: Field, crs: str | None) -> Beforehand:
    raster = read_geotiff(path, field, crs)
    said = _said(raster.sentinels, raster.coded, raster.odd, "cells", path.name)
    unknown = ~np.isfinite(raster.values)
    if not unknown.any():
        return Beforehand(raster.values, said)
    at, values = field.cells[~unknown], raster.values[~unknown]
    filled = raster.values.copy()
    filled[unknown] = values[_nearest(at, field.cells[unknown], field, path.name)]
    seen = f"nothing is known of {unknown.sum()} of {len(unknown)} cells"
    note = Finding(seen, "they take the nearest value", file=path.name)
    return Beforehand(filled, (*said, note))


def _of_points(path: Path, field: Field, column: str | None, crs: str | None) -> Beforehand:
    """Average points in each cell, or take the nearest."""
    read = of_table if path.suffix.lower() == ".csv" else of_layer
    at, values, blank = read(path, field, column, crs)
    found = sentinels_in(values)
    coded = found.are(values)
    odd = int((values == found.odd).sum())
    said = _said(found, int(coded.sum()), odd, "points", path.name)
    if blank:
        said += (Finding(f"{blank} points have no value", file=path.name),)
    at, values = at[~coded], values[~coded]
    nearest = _nearest(at, field.cells, field, path.name)
    half = field.cell_size / 2
    offset, cell = (np.asarray(a) for a in scipy.spatial.KDTree(field.cells).query(at, p=np.inf))
    inside = offset <= half
    count = np.bincount(cell[inside], minlength=len(field.cells))
    total = np.bincount(cell[inside], values[inside], minlength=len(field.cells))
    mean = np.where(count > 0, total / np.maximum(count, 1), values[nearest])
    return Beforehand(np.asarray(mean), said)


def _said(found: Sentinels, coded: int, odd: int, what: str, file: str) -> tuple[Finding, ...]:
    """Findings about numbers that stand for no data, and about one that may."""
    among = f"where others hold {found.low:.4g} to {found.high:.4g}"
    said = []
    if coded:
        codes = " or ".join(f"{code:.6g}" for code in found.codes) or "a huge number"
        seen, done = f"{coded} {what} hold {codes} {among}", "taken as no data"
        said.append(Finding(seen, done, "left out", file))
    if odd:
        seen = f"{odd} {what} hold {found.odd:.6g} {among}"
        done = "used as it stands; declare it as no data if it is none"
        said.append(Finding(seen, done, "doubt", file))
    return tuple(said)


def _nearest(at: Floats, cells: Floats, field: Field, file: str) -> Floats:
    """(n,) indices of the places (k, 2) nearest to cells (n, 2), none of which is too far.

    Raises
    ------
    ReadingsError
        If nothing is known near some of the cells.
    """
    most = FARTHEST_CELLS * field.cell_size
    away, nearest = (
        scipy.spatial.KDTree(at).query(cells) if len(at) else (np.full(len(cells), np.inf), [])
    )
    missing = np.flatnonzero(np.asarray(away) > most)
    if not missing.size:
        return np.asarray(nearest)
    if len(missing) == len(field.cells):
        raise ReadingsError(
            f"it does not cover {field.name or 'the field'}: nothing is known of any cell",
            where=file,
            remedy="check that file and field belong together, and the CRS of both",
        )
    east, north = cells[missing[0]].tolist()
    raise ReadingsError(
        f"nothing is known within {most:g} m of {len(missing)} of {len(field.cells)} cells, the "
        f"first at ({east:.1f}, {north:.1f})",
        where=file,
        remedy="fill its holes, or cut the boundary to what it covers",
    )
