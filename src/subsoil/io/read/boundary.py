"""Fields from files of their outlines.

========================  =====================================================================
``.geojson`` ``.json``    WGS84 longitude, latitude (RFC 7946); a member ``crs`` that names a
                          metric CRS, as older programs write it, is honoured
``.coords``               a corner a line, WGS84 latitude, longitude in decimal degrees
``.csv`` ``.txt``         a corner a line under a header ``easting,northing`` (metres) or
                          ``lat,lon``; without a header, metres in the CRS that the caller names
``.gpkg`` ``.shp``        one layer of polygons in WGS84 or metres; pyogrio reads it
``.kml``                  polygons of placemarks, WGS84
========================  =====================================================================

One polygon is the field. Further polygons whose property ``role`` is ``"keep-out"`` are areas in
which nothing is probed. Points, lines and layers of them beside it are not used, and the notes of
the field name them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import shapely

from subsoil.errors import BoundaryError, brief
from subsoil.findings import Finding
from subsoil.io.read.corners import read_coords, read_corners
from subsoil.io.read.geofile import read_geofile
from subsoil.io.read.geojson import read_geojson
from subsoil.io.read.kml import read_kml
from subsoil.io.read.outlines import KEEP_OUT, Outlines
from subsoil.io.read.text import check_file
from subsoil.land.crs import WGS84, metres_frame, project, stretch
from subsoil.land.field import Field
from subsoil.land.outline import Area

READERS: dict[str, Callable[[Path, str | None], Outlines]] = {
    ".geojson": read_geojson,
    ".json": read_geojson,
    ".coords": lambda path, _: read_coords(path),
    ".csv": read_corners,
    ".txt": read_corners,
    ".gpkg": read_geofile,
    ".shp": read_geofile,
    ".kml": lambda path, _: read_kml(path),
}
"""Reader of each suffix: from a path and the CRS of a file that names none to its outlines."""


def read_field(
    path: str | Path,
    *,
    crs: str | None = None,
    cell_size: float = 5.0,
    keep_outs: str | Path | None = None,
) -> Field:
    """Read a field from a file of its outline.

    Parameters
    ----------
    path
        File in one of the formats above, told apart by its suffix.
    crs
        Frame of a file that does not name one, such as ``"EPSG:32630"``. Files in latitude and
        longitude by their format have no need of it.
    cell_size
        Side of a cell in m.
    keep_outs
        File in one of the same formats; nothing is probed in any of its polygons.

    Returns
    -------
    Field
        In the frame of the file if its metres are metres on the ground there, else in the UTM
        zone of its centre; named after the file. Its findings say what was moved, and what of the
        files is not used.

    Raises
    ------
    BoundaryError
        If a file is missing, cannot be read, or holds no usable outline, or if keep-outs lie
        elsewhere than the field. The message names the file, and the row, line or feature.
    MissingExtraError
        If the format needs pyogrio and it is not installed.
    ParameterError
        If the cell size is not positive.
    """
    path = Path(path)
    found = _read(path, crs)
    field = _field(found, cell_size, path.name)
    barred = _place(found.keep_outs, found.crs, field, path.name)
    findings = (*field.findings, *found.findings, *_idle(barred, field, path.name))
    if keep_outs is not None:
        file = Path(keep_outs)
        other = _read(file, crs)
        more = _place(other.outlines + other.keep_outs, other.crs, field, file.name)
        barred, findings = (
            barred + more,
            (*findings, *other.findings, *_idle(more, field, file.name)),
        )
    return replace(field, keep_outs=barred, findings=findings) if barred or findings else field


def _read(path: Path, crs: str | None) -> Outlines:
    check_file(path, BoundaryError)
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise BoundaryError(
            "nothing reads outlines from files with this suffix",
            where=path.name,
            remedy=f"save it as one of {' '.join(READERS)}",
        )
    return reader(path, crs)


def _field(found: Outlines, cell_size: float, name: str) -> Field:
    if len(found.outlines) != 1:
        raise BoundaryError(
            f"it holds {len(found.outlines)} outlines, not one",
            where=name,
            remedy=f'leave one, and give keep-outs the property "role": "{KEEP_OUT}"',
        )
    (outline,) = found.outlines
    if found.crs == WGS84:
        return Field.from_lonlat(outline, cell_size=cell_size, name=name)
    field = Field(outline, found.crs, (), cell_size, name)
    home = metres_frame(field.crs, field.entrance) if field.crs else ""
    if home == field.crs:
        return field
    moved = Field.from_lonlat(
        _move(outline, field.crs, WGS84, name), cell_size=cell_size, name=name
    )
    off = 100 * stretch(field.crs, field.entrance)
    seen = f"metres of {brief(field.crs)} are {off:.2g} % off here, so it is kept in {moved.crs}"
    return replace(moved, findings=(Finding(seen, file=name),))


def _place(areas: tuple[Area, ...], crs: str, field: Field, file: str) -> tuple[Area, ...]:
    """Keep-outs in the frame of the field."""
    if crs != field.crs:
        areas = tuple(_move(area, crs, field.crs, file) for area in areas)
    if areas and not any(area.intersects(field.boundary) for area in areas):
        raise BoundaryError(
            "no keep-out touches the field",
            where=file,
            remedy="check their CRS and the order of latitude and longitude",
        )
    return areas


def _idle(areas: tuple[Area, ...], field: Field, file: str) -> tuple[Finding, ...]:
    """Keep-outs that keep nobody out of the field, if there are any."""
    idle = sum(not area.intersects(field.boundary) for area in areas)
    seen = f"{idle} of {len(areas)} keep-outs do not touch the field"
    return (Finding(seen, file=file),) if idle else ()


def _move(area: Area, source: str, target: str, file: str) -> Area:
    try:
        return shapely.transform(area, lambda xy: project(source, target, xy[:, 0], xy[:, 1]))
    except BoundaryError as error:
        raise BoundaryError(error.what, where=file, remedy=error.remedy) from error
