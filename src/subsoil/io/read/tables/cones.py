"""Cones in a column of a table."""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import cache

from subsoil.errors import ParameterError
from subsoil.io.read.tables.vocabulary import plain
from subsoil.penetrometer import LARGE_CONE, SMALL_CONE, Cone

_BY_NAME = {"1/2": SMALL_CONE, "0.5": SMALL_CONE, "3/4": LARGE_CONE, "0.75": LARGE_CONE}
_INCHES = re.compile(r"(1/2|3/4|0\.5|0\.75) ?(?:in|inch|\"|'')?")
_AREA = re.compile(r"(\d+(?:[.,]\d+)?) ?(mm\^?2|cm\^?2)?")


def cones_of(texts: Sequence[str], heading: str) -> list[Cone | None]:
    """Cones of rows, ``None`` where a cell names none.

    Examples
    --------
    >>> [cone and cone.area_mm2 for cone in cones_of(["1/2 inch", "3.23 cm2", "-"], "cone")]
    [130.0, 323.0, None]
    """
    found = re.search(r"(mm|cm)\^?2", plain(heading))
    unit = found[1] + "2" if found else ""
    return [_cone(text, unit) for text in texts]


@cache
def _cone(text: str, unit: str) -> Cone | None:
    words = plain(text)
    if not unit and (inches := _INCHES.fullmatch(words)):
        return _BY_NAME[inches[1]]
    area = _AREA.fullmatch(words)
    unit = (area[2] or "").replace("^", "") or unit if area else ""
    if area is None or not unit:
        return None
    try:
        return Cone(float(area[1].replace(",", ".")) * (100.0 if unit == "cm2" else 1.0))
    except ParameterError:
        return None
