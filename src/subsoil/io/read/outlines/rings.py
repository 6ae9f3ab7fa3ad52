"""Rings: lines that come back to where they start, and areas put right without guessing."""

from __future__ import annotations

from typing import cast

import numpy as np
import shapely
from shapely.geometry import LineString, MultiPolygon, Polygon

from subsoil.arrays import Floats
from subsoil.findings import Finding
from subsoil.land.crs import is_degrees, named_crs
from subsoil.land.outline import Area, check_outline

MOST_GAP_M = 10.0
"""Gap in m, of a receiver's error at both ends, up to which a walked line is closed."""
_MOST_GAP_SHARE = 0.05
_SLIVER_M2 = 1.0
_LOOPS_SHARE = 0.01
_MOST_WALKED = 5000
_M_A_DEGREE = 111_320.0


def gap_m(line: LineString, crs: str) -> float:
    """Distance in m between the ends of a line."""
    ends = _on_ground(shapely.get_coordinates(line), crs)
    return float(np.hypot(*(ends[-1] - ends[0])))


def closed(line: LineString, crs: str) -> Polygon | None:
    """Area that a line goes around, ``None`` if its ends lie apart or it encloses nothing.

    A walked line crosses itself where somebody stood or turned; loops of up to 1 % of the area
    are left out. A line of more than 5000 corners is taken as it stands.
    """
    corners = shapely.get_coordinates(line)
    length = float(np.hypot(*np.diff(_on_ground(corners, crs), axis=0).T).sum())
    if len(corners) < 4 or not gap_m(line, crs) <= min(MOST_GAP_M, _MOST_GAP_SHARE * length):
        return None
    ring = Polygon(corners)
    if len(corners) > _MOST_WALKED or ring.is_valid:
        return ring
    parts = shapely.get_parts(shapely.make_valid(ring))
    largest = max(parts, key=lambda part: part.area)
    whole = sum(part.area for part in parts)
    small = isinstance(largest, Polygon) and largest.area >= (1 - _LOOPS_SHARE) * whole > 0
    return largest if small else ring


def sound(area: Area, where: str, crs: str, file: str) -> tuple[Area, tuple[Finding, ...]]:
    """An area whose parts are valid and do not overlap, and what was left out of it.

    Parts that touch are one. An outline in degrees over the antimeridian goes on beyond 180.

    Raises
    ------
    BoundaryError
        If it is empty, or a part crosses itself.
    """
    area = _unbroken(area) if is_degrees(crs) else area
    if not isinstance(area, MultiPolygon) or area.is_empty:
        check_outline(area, where)
        return area, ()
    parts = [part for part in area.geoms if _square_metres(part, crs) >= _SLIVER_M2]
    parts = parts or list(area.geoms)
    for part in parts:
        check_outline(part, where)
    whole: Area = MultiPolygon(parts) if len(parts) > 1 else parts[0]
    if not whole.is_valid:
        whole = cast("Area", shapely.union_all(parts))
    count = len(area.geoms) - len(parts)
    seen = f"{count} of {len(area.geoms)} pieces of {where.removeprefix(f'{file}, ')} are slivers"
    said = Finding(f"{seen} under {_SLIVER_M2:g} m2", "left out", "left out", file)
    return whole, (said,) if count else ()


def _unbroken(area: Area) -> Area:
    """Area in degrees whose parts at both ends of the map are brought together."""
    west, _, east, _ = area.bounds if not area.is_empty else (0.0, 0.0, 0.0, 0.0)
    if not (east - west > 180 and west >= -180 and east <= 180):
        return area
    return shapely.transform(area, lambda xy: xy + np.outer(xy[:, 0] < 0, (360.0, 0.0)))


def _square_metres(part: Polygon, crs: str) -> float:
    return float(Polygon(_on_ground(shapely.get_coordinates(part.exterior), crs)).area)


def _on_ground(corners: Floats, crs: str) -> Floats:
    """(k, 2) corners in m from the first, near enough to say whether a ring is closed."""
    away = corners - corners[0]
    if is_degrees(crs):
        return np.asarray(away * _M_A_DEGREE * (np.cos(np.radians(corners[0, 1])), 1.0))
    unit = named_crs(crs, "CRS").axis_info[0].unit_conversion_factor if crs else 1.0
    return np.asarray(away * unit)
