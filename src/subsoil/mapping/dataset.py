"""Soil maps as xarray data sets after the CF conventions."""

from __future__ import annotations

from typing import TYPE_CHECKING

from subsoil.land.crs import named_crs
from subsoil.mapping.uncertainty import standard_deviation
from subsoil.optional import load

if TYPE_CHECKING:
    from xarray import Dataset

    from subsoil.mapping.soilmap import SoilMap

_AXES = {
    "easting": {"standard_name": "projection_x_coordinate", "long_name": "easting", "axis": "X"},
    "northing": {"standard_name": "projection_y_coordinate", "long_name": "northing", "axis": "Y"},
}
_VARIABLES = {
    "mean": ("kPa", "kriged penetration resistance"),
    "std_dev": ("kPa", "kriging standard deviation of penetration resistance"),
    "variance": ("kPa2", "kriging variance of penetration resistance"),
}


def dataset_of(soil_map: SoilMap) -> Dataset:
    """Soil map as a data set, rows from south to north.

    Returns
    -------
    xarray.Dataset
        ``mean`` and ``std_dev`` in kPa and ``variance`` in kPa2, (depth, northing, easting).
        ``depth`` is that of a layer's centre in m, positive down; a layer has a ``layer`` name,
        such as ``"0.15-0.20 m"``, a ``depth_top`` and a ``depth_bottom`` too. ``crs`` holds the
        frame as WKT; a local frame has none. Cells outside the field, in its keep-outs, and in
        layers that no sample reached are NaN. A variance that is negative by rounding stays as it
        is, and its standard deviation is NaN.

    Raises
    ------
    MissingExtraError
        If xarray is not installed.

    Examples
    --------
    >>> from subsoil import Field, Layers, SoilMap
    >>> field = Field.from_metres([(0, 0), (40, 0), (40, 20), (0, 20)])
    >>> data = dataset_of(SoilMap(field, Layers((0.0, 0.2, 0.4))))
    >>> dict(data.sizes), data.depth.values.round(3).tolist()
    ({'depth': 2, 'northing': 4, 'easting': 8}, [0.1, 0.3])
    """
    xarray = load("xarray", "geo", "a data set")
    field, layers = soil_map.field, soil_map.layers
    values = {
        "mean": soil_map.mean,
        "std_dev": standard_deviation(soil_map.variance),
        "variance": soil_map.variance,
    }
    dims = ("depth", "northing", "easting")
    frame = {"grid_mapping": "crs"} if field.crs else {}
    variables = {
        name: (dims, field.grid.image(values[name]), {"units": unit, "long_name": words, **frame})
        for name, (unit, words) in _VARIABLES.items()
    }
    coordinates: dict[str, tuple[object, ...]] = {
        "depth": ("depth", layers.centre_m, {**_depth("centre"), "axis": "Z"}),
        "northing": ("northing", field.grid.northing, {**_AXES["northing"], "units": "m"}),
        "easting": ("easting", field.grid.easting, {**_AXES["easting"], "units": "m"}),
        "layer": ("depth", list(layers.names), {"long_name": "depth layer"}),
        "depth_top": ("depth", layers.top_m, _depth("upper edge")),
        "depth_bottom": ("depth", layers.bottom_m, _depth("lower edge")),
    }
    if field.crs:
        coordinates["crs"] = ((), 0, named_crs(field.crs, field.name).to_cf())
    title = f"{field.name}, simulated" if soil_map.simulated else field.name
    about = {"Conventions": "CF-1.11", "title": title, "samples": len(soil_map.samples)}
    dataset: Dataset = xarray.Dataset(variables, coordinates, about)
    return dataset


def _depth(what: str) -> dict[str, str]:
    return {
        "standard_name": "depth",
        "long_name": f"depth of the layer's {what}",
        "units": "m",
        "positive": "down",
    }
