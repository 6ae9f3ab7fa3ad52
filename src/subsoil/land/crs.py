"""Frames: where a pair of coordinates lies on Earth.

A frame is named by its CRS, such as ``"EPSG:32630"``. Longitude comes before latitude and easting
before northing, whatever order the CRS itself prefers.
"""

from __future__ import annotations

import warnings
from functools import cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from subsoil.arrays import Floats
from subsoil.errors import BoundaryError, brief, listed

if TYPE_CHECKING:
    from pyproj import CRS, Transformer

WGS84 = "EPSG:4326"
"""Longitude and latitude as satellite receivers give them."""

MOST_STRETCH = 0.001
"""Share by which metres of a frame may differ from metres on the ground: UTM's at a zone's edge."""

NEAR_M = 1.0
"""Distance in m up to which the way between two frames is as good as exact."""
MOST_OFF_M = 5.0
"""Distance in m up to which the way between two frames may be known: a cell, a receiver's error."""

_STRETCH_M = 100.0


def utm_crs(longitude: float, latitude: float) -> str:
    """EPSG code of the WGS84 UTM zone of a place.

    Examples
    --------
    >>> utm_crs(-0.527, 53.26), utm_crs(151.2, -33.9)
    ('EPSG:32630', 'EPSG:32756')
    >>> utm_crs(180.1, -16.8), utm_crs(179.9, -16.8)
    ('EPSG:32701', 'EPSG:32760')
    """
    longitude -= 360 if longitude > 180 else 0
    zone = min(int((longitude + 180) // 6) + 1, 60)
    return f"EPSG:{(32600 if latitude >= 0 else 32700) + zone}"


def named_crs(name: str, where: str) -> CRS:
    """CRS of a name.

    Raises
    ------
    BoundaryError
        If nothing goes by that name.
    """
    from pyproj import CRS
    from pyproj.exceptions import CRSError

    try:
        return CRS.from_user_input(name)
    except CRSError as error:
        raise BoundaryError(
            f"there is no CRS {brief(name)!r}", where=where, remedy="name it like EPSG:32630"
        ) from error


def check_metric(name: str, where: str) -> None:
    """Check that a CRS measures easting and northing in metres.

    Raises
    ------
    BoundaryError
        If it is unknown, in degrees, or in feet.
    """
    crs = named_crs(name, where)
    units = {axis.unit_name for axis in crs.axis_info}
    if not (crs.is_projected and units == {"metre"}):
        raise BoundaryError(
            f"{brief(name)} measures in {listed(sorted(units)) or 'no unit'}, not on a plane in "
            "metres",
            where=where,
            remedy="use a projected CRS in metres, such as the UTM zone of the field",
        )


def is_degrees(name: str) -> bool:
    """Whether a CRS measures longitude and latitude, of whatever datum.

    Examples
    --------
    >>> is_degrees("EPSG:4258"), is_degrees("EPSG:32631"), is_degrees("")
    (True, False, False)
    """
    return bool(name) and (name == WGS84 or named_crs(name, "CRS").is_geographic)


def foreign_unit(name: str) -> str:
    """Unit of a projected CRS that does not measure in metres; empty if it does.

    Examples
    --------
    >>> foreign_unit("EPSG:2263"), foreign_unit("EPSG:32631")
    ('US survey foot', '')
    """
    crs = named_crs(name, "CRS") if name else None
    units = {axis.unit_name for axis in crs.axis_info} if crs and crs.is_projected else set()
    return "" if units <= {"metre"} else listed(sorted(units))


def stretch(name: str, at: tuple[float, float]) -> float:
    """Largest share by which metres of a frame differ from metres on the ground, at a place.

    Measured along 16 directions by geodesics on the frame's own ellipsoid, so a frame that keeps
    areas and shears shapes is found out as one that scales.

    Parameters
    ----------
    name
        CRS in metres.
    at
        Easting and northing in m.

    Raises
    ------
    BoundaryError
        If there is no such CRS, or it has no such place.

    Examples
    --------
    >>> round(stretch("EPSG:3857", (628000.0, 6817000.0)), 2) < 0.4
    True
    >>> stretch("EPSG:32631", (500000.0, 5770000.0)) < 0.0005
    True
    """
    from pyproj import Proj

    crs = named_crs(name, "CRS")
    angle = np.arange(16) * np.pi / 16
    x, y = _STRETCH_M / 2 * np.cos(angle), _STRETCH_M / 2 * np.sin(angle)
    plane, ellipsoid = Proj(crs), crs.get_geod()
    start, end = (plane(at[0] + s * x, at[1] + s * y, inverse=True) for s in (-1, 1))
    if ellipsoid is None or not np.isfinite([*start, *end]).all():
        raise BoundaryError(
            f"({at[0]:g}, {at[1]:g}) is no place in {brief(name)}",
            where="CRS",
            remedy="check the coordinates and the CRS",
        )
    ground = np.asarray(ellipsoid.inv(*start, *end)[2])
    return float(np.abs(ground / _STRETCH_M - 1).max())


def metres_frame(name: str, at: tuple[float, float]) -> str:
    """Frame to work in at a place of another: that one, or the UTM zone if its metres are not.

    National grids and UTM zones stay as they are; Web Mercator and frames of whole continents,
    more than 0.1 % off at this place, do not.

    Parameters
    ----------
    name
        CRS in metres.
    at
        Easting and northing in m.

    Raises
    ------
    BoundaryError
        If there is no such CRS, it has no such place, or nothing leads from it to WGS84.

    Examples
    --------
    >>> metres_frame("EPSG:3857", (628000.0, 6817000.0))
    'EPSG:32631'
    >>> metres_frame("EPSG:28992", (174000.0, 444000.0))
    'EPSG:28992'
    """
    if stretch(name, at) <= MOST_STRETCH:
        return name
    ((longitude, latitude),) = project(name, WGS84, [at[0]], [at[1]])
    return utm_crs(float(longitude), float(latitude))


def project(source: str, target: str, x: ArrayLike, y: ArrayLike) -> Floats:
    """(n, 2) coordinates in one frame of (n,) coordinates x, y in another.

    Raises
    ------
    BoundaryError
        If a frame has no name or an unknown one, or if the way between the two is not known to
        5 m there: it would move the field by more than a cell.
    """
    x, y = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
    off = accuracy(source, target, x, y)
    if not off <= MOST_OFF_M:
        known = f"to within {off:.0f} m only" if np.isfinite(off) else "to nobody"
        raise BoundaryError(
            f"the exact transformation from {brief(source)} to {brief(target)} is not at hand, "
            f"another is known {known}",
            where="CRS",
            remedy="export everything in WGS84 from a program that has the grids of the old datum",
        )
    return np.column_stack(_transformer(source, target).transform(x, y))


def accuracy(source: str, target: str, x: ArrayLike, y: ArrayLike) -> float:
    """Error in m of the best way known here from one frame to another, in the middle of places.

    The registry's own word on the operation that PROJ chooses there; infinite where nothing is
    known, or the only ones known need a grid that is not installed.

    Raises
    ------
    BoundaryError
        If a frame has no name or an unknown one.

    Examples
    --------
    >>> accuracy("EPSG:28992", WGS84, 174000.0, 444000.0)
    1.0
    >>> accuracy("EPSG:27700", WGS84, 500000.0, 380000.0) <= 2
    True
    """
    from pyproj.exceptions import ProjError

    transformer = _transformer(source, target)
    if source == target or not np.size(x):
        return 0.0
    end = transformer.transform(np.median(np.asarray(x)), np.median(np.asarray(y)))
    if not np.isfinite(end).all():
        return 0.0 if _datum(source) == _datum(target) else np.inf
    try:
        off = transformer.get_last_used_operation().accuracy
    except ProjError:  # there is but one
        off = transformer.accuracy
    return float(off) if off is not None and off >= 0 else np.inf


def _datum(name: str) -> object:
    return named_crs(name, "CRS").datum


@cache
def _transformer(source: str, target: str) -> Transformer:
    from pyproj import Transformer

    if not (source and target):
        raise BoundaryError(
            f"nothing leads from {brief(source) or 'a local frame'} "
            f"to {brief(target) or 'a local frame'}",
            where="CRS",
            remedy="name the CRS of everything in metres, or give longitude and latitude",
        )
    ends = named_crs(source, "CRS"), named_crs(target, "CRS")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # of a missing grid: accuracy tells
        return Transformer.from_crs(*ends, always_xy=True)
