"""Rasters: one band of a GeoTIFF, averaged over the cells of a field."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from subsoil.arrays import Floats
from subsoil.errors import ReadingsError, brief
from subsoil.io.read.alone import alone
from subsoil.io.read.sentinels import Sentinels, sentinels_in
from subsoil.land.field import Field
from subsoil.optional import GEOTIFF, load

_ANY_FRAME = "EPSG:32631"
"""Stands for the frame that field and raster share without naming it."""
_MOST_PIXELS = 500_000_000


@dataclass(frozen=True)
class Raster:
    """One band over the cells of a field.

    Attributes
    ----------
    values
        (N,) means of the cells, NaN where nothing is known.
    sentinels
        What among its pixels stands for no data without being declared.
    coded, odd
        Cells with a pixel of these, and with one of the odd value.
    """

    values: Floats
    sentinels: Sentinels
    coded: int
    odd: int


def read_geotiff(path: Path, field: Field, crs: str | None) -> Raster:
    """Average the only band over each cell, by area.

    Parameters
    ----------
    path
        The file.
    field
        The field; its frame is what the raster is brought to.
    crs
        Frame of a file that does not name one, if not the field's.

    Raises
    ------
    ReadingsError
        If it cannot be read, has several bands, is too large, or its frame is unknown.
    MissingExtraError
        If rasterio is not installed.
    """
    rasterio = load(*GEOTIFF, where=path.name, instead="save points as CSV")
    try:
        with (
            alone(path, ReadingsError) as copy,
            rasterio.Env(GDAL_DISABLE_READDIR_ON_OPEN="EMPTY_DIR", GDAL_PAM_ENABLED="NO"),
            rasterio.open(copy, driver="GTiff") as raster,
        ):
            _check(raster, path.name)
            return _over_cells(raster, field, _frame(raster, field, crs, path.name))
    except rasterio.errors.RasterioError as error:
        raise ReadingsError(
            f"GDAL cannot read it: {brief(' '.join(str(error).split()), 200)}",
            where=path.name,
            remedy="export it again as a GeoTIFF",
        ) from error


def _over_cells(raster: Any, field: Field, home: str) -> Raster:
    pixels: Floats = raster.read(1, masked=True).astype(float).filled(np.nan)
    found = sentinels_in(pixels.ravel())
    coded, odd = found.are(pixels), pixels == found.odd
    values = _averaged(raster, np.where(coded, np.nan, pixels), field, home)
    touched = [
        int((_averaged(raster, each.astype(float), field, home) > 0).sum()) if each.any() else 0
        for each in (coded, odd)
    ]
    return Raster(values, found, *touched)


def _check(raster: Any, file: str) -> None:
    if raster.count != 1:
        raise ReadingsError(
            f"it has {raster.count} bands", where=file, remedy="save the one to follow"
        )
    if raster.width * raster.height > _MOST_PIXELS:
        raise ReadingsError(
            f"it has {raster.width} x {raster.height} pixels",
            where=file,
            remedy="cut it to the field",
        )
    if raster.tags(ns="OVERVIEWS"):
        raise ReadingsError(
            "it keeps overviews in another file", where=file, remedy="export it without overviews"
        )


def _frame(raster: Any, field: Field, crs: str | None, file: str) -> str:
    home = raster.crs.to_wkt() if raster.crs else (crs or field.crs)
    if bool(home) != bool(field.crs):
        raise ReadingsError(
            "raster and field are not both in a named CRS, so nothing leads from one to the other",
            where=file,
            remedy="name the CRS of both",
        )
    return str(home)


def _averaged(raster: Any, pixels: Floats, field: Field, home: str) -> Floats:
    warp, affine = load("rasterio.warp", *GEOTIFF[1:]), load(*GEOTIFF).Affine
    grid, size = field.grid, field.cell_size
    west, north = grid.easting[0] - size / 2, grid.northing[-1] + size / 2
    image = np.full((len(grid.northing), len(grid.easting)), np.nan)
    warp.reproject(
        pixels,
        image,
        src_transform=raster.transform,
        src_crs=home or _ANY_FRAME,
        src_nodata=np.nan,
        dst_transform=affine(size, 0.0, west, 0.0, -size, north),
        dst_crs=field.crs or _ANY_FRAME,
        dst_nodata=np.nan,
        resampling=warp.Resampling.average,
    )
    values: Floats = image[::-1][grid.inside]
    return values
