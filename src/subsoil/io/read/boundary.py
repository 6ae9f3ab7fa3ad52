"""Fields from files of their outlines.

========================  =====================================================================
``.geojson`` ``.json``    WGS84 longitude, latitude (RFC 7946); a member ``crs`` that names
                          another CRS, as older programs write it, is honoured
``.coords``               a corner a line, WGS84 latitude, longitude in decimal degrees
``.csv`` ``.txt``         a corner a line under a header ``easting,northing`` (metres) or
                          ``lat,lon``; without a header, metres in the CRS that the caller names
``.gpkg`` ``.shp``        a layer of polygons; pyogrio reads it
``.kml`` ``.kmz``         polygons of placemarks, WGS84; closed lines and tracks without them
``.gpx``                  a track that comes back to where it starts, WGS84
``.zip``                  any of these, packed, such as the parts of a shapefile
========================  =====================================================================

One polygon is the field, or several that adjoin; of others the caller names one. Polygons whose
property ``role`` is ``"keep-out"`` are areas in which nothing is probed, and so are holes. Points,
lines and layers of them beside it are not used, and the findings of the field name them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import shapely

from subsoil.errors import BoundaryError, brief, printable
from subsoil.findings import Finding
from subsoil.io.read.outlines.archive import ARCHIVES, read_archive
from subsoil.io.read.outlines.corners import read_coords, read_corners
from subsoil.io.read.outlines.geofile import read_geofile
from subsoil.io.read.outlines.geojson import read_geojson
from subsoil.io.read.outlines.gpx import read_gpx
from subsoil.io.read.outlines.home import exactness, home_of, moved
from subsoil.io.read.outlines.kml import read_kml
from subsoil.io.read.outlines.outlines import Outlines
from subsoil.io.read.outlines.parcels import chosen, joined
from subsoil.io.read.text import check_file
from subsoil.land.field import Field
from subsoil.land.outline import Area

READERS: dict[str, Callable[[Path, str | None, str], Outlines]] = {
    ".geojson": lambda path, crs, _: read_geojson(path, crs),
    ".json": lambda path, crs, _: read_geojson(path, crs),
    ".coords": lambda path, *_: read_coords(path),
    ".csv": lambda path, crs, _: read_corners(path, crs),
    ".txt": lambda path, crs, _: read_corners(path, crs),
    ".gpkg": read_geofile,
    ".shp": read_geofile,
    ".kml": lambda path, *_: read_kml(path),
    ".gpx": lambda path, *_: read_gpx(path),
}
"""Reader of each suffix: from a path, the CRS of a file that names none, and a name to look for."""
SUFFIXES = (*READERS, *ARCHIVES)
"""Suffixes of files of outlines."""
_MOST_NAMES = 3


def read_field(
    path: str | Path,
    *,
    crs: str | None = None,
    cell_size: float = 5.0,
    keep_outs: str | Path | None = None,
    name: str = "",
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
    name
        Which outline is the field, where the file holds several: its property ``name``, or the
        layer or packed file that holds it.

    Returns
    -------
    Field
        In the frame of the file if its metres are metres on the ground there, else in the UTM
        zone of its centre; named as in the file, or after it. Its findings say what was moved or
        joined, and what of the files is not used.

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
    found = outlines_in(path, crs, name)
    field, said = _field(found, name, cell_size, path.name)
    barred = _place(found.keep_outs, found.crs, field, path.name)
    findings = (*said, *found.findings, *_idle(barred, field, path.name))
    if keep_outs is not None:
        file = Path(keep_outs)
        other = outlines_in(file, crs, "")
        areas = (*(each.area for each in other.parcels), *other.keep_outs)
        more = _place(areas, other.crs, field, file.name)
        barred += more
        findings += (*other.findings, *_idle(more, field, file.name))
    return replace(field, keep_outs=barred, findings=findings, name=_name(found, field, name))


def outlines_in(path: Path, crs: str | None, name: str) -> Outlines:
    """What a file shows, by the reader of its suffix.

    Raises
    ------
    BoundaryError
        If nothing reads files with this suffix, or its reader refuses it.
    """
    check_file(path, BoundaryError)
    suffix = path.suffix.lower()
    if suffix in ARCHIVES:
        return read_archive(path, READERS, crs, name)
    reader = READERS.get(suffix)
    if reader is None:
        raise BoundaryError(
            "nothing reads outlines from files with this suffix",
            where=path.name,
            remedy=f"save it as one of {' '.join(SUFFIXES)}",
        )
    return reader(path, crs, name)


def _field(
    found: Outlines, name: str, cell_size: float, file: str
) -> tuple[Field, tuple[Finding, ...]]:
    """Field of the parcels of a file, called after the file, and what was done to make it one."""
    parcels, others = chosen(found.parcels, name, file)
    bounds = shapely.MultiPolygon(
        [p for each in parcels for p in shapely.get_parts(each.area)]
    ).bounds
    home, why = home_of(found.crs, bounds, cell_size, file)
    here = [replace(p, area=moved(p.area, found.crs, home, file)) for p in parcels]
    area, together = joined(here, file)
    field = Field(area, home, (), cell_size, file)
    return field, (*why, *exactness(field, file), *others, *together, *_holes(area, file))


def _name(found: Outlines, field: Field, name: str) -> str:
    """What a field is called: as its parcels are, or after its file."""
    parcels, _ = chosen(found.parcels, name, field.name)
    names = list(dict.fromkeys(each.name for each in parcels if each.name))
    few = names if len(names) <= _MOST_NAMES else []
    return printable(brief(" and ".join(few), 60)) or field.name


def _holes(area: Area, file: str) -> tuple[Finding, ...]:
    """Say that holes of an outline are kept out of, if it has any."""
    rings = [hole for part in shapely.get_parts(area) for hole in part.interiors]
    holes = [each for ring in rings if (each := shapely.Polygon(ring).area) >= 1.0]
    if not holes:
        return ()
    hectares = sum(holes) / 10_000
    what = "a hole" if len(holes) == 1 else f"{len(holes)} holes"
    seen = f"the outline has {what} of {hectares:.2g} ha"
    return (Finding(seen, "nothing is probed there", file=file),)


def _place(areas: tuple[Area, ...], crs: str, field: Field, file: str) -> tuple[Area, ...]:
    """Keep-outs in the frame of the field."""
    areas = tuple(moved(area, crs, field.crs, file) for area in areas)
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
