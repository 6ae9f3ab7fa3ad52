"""The same pushes, written as tables in every layout, unit, mark, encoding and step."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from subsoil.arrays import Floats
from subsoil.land.field import Field

KPA = {"kpa": 1.0, "mpa": 1000.0, "psi": 6.894757, "bar": 100.0, "N/cm2": 10.0, "kgf/cm2": 98.0665}
DIGITS = {"kpa": 1, "mpa": 4, "psi": 2, "bar": 3, "N/cm2": 2, "kgf/cm2": 3}
METRES = {"cm": 0.01, "mm": 0.001, "m": 1.0, "in": 0.0254, "ft": 0.3048}


@dataclass(frozen=True)
class Pushes:
    """(n,) places in degrees and (n, k) kPa at (k,) depths in m; NaN where not reached."""

    lon: Floats
    lat: Floats
    depth_m: Floats
    kpa: Floats


@dataclass(frozen=True)
class Style:
    """How a table is written."""

    unit: str = "kpa"
    length: str = "cm"
    place: str = "degrees"
    delimiter: str = ","
    decimal: str = "."
    missing: str = ""
    heading: Callable[[str, str], str] = "{0}_{1}".format
    thousands: str = ""


def number(value: float, digits: int, style: Style) -> str:
    if not np.isfinite(value):
        return style.missing
    text = f"{value:,.{digits}f}" if style.thousands else f"{value:.{digits}f}"
    return text.translate({44: style.thousands, 46: style.decimal})


def strength(kpa: float, style: Style) -> str:
    return number(kpa / KPA[style.unit], DIGITS[style.unit], style)


def depth(metres: float, style: Style) -> str:
    return f"{round(metres / METRES[style.length], 4):g}".replace(".", style.decimal)


def places(pushes: Pushes, style: Style, field: Field) -> tuple[list[str], list[list[str]]]:
    if style.place == "metres":
        at = field.to_metres(pushes.lon, pushes.lat)
        return ["Rechtswert", "Hochwert"], [[number(v, 3, style) for v in p] for p in at]
    if style.place == "xy":
        rows = zip(pushes.lon, pushes.lat, strict=True)
        return ["X", "Y"], [[number(v, 8, style) for v in row] for row in rows]
    rows = zip(pushes.lat, pushes.lon, strict=True)
    if style.place == "degrees":
        return ["Latitude (°)", "Longitud"], [[number(v, 8, style) for v in row] for row in rows]
    if style.place == "nmea":
        heads = ["lat", "N/S", "lng", "E/W"]
        return heads, [
            [packed(lat, 2, style), "NS"[int(lat < 0)], packed(lon, 3, style), "EW"[int(lon < 0)]]
            for lat, lon in rows
        ]
    return ["Breite", "Länge"], [
        [parts(lat, "NS", style), parts(lon, "EW", style)] for lat, lon in rows
    ]


def packed(angle: float, width: int, style: Style) -> str:
    whole, rest = divmod(abs(angle), 1.0)
    return f"{int(whole):0{width}d}{rest * 60:09.6f}".replace(".", style.decimal)


def parts(angle: float, halves: str, style: Style) -> str:
    half = halves[int(angle < 0)]
    whole, rest = divmod(abs(angle), 1.0)
    if style.place == "minutes":
        text = f"{int(whole)}°{rest * 60:.6f}'{half}"
    else:
        minutes, seconds = divmod(rest * 60, 1.0)
        text = f"{half} {int(whole)}° {int(minutes)}' {seconds * 60:.4f}''"
    return text.replace(".", style.decimal)


def wide(pushes: Pushes, style: Style, field: Field) -> list[list[str]]:
    heads, at = places(pushes, style, field)
    depths = [style.heading(style.unit, f"{depth(d, style)}{style.length}") for d in pushes.depth_m]
    rows = [[*p, *(strength(v, style) for v in k)] for p, k in zip(at, pushes.kpa, strict=True)]
    return [["id", *heads, *depths], *([str(i), *row] for i, row in enumerate(rows, 1))]


def tidy(pushes: Pushes, style: Style, field: Field, order: int = 1) -> list[list[str]]:
    heads, at = places(pushes, style, field)
    rows = [
        [str(i), *place, depth(d, style), strength(v, style)]
        for i, (place, kpa) in enumerate(zip(at, pushes.kpa, strict=True), 1)
        for d, v in list(zip(pushes.depth_m, kpa, strict=True))[::order]
    ]
    return [["push", *heads, f"depth ({style.length})", f"CI ({style.unit})"], *rows]


def text_of(rows: Sequence[Sequence[str]], delimiter: str) -> str:
    buffer = io.StringIO()
    csv.writer(buffer, delimiter=delimiter).writerows(rows)
    return buffer.getvalue()


def geojson(pushes: Pushes, style: Style) -> str:
    heads = [style.heading(style.unit, f"{depth(d, style)}{style.length}") for d in pushes.depth_m]
    features = [
        {
            "type": "Feature",
            "geometry": {"type": "Point", "coordinates": [float(lon), float(lat)]},
            "properties": {
                head: round(value / KPA[style.unit], DIGITS[style.unit])
                if np.isfinite(value)
                else None
                for head, value in zip(heads, kpa, strict=True)
            },
        }
        for lon, lat, kpa in zip(pushes.lon, pushes.lat, pushes.kpa, strict=True)
    ]
    return json.dumps({"type": "FeatureCollection", "features": features})


def write(path: Path, text: str, encoding: str) -> Path:
    path.write_bytes(text.encode(encoding))
    return path
