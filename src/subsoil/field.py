"""A field: its outline, its metric frame and its grid of cells.

Everything else in subsoil works in metres, easting and northing, in the frame of the field. A
field given in longitude and latitude gets the UTM zone of its centre; a field given in metres
keeps the frame it came in, or none (``crs=""``: a local frame).
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray
from shapely.geometry import LinearRing, MultiPolygon, Polygon
from shapely.validation import explain_validity

from subsoil.errors import BoundaryError, ParameterError

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Area = Polygon | MultiPolygon

_SQUARE_METRES_A_HECTARE = 10_000.0


@dataclass(frozen=True)
class Grid:
    """The rectangle of cells that covers a field.

    Attributes
    ----------
    easting, northing
        (nx,) and (ny,) cell centres in m, ascending.
    inside
        (ny, nx) whether a cell's centre lies in the field; rows run south to north.
    """

    easting: Floats
    northing: Floats
    inside: NDArray[np.bool_]

    def image(self, values: ArrayLike) -> Floats:
        """Lay values of cells, (..., N), out as (..., ny, nx) with NaN outside the field."""
        values = np.asarray(values, dtype=float)
        picture = np.full((*values.shape[:-1], *self.inside.shape), np.nan)
        picture[..., self.inside] = values
        return picture


@dataclass(frozen=True)
class Field:
    """A piece of land to survey.

    Parameters
    ----------
    boundary
        Outline in m, holes allowed.
    crs
        Metric frame, such as ``"EPSG:32630"``; empty for a local frame.
    keep_outs
        Areas in m in which nothing is probed.
    cell_size
        Side of a cell in m.
    name
        What people call it.

    Raises
    ------
    BoundaryError
        If the outline is empty, crosses itself, is in degrees, or holds no cell.

    Examples
    --------
    >>> field = Field.from_metres([(0, 0), (180, 0), (180, 130), (0, 130)])
    >>> len(field.cells), round(field.area_ha, 2)
    (936, 2.34)
    """

    boundary: Area
    crs: str = ""
    keep_outs: tuple[Area, ...] = ()
    cell_size: float = 5.0
    name: str = field(default="field", compare=False)

    def __post_init__(self) -> None:
        if not (np.isfinite(self.cell_size) and self.cell_size > 0):
            raise ParameterError(
                f"cells need a side in metres, not {self.cell_size:g}", where="cell size"
            )
        _check_outline(self.boundary, self.name)
        for k, area in enumerate(self.keep_outs):
            _check_outline(area, f"{self.name}, keep-out {k + 1}")
        if not self._probeable.area > 0:
            raise BoundaryError("keep-outs cover the whole field", where=self.name)
        _check_extent(self.boundary, self.cell_size, self.name)
        if not len(self.cells):
            raise BoundaryError(
                f"no cell of {self.cell_size:g} m has its centre inside the field",
                where=self.name,
                remedy="use smaller cells",
            )

    @classmethod
    def from_metres(
        cls,
        vertices: ArrayLike,
        *,
        crs: str = "",
        keep_outs: Iterable[ArrayLike] = (),
        cell_size: float = 5.0,
        name: str = "field",
    ) -> Field:
        """Field from (k, 2) vertices, easting and northing in m.

        Raises
        ------
        BoundaryError
            If the vertices do not make an outline.
        """
        areas = tuple(_polygon(v, f"{name}, keep-out") for v in keep_outs)
        return cls(_polygon(vertices, name), crs, areas, cell_size, name)

    @classmethod
    def from_lonlat(
        cls,
        outline: Area,
        *,
        keep_outs: Iterable[Area] = (),
        cell_size: float = 5.0,
        name: str = "field",
    ) -> Field:
        """Field from an outline in WGS84 longitude and latitude (x = longitude).

        The field's frame is the UTM zone of its centre.

        Raises
        ------
        BoundaryError
            If the outline is invalid, out of range, or looks as if latitude came first.
        """
        if outline.is_empty:
            raise BoundaryError("the outline is empty", where=name)
        west, south, east, north = outline.bounds
        _check_lonlat(west, south, east, north, name)
        crs = utm_crs((west + east) / 2, (south + north) / 2)
        return cls(
            _to_metres(outline, crs),
            crs,
            tuple(_to_metres(area, crs) for area in keep_outs),
            cell_size,
            name,
        )

    @property
    def area_ha(self) -> float:
        """Area inside the outline and outside the keep-outs, in ha."""
        return float(self._probeable.area) / _SQUARE_METRES_A_HECTARE

    @cached_property
    def _probeable(self) -> Area:
        rest = shapely.difference(self.boundary, shapely.union_all(list(self.keep_outs)))
        return rest if isinstance(rest, Polygon) else MultiPolygon(rest)

    @cached_property
    def grid(self) -> Grid:
        """Cells of the field's bounding box; edges lie at multiples of the cell size."""
        west, south, east, north = self.boundary.bounds
        easting = _centres(west, east, self.cell_size)
        northing = _centres(south, north, self.cell_size)
        x, y = np.meshgrid(easting, northing)
        inside = shapely.contains_xy(self._probeable, x, y)
        for array in (easting, northing, inside):
            array.setflags(write=False)
        return Grid(easting, northing, inside)

    @cached_property
    def cells(self) -> Floats:
        """(N, 2) centres in m of the cells inside the field, row by row from the south-west."""
        rows, columns = np.nonzero(self.grid.inside)
        centres = np.column_stack([self.grid.easting[columns], self.grid.northing[rows]])
        centres.setflags(write=False)
        return centres

    def nearest_cell(self, at: ArrayLike) -> int:
        """Index of the cell whose centre is nearest to a place in m."""
        return int(np.argmin(((self.cells - np.asarray(at, dtype=float)) ** 2).sum(axis=1)))

    def contains(self, at: ArrayLike) -> NDArray[np.bool_]:
        """Whether (n, 2) places in m lie in the field, outside its keep-outs."""
        at = np.atleast_2d(np.asarray(at, dtype=float))
        return np.asarray(shapely.contains_xy(self._probeable, at[:, 0], at[:, 1]))

    def to_metres(self, longitude: ArrayLike, latitude: ArrayLike) -> Floats:
        """(n, 2) easting and northing in m of WGS84 longitudes and latitudes in degrees.

        Raises
        ------
        ParameterError
            If the field lies in a local frame.
        """
        return _project(self._geographic_crs(), self.crs, longitude, latitude)

    def to_lonlat(self, at: ArrayLike) -> Floats:
        """(n, 2) WGS84 longitude and latitude in degrees of places in m.

        Raises
        ------
        ParameterError
            If the field lies in a local frame.
        """
        at = np.atleast_2d(np.asarray(at, dtype=float))
        return _project(self.crs, self._geographic_crs(), at[:, 0], at[:, 1])

    def _geographic_crs(self) -> str:
        if not self.crs:
            raise ParameterError(
                "the field lies in a local frame without a place on Earth",
                where=self.name,
                remedy="give its boundary in longitude and latitude, or name its CRS",
            )
        return "EPSG:4326"


def utm_crs(longitude: float, latitude: float) -> str:
    """EPSG code of the WGS84 UTM zone of a place.

    Examples
    --------
    >>> utm_crs(-0.527, 53.26), utm_crs(151.2, -33.9)
    ('EPSG:32630', 'EPSG:32756')
    """
    zone = min(int((longitude + 180) // 6) + 1, 60)
    return f"EPSG:{(32600 if latitude >= 0 else 32700) + zone}"


def _project(source: str, target: str, x: ArrayLike, y: ArrayLike) -> Floats:
    from pyproj.transformer import TransformerGroup

    group = TransformerGroup(source, target, always_xy=True)
    if not group.best_available:
        raise BoundaryError(
            f"the exact transformation from {source} to {target} needs a grid that is missing",
            where="CRS",
            remedy="give coordinates as WGS84 longitude and latitude",
        )
    return np.column_stack(group.transformers[0].transform(np.asarray(x), np.asarray(y)))


def _to_metres(area: Area, crs: str) -> Area:
    return shapely.transform(area, lambda xy: _project("EPSG:4326", crs, xy[:, 0], xy[:, 1]))


def _centres(low: float, high: float, size: float) -> Floats:
    first = math.floor(low / size + 1e-9)
    last = math.ceil(high / size - 1e-9)
    return (np.arange(first, last, dtype=float) + 0.5) * size


def _polygon(vertices: ArrayLike, where: str) -> Polygon:
    points = np.asarray(vertices, dtype=float)
    if points.ndim != 2 or points.shape[1:] != (2,) or len(points) < 3:
        raise BoundaryError(
            f"an outline is three or more (easting, northing) pairs, not an array {points.shape}",
            where=where,
        )
    bad = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if bad.size:
        raise BoundaryError("a vertex is not a number", where=f"{where}, vertex {bad[0] + 1}")
    return Polygon(LinearRing(points))


def _check_outline(area: Area, where: str) -> None:
    if area.is_empty or area.geom_type not in ("Polygon", "MultiPolygon"):
        raise BoundaryError(
            f"the outline is {'empty' if area.is_empty else 'a ' + area.geom_type}, not a polygon",
            where=where,
            remedy="give one closed outline of the field",
        )
    if not area.is_valid:
        raise BoundaryError(
            f"the outline is not valid: {explain_validity(area)}",
            where=where,
            remedy="draw it in order around the field, without crossing itself",
        )


def _check_extent(area: Area, cell_size: float, where: str) -> None:
    west, south, east, north = area.bounds
    span = max(east - west, north - south)
    if span < 1.0 and max(abs(west), abs(east)) <= 180 and max(abs(south), abs(north)) <= 90:
        raise BoundaryError(
            f"the outline is {span:.4g} m wide: these look like degrees, not metres",
            where=where,
            remedy="give longitude and latitude as GeoJSON or .coords, or project to metres",
        )
    if span / cell_size > 20_000:
        raise BoundaryError(
            f"the outline is {span / 1000:.0f} km wide, far more than {cell_size:g} m cells cover",
            where=where,
            remedy="check the coordinates, or use larger cells",
        )


def _check_lonlat(west: float, south: float, east: float, north: float, where: str) -> None:
    if max(abs(west), abs(east)) > 180 or max(abs(south), abs(north)) > 90:
        metric = max(abs(west), abs(east), abs(south), abs(north)) > 360
        raise BoundaryError(
            f"coordinates from ({west:g}, {south:g}) to ({east:g}, {north:g}) "
            "are not longitude and latitude",
            where=where,
            remedy="they look like metres: name their CRS"
            if metric
            else "latitude and longitude look swapped: put longitude first",
        )
    longitude, latitude = (west + east) / 2, (south + north) / 2
    swappable = max(abs(south), abs(north)) <= 90 and max(abs(west), abs(east)) <= 90
    if not swappable:
        return
    if not _on_land(longitude, latitude) and _on_land(latitude, longitude):
        raise BoundaryError(
            f"longitude {longitude:.3f}, latitude {latitude:.3f} is open sea: "
            "latitude and longitude look swapped",
            where=where,
            remedy="GeoJSON wants longitude first, .coords files want latitude first",
        )


def _on_land(longitude: float, latitude: float) -> bool:
    """Whether a country's own map projection covers the place, by the EPSG registry."""
    from pyproj.aoi import AreaOfInterest
    from pyproj.database import query_crs_info
    from pyproj.enums import PJType

    here = AreaOfInterest(longitude, latitude, longitude, latitude)
    found = query_crs_info("EPSG", PJType.PROJECTED_CRS, here, contains=True)
    areas = (info.area_of_use for info in found if info.area_of_use)
    return any(
        "onshore" in area.name
        and not area.name.startswith("Between")
        and area.east - area.west < 25
        for area in areas
        if area.name
    )
