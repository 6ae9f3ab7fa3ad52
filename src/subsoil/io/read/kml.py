"""Outlines as KML: WGS84, longitude first.

Only polygons are read, of the file itself: links to other files are not followed. Pins, lines and
links beside them are noted.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from shapely.geometry import MultiPolygon, Polygon

from subsoil.arrays import Floats
from subsoil.errors import BoundaryError, brief
from subsoil.io.read.outlines import NOTHING, Feature, Outlines, not_an_outline, outlines_of
from subsoil.io.read.text import read_text
from subsoil.land.crs import WGS84
from subsoil.land.outline import polygon

Element = ElementTree.Element

_SHAPES = ("Point", "LineString", "LinearRing", "Track", "MultiTrack", "Model")
_LINKS = ("NetworkLink", "GroundOverlay")


def read_kml(path: Path) -> Outlines:
    """Read the polygons of all placemarks; what is beside them is noted.

    Raises
    ------
    BoundaryError
        If it is not KML, declares entities, or has no polygon, or one that is not usable.
    """
    root = _parsed(read_text(path, BoundaryError), path.name)
    places = [each for each in root.iter() if _kind(each) == "Placemark"]
    features = [each for k, place in enumerate(places, 1) for each in _features(place, k, path)]
    if not features:
        raise not_an_outline("file without a polygon", path.name)
    links = [Feature(path.name, _kind(each)) for each in root.iter() if _kind(each) in _LINKS]
    return outlines_of([*features, *links], WGS84, path.name)


def _parsed(text: str, file: str) -> Element:
    if "<!DOCTYPE" in text or "<!ENTITY" in text:
        raise BoundaryError(
            "it declares entities, which no KML needs", where=file, remedy="export it again"
        )
    try:
        root = ElementTree.fromstring(text.partition("?>")[2] if text.startswith("<?xml") else text)
    except (ElementTree.ParseError, RecursionError) as error:
        raise BoundaryError(
            f"this is not XML: {brief(str(error), 200)}",
            where=file,
            remedy="export it again as KML",
        ) from error
    if _kind(root) != "kml":
        raise BoundaryError(
            f"this is {brief(_kind(root))}, not KML", where=file, remedy="export it again as KML"
        )
    return root


def _features(place: Element, number: int, path: Path) -> Iterator[Feature]:
    """Polygons of a placemark as one, and what else is drawn there."""
    name = next((each.text or "" for each in place if _kind(each) == "name"), "").strip()
    where = f"{path.name}, feature {number}" + (f" ({brief(name)})" if name else "")
    drawn = [each for each in place.iter() if _kind(each) == "Polygon"]
    rings = {ring for each in drawn for ring in each.iter()}
    if drawn:
        found = [_polygon(each, where) for each in drawn]
        yield Feature(where, found[0] if len(found) == 1 else MultiPolygon(found), _role(place))
    others = [_kind(each) for each in place.iter() if each not in rings]
    shapes = [kind for kind in others if kind in _SHAPES]
    for kind in shapes or ([] if drawn else [NOTHING]):
        yield Feature(where, kind, "" if drawn else _role(place))


def _role(place: Element) -> str:
    for each in place.iter():
        if _kind(each) in ("Data", "SimpleData") and each.get("name") == "role":
            return "".join(each.itertext()).strip()
    return ""


def _polygon(element: Element, where: str) -> Polygon:
    rings = {"outerBoundaryIs": [], "innerBoundaryIs": []}  # type: dict[str, list[Polygon]]
    for boundary in element:
        for each in boundary.iter():
            if _kind(boundary) in rings and _kind(each) == "coordinates":
                rings[_kind(boundary)].append(polygon(_corners(each.text or "", where), where))
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


def _kind(element: Element) -> str:
    """Name of an element without its namespace; comments have none."""
    return str(element.tag).rpartition("}")[2]
