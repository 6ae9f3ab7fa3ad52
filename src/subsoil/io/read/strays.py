"""Readings outside the field: used at the fence, left out beyond, and why most lie elsewhere."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import shapely

from subsoil.arrays import Bools, Floats, Integers
from subsoil.errors import BoundaryError, ReadingsError
from subsoil.findings import Finding
from subsoil.io.read.places import Places
from subsoil.land.crs import utm_crs
from subsoil.land.field import Field

FENCE_M = 5.0
"""Distance in m from the field up to which a reading is its own: a hand-held receiver's error."""
_TOUCH_M = 0.005
_MOST, _SOME = 0.5, 0.1
"""Share of readings, and of a covariate's points that reach beyond the field, that tell a cause."""
_FEET = 0.3048
_MERCATOR = "EPSG:3857"


def at_field(at: Floats, field: Field, fence_m: float) -> Bools:
    """Whether (n, 2) places in m lie in the field, or no farther from it than its fence."""
    return np.asarray(field.metres_away(at) <= fence_m + _TOUCH_M)


def strays(
    rows: Integers, at: Floats, field: Field, fence_m: float, file: str
) -> tuple[Finding, ...]:
    """Findings about readings, (n,) rows and (n, 2) m, that the field does not contain."""
    away = field.metres_away(at)
    barred = np.asarray(shapely.intersects_xy(shapely.union_all(list(field.keep_outs)), *at.T))
    return tuple(
        _stray(float(away[k]), bool(barred[k]), fence_m, file, int(rows[k]))
        for k in np.flatnonzero(away > _TOUCH_M)
    )


def _stray(away_m: float, barred: bool, fence_m: float, file: str, row: int) -> Finding:
    where = f"{_far(away_m)} inside a keep-out" if barred else f"{_far(away_m)} outside the field"
    if away_m <= fence_m + _TOUCH_M:
        return Finding(where, "used where it was taken", "note", file, row)
    return Finding("in a keep-out" if barred else where, "left out", "left out", file, row)


def elsewhere(
    places: Places, field: Field, at: Floats, crs: str | None, things: str = "readings"
) -> ReadingsError:
    """Complaint about things most of which lie outside the field, and what would explain it."""
    away = field.metres_away(at)
    outside = away[away > 0]
    far = _far(float(np.median(outside)))
    needed = _MOST if things == "readings" else _SOME
    what = f"{len(outside)} of {len(at)} {things} lie outside {field.name}, typically {far} away"
    for other, frame, why, remedy in _explanations(places, field, crs):
        if _inside_share(other, field, frame) >= needed:
            return ReadingsError(f"{what}; {why}", where=places.file, remedy=remedy)
    remedy = "check that file and field belong together"
    return ReadingsError(
        what,
        where=places.file,
        remedy=remedy if places.lonlat else f"{remedy}, and name the CRS of the {things}",
    )


Explanation = tuple[Places, str | None, str, str]


def _inside_share(places: Places, field: Field, crs: str | None) -> float:
    """Share of the places that lie in the field."""
    try:
        at, _ = places.metres(field, crs)
    except (BoundaryError, ReadingsError):
        return 0.0
    return float(field.contains(at).mean())


def _explanations(places: Places, field: Field, crs: str | None) -> Iterator[Explanation]:
    """What may have gone wrong with readings, or with the outline: how they are read then."""
    x, y = places.x, places.y
    columns = "latitude and longitude" if places.lonlat else "easting and northing"
    outline = ""
    if field.crs:
        ((longitude, latitude),) = field.to_lonlat(field.entrance)
        outline = f", or mend the outline, at latitude {latitude:.3f}, longitude {longitude:.3f}"
    swapped = f"swapping {columns} puts them inside"
    yield replace(places, x=y, y=x), crs, swapped, f"swap the names of the two columns{outline}"
    if places.lonlat:
        for east, north, name in ((-1, 1, "longitude"), (1, -1, "latitude"), (-1, -1, "both")):
            why = f"the other sign of {name} puts them inside (west and south are negative)"
            yield replace(places, x=east * x, y=north * y), crs, why, f"mend the signs{outline}"
        return
    for factor, unit in ((1000.0, "kilometres"), (_FEET, "feet")):
        why = f"taken as {unit} they lie inside"
        yield replace(places, x=factor * x, y=factor * y), crs, why, "write them in metres"
    if field.crs and np.abs(x).max() <= 180 and np.abs(y).max() <= 180:
        for first, second, name in ((x, y, "lon,lat"), (y, x, "lat,lon")):
            why = "taken as degrees they lie inside"
            degrees = Places(first, second, True, places.file)
            yield degrees, None, why, f"name the columns {name}"
    for frame in _frames_nearby(field):
        yield places, frame, f"in {frame} they lie inside", f"--crs {frame}"


def _frames_nearby(field: Field) -> Iterator[str]:
    """Frames in m that readings may be in without saying so."""
    if not field.crs:
        return
    ((longitude, latitude),) = field.to_lonlat(field.entrance)
    for zone in (0, -6, 6):
        for side in (latitude, -latitude):
            yield utm_crs((longitude + zone + 180) % 360 - 180, side)
    yield _MERCATOR


def _far(metres: float) -> str:
    if not np.isfinite(metres):
        return "half a world"
    if metres >= 10_000:
        return f"{metres / 1000:.0f} km"
    return f"{metres:.0f} m" if metres >= 10 else f"{metres:.2g} m"
