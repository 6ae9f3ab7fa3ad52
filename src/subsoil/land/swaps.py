"""Swaps: pairs of coordinates that make sense only the other way round."""

from __future__ import annotations

from functools import cache

from subsoil.land.crs import named_crs

_WIDEST_COUNTRY_FRAME_DEG = 30
_MARGIN_DEG = 10


def looks_swapped(longitude: float, latitude: float) -> bool:
    """Whether a place is surely at sea, and its mirror image with the numbers swapped is on land.

    Land is where a country keeps a frame of its own, by the rectangles of the EPSG registry. They
    overlap the sea, so many a swap goes unnoticed, but a field on land is not taken for one.

    Examples
    --------
    >>> looks_swapped(53.26, -0.53), looks_swapped(-0.53, 53.26)
    (True, False)
    """
    if max(abs(longitude), abs(latitude)) > 90:
        return False
    at_sea = not _countries(longitude, latitude)
    return at_sea and any("onshore" in name for name in _countries(latitude, longitude))


def looks_transposed(name: str, easting: float, northing: float) -> bool:
    """Whether a place is far from where a CRS is used, and its mirror image is not.

    Examples
    --------
    >>> looks_transposed("EPSG:32631", 5775170.0, 680990.0)
    True
    >>> looks_transposed("EPSG:32631", 680990.0, 5775170.0)
    False
    """
    return not _in_use(name, easting, northing) and _in_use(name, northing, easting)


def _in_use(name: str, easting: float, northing: float) -> bool:
    """Whether a place lies within ten degrees of where a CRS is used, as far as that is known."""
    from pyproj import Proj

    crs = named_crs(name, "CRS")
    if crs.area_of_use is None:
        return True
    longitude, latitude = Proj(crs)(easting, northing, inverse=True)
    west, south, east, north = crs.area_of_use.bounds
    along = west - _MARGIN_DEG <= longitude <= east + _MARGIN_DEG or west > east
    return bool(along and south - _MARGIN_DEG <= latitude <= north + _MARGIN_DEG)


@cache
def _countries(longitude: float, latitude: float) -> frozenset[str]:
    """Names of areas of use that belong to a country and not to a zone, ocean or continent."""
    from pyproj.aoi import AreaOfInterest
    from pyproj.database import query_crs_info
    from pyproj.enums import PJType

    kinds = [PJType.PROJECTED_CRS, PJType.GEOGRAPHIC_2D_CRS]
    here = AreaOfInterest(longitude, latitude, longitude, latitude)
    found = query_crs_info("EPSG", kinds, here, contains=True)
    areas = [info.area_of_use for info in found if info.area_of_use]
    names = (
        area.name or "" for area in areas if 0 < area.east - area.west < _WIDEST_COUNTRY_FRAME_DEG
    )
    return frozenset(name for name in names if name and not name.startswith("Between"))
