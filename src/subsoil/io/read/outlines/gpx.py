"""Outlines as GPX: a track or route around the field, WGS84."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from shapely.geometry import LineString

from subsoil.errors import BoundaryError, brief
from subsoil.io.read.outlines.outlines import Feature, Outlines, not_an_outline, outlines_of
from subsoil.io.read.xml import Element, kind_of, parsed, word_of
from subsoil.land.crs import WGS84

_KINDS = {"trk": ("track", "trkpt"), "rte": ("route", "rtept")}


def read_gpx(path: Path) -> Outlines:
    """Read tracks and routes that come back to where they start; waypoints are noted.

    Raises
    ------
    BoundaryError
        If it is not GPX, declares entities, or has no closed track.
    """
    root = parsed(path, "gpx")
    features = [each for k, line in enumerate(root, 1) for each in _features(line, k, path)]
    if not features:
        raise not_an_outline("file without a track", path.name)
    return outlines_of(features, WGS84, path.name)


def _features(element: Element, number: int, path: Path) -> Iterator[Feature]:
    name = word_of(element, "name")
    where = f"{path.name}, element {number}" + (f" ({brief(name)})" if name else "")
    if kind_of(element) == "wpt":
        yield Feature(where, "waypoint", name=name)
    elif kind_of(element) in _KINDS:
        kind, point = _KINDS[kind_of(element)]
        at = [_place(each, where) for each in element.iter() if kind_of(each) == point]
        yield Feature(where, LineString(at) if len(at) > 1 else kind, name=name, kind=kind)


def _place(point: Element, where: str) -> tuple[float, float]:
    try:
        place = float(point.get("lon", "")), float(point.get("lat", ""))
    except ValueError:
        place = np.nan, np.nan
    if not (np.abs(place) <= (180, 90)).all():
        raise BoundaryError(
            "a point has no latitude and longitude", where=where, remedy="export it again"
        )
    return place
