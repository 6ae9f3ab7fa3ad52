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
from html import escape
from typing import cast

import numpy as np
import shapely
from numpy.typing import ArrayLike

from subsoil.arrays import Bools, Floats
from subsoil.errors import BoundaryError, ParameterError, brief
from subsoil.findings import Finding
from subsoil.land.crs import WGS84, check_metric, metres_frame, project, utm_crs
from subsoil.land.outline import Area, check_extent, check_lonlat, check_outline, polygon

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
    inside: Bools

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
    findings
        What was done to bring it here, and what of its file is not used, for whoever drew it.

    Raises
    ------
    BoundaryError
        If the outline is empty, crosses itself, is in degrees, or holds no cell; if the CRS is
        unknown or does not measure in metres.

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
    findings: tuple[Finding, ...] = field(default=(), compare=False)

    def __post_init__(self) -> None:
        if self.crs:
            check_metric(self.crs, self.name)
        check_outline(self.boundary, self.name)
        for k, area in enumerate(self.keep_outs):
            check_outline(area, f"{self.name}, keep-out {k + 1}")
        if not self._probeable.area > 0:
            raise BoundaryError("keep-outs cover the whole field", where=self.name)
        check_extent(self.boundary.bounds, self.cell_size, self.name)
        shapely.prepare(self._probeable)
        if not len(self.cells):
            raise BoundaryError(
                f"no cell of {self.cell_size:g} m has its centre inside the field",
                where=self.name,
                remedy="use smaller cells",
            )

    def __repr__(self) -> str:
        return f"<field {self._in_short}>"

    def _repr_html_(self) -> str:
        outline = self.boundary._repr_svg_()  # what shapely shows in a notebook
        return f"<figure>{outline}<figcaption>{escape(self._in_short)}</figcaption></figure>"

    @property
    def _in_short(self) -> str:
        cells = f"{len(self.cells)} cells of {self.cell_size:g} m"
        return f"{self.name}: {self.area_ha:.2f} ha, {cells}, {self.crs or 'local frame'}"

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
            If the vertices do not make an outline, or metres of the frame are not metres on the
            ground there, as in Web Mercator.
        """
        areas = tuple(polygon(v, f"{name}, keep-out") for v in keep_outs)
        found = cls(polygon(vertices, name), crs, areas, cell_size, name)
        home = metres_frame(crs, found.entrance) if crs else ""
        if home != crs:
            raise BoundaryError(
                f"a metre of {brief(crs)} is not a metre on the ground there",
                where=name,
                remedy=f"give the vertices in {home}",
            )
        return found

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
        check_outline(outline, name)
        check_lonlat(outline.bounds, name)
        west, south, east, north = outline.bounds
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

    @property
    def extent_m(self) -> float:
        """Length in m of the diagonal of the box around the outline."""
        west, south, east, north = self.boundary.bounds
        return math.hypot(east - west, north - south)

    @property
    def entrance(self) -> tuple[float, float]:
        """Where an agent enters: the corner of the outline nearest to the south-west, in m."""
        west, south, _, _ = self.boundary.bounds
        corners = shapely.get_coordinates(self.boundary)
        nearest = np.argmin(np.hypot(corners[:, 0] - west, corners[:, 1] - south))
        return (float(corners[nearest, 0]), float(corners[nearest, 1]))

    @cached_property
    def _probeable(self) -> Area:
        barred = shapely.union_all(list(self.keep_outs))
        return cast("Area", shapely.difference(self.boundary, barred))

    @cached_property
    def grid(self) -> Grid:
        """Cells of the field's bounding box; edges lie at multiples of the cell size."""
        west, south, east, north = self.boundary.bounds
        easting = centres(west, east, self.cell_size)
        northing = centres(south, north, self.cell_size)
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
        """Index of the cell whose centre is nearest to a place in m.

        Raises
        ------
        ParameterError
            If the place is not finite.
        """
        place = np.asarray(at, dtype=float)
        if not np.isfinite(place).all():
            raise ParameterError(
                f"{place.tolist()} is no place", where=f"{self.name}, nearest cell"
            )
        return int(np.argmin(((self.cells - place) ** 2).sum(axis=1)))

    def metres_away(self, at: ArrayLike) -> Floats:
        """(n,) distances in m of (n, 2) places from where one may probe."""
        at = np.atleast_2d(np.asarray(at, dtype=float))
        away = np.asarray(shapely.distance(shapely.points(at), self._probeable))
        return np.where(np.isfinite(away), away, np.inf)

    def contains(self, at: ArrayLike) -> Bools:
        """Whether (n, 2) places in m lie in the field or on its edge, and not in a keep-out."""
        at = np.atleast_2d(np.asarray(at, dtype=float))
        return np.asarray(shapely.intersects_xy(self._probeable, at[:, 0], at[:, 1]))

    def to_metres(self, longitude: ArrayLike, latitude: ArrayLike) -> Floats:
        """(n, 2) easting and northing in m of WGS84 longitudes and latitudes in degrees.

        Raises
        ------
        ParameterError
            If the field lies in a local frame.
        """
        return project(WGS84, self._named_crs(), longitude, latitude)

    def to_lonlat(self, at: ArrayLike) -> Floats:
        """(n, 2) WGS84 longitude and latitude in degrees of places in m.

        Raises
        ------
        ParameterError
            If the field lies in a local frame.
        """
        at = np.atleast_2d(np.asarray(at, dtype=float))
        return project(self._named_crs(), WGS84, at[:, 0], at[:, 1])

    def _named_crs(self) -> str:
        if not self.crs:
            raise ParameterError(
                "the field lies in a local frame without a place on Earth",
                where=self.name,
                remedy="give its boundary in longitude and latitude, or name its CRS",
            )
        return self.crs


def _to_metres(area: Area, crs: str) -> Area:
    return shapely.transform(area, lambda xy: project(WGS84, crs, xy[:, 0], xy[:, 1]))


def centres(low: float, high: float, size: float) -> Floats:
    """Centres of the pieces of some size, between multiples of it, that cover a stretch.

    Examples
    --------
    >>> centres(12.0, 26.0, 5.0)
    array([12.5, 17.5, 22.5, 27.5])
    """
    first = math.floor(low / size + 1e-9)
    last = math.ceil(high / size - 1e-9)
    return (np.arange(first, last, dtype=float) + 0.5) * size
