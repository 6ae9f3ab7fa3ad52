"""Points with values: features of GeoPackages, shapefiles and GeoJSON."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import shapely

from subsoil.arrays import Floats
from subsoil.errors import ReadingsError
from subsoil.io.read.outlines.geofile import read_layer
from subsoil.io.read.outlines.geojson import features_of
from subsoil.land.crs import WGS84


def read_points(path: Path) -> tuple[Floats, dict[str, Floats], str]:
    """Read the only layer of points of a file.

    Returns
    -------
    at, fields, crs
        (n, 2) places, longitude or easting first; (n,) values of every attribute that holds
        numbers, NaN where there is none; and the frame, empty if the file names none.

    Raises
    ------
    ReadingsError
        If it cannot be read, or holds other features than points.
    BoundaryError
        If it is JSON that cannot be read.
    MissingExtraError
        If the format needs pyogrio and it is not installed.
    """
    if path.suffix.lower() in (".geojson", ".json"):
        return _of_geojson(path)
    layer = read_layer(path, "Point", ReadingsError)
    points = shapely.from_wkb(layer.shapes)
    if set(shapely.get_type_id(points).tolist()) != {int(shapely.GeometryType.POINT)}:
        raise ReadingsError("its features are not points", where=path.name)
    numeric = {name: c.astype(float) for name, c in layer.fields.items() if c.dtype.kind in "if"}
    return shapely.get_coordinates(points), numeric, layer.crs


def _of_geojson(path: Path) -> tuple[Floats, dict[str, Floats], str]:
    features, crs = features_of(path)
    at, rows = [], []
    for k, feature in enumerate(features, 1):
        geometry = feature.get("geometry") if isinstance(feature, dict) else None
        if not isinstance(geometry, dict) or geometry.get("type") != "Point":
            raise ReadingsError("this is not a point", where=f"{path.name}, feature {k}")
        at.append(_place(geometry.get("coordinates"), f"{path.name}, feature {k}"))
        properties = feature.get("properties")
        rows.append(properties if isinstance(properties, dict) else {})
    if not at:
        raise ReadingsError("its features are not points", where=path.name)
    names = dict.fromkeys(name for row in rows for name in row)
    fields = {name: [_number(row.get(name)) for row in rows] for name in names}
    numeric = {n: np.array(v) for n, v in fields.items() if np.isfinite(v).any()}
    return np.array(at), numeric, crs or WGS84


def _place(coordinates: Any, where: str) -> tuple[float, float]:
    numbers = coordinates[:2] if isinstance(coordinates, list) else []
    place = tuple(_number(value) for value in numbers)
    if len(place) != 2 or not np.isfinite(place).all():
        raise ReadingsError("its coordinates are not two numbers", where=where)
    return place[0], place[1]


def _number(value: Any) -> float:
    """Number as such, NaN for anything else."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return np.nan
    try:
        return float(value)
    except OverflowError:
        return np.nan
