"""Outlines of a file: what it shows, before it becomes a field."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from subsoil.errors import BoundaryError, brief, listed
from subsoil.findings import Finding
from subsoil.land.crs import WGS84, named_crs
from subsoil.land.outline import Area, check_outline

KEEP_OUT = "keep-out"
"""Value of a feature's property ``role`` that marks an area in which nothing is probed."""
NOTHING = "feature without geometry"
"""What a feature is that has no shape."""
_BESIDE = {
    "Point", "MultiPoint", "LineString", "MultiLineString", "LinearRing", "Track", "MultiTrack",
    "Model", "NetworkLink", "GroundOverlay", NOTHING,
}  # fmt: skip
"""Shapes that a file may have beside its outline: gates, drains, wheel tracks."""


@dataclass(frozen=True)
class Feature:
    """One shape of a file.

    Attributes
    ----------
    where
        File and feature, for messages.
    shape
        Its area, x before y; the name of its kind if it is none.
    role
        Its property ``role``, empty if it has none.
    """

    where: str
    shape: Area | str
    role: str = ""


@dataclass(frozen=True)
class Outlines:
    """The shapes of a file, in one frame.

    Attributes
    ----------
    crs
        :data:`~subsoil.land.crs.WGS84`, a metric CRS, or empty for a local frame.
    outlines, keep_outs
        Valid areas that are not, and that are, marked as keep-outs.
    findings
        What of the file is not in them.
    """

    crs: str
    outlines: tuple[Area, ...]
    keep_outs: tuple[Area, ...]
    findings: tuple[Finding, ...] = ()


def outlines_of(features: Iterable[Feature], crs: str, file: str) -> Outlines:
    """Sort features into outlines and keep-outs; points and lines beside them are noted.

    Raises
    ------
    BoundaryError
        If there is none but points and lines, one of these is marked as a keep-out, or an area
        is empty or crosses itself; the message names it.
    """
    outlines: list[Area] = []
    keep_outs: list[Area] = []
    others: list[Feature] = []
    for feature in features:
        if isinstance(feature.shape, str):
            others.append(feature)
            continue
        check_outline(feature.shape, feature.where)
        (keep_outs if feature.role == KEEP_OUT else outlines).append(feature.shape)
    for other in others:
        if other.role == KEEP_OUT or other.shape not in _BESIDE or not (outlines or keep_outs):
            raise not_an_outline(str(other.shape), other.where)
    left = [f"{other.shape} of {other.where}".replace(f" of {file}, ", " of ") for other in others]
    return Outlines(crs, tuple(outlines), tuple(keep_outs), left_alone(left, file))


def left_alone(names: Sequence[str], file: str) -> tuple[Finding, ...]:
    """What of a file is not used, if anything is not."""
    return (Finding(f"no polygons, left alone: {listed(names)}", file=file),) if names else ()


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
            f"longitudes and latitudes are of {brief(crs.name)}, not of WGS84",
            where=where,
            remedy="export the file again in WGS84",
        )
    return WGS84
