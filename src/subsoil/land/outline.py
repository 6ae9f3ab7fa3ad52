"""Outlines: closed rings of vertices, and what makes one usable as a field.

A sketch on a phone, an export of a farm program and a list of corners go wrong in the same few
ways; each is told apart here, so that a field is never laid in the wrong place.
"""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import ArrayLike
from shapely.geometry import LinearRing, LineString, MultiPolygon, Polygon
from shapely.validation import explain_validity

from subsoil.errors import BoundaryError, ParameterError
from subsoil.land.swaps import looks_swapped

Area = Polygon | MultiPolygon

FARTHEST_M = 1e9
"""No frame reaches farther from its origin, in m or feet."""
_FIRST = 1000
_START = 2000
_MOST_CORNERS = 2_000_000
_MOST_CELLS = 25_000_000
_ORDER = "GeoJSON wants longitude first, .coords files want latitude first"


def polygon(vertices: ArrayLike, where: str) -> Polygon:
    """Polygon of (k, 2) vertices in order around it; the ring closes itself.

    Raises
    ------
    BoundaryError
        If they are not three or more different pairs of finite numbers.
    """
    try:
        points = np.asarray(vertices, dtype=float)
    except (OverflowError, TypeError, ValueError) as error:
        raise BoundaryError("a vertex is not a pair of numbers", where=where) from error
    if points.ndim != 2 or points.shape[1:] != (2,):
        raise BoundaryError(
            f"an outline is three or more (easting, northing) pairs, not an array {points.shape}",
            where=where,
        )
    bad = np.flatnonzero(~(np.abs(points) <= FARTHEST_M).all(axis=1))
    if bad.size:
        finite = np.isfinite(points[bad[0]]).all()
        what = "a vertex is no place on Earth" if finite else "a vertex is not a number"
        raise BoundaryError(what, where=f"{where}, vertex {bad[0] + 1}")
    corners = len(np.unique(points[:_FIRST], axis=0))
    corners = corners if corners > 2 else len(np.unique(points, axis=0))
    if corners < 3:
        raise BoundaryError(
            f"an outline needs three different corners, this has {corners}", where=where
        )
    return Polygon(LinearRing(points))


def check_outline(area: Area, where: str) -> None:
    """Check that an outline is a polygon that does not cross itself.

    Raises
    ------
    BoundaryError
        If it is empty, of another kind, or not valid; the message says where.
    """
    if area.is_empty or area.geom_type not in ("Polygon", "MultiPolygon"):
        raise BoundaryError(
            f"the outline is {'empty' if area.is_empty else 'a ' + area.geom_type}, not a polygon",
            where=where,
            remedy="give one closed outline of the field",
        )
    corners = shapely.get_num_coordinates(area)
    if corners > _MOST_CORNERS:
        raise BoundaryError(
            f"the outline has {corners} corners", where=where, remedy="simplify it to a decimetre"
        )
    fault = _fault(area)
    if fault:
        raise BoundaryError(
            f"the outline is not valid: {fault}",
            where=where,
            remedy="draw it in order around the field, without crossing itself",
        )


def _fault(area: Area) -> str:
    """Where an area crosses itself; empty if it does not. Scribbles are found out early."""
    for ring in shapely.get_rings(area):
        start = LineString(ring.coords[:_START])
        if len(ring.coords) > _START and not start.is_simple:
            return explain_validity(Polygon(start))
    valid = explain_validity(area)
    return "" if valid == "Valid Geometry" else valid


def check_extent(bounds: tuple[float, float, float, float], cell_size: float, where: str) -> None:
    """Check that an outline in m is as large as a field.

    Parameters
    ----------
    bounds
        West, south, east and north in m.
    cell_size
        Side of a cell in m.
    where
        File or field, for messages.

    Raises
    ------
    ParameterError
        If cells have no side.
    BoundaryError
        If it looks like degrees or kilometres, or needs more cells than a map can hold.
    """
    if not (np.isfinite(cell_size) and cell_size > 0):
        raise ParameterError(f"cells need a side in metres, not {cell_size:g}", where="cell size")
    west, south, east, north = bounds
    span = max(east - west, north - south)
    if span < 1.0 and max(abs(west), abs(east)) <= 180 and max(abs(south), abs(north)) <= 90:
        raise BoundaryError(
            f"the outline is {span:.4g} m wide: these look like degrees, not metres",
            where=where,
            remedy="give longitude and latitude as GeoJSON or .coords, or project to metres",
        )
    if looks_like_kilometres(bounds):
        raise BoundaryError(
            f"the outline is {span:.4g} m wide: these look like kilometres, not metres",
            where=where,
            remedy="write easting and northing in metres",
        )
    if (east - west) / cell_size * ((north - south) / cell_size) > _MOST_CELLS:
        raise BoundaryError(
            f"the outline is {span / 1000:.3g} km wide, far more than {cell_size:g} m cells cover",
            where=where,
            remedy="check the coordinates, or use larger cells",
        )


def looks_like_kilometres(bounds: tuple[float, float, float, float]) -> bool:
    """Whether a box (west, south, east, north) is a field on a UTM zone or national grid in km.

    Examples
    --------
    >>> looks_like_kilometres((665.0, 5904.0, 665.2, 5904.1))
    True
    """
    west, south, east, north = bounds
    small = 0 < max(east - west, north - south) < 10.0
    return small and 100 <= abs(east) < 1000 and 1000 <= abs(north) < 10_000


def check_lonlat(bounds: tuple[float, float, float, float], where: str) -> None:
    """Check that bounds (west, south, east, north) are WGS84 degrees in that order.

    Raises
    ------
    BoundaryError
        If they are out of range, or fall in the sea and their mirror image on land.
    """
    west, south, east, north = bounds
    east = 180.0 if west <= 180 < east < 181 else east  # over the antimeridian
    if max(abs(west), abs(east)) > 180 or max(abs(south), abs(north)) > 90:
        metric = max(abs(west), abs(east), abs(south), abs(north)) > 360
        raise BoundaryError(
            f"coordinates from ({west:g}, {south:g}) to ({east:g}, {north:g}) "
            "are not longitude and latitude",
            where=where,
            remedy="they look like metres: name their CRS"
            if metric
            else f"latitude and longitude look swapped: {_ORDER}",
        )
    longitude, latitude = (west + east) / 2, (south + north) / 2
    if looks_swapped(longitude, latitude):
        raise BoundaryError(
            f"longitude {longitude:.3f}, latitude {latitude:.3f} is open sea: "
            "latitude and longitude look swapped",
            where=where,
            remedy=_ORDER,
        )
