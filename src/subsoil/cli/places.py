"""Places as people type them and read them."""

from __future__ import annotations

from math import atan2, degrees, hypot, isfinite

import numpy as np
import shapely

from subsoil.errors import ParameterError, brief
from subsoil.io.read.strays import FENCE_M
from subsoil.land.field import Field
from subsoil.reports import Place
from subsoil.units import METRIC, Units

_NEAR_M = 10_000.0
_POINTS = ("north", "north-east", "east", "south-east", "south", "south-west", "west", "north-west")


def place_of(text: str, field: Field, where: str) -> Place:
    """Place in the field's frame of ``LAT,LON``, or of ``EASTING,NORTHING`` in a local frame.

    Raises
    ------
    ParameterError
        If it is not two numbers, no place on Earth, or more than 10 km from the field.
    """
    wanted = "latitude,longitude" if field.crs else "easting,northing"
    try:
        first, second = (float(part) for part in text.split(","))
    except ValueError:
        raise ParameterError(
            f"{brief(text)!r} is not two numbers",
            where=where,
            remedy=f"give {wanted}, with decimal points",
        ) from None
    place = _in_metres(first, second, field)
    if place is None or metres_outside(place, field) > _NEAR_M:
        swapped = _in_metres(second, first, field)
        mixed = swapped is not None and metres_outside(swapped, field) <= _NEAR_M
        raise ParameterError(
            f"{brief(text)!r} is nowhere near {field.name}",
            where=where,
            remedy=f"give {wanted}" + (": they look swapped" if mixed else ""),
        )
    return place


def _in_metres(first: float, second: float, field: Field) -> Place | None:
    """Place of two numbers in the field's frame; ``None`` if there is none."""
    if not (isfinite(first) and isfinite(second)):
        return None
    if not field.crs:
        return first, second
    if abs(first) > 90 or abs(second) > 180:
        return None
    (east, north) = field.to_metres([second], [first])[0].tolist()
    return (east, north) if isfinite(east) and isfinite(north) else None


def check_on_field(place: Place, field: Field, where: str) -> None:
    """Check that a place lies in the field and in no keep-out, to what receivers are off.

    Raises
    ------
    ParameterError
        If it does not.
    """
    away = metres_outside(place, field)
    if away > FENCE_M:
        raise ParameterError(
            f"it is {away:.0f} m outside {field.name}",
            where=where,
            remedy="correct the place; a reading of another field goes into a survey of its own",
        )
    spot = shapely.Point(place)
    if any(area.contains(spot) for area in field.keep_outs):
        raise ParameterError(
            "it lies in a keep-out", where=where, remedy="correct the place, or leave it out"
        )


def metres_outside(place: Place, field: Field) -> float:
    """Distance in m to the outline from outside; 0 within."""
    return float(shapely.distance(shapely.Point(place), field.boundary))


def in_words(place: Place, field: Field) -> str:
    """A place to go to: latitude and longitude to seven decimals, or metres of a local frame."""
    if not field.crs:
        return f"easting {place[0]:.2f} m, northing {place[1]:.2f} m"
    longitude, latitude = field.to_lonlat(place)[0].tolist()
    return f"latitude {latitude:.7f}, longitude {longitude:.7f}"


def bearing(here: Place, there: Place) -> float:
    """Direction from one place to another, in degrees clockwise from north.

    Examples
    --------
    >>> bearing((0.0, 0.0), (5.0, 0.0)), bearing((0.0, 0.0), (-5.0, 5.0))
    (90.0, 315.0)
    """
    return degrees(atan2(there[0] - here[0], there[1] - here[1])) % 360.0


def way_in_words(here: Place, there: Place, units: Units = METRIC) -> str:
    """Distance and bearing of a place, such as ``35 m to the north-east (48 degrees)``.

    Examples
    --------
    >>> way_in_words((0.0, 0.0), (30.0, 30.0))
    '42 m to the north-east (45°)'
    """
    metres, towards = hypot(there[0] - here[0], there[1] - here[1]), bearing(here, there)
    if metres < 0.5:
        return "where you are"
    point = _POINTS[int(np.floor(towards / 45.0 + 0.5)) % 8]
    return f"{units.length.text(metres)} to the {point} ({round(towards) % 360}°)"
