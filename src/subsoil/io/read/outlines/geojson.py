"""Outlines as GeoJSON (RFC 7946): WGS84, longitude first.

Programs older than the RFC name another frame in a member ``crs``; it is honoured.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from shapely.geometry import LineString, MultiPolygon, Polygon

from subsoil.errors import BoundaryError, brief
from subsoil.io.read.outlines.outlines import (
    NOTHING,
    Feature,
    Outlines,
    frame,
    name_among,
    outlines_of,
)
from subsoil.io.read.text import read_text
from subsoil.land.crs import WGS84
from subsoil.land.outline import FARTHEST_M, Area, polygon


def read_geojson(path: Path, crs: str | None) -> Outlines:
    """Read a Polygon, MultiPolygon, Feature or FeatureCollection.

    Parameters
    ----------
    path
        The file.
    crs
        Frame of a file that does not name one; WGS84 if None.

    Raises
    ------
    BoundaryError
        If it is not JSON or not GeoJSON, has no polygon, or one that is not usable; the message
        names the line or the feature.
    """
    document = _json(read_text(path, BoundaryError), path.name)
    home = _home(document, path.name) or crs
    crs = frame(home, path.name) if home else WGS84
    return outlines_of(_features(document, path.name), crs, path.name)


def features_of(path: Path) -> tuple[list[Any], str]:
    """Features of a FeatureCollection as they stand, and its frame, empty if it names none.

    Raises
    ------
    BoundaryError
        If it is not JSON, no FeatureCollection, or its frame is unknown.
    """
    document = _json(read_text(path, BoundaryError), path.name)
    features = document.get("features")
    if document.get("type") != "FeatureCollection" or not isinstance(features, list):
        raise BoundaryError(
            "this is no FeatureCollection", where=path.name, remedy="export it again as GeoJSON"
        )
    return features, _home(document, path.name)


def _json(text: str, file: str) -> dict[str, Any]:
    try:
        document = json.loads(text, object_pairs_hook=_once)
    except json.JSONDecodeError as error:
        raise BoundaryError(
            f"this is not JSON: {error.msg}",
            where=f"{file}, line {error.lineno}, column {error.colno}",
            remedy="export it again as GeoJSON",
        ) from error
    except KeyError as error:
        raise BoundaryError(
            f"{brief(str(error.args[0]))!r} is there twice in one object",
            where=file,
            remedy="keep one of the two",
        ) from error
    except (RecursionError, ValueError) as error:
        raise BoundaryError(
            "its lists are nested too deeply, or a number is too long", where=file
        ) from error
    if not isinstance(document, dict):
        raise BoundaryError(
            "this is JSON, but not GeoJSON", where=file, remedy="export it again as GeoJSON"
        )
    return document


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """Object of these members; a name that comes twice is a KeyError."""
    found = dict(pairs)
    if len(found) < len(pairs):
        names = [name for name, _ in pairs]
        raise KeyError(next(name for name in names if names.count(name) > 1))
    return found


def _home(document: dict[str, Any], file: str) -> str:
    """Frame that a document names, if it does."""
    member = document.get("crs")
    if not member:
        return ""
    try:
        return frame(str(member["properties"]["name"]), file)
    except (TypeError, KeyError) as error:
        raise BoundaryError(
            "its crs member names no CRS", where=file, remedy="export it again in WGS84"
        ) from error


def _features(document: dict[str, Any], file: str) -> Iterator[Feature]:
    kind = document.get("type")
    foreign = "TopoJSON" if kind == "Topology" else "Esri JSON" if "rings" in document else ""
    if foreign or "geometryType" in document:
        raise BoundaryError(
            f"this is {foreign or 'Esri JSON'}, not GeoJSON",
            where=file,
            remedy="export it again as GeoJSON",
        )
    if kind == "Feature":
        yield from _feature(document, file)
    elif kind == "FeatureCollection":
        features = document.get("features")
        for k, feature in enumerate(features if isinstance(features, list) else [], 1):
            yield from _feature(feature, f"{file}, feature {k}")
    else:
        yield from (Feature(file, shape) for shape in _shapes(document, file))


def _feature(feature: Any, where: str) -> Iterator[Feature]:
    if not (isinstance(feature, dict) and feature.get("type") == "Feature"):
        raise BoundaryError("this is not a Feature", where=where, remedy="export it again")
    properties = feature.get("properties")
    properties = properties if isinstance(properties, dict) else {}
    name, role = name_among(properties), str(properties.get("role", ""))
    where = f"{where} ({brief(name)})" if name else where
    for shape in _shapes(feature.get("geometry"), where):
        yield Feature(where, shape, role, name)


def _shapes(geometry: Any, where: str) -> Iterator[Area | LineString | str]:
    """Areas and lines of a geometry; the names of the kinds of all else."""
    geometry = geometry if isinstance(geometry, dict) else {}
    kind, coordinates = geometry.get("type"), geometry.get("coordinates")
    members = geometry.get("geometries")
    if kind == "GeometryCollection" and isinstance(members, list) and members:
        for member in members:
            if isinstance(member, dict) and member.get("type") == kind:
                raise BoundaryError("it has collections in collections", where=where)
            yield from _shapes(member, where)
    elif kind in ("Polygon", "MultiPolygon"):
        yield _area(kind, coordinates, where)
    else:
        line = _line(coordinates) if kind == "LineString" else None
        yield line or (brief(kind) if isinstance(kind, str) else NOTHING)


def _area(kind: str, coordinates: Any, where: str) -> Area:
    if not (isinstance(coordinates, list) and coordinates):
        raise BoundaryError("it has no coordinates", where=where, remedy="draw the outline again")
    if kind == "Polygon":
        return _polygon(coordinates, where)
    return MultiPolygon([_polygon(rings, where) for rings in coordinates])


def _line(coordinates: Any) -> LineString | None:
    """Line of two or more finite vertices, if it is that."""
    try:
        corners = np.array([vertex[:2] for vertex in coordinates], dtype=float)
    except (TypeError, ValueError, OverflowError, KeyError):
        return None
    fit = corners.ndim == 2 and corners.shape[1] == 2 and len(corners) > 1
    return LineString(corners) if fit and (np.abs(corners) <= FARTHEST_M).all() else None


def _polygon(rings: Any, where: str) -> Polygon:
    if not (isinstance(rings, list) and rings):
        raise BoundaryError("a polygon has no ring", where=where, remedy="draw it again")
    shell, *holes = [_ring(ring, where) for ring in rings]
    return Polygon(shell.exterior, [hole.exterior for hole in holes])


def _ring(ring: Any, where: str) -> Polygon:
    if not (isinstance(ring, list) and all(isinstance(v, list) and len(v) > 1 for v in ring)):
        raise BoundaryError("a ring is not a list of [longitude, latitude]", where=where)
    return polygon([vertex[:2] for vertex in ring], where)
