"""Stops to make, as files that receivers, phones and any GIS show the way by.

GPX (waypoints), KML and GeoJSON are in longitude and latitude (WGS84); CSV is in latitude and
longitude, or in metres of a local frame. Stops are named by their numbers, in order.
"""

from __future__ import annotations

import csv
import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import shapely
from numpy.typing import ArrayLike

from subsoil.arrays import Floats
from subsoil.errors import ParameterError, SubsoilError
from subsoil.io.write.whole import whole
from subsoil.land.crs import WGS84
from subsoil.land.field import Field
from subsoil.optional import load

Stops = list[tuple[str, float, float]]
"""Name, x and y of each stop: longitude and latitude in degrees, or easting and northing in m."""

_DRIVERS = {
    ".gpx": ("GPX", "waypoints", "name"),
    ".kml": ("KML", "stops", "Name"),
}
"""GDAL's driver, the layer and the field of names of each format that it writes."""


def write_stops(path: Path, field: Field, at: ArrayLike) -> Path:
    """Write (n, 2) places in m in the frame of a field, and return the path.

    The file is read back before it gets its name.

    Raises
    ------
    ParameterError
        If :func:`check_stops_file` finds a reason, or there are no stops.
    MissingExtraError
        If pyogrio is not installed, which GPX and KML need.
    SubsoilError
        If what was written reads otherwise.
    OSError
        If the file cannot be written.
    """
    check_stops_file(path, field)
    stops = _named(path, field, np.asarray(at, dtype=float).reshape(-1, 2))
    suffix = path.suffix.lower()
    with whole(path) as unfinished:
        if suffix in _DRIVERS:
            _write_ogr(unfinished, stops)
            back = _read_ogr(unfinished)
        else:
            write, read = _PLAIN[suffix]
            write(unfinished, stops, degrees=bool(field.crs))
            back = read(unfinished)
        if back != stops:
            raise SubsoilError(
                "it reads otherwise than it was written",
                where=str(path),
                remedy="write another format, such as .csv",
            )
    return path


def check_stops_file(path: Path, field: Field) -> None:
    """Check that stops of a field can be written to a file of this name.

    Raises
    ------
    ParameterError
        If nothing here writes such files, or they are in longitude and latitude and the field lies
        in a local frame.
    """
    suffix = path.suffix.lower()
    if suffix not in (*_DRIVERS, *_PLAIN):
        raise ParameterError(
            f"nothing here writes stops as {suffix or 'a file without an ending'}",
            where=str(path),
            remedy=f"one of {', '.join((*_DRIVERS, *_PLAIN))}",
        )
    if not field.crs and suffix != ".csv":
        raise ParameterError(
            f"{suffix} is in longitude and latitude, and the field in a local frame",
            where=str(path),
            remedy="write .csv, which is in easting and northing then",
        )


def _named(path: Path, field: Field, at: Floats) -> Stops:
    """Stops as the file is to hold them: degrees to seven digits, metres to three."""
    if not len(at):
        raise ParameterError(
            "there are no stops to write",
            where=str(path),
            remedy="the survey is over: raise --samples to go on",
        )
    rows = np.round(field.to_lonlat(at), 7) if field.crs else np.round(at, 3)
    return [(str(k), float(x), float(y)) for k, (x, y) in enumerate(rows.tolist(), start=1)]


def _write_ogr(path: Path, stops: Stops) -> None:
    driver, layer, name = _DRIVERS[path.suffix.lower()]
    ogr = load("pyogrio.raw", "geo", f"a file of {driver}")
    ogr.write(
        path,
        geometry=shapely.to_wkb(shapely.points([(x, y) for _, x, y in stops])),
        field_data=[np.array([stop for stop, _, _ in stops], dtype=object)],
        fields=[name],
        layer=layer,
        driver=driver,
        geometry_type="Point",
        crs=WGS84,
    )


def _read_ogr(path: Path) -> Stops:
    driver, layer, name = _DRIVERS[path.suffix.lower()]
    ogr = load("pyogrio.raw", "geo", f"a file of {driver}")
    _, _, geometry, (names,) = ogr.read(path, layer=layer, columns=[name])
    at = shapely.get_coordinates(shapely.from_wkb(geometry)).round(7).tolist()
    return [(str(stop), x, y) for stop, (x, y) in zip(names, at, strict=True)]


def _write_geojson(path: Path, stops: Stops, *, degrees: bool) -> None:  # noqa: ARG001 - always are
    features = [
        {
            "type": "Feature",
            "properties": {"name": name},
            "geometry": {"type": "Point", "coordinates": [x, y]},
        }
        for name, x, y in stops
    ]
    collection = {"type": "FeatureCollection", "features": features}
    path.write_text(json.dumps(collection, indent=1), encoding="utf-8")


def _read_geojson(path: Path) -> Stops:
    features = json.loads(path.read_text(encoding="utf-8"))["features"]
    return [
        (feature["properties"]["name"], *feature["geometry"]["coordinates"])
        for feature in features
    ]  # fmt: skip


def _write_csv(path: Path, stops: Stops, *, degrees: bool) -> None:
    digits = 7 if degrees else 3
    with path.open("w", encoding="utf-8", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(["stop", *(("lat", "lon") if degrees else ("northing", "easting"))])
        rows.writerows([name, f"{y:.{digits}f}", f"{x:.{digits}f}"] for name, x, y in stops)


def _read_csv(path: Path) -> Stops:
    with path.open(encoding="utf-8", newline="") as file:
        _, *rows = csv.reader(file)
    return [(name, float(x), float(y)) for name, y, x in rows]


_PLAIN: dict[str, tuple[Callable[..., None], Callable[[Path], Stops]]] = {
    ".geojson": (_write_geojson, _read_geojson),
    ".csv": (_write_csv, _read_csv),
}
"""What writes and what reads each format that needs no library."""
