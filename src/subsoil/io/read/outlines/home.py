"""Home frames: metres that are metres on the ground at the field, and how exactly it lies there."""

from __future__ import annotations

import shapely

from subsoil.errors import BoundaryError, brief
from subsoil.findings import Finding
from subsoil.land.crs import (
    MOST_OFF_M,
    NEAR_M,
    WGS84,
    accuracy,
    foreign_unit,
    is_degrees,
    metres_frame,
    named_crs,
    project,
    stretch,
    utm_crs,
)
from subsoil.land.field import Field
from subsoil.land.outline import Area, check_extent, check_lonlat
from subsoil.land.swaps import looks_transposed

Bounds = tuple[float, float, float, float]


def home_of(crs: str, bounds: Bounds, cell_size: float, file: str) -> tuple[str, list[Finding]]:
    """Frame to keep a field in, and why it is another than that of its file.

    Parameters
    ----------
    crs
        Frame of the file; empty for a local one.
    bounds
        West, south, east and north of the outline in it.
    cell_size
        Side of a cell in m.
    file
        Name of the file.

    Raises
    ------
    BoundaryError
        If coordinates are not what the frame says, or the way from it to WGS84 is not known.
    """
    middle = (bounds[0] + bounds[2]) / 2, (bounds[1] + bounds[3]) / 2
    if is_degrees(crs):
        check_lonlat(bounds, file)
        home = _utm(crs, middle, file)
        return home, [] if crs == WGS84 else [_other_datum(crs, middle, home, file)]
    unit = foreign_unit(crs)
    if unit:
        home = _utm(crs, middle, file)
        seen = f"{brief(crs)} measures in {unit}, so it is kept in {home}"
        return home, [Finding(seen, file=file)]
    check_extent(bounds, cell_size, file)
    if crs and looks_transposed(crs, *middle):
        raise BoundaryError(
            f"easting {middle[0]:.0f}, northing {middle[1]:.0f} is far from where {brief(crs)} "
            "is used: they look swapped",
            where=file,
            remedy="write easting first",
        )
    home = metres_frame(crs, middle) if crs else ""
    if home == crs:
        return home, []
    off = 100 * stretch(crs, middle)
    seen = f"metres of {brief(crs)} are {off:.2g} % off here, so it is kept in {home}"
    return home, [Finding(seen, file=file)]


def exactness(field: Field, file: str) -> tuple[Finding, ...]:
    """How exactly a field's frame is tied to latitude and longitude, unless to a metre."""
    off = accuracy(field.crs, WGS84, *field.entrance) if field.crs else 0.0
    if off <= NEAR_M:
        return ()
    crs = brief(field.crs)
    if off <= MOST_OFF_M:
        seen = f"places in latitude and longitude are brought to {crs} to within about {off:.0f} m"
        done = "for exact ones, export the outline in WGS84 from a program that has its grid"
        return (Finding(seen, done, file=file),)
    seen = f"nothing exact leads from {crs} to latitude and longitude here"
    done = "give readings in the same frame, or export the outline in WGS84"
    return (Finding(seen, done, "doubt", file),)


def moved(area: Area, source: str, target: str, file: str) -> Area:
    """Area of one frame in another.

    Raises
    ------
    BoundaryError
        If nothing leads there, or it has no such place.
    """
    if source == target:
        return area
    try:
        found = shapely.transform(area, lambda xy: project(source, target, xy[:, 0], xy[:, 1]))
    except BoundaryError as error:
        raise BoundaryError(error.what, where=file, remedy=error.remedy) from error
    if not all(map(_finite, found.bounds)):
        raise BoundaryError(
            f"its coordinates are no place in {brief(target)}",
            where=file,
            remedy="check the coordinates and the CRS",
        )
    return found


def _finite(value: float) -> bool:
    return abs(value) < float("inf")


def _utm(crs: str, at: tuple[float, float], file: str) -> str:
    try:
        ((longitude, latitude),) = project(crs, WGS84, [at[0]], [at[1]])
        return utm_crs(float(longitude), float(latitude))
    except (BoundaryError, ValueError, OverflowError) as error:
        if isinstance(error, BoundaryError):
            raise BoundaryError(error.what, where=file, remedy=error.remedy) from error
        raise BoundaryError(
            f"({at[0]:g}, {at[1]:g}) is no place in {brief(crs)}",
            where=file,
            remedy="check the coordinates and the CRS",
        ) from error


def _other_datum(crs: str, at: tuple[float, float], home: str, file: str) -> Finding:
    off = accuracy(crs, WGS84, *at)
    how = "under a metre off WGS84" if off <= NEAR_M else f"tied to WGS84 to about {off:.0f} m"
    name = brief(named_crs(crs, file).name)
    return Finding(
        f"longitudes and latitudes are of {name}, {how}", f"brought to {home}", file=file
    )
