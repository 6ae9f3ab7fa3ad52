"""Longitudes and latitudes as instruments write them."""

from __future__ import annotations

import math
import re

from subsoil.errors import brief

_NUMBER = r"\d+(?:[.,]\d*)?"
_COORDINATE = re.compile(
    rf"(?P<before>[NSEW])?\s*(?P<sign>[-+]?)(?P<first>{_NUMBER})"
    rf"(?:[\s°]+(?P<minutes>{_NUMBER})['′]?)?[\s°]*(?P<after>[NSEW])?",
    re.IGNORECASE,
)
_TOGETHER = 4
"""Digits before the point from which on degrees and minutes stand together: 5205.7636."""


def degrees(text: str) -> float:
    """Degrees of a coordinate, NaN if it is blank.

    Decimal degrees, degrees and minutes, or both together as receivers send them, ``DDMM.mmmm``;
    a letter of the hemisphere before or after. Minutes without a letter are refused.

    Raises
    ------
    ValueError
        If it is anything else.

    Examples
    --------
    >>> degrees("-93.65"), degrees("N52 46.015"), degrees("5246.0150 N"), degrees("00030.0000W")
    (-93.65, 52.7669167, 52.7669167, -0.5)
    """
    text = text.strip()
    if not text:
        return math.nan
    found = _COORDINATE.fullmatch(text)
    letters = [found[k].upper() for k in ("before", "after") if found[k]] if found else []
    if not found or len(letters) > 1 or (letters and found["sign"]):
        raise ValueError(f"{brief(text)!r} is no latitude or longitude")
    whole = re.split("[.,]", found["first"])[0]
    value = float(found["first"].replace(",", "."))
    minutes = float((found["minutes"] or "0").replace(",", "."))
    together = len(whole) >= _TOGETHER and not found["minutes"]
    if together:
        value, minutes = divmod(value, 100)
    if minutes >= 60 or ((together or found["minutes"]) and not letters):
        raise ValueError(f"{brief(text)!r} is no latitude or longitude: degrees, minutes, N or E")
    negative = found["sign"] == "-" or letters in (["S"], ["W"])
    return (-1 if negative else 1) * round(value + minutes / 60, 7)
