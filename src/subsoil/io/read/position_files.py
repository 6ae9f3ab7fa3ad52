"""Files of positions: GPX, GeoJSON, GeoPackages and shapefiles of points, and tables."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Mapping, Sequence
from datetime import datetime
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import shapely

from subsoil.errors import BoundaryError, ReadingsError, brief, listed
from subsoil.findings import Finding
from subsoil.io.read.instruments.coordinates import degrees
from subsoil.io.read.joining import Positions
from subsoil.io.read.outlines.geofile import read_layer
from subsoil.io.read.outlines.geojson import features_of
from subsoil.io.read.recording import Frame, unusable
from subsoil.io.read.text import POSITION_COLUMNS, number, read_text
from subsoil.land.crs import WGS84, named_crs, project

_NUMBERS = ("number", "num", "no", "no.", "nr", "nr.", "n", "push", "point", "name", "id", "fid")
"""Names of what positions are called by, the best first."""
_TIMES = ("time", "datetime", "timestamp", "date_time", "utc", "date")
_WIDE = (".gpkg", ".shp")

Point = tuple[float, float, str, datetime | None]
"""x, y, number and time."""


def read_positions(path: str | Path) -> Positions:
    """Read positions with the number or the time of each.

    Numbers are in a column or attribute such as ``number``, ``push``, ``name`` or ``id``, times in
    ISO 8601 in ``time`` or ``timestamp``. In GPX they are the name and time of waypoints, route
    and track points.

    Raises
    ------
    ReadingsError
        If the file cannot be read as any of these, or holds no position.
    MissingExtraError
        If it is a GeoPackage or shapefile and pyogrio is not installed.
    """
    path = Path(path)
    if path.suffix.lower() in _WIDE:
        return _checked(_of_layer(path))
    text = read_text(path, ReadingsError)
    if "<gpx" in text[:4096].lower():
        return _checked(_of_gpx(text, path.name))
    if text.lstrip().startswith("{"):
        return _checked(_of_geojson(path))
    return _checked(_of_table(text, path.name))


def _checked(found: Positions) -> Positions:
    if not len(found.x):
        first = f"; first {found.findings[0]}" if found.findings else ""
        raise ReadingsError(
            f"it holds no positions{first}", where=found.file, remedy="export it again"
        )
    return found


def _positions(
    points: Sequence[Point], file: str, frame: Frame, crs: str, findings: Sequence[Finding] = ()
) -> Positions:
    return Positions(
        file,
        frame,
        np.array([x for x, _, _, _ in points]),
        np.array([y for _, y, _, _ in points]),
        tuple(number for _, _, number, _ in points),
        tuple(time for _, _, _, time in points),
        crs,
        tuple(findings),
    )


def _of_gpx(text: str, file: str) -> Positions:
    if "<!DOCTYPE" in text or "<!ENTITY" in text:
        raise ReadingsError(
            "it declares entities, which no GPX needs", where=file, remedy="export it again"
        )
    try:
        root = ElementTree.fromstring(text.partition("?>")[2] if text.startswith("<?xml") else text)
    except (ElementTree.ParseError, RecursionError) as error:
        raise ReadingsError(
            f"this is not XML: {brief(str(error), 200)}", where=file, remedy="export it again"
        ) from error
    points: list[Point] = []
    findings: list[Finding] = []
    for k, each in enumerate((e for e in root.iter() if _tag(e) in ("wpt", "rtept", "trkpt")), 1):
        inside = {_tag(part): (part.text or "").strip() for part in each}
        try:
            x, y = number(each.get("lon", "")), number(each.get("lat", ""))
        except ValueError as error:
            findings.append(unusable(error, file, k))
            continue
        points.append((x, y, inside.get("name", ""), _time(inside.get("time", ""))))
    return _positions(points, file, "lonlat", "", findings)


def _tag(element: ElementTree.Element) -> str:
    return element.tag.rpartition("}")[2]


def _of_geojson(path: Path) -> Positions:
    try:
        features, crs = features_of(path)
    except BoundaryError as error:
        raise ReadingsError(error.what, where=error.where, remedy=error.remedy) from error
    points: list[Point] = []
    findings: list[Finding] = []
    for k, feature in enumerate(features, 1):
        geometry = feature.get("geometry") if isinstance(feature, dict) else None
        said = feature.get("properties") if isinstance(feature, dict) else None
        try:
            if not isinstance(geometry, dict) or geometry.get("type") != "Point":
                raise ValueError("it is no Point")
            x, y = (number(str(part)) for part in list(geometry.get("coordinates") or ())[:2])
        except (ValueError, TypeError) as error:
            findings.append(unusable(ValueError(str(error)), path.name, k))
            continue
        points.append((x, y, *_called(said if isinstance(said, dict) else {})))
    return _in_frame(points, path.name, crs or WGS84, findings)


def _of_layer(path: Path) -> Positions:
    layer = read_layer(path, "Point", ReadingsError)
    if not layer.crs:
        raise ReadingsError(
            "it does not name its CRS", where=path.name, remedy="keep the .prj file beside it"
        )
    points: list[Point] = []
    findings: list[Finding] = []
    for k, shape in enumerate(layer.shapes):
        place = shapely.from_wkb(shape, on_invalid="ignore") if shape else None
        if not isinstance(place, shapely.Point) or place.is_empty:
            findings.append(Finding("it is no point", "left out", "left out", path.name, k + 1))
            continue
        said = {name: values[k] for name, values in layer.fields.items()}
        points.append((place.x, place.y, *_called(said)))
    return _in_frame(points, path.name, layer.crs, findings)


def _in_frame(
    points: Sequence[Point], file: str, crs: str, findings: Sequence[Finding]
) -> Positions:
    """Positions in metres of their CRS, or in degrees of WGS84."""
    if not named_crs(crs, file).is_geographic:
        return _positions(points, file, "metres", crs, findings)
    if points and crs != WGS84:
        x, y = zip(*((x, y) for x, y, _, _ in points), strict=True)
        moved = project(crs, WGS84, x, y)
        points = [(*xy, *rest[2:]) for xy, rest in zip(moved.tolist(), points, strict=True)]
    return _positions(points, file, "lonlat", "", findings)


def _called(said: Mapping[str, Any]) -> tuple[str, datetime | None]:
    """Number and time by attributes."""
    low = {str(name).strip().lower(): value for name, value in said.items()}
    numbers = [str(low[name]) for name in _NUMBERS if low.get(name) not in (None, "")]
    times = [str(low[name]) for name in _TIMES if low.get(name) not in (None, "")]
    called = numbers[0] if numbers else ""
    return called.removesuffix(".0"), _time(times[0]) if times else None


def _time(text: str) -> datetime | None:
    try:
        return datetime.fromisoformat(text.strip())
    except ValueError:
        return None


def _of_table(text: str, file: str) -> Positions:
    delimiter = max(";\t,", key=text.lstrip().split("\n", 1)[0].count)
    try:
        rows = list(csv.reader(io.StringIO(text, newline=""), delimiter=delimiter))
    except csv.Error as error:
        raise ReadingsError(f"this is not a table: {error}", where=file) from error
    heading = next((k for k, row in enumerate(rows) if any(cell.strip() for cell in row)), 0)
    names = [cell.strip().lower() for cell in rows[heading]]
    meanings = [POSITION_COLUMNS.get(name, "") for name in names]
    lonlat = "longitude" in meanings and "latitude" in meanings
    wanted = ("longitude", "latitude") if lonlat else ("easting", "northing")
    if not all(meanings.count(each) == 1 for each in wanted):
        raise ReadingsError(
            f"no columns say where it was; it has {listed(names)}",
            where=f"{file}, row {heading + 1}",
            remedy="start the table with number,lat,lon or number,easting,northing",
        )
    points: list[Point] = []
    findings: list[Finding] = []
    for row, cells in _filled(rows, heading):
        try:
            x, y = (_coordinate(cells, meanings.index(each), lonlat, delimiter) for each in wanted)
        except ValueError as error:
            findings.append(unusable(error, file, row))
            continue
        points.append((x, y, *_called(dict(zip(names, cells, strict=False)))))
    return _positions(points, file, "lonlat" if lonlat else "metres", "", findings)


def _filled(rows: Sequence[list[str]], heading: int) -> Iterator[tuple[int, list[str]]]:
    for row, cells in enumerate(rows[heading + 1 :], heading + 2):
        if any(cell.strip() for cell in cells):
            yield row, cells


def _coordinate(cells: Sequence[str], k: int, lonlat: bool, delimiter: str) -> float:
    if k >= len(cells) or not cells[k].strip():
        raise ValueError("a number is missing")
    if lonlat:
        return degrees(cells[k])
    return number(cells[k].replace(",", ".") if delimiter != "," else cells[k])
