"""Outlines as GeoJSON (RFC 7946): WGS84, longitude first.

Programs older than the RFC name another frame in a member ``crs``; it is honoured.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from shapely.geometry import MultiPolygon, Polygon

from subsoil.errors import BoundaryError, brief
from subsoil.io.read.outlines import NOTHING, Feature, Outlines, frame, outlines_of
from subsoil.io.read.text import read_text
from subsoil.land.crs import WGS84
from subsoil.land.outline import Area, polygon


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
    if document.get("type") == "Feature":
        yield _feature(document, file)
    elif document.get("type") == "FeatureCollection":
        features = document.get("features")
        for k, feature in enumerate(features if isinstance(features, list) else [], 1):
            yield _feature(feature, f"{file}, feature {k}")
    else:
        yield Feature(file, _shape(document, file))


def _feature(feature: Any, where: str) -> Feature:
    if not (isinstance(feature, dict) and feature.get("type") == "Feature"):
        raise BoundaryError("this is not a Feature", where=where, remedy="export it again")
    properties = feature.get("properties")
    properties = properties if isinstance(properties, dict) else {}
    if properties.get("name"):
        where = f"{where} ({brief(str(properties['name']))})"
    return Feature(where, _shape(feature.get("geometry"), where), str(properties.get("role", "")))


def _shape(geometry: Any, where: str) -> Area | str:
    """Area of a geometry; the name of its kind if it is none."""
    geometry = geometry if isinstance(geometry, dict) else {}
    kind, coordinates = geometry.get("type"), geometry.get("coordinates")
    if kind not in ("Polygon", "MultiPolygon"):
        return brief(kind) if isinstance(kind, str) else NOTHING
    if not (isinstance(coordinates, list) and coordinates):
        raise BoundaryError("it has no coordinates", where=where, remedy="draw the outline again")
    if kind == "Polygon":
        return _polygon(coordinates, where)
    return MultiPolygon([_polygon(rings, where) for rings in coordinates])


def _polygon(rings: Any, where: str) -> Polygon:
    if not (isinstance(rings, list) and rings):
        raise BoundaryError("a polygon has no ring", where=where, remedy="draw it again")
    shell, *holes = [_ring(ring, where) for ring in rings]
    return Polygon(shell.exterior, [hole.exterior for hole in holes])


def _ring(ring: Any, where: str) -> Polygon:
    if not (isinstance(ring, list) and all(isinstance(v, list) and len(v) > 1 for v in ring)):
        raise BoundaryError("a ring is not a list of [longitude, latitude]", where=where)
    return polygon([vertex[:2] for vertex in ring], where)
