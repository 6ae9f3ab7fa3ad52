"""Points with attributes as a sheet: GeoPackage, shapefile and GeoJSON, as QField writes them."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from subsoil.errors import BoundaryError, ReadingsError
from subsoil.io.read.outlines.geofile import read_layer
from subsoil.io.read.outlines.geojson import features_of
from subsoil.io.read.tables.sheet import Row, Sheet
from subsoil.land.crs import WGS84

_SUFFIXES = (".gpkg", ".shp", ".geojson", ".json")
_SQLITE = b"SQLite format 3\x00"


def looks_like_points(head: bytes, name: str) -> bool:
    """Whether a file is one, by its first bytes and its name."""
    return name.lower().endswith(_SUFFIXES) or head.startswith(_SQLITE)


def read_point_sheet(path: Path) -> tuple[Sheet, ...]:
    """Read the only layer of points of a file; features count from 1.

    Raises
    ------
    ReadingsError
        If it cannot be read, or holds other features than points.
    MissingExtraError
        If the format needs pyogrio and it is not installed.
    """
    if path.suffix.lower() in (".geojson", ".json"):
        return (_of_geojson(path),)
    layer = read_layer(path, "Point", ReadingsError)
    shapes = [shapely.from_wkb(shape) if shape else None for shape in layer.shapes]
    names = list(layer.fields)
    columns = [_texts(layer.fields[name]) for name in names]
    rows: list[Row] = [(0, names)]
    rows += [(k, list(cells)) for k, cells in enumerate(zip(*columns, strict=True), 1)]
    places = {k: _place(shape, f"{path.name}, feature {k}") for k, shape in enumerate(shapes, 1)}
    return (_sheet(path.name, rows, places, layer.crs),)


def _of_geojson(path: Path) -> Sheet:
    try:
        features, crs = features_of(path)
    except BoundaryError as error:
        raise ReadingsError(error.what, where=error.where, remedy=error.remedy) from error
    places, attributes = {}, []
    for k, feature in enumerate(features, 1):
        inner = feature if isinstance(feature, dict) else {}
        places[k] = _coordinates(inner.get("geometry"), f"{path.name}, feature {k}")
        properties = inner.get("properties")
        attributes.append(properties if isinstance(properties, dict) else {})
    names = list(dict.fromkeys(name for each in attributes for name in each))
    rows: list[Row] = [(0, names)]
    rows += [(k, [_text(each.get(n)) for n in names]) for k, each in enumerate(attributes, 1)]
    return _sheet(path.name, rows, places, crs or WGS84)


def _sheet(
    file: str, rows: list[Row], places: dict[int, tuple[float, float] | None], crs: str
) -> Sheet:
    at = {k: place for k, place in places.items() if place is not None}
    if not at:
        raise ReadingsError(
            "none of its features is a point", where=file, remedy="save the points alone"
        )
    return Sheet(file, rows, by_program=True, places=at, crs=crs)


def _place(shape: Any, where: str) -> tuple[float, float] | None:
    """Coordinates of a point, or of several that are one; ``None`` without any."""
    if shape is None or shape.is_empty:
        return None
    parts = shapely.get_parts(shape)
    if len(parts) != 1 or shapely.get_type_id(parts[0]) != shapely.GeometryType.POINT:
        raise _not_a_point(where)
    x, y = shapely.get_coordinates(parts[0])[0]
    return (float(x), float(y)) if np.isfinite([x, y]).all() else None


def _coordinates(geometry: Any, where: str) -> tuple[float, float] | None:
    if geometry is None:
        return None
    if not isinstance(geometry, dict) or geometry.get("type") not in ("Point", "MultiPoint"):
        raise _not_a_point(where)
    at = geometry.get("coordinates")
    if geometry["type"] == "MultiPoint" and isinstance(at, list) and len(at) == 1:
        (at,) = at
    numbers = at[:2] if isinstance(at, list) else []
    if len(numbers) != 2 or not all(type(n) in (int, float) and abs(n) < 1e12 for n in numbers):
        raise ReadingsError("its coordinates are not two numbers", where=where)
    return float(numbers[0]), float(numbers[1])


def _not_a_point(where: str) -> ReadingsError:
    return ReadingsError(
        "this is not a point", where=where, remedy="save the points of readings alone"
    )


def _texts(values: np.ndarray[Any, Any]) -> list[str]:
    if values.dtype.kind == "M":
        return [
            "" if text == "NaT" else text for text in np.datetime_as_string(values, "ms").tolist()
        ]
    return [_text(value) for value in values.tolist()]


def _text(value: Any) -> str:
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return ""
    if isinstance(value, list | dict):
        return "(nested)"
    if isinstance(value, int) and abs(value) > 10**18:
        return "(endless)"
    return repr(value) if isinstance(value, float) else str(value)
