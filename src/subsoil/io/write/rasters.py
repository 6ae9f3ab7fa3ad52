"""Soil maps as GeoTIFFs for any GIS: the kriged mean and how sure it is, layer by layer.

Cells outside the field, in its keep-outs, and in layers that no sample reached are NaN.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from subsoil.arrays import Floats
from subsoil.io.write.whole import whole
from subsoil.land.crs import named_crs
from subsoil.land.field import Field
from subsoil.mapping.soilmap import SoilMap
from subsoil.mapping.uncertainty import standard_deviation
from subsoil.optional import GEOTIFF, load

_BLOCK = 256
_COG = {
    "driver": "COG",
    "dtype": "float32",
    "nodata": float("nan"),
    "compress": "DEFLATE",
    "predictor": "FLOATING_POINT",
    "blocksize": _BLOCK,
    "overview_resampling": "average",
}


def write_geotiffs(soil_map: SoilMap, folder: Path) -> tuple[Path, ...]:
    """Write ``mean_kpa.tif`` and ``std_dev_kpa.tif``, one band a layer, and return their paths.

    They are cloud-optimised GeoTIFFs of 32-bit floats, north up, in the frame of the field; those
    of a local frame name no CRS. A standard deviation is NaN, as cells without data are, where
    rounding left the variance below zero.

    Parameters
    ----------
    soil_map
        Map of m layers.
    folder
        Where to write to; it exists.

    Raises
    ------
    MissingExtraError
        If rasterio is not installed.
    OSError
        If a file cannot be written.
    """
    field = soil_map.field
    rasters = {
        "mean_kpa.tif": soil_map.mean,
        "std_dev_kpa.tif": standard_deviation(soil_map.variance),
    }
    names = soil_map.layers.names
    about = {"SAMPLES": str(len(soil_map.samples))}
    if soil_map.simulated:
        names, about = tuple(f"{name}, simulated" for name in names), {**about, "SIMULATED": "yes"}
    return tuple(
        _write(Path(folder) / name, field.grid.image(values), names, field, about)
        for name, values in rasters.items()
    )


def _write(
    path: Path, bands: Floats, names: tuple[str, ...], field: Field, about: Mapping[str, str]
) -> Path:
    """Write bands (m, ny, nx), rows from south to north, and what to know of them."""
    rasterio = load(*GEOTIFF)
    size, grid = field.cell_size, field.grid
    west, north = grid.easting[0] - size / 2, grid.northing[-1] + size / 2
    with (
        whole(path) as unfinished,
        rasterio.open(
            unfinished,
            "w",
            width=len(grid.easting),
            height=len(grid.northing),
            count=len(bands),
            crs=named_crs(field.crs, field.name).to_wkt() if field.crs else None,
            transform=rasterio.Affine(size, 0.0, west, 0.0, -size, north),
            **_COG,
        ) as raster,
    ):
        raster.write(bands[:, ::-1].astype(np.float32))
        raster.descriptions = names
        raster.units = ("kPa",) * len(bands)
        raster.update_tags(**about)
    return path
