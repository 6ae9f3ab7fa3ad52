"""Outlines of a file: what it shows, before it becomes a field."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from shapely.geometry import LineString

from subsoil.errors import BoundaryError, brief, listed
from subsoil.findings import Finding
from subsoil.io.read.outlines.rings import closed, gap_m, sound
from subsoil.land.crs import WGS84, named_crs
from subsoil.land.outline import Area

KEEP_OUT = "keep-out"
"""Value of a feature's property ``role`` that marks an area in which nothing is probed."""
NOTHING = "feature without geometry"
"""What a feature is that has no shape."""
_NAMES = ("name", "field_name", "fieldname", "field", "title", "label")
_BESIDE = {
    "Point", "MultiPoint", "LineString", "MultiLineString", "LinearRing", "Track", "MultiTrack",
    "Model", "NetworkLink", "GroundOverlay", "waypoint", "track", "route", NOTHING,
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
        Its area or line, x before y; the name of its kind if it is neither.
    role
        Its property ``role``, empty if it has none.
    name
        What its owner calls it, empty if nothing.
    kind
        What the file calls it, if it is a line.
    """

    where: str
    shape: Area | LineString | str
    role: str = ""
    name: str = ""
    kind: str = "LineString"

    @property
    def is_keep_out(self) -> bool:
        """Whether it is marked as an area in which nothing is probed."""
        return self.role.strip().lower().replace("_", "-").replace(" ", "-") == KEEP_OUT

    @property
    def what(self) -> str:
        """Its kind in words, if it is no area."""
        return self.shape if isinstance(self.shape, str) else self.kind


@dataclass(frozen=True)
class Parcel:
    """A valid area, which is the field or a part of it.

    Attributes
    ----------
    where
        File and feature, for messages.
    area
        The area, x before y.
    name
        What its owner calls it, empty if nothing.
    """

    where: str
    area: Area
    name: str = ""


@dataclass(frozen=True)
class Outlines:
    """The shapes of a file, in one frame.

    Attributes
    ----------
    crs
        A CRS in degrees or on a plane, or empty for a local frame.
    parcels, keep_outs
        Valid areas that are not, and that are, marked as keep-outs.
    findings
        What of the file is not in them, and what was taken for an outline without being drawn so.
    """

    crs: str
    parcels: tuple[Parcel, ...]
    keep_outs: tuple[Area, ...]
    findings: tuple[Finding, ...] = ()


def outlines_of(features: Iterable[Feature], crs: str, file: str) -> Outlines:
    """Sort features into outlines and keep-outs; points and lines beside them are noted.

    Where there is no polygon, lines that come back to where they start are outlines.

    Raises
    ------
    BoundaryError
        If there is none but points and open lines, one of these is marked as a keep-out, or an
        area is empty or crosses itself; the message names it.
    """
    features = tuple(features)
    drawn = any(isinstance(each.shape, Area) and not each.is_keep_out for each in features)
    parcels, keep_outs = list[Parcel](), list[Area]()
    beside, findings = list[Feature](), list[Finding]()
    for each in features:
        shape = each.shape
        if isinstance(shape, LineString) and (each.is_keep_out or not drawn):
            shape = closed(shape, crs) or shape
        if not isinstance(shape, Area):
            beside.append(each)
            continue
        area, dropped = sound(shape, each.where, crs, file)
        findings += (*_ring_taken(each, crs, file), *dropped)
        if each.is_keep_out:
            keep_outs.append(area)
        else:
            parcels.append(Parcel(each.where, area, each.name))
    for each in sorted(beside, key=lambda each: isinstance(each.shape, str)):
        if each.is_keep_out or each.what not in _BESIDE or not (parcels or keep_outs):
            raise _no_outline(each, crs)
    left = [f"{each.what} of {each.where}".replace(f" of {file}, ", " of ") for each in beside]
    return Outlines(crs, tuple(parcels), tuple(keep_outs), (*findings, *left_alone(left, file)))


def _ring_taken(feature: Feature, crs: str, file: str) -> tuple[Finding, ...]:
    """Say of a line that it was taken for an outline, and how far from closed it is."""
    if not isinstance(feature.shape, LineString):
        return ()
    gap = gap_m(feature.shape, crs)
    where = feature.where.removeprefix(f"{file}, ")
    apart = f", its ends {gap:.2g} m apart" if gap > 0.05 else ""
    seen = f"{feature.kind} of {where} is a closed line, no polygon{apart}"
    return (Finding(seen, "taken as an outline", file=file),)


def left_alone(names: Sequence[str], file: str) -> tuple[Finding, ...]:
    """What of a file is not used, if anything is not."""
    return (Finding(f"no polygons, left alone: {listed(names)}", file=file),) if names else ()


def _no_outline(feature: Feature, crs: str) -> BoundaryError:
    """Complaint about a feature that would have to be an area."""
    if isinstance(feature.shape, LineString):
        gap = gap_m(feature.shape, crs)
        return BoundaryError(
            f"a {feature.kind} is not an outline: it is open, its ends are {gap:.4g} m apart",
            where=feature.where,
            remedy="end it where it starts, or draw the field as a polygon",
        )
    return not_an_outline(feature.shape if isinstance(feature.shape, str) else "", feature.where)


def not_an_outline(kind: str, where: str) -> BoundaryError:
    """Complaint about a feature of another kind than polygon."""
    return BoundaryError(
        f"a {kind} is not an outline",
        where=where,
        remedy="draw the field as a polygon, and leave other features out",
    )


def name_among(properties: Mapping[str, Any]) -> str:
    """What the owner of a feature calls it, by its properties; empty if nothing.

    Examples
    --------
    >>> name_among({"id": 7, "Name": " Long Acre "})
    'Long Acre'
    """
    known = {str(key).lower(): value for key, value in properties.items()}
    found = (known.get(key) for key in _NAMES)
    return next((text for value in found if (text := _word(value))), "")


def _word(value: Any) -> str:
    return str(value).strip() if isinstance(value, str | int) else ""


def frame(name: str, where: str) -> str:
    """Name of a frame in the words used here, without heights.

    Raises
    ------
    BoundaryError
        If it is unknown, or neither in degrees nor on a plane.

    Examples
    --------
    >>> frame("urn:ogc:def:crs:OGC:1.3:CRS84", "a.json"), frame("urn:ogc:def:crs:EPSG::2154", "")
    ('EPSG:4326', 'EPSG:2154')
    >>> frame("EPSG:4979", ""), frame("EPSG:7405", "")
    ('EPSG:4326', 'EPSG:27700')
    """
    crs = named_crs(name, where)
    crs = (crs.sub_crs_list[0] if crs.is_compound else crs).to_2d()
    if not (crs.is_geographic or crs.is_projected):
        raise BoundaryError(
            f"its CRS {brief(crs.name)!r} is of no place on Earth",
            where=where,
            remedy="export it again in WGS84",
        )
    authority = crs.to_authority()
    if authority == ("OGC", "CRS84"):
        return WGS84
    return ":".join(authority) if authority else str(crs.to_wkt())
