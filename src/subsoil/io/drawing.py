"""Drawings: what a file of outlines shows, before it becomes a field."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from shapely.geometry import MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

from subsoil.errors import BoundaryError
from subsoil.frames import WGS84, named_crs
from subsoil.outline import Area, check_outline

KEEP_OUT = "keep-out"
"""Value of a feature's property ``role`` that marks an area in which nothing is probed."""


@dataclass(frozen=True)
class Feature:
    """One shape of a file.

    Attributes
    ----------
    where
        File and feature, for messages.
    shape
        Its geometry, x before y.
    role
        Its property ``role``, empty if it has none.
    """

    where: str
    shape: BaseGeometry
    role: str = ""


@dataclass(frozen=True)
class Drawing:
    """The shapes of a file, in one frame.

    Attributes
    ----------
    crs
        :data:`~subsoil.frames.WGS84`, a metric CRS, or empty for a local frame.
    outlines, keep_outs
        Valid areas that are not, and that are, marked as keep-outs.
    """

    crs: str
    outlines: tuple[Area, ...]
    keep_outs: tuple[Area, ...]


def draw(features: Iterable[Feature], crs: str) -> Drawing:
    """Sort features into outlines and keep-outs.

    Raises
    ------
    BoundaryError
        If one is no polygon, empty, or crosses itself; the message names it.
    """
    outlines: list[Area] = []
    keep_outs: list[Area] = []
    for feature in features:
        area = feature.shape
        if not isinstance(area, Polygon | MultiPolygon):
            raise not_an_outline(area.geom_type, feature.where)
        check_outline(area, feature.where)
        (keep_outs if feature.role == KEEP_OUT else outlines).append(area)
    return Drawing(crs, tuple(outlines), tuple(keep_outs))


def not_an_outline(kind: str, where: str) -> BoundaryError:
    """Complaint about a feature of another kind than polygon."""
    return BoundaryError(
        f"a {kind} is not an outline",
        where=where,
        remedy="draw the field as a polygon, and leave other features out",
    )


def frame(name: str, where: str) -> str:
    """Name of a frame in the words used here, WGS84 or a CRS in metres.

    Raises
    ------
    BoundaryError
        If it is unknown, or in degrees of another datum than WGS84.

    Examples
    --------
    >>> frame("urn:ogc:def:crs:OGC:1.3:CRS84", "a.json"), frame("urn:ogc:def:crs:EPSG::2154", "")
    ('EPSG:4326', 'EPSG:2154')
    """
    crs = named_crs(name, where)
    authority = crs.to_authority()
    if not crs.is_geographic:
        return ":".join(authority) if authority else crs.to_wkt()
    if authority not in (("EPSG", "4326"), ("OGC", "CRS84")):
        raise BoundaryError(
            f"longitudes and latitudes are of {crs.name}, not of WGS84",
            where=where,
            remedy="export the file again in WGS84",
        )
    return WGS84
