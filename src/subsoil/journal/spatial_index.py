"""Spatial indexes that GDAL or QGIS built in a survey file are kept right while it is written.

Their triggers call functions that GDAL brings along and plain sqlite lacks
(OGC 12-128r18, annex F.3); they are given to a connection here.
"""

from __future__ import annotations

import sqlite3

import shapely
from shapely.geometry.base import BaseGeometry

from subsoil.journal.geopackage import geometry_of


def know_functions(database: sqlite3.Connection) -> None:
    """Give a connection the functions that the triggers of a spatial index call."""
    database.create_function("ST_IsEmpty", 1, _is_empty, deterministic=True)
    for place, name in enumerate(("ST_MinX", "ST_MinY", "ST_MaxX", "ST_MaxY")):
        database.create_function(name, 1, _Edge(place), deterministic=True)


class _Edge:
    """One of west, south, east and north of a geometry; none of an empty one."""

    def __init__(self, place: int) -> None:
        self._place = place

    def __call__(self, blob: object) -> float | None:
        geometry = _read(blob)
        if geometry is None or geometry.is_empty:
            return None
        return float(geometry.bounds[self._place])


def _is_empty(blob: object) -> int | None:
    geometry = _read(blob)
    return None if geometry is None else int(geometry.is_empty)


def _read(blob: object) -> BaseGeometry | None:
    """Geometry of a GeoPackage blob; sqlite knows no other answer to a bad one than NULL."""
    try:
        return geometry_of(blob) if isinstance(blob, bytes) else None
    except (ValueError, shapely.errors.ShapelyError):
        return None
