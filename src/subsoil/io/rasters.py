"""Soil maps as rasters: xarray data sets, and GeoTIFFs for any GIS.

Both hold the kriged mean and how sure it is, layer by layer. Cells outside the field, in its
keep-outs, and in layers that no sample reached are NaN.
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from subsoil.errors import MissingExtraError, ParameterError
from subsoil.field import Field
from subsoil.frames import named_crs
from subsoil.io.whole import whole
from subsoil.mapping.soilmap import SoilMap
from subsoil.mapping.uncertainty import standard_deviation

if TYPE_CHECKING:
    from xarray import Dataset

Floats = NDArray[np.float64]

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
_AXES = {
    "easting": {"standard_name": "projection_x_coordinate", "long_name": "easting", "axis": "X"},
    "northing": {"standard_name": "projection_y_coordinate", "long_name": "northing", "axis": "Y"},
}
_VARIABLES = {
    "mean": ("kPa", "kriged penetration resistance"),
    "std_dev": ("kPa", "kriging standard deviation of penetration resistance"),
    "variance": ("kPa2", "kriging variance of penetration resistance"),
}


def to_dataset(soil_map: SoilMap, field: Field) -> Dataset:
    """Soil map as a data set after the CF conventions, rows from south to north.

    Parameters
    ----------
    soil_map
        Map of m layers.
    field
        The field whose cells were mapped.

    Returns
    -------
    xarray.Dataset
        ``mean`` and ``std_dev`` in kPa and ``variance`` in kPa2, (layer, northing, easting). A
        layer goes by its name, such as ``"0.15-0.20 m"``, and has a ``depth`` (its centre), a
        ``depth_top`` and a ``depth_bottom`` in m, positive down. ``crs`` holds the frame as WKT;
        a local frame has none. A variance that is negative by rounding stays as it is, and its
        standard deviation is NaN.

    Raises
    ------
    ParameterError
        If the map is not one of this field.
    MissingExtraError
        If xarray is not installed.

    Examples
    --------
    >>> from subsoil import Field, Layers, Spherical
    >>> field = Field.from_metres([(0, 0), (40, 0), (40, 20), (0, 20)])
    >>> layers = Layers((0.0, 0.2, 0.4))
    >>> empty = SoilMap(field.cells, layers)
    >>> dict(to_dataset(empty, field).sizes)
    {'layer': 2, 'northing': 4, 'easting': 8}
    """
    xarray = _extra("xarray", "a data set")
    _check_cells(soil_map, field)
    values = {
        "mean": soil_map.mean,
        "std_dev": standard_deviation(soil_map.variance),
        "variance": soil_map.variance,
    }
    dims = ("layer", "northing", "easting")
    frame = {"grid_mapping": "crs"} if field.crs else {}
    variables = {
        name: (dims, field.grid.image(values[name]), {"units": unit, "long_name": words, **frame})
        for name, (unit, words) in _VARIABLES.items()
    }
    coordinates: dict[str, tuple[object, ...]] = {
        "layer": ("layer", list(soil_map.layers.names), {"long_name": "depth layer"}),
        "easting": ("easting", field.grid.easting, {**_AXES["easting"], "units": "m"}),
        "northing": ("northing", field.grid.northing, {**_AXES["northing"], "units": "m"}),
        "depth": ("layer", soil_map.layers.centre_m, _depth("centre")),
        "depth_top": ("layer", soil_map.layers.top_m, _depth("upper edge")),
        "depth_bottom": ("layer", soil_map.layers.bottom_m, _depth("lower edge")),
    }
    if field.crs:
        coordinates["crs"] = ((), 0, named_crs(field.crs, field.name).to_cf())
    title = f"{field.name}, simulated" if soil_map.simulated else field.name
    about = {"Conventions": "CF-1.11", "title": title, "samples": len(soil_map.samples)}
    dataset: Dataset = xarray.Dataset(variables, coordinates, about)
    return dataset


def write_geotiffs(soil_map: SoilMap, field: Field, folder: Path) -> tuple[Path, ...]:
    """Write ``mean_kpa.tif`` and ``std_dev_kpa.tif``, one band a layer, and return their paths.

    They are cloud-optimised GeoTIFFs of 32-bit floats, north up, in the frame of the field; those
    of a local frame name no CRS. A standard deviation is NaN, as cells without data are, where
    rounding left the variance below zero.

    Parameters
    ----------
    soil_map
        Map of m layers.
    field
        The field whose cells were mapped.
    folder
        Where to write to; it exists.

    Raises
    ------
    ParameterError
        If the map is not one of this field.
    MissingExtraError
        If rasterio is not installed.
    OSError
        If a file cannot be written.
    """
    _check_cells(soil_map, field)
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
    rasterio = _extra("rasterio", "a GeoTIFF")
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


def _check_cells(soil_map: SoilMap, field: Field) -> None:
    if not np.array_equal(soil_map.cells, field.cells):
        raise ParameterError(
            f"the map has {len(soil_map.cells)} cells that are not the field's {len(field.cells)}",
            where=field.name,
            remedy="give the field that was mapped",
        )


def _depth(what: str) -> dict[str, str]:
    return {
        "standard_name": "depth",
        "long_name": f"depth of the layer's {what}",
        "units": "m",
        "positive": "down",
    }


def _extra(name: str, what: str) -> ModuleType:
    try:
        return import_module(name)
    except ImportError as error:
        raise MissingExtraError(
            f"{what} needs {name}, which is not installed", remedy="pip install 'subsoil[geo]'"
        ) from error
