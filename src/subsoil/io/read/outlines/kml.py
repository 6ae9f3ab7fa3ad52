"""Outlines as KML: WGS84, longitude first.

Polygons are read of the file itself, and closed lines, bare rings and tracks where there is none:
links to other files are not followed. What is beside them is noted.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from shapely.geometry import LineString, MultiPolygon, Polygon

from subsoil.arrays import Floats
from subsoil.errors import BoundaryError, brief
from subsoil.io.read.outlines.outlines import (
    NOTHING,
    Feature,
    Outlines,
    not_an_outline,
    outlines_of,
)
from subsoil.io.read.xml import Element, kind_of, parsed, word_of
from subsoil.land.crs import WGS84
from subsoil.land.outline import FARTHEST_M, polygon

_LINES = ("LineString", "LinearRing", "Track")
_SHAPES = ("Point", *_LINES, "Model")
_LINKS = ("NetworkLink", "GroundOverlay")


def read_kml(path: Path) -> Outlines:
    """Read the polygons of all placemarks; what is beside them is noted.

    Raises
    ------
    BoundaryError
        If it is not KML, declares entities, or has no polygon, or one that is not usable.
    """
    root = parsed(path, "kml")
    places = [each for each in root.iter() if kind_of(each) == "Placemark"]
    features = [each for k, place in enumerate(places, 1) for each in _features(place, k, path)]
    if not features:
        raise not_an_outline("file without a polygon", path.name)
    links = [Feature(path.name, kind_of(each)) for each in root.iter() if kind_of(each) in _LINKS]
    return outlines_of([*features, *links], WGS84, path.name)


def _features(place: Element, number: int, path: Path) -> Iterator[Feature]:
    """Polygons of a placemark as one, and what else is drawn there."""
    name = word_of(place, "name")
    where = f"{path.name}, feature {number}" + (f" ({brief(name)})" if name else "")
    drawn = [each for each in place.iter() if kind_of(each) == "Polygon"]
    rings = {ring for each in drawn for ring in each.iter()}
    role = _role(place)
    if drawn:
        found = [_polygon(each, where) for each in drawn]
        yield Feature(where, found[0] if len(found) == 1 else MultiPolygon(found), role, name)
    others = [each for each in place.iter() if each not in rings and kind_of(each) in _SHAPES]
    for each in others:
        kind = kind_of(each)
        line = _line(each, where) if kind in _LINES else None
        yield Feature(where, line or kind, "" if drawn else role, name, kind)
    if not (drawn or others):
        yield Feature(where, NOTHING, role, name)


def _role(place: Element) -> str:
    for each in place.iter():
        if kind_of(each) in ("Data", "SimpleData") and each.get("name") == "role":
            return "".join(each.itertext()).strip()
    return ""


def _line(element: Element, where: str) -> LineString | None:
    """A line, ring or track, if it has two places or more."""
    texts = [each.text or "" for each in element if kind_of(each) in ("coordinates", "coord")]
    if kind_of(element) == "Track":
        texts = [",".join(text.split()) for text in texts]
    corners = _corners(" ".join(texts), where)
    fit = len(corners) > 1 and (np.abs(corners) <= FARTHEST_M).all()
    return LineString(corners) if fit else None


def _polygon(element: Element, where: str) -> Polygon:
    rings = {"outerBoundaryIs": [], "innerBoundaryIs": []}  # type: dict[str, list[Polygon]]
    for boundary in element:
        for each in boundary.iter():
            if kind_of(boundary) in rings and kind_of(each) == "coordinates":
                rings[kind_of(boundary)].append(polygon(_corners(each.text or "", where), where))
    if len(rings["outerBoundaryIs"]) != 1:
        raise BoundaryError(
            f"a polygon has {len(rings['outerBoundaryIs'])} outer rings, not one",
            where=where,
            remedy="draw it again",
        )
    (shell,) = rings["outerBoundaryIs"]
    return Polygon(shell.exterior, [hole.exterior for hole in rings["innerBoundaryIs"]])


def _corners(text: str, where: str) -> Floats:
    """(k, 2) longitudes and latitudes of ``lon,lat[,height]`` parted by blanks."""
    try:
        pairs = [word.split(",")[:2] for word in text.split()]
        return np.array([[float(x), float(y)] for x, y in pairs]).reshape(-1, 2)
    except ValueError as error:
        raise BoundaryError(
            "its coordinates are not longitude,latitude pairs",
            where=where,
            remedy="draw it again",
        ) from error
