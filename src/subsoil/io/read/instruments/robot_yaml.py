"""Readings of the penetrometer robot at Riseholme, as its program writes them in YAML.

::

    names: [2.5 cm, 5.0 cm, ...]
    data:
    - position: {lat: 53.26092, lon: -0.52711}
      data: [17.2, 123.3, ...]        # kPa, 0 or null = depth not reached
"""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from subsoil.arrays import Floats
from subsoil.errors import ReadingsError, brief
from subsoil.findings import Finding
from subsoil.io.read.missing import is_missing
from subsoil.io.read.recording import Record, Recording, depth_of, unusable
from subsoil.io.read.text import read_text

NAME = "robot survey"

_SafeLoader: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
"""The fast one where there is one."""
_PLAIN = re.compile(r"[-+]?(0|[1-9]\d{0,30})")
_FIRST_KEY = re.compile(rb"(?:\s*#[^\n]*\n|\s)*(?:names|data|datum):")
_CLOCK = re.compile(r"[^.:]*:.*")


class _Loader(_SafeLoader):  # type: ignore[misc]
    """Loader that refuses what YAML reads otherwise than people do: 0750 as 488, 1:30 as 90."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        seen: set[str] = set()
        for key in (key for key, _ in node.value if isinstance(key, yaml.ScalarNode)):
            if key.value in seen:
                raise _doubt(f"{brief(key.value)!r} is there twice", key)
            seen.add(key.value)
        mapping: dict[Any, Any] = super().construct_mapping(node, deep)
        return mapping


def _whole(_: _Loader, node: yaml.ScalarNode) -> int:
    if not _PLAIN.fullmatch(node.value):
        raise _doubt(f"{brief(node.value)!r} is no plain whole number", node)
    return int(node.value)


def _decimal(loader: _Loader, node: yaml.ScalarNode) -> float:
    if _CLOCK.fullmatch(node.value) or "_" in node.value:
        raise _doubt(f"{brief(node.value)!r} is no plain number", node)
    return float(loader.construct_yaml_float(node))


def _doubt(what: str, node: yaml.Node) -> yaml.constructor.ConstructorError:
    return yaml.constructor.ConstructorError(None, None, what, node.start_mark)


_Loader.add_constructor("tag:yaml.org,2002:int", _whole)
_Loader.add_constructor("tag:yaml.org,2002:float", _decimal)


def sniff(head: bytes, name: str) -> bool:
    """Whether a file is one, by its first bytes and its name."""
    return name.lower().endswith((".yaml", ".yml")) or bool(_FIRST_KEY.match(head))


def read(path: Path) -> Recording:
    """Read a robot's log; records count from 1.

    Raises
    ------
    ReadingsError
        If it is not YAML, does not have the shape above, has a key twice, or a number that YAML
        reads as octal or by the clock. A record that does not have the shape is refused instead.
    """
    document = _yaml(read_text(path, ReadingsError), path.name)
    depth_m = _depths(document.get("names"), path.name)
    entries = document.get("data")
    if not isinstance(entries, list):
        raise ReadingsError("it has no list 'data'", where=path.name, remedy="export it again")
    records: list[Record] = []
    findings: list[Finding] = []
    for row, entry in enumerate(entries, 1):
        try:
            records.append(_record(row, entry, depth_m))
        except ValueError as error:
            findings.append(unusable(error, path.name, row))
    return Recording(tuple(records), tuple(findings), "lonlat", "kpa", instrument=NAME)


def _yaml(text: str, file: str) -> dict[str, Any]:
    try:
        document = yaml.load(text, Loader=_Loader)
    except (yaml.YAMLError, RecursionError, ValueError) as error:
        mark = getattr(error, "problem_mark", None)
        problem = getattr(error, "problem", None) or "it is nested too deeply"
        raise ReadingsError(
            f"this is not YAML as a robot writes it: {brief(problem, 200)}",
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
        depth_m = np.array(
            [depth_of(name if isinstance(name, str) else _shown(name)) for name in names]
        )
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
    kpa = [_strength(value, f"{depth:g} m") for value, depth in zip(values, depth_m, strict=True)]
    x, y = _finite(position.get("lon"), "lon"), _finite(position.get("lat"), "lat")
    return Record(row, x, y, depth_m, np.where(np.array(kpa) == 0, np.nan, kpa))


def _is_nan(value: Any) -> bool:
    return isinstance(value, float) and math.isnan(value)


def _strength(value: Any, place: str) -> float:
    """Number of a depth, NaN where none was read."""
    missing = value is None or _is_nan(value) or (isinstance(value, str) and is_missing(value))
    return math.nan if missing else _finite(value, place)


def _finite(value: Any, place: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise ValueError(f"{_shown(value)} at {place} is not a number")
    return float(value)


def _shown(value: Any) -> str:
    """Value in a message, which a list within lists would never end."""
    if isinstance(value, list | dict | set | tuple):
        return f"a {type(value).__name__}"
    return brief(repr(value))
