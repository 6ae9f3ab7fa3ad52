"""Readings of the penetrometer robot at Riseholme, as its program writes them in YAML.

::

    names: [2.5 cm, 5.0 cm, ...]
    data:
    - position: {lat: 53.26092, lon: -0.52711}
      data: [17.2, 123.3, ...]        # kPa, 0 = depth not reached
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import yaml

from subsoil.errors import ReadingsError
from subsoil.io.records import Finding, Floats, Record, Recording, depth_of
from subsoil.io.text import read_text

_LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


def read_robot_yaml(path: Path) -> Recording:
    """Read a robot's log; records count from 1.

    Raises
    ------
    ReadingsError
        If it is not YAML, or does not have the shape above. A record that does not have it is
        refused instead.
    """
    document = _yaml(read_text(path, ReadingsError), path.name)
    depth_m = _depths(document.get("names"), path.name)
    entries = document.get("data")
    if not isinstance(entries, list):
        raise ReadingsError("it has no list 'data'", where=path.name, remedy="export it again")
    records: list[Record] = []
    refused: list[Finding] = []
    for row, entry in enumerate(entries, 1):
        try:
            records.append(_record(row, entry, depth_m))
        except ValueError as error:
            refused.append(Finding(row, str(error)))
    return Recording(tuple(records), tuple(refused), lonlat=True, unit="kpa")


def _yaml(text: str, file: str) -> dict[str, Any]:
    try:
        document = yaml.load(text, Loader=_LOADER)
    except (yaml.YAMLError, RecursionError, ValueError) as error:
        mark = getattr(error, "problem_mark", None)
        raise ReadingsError(
            f"this is not YAML: {getattr(error, 'problem', None) or type(error).__name__}",
            where=f"{file}, line {mark.line + 1}" if mark else file,
            remedy="export it again",
        ) from error
    if not isinstance(document, dict):
        raise ReadingsError(
            "this is YAML, but not a robot's readings: it needs 'names' and 'data'",
            where=file,
            remedy="export it again, or save the readings as CSV",
        )
    return document


def _depths(names: Any, file: str) -> Floats:
    if not (isinstance(names, list) and names):
        raise ReadingsError("it has no list 'names' of depths", where=file, remedy="export again")
    try:
        depth_m = np.array([depth_of(str(name)) for name in names])
    except ValueError as error:
        raise ReadingsError(str(error), where=f"{file}, names") from error
    if np.any(np.diff(depth_m) <= 0):
        raise ReadingsError("depths do not increase", where=f"{file}, names")
    return depth_m


def _record(row: int, entry: Any, depth_m: Floats) -> Record:
    values = entry.get("data") if isinstance(entry, dict) else None
    position = entry.get("position") if isinstance(entry, dict) else None
    if not isinstance(values, list) or not isinstance(position, dict):
        raise ValueError("it needs a position and a list of data")
    if len(values) != depth_m.size:
        raise ValueError(f"{len(values)} values do not pair with {depth_m.size} depths")
    kpa = [_finite(value, f"{depth:g} m") for value, depth in zip(values, depth_m, strict=True)]
    x, y = _finite(position.get("lon"), "lon"), _finite(position.get("lat"), "lat")
    return Record(row, x, y, depth_m, np.where(np.array(kpa) == 0, np.nan, kpa))


def _finite(value: Any, place: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not np.isfinite(value):
        raise ValueError(f"{value!r} at {place} is not a number")
    return float(value)
