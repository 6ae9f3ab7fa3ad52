"""Angles as receivers and people write them: minutes, seconds, hemispheres, NMEA."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from subsoil.arrays import Floats
from subsoil.errors import brief

_NUMBER = r"\d+(?:[.,]\d+)?"


def _written(degree: str, minute: str, second: str) -> re.Pattern[str]:
    """Pattern of an angle whose parts end in marks of one kind."""
    return re.compile(
        rf"(?P<first>[NSEWO])?\s*(?P<minus>[-+])?\s*(?P<degrees>{_NUMBER})\s*"
        rf"(?:(?P<mark>{degree})\s*(?:(?P<minutes>{_NUMBER})\s*(?:{minute})\s*"
        rf"(?:(?P<seconds>{_NUMBER})\s*(?:{second}))?)?)?\s*(?P<last>[NSEWO])?",
        re.IGNORECASE,
    )


_BY_SIGNS = _written(r"°|º|˚|:|\s|-", r"'|′|’|:|\s|-|", r"\"|″|”|''|’’|′′|")
_BY_LETTERS = _written(r"d|deg", r"m|min", r"s|sec")
_DECIMAL = set("0123456789.,+-")
_SOUTH_WEST = "SW"
NORTH_SOUTH, EAST_WEST = "NS", "EW"


def angles(texts: Sequence[str], halves: Sequence[str], axis: str) -> tuple[Floats, dict[int, str]]:
    """Angles in degrees of texts with hemispheres or minutes.

    Parameters
    ----------
    texts
        One angle each, such as ``"52°5.76358N"``, ``"N52 46.015"`` or NMEA's ``"5205.76358"``.
    halves
        Hemisphere of each, as a column of its own says it; blanks where the angle itself does.
    axis
        :data:`NORTH_SOUTH` or :data:`EAST_WEST`.

    Returns
    -------
    degrees, wrong
        (n,) degrees, NaN where a text is none; and why, by its position.

    Examples
    --------
    >>> angles(["52°30'N", "5230.0", "-1 30"], ["", "S", ""], "NS")[0].round(3).tolist()
    [52.5, -52.5, -1.5]
    """
    packed = _is_nmea(texts, halves, axis)
    found = np.full(len(texts), np.nan)
    wrong: dict[int, str] = {}
    for k, (text, half) in enumerate(zip(texts, halves, strict=True)):
        try:
            found[k] = _angle(text.strip(), half.strip().upper()[:1], axis, packed)
        except ValueError as error:
            wrong[k] = str(error)
    return found, wrong


def has_parts(texts: Sequence[str]) -> bool:
    """Whether any of the texts has minutes, or says its hemisphere."""
    if set().union(*texts) <= _DECIMAL:
        return False
    return any(
        any(match[part] for part in ("minutes", "first", "last", "mark"))
        for text in texts
        if (match := _match(text.strip()))
    )


def _match(text: str) -> re.Match[str] | None:
    return _BY_LETTERS.fullmatch(text) or _BY_SIGNS.fullmatch(text)


def _is_nmea(texts: Sequence[str], halves: Sequence[str], axis: str) -> bool:
    """Whether numbers are degrees times 100 and minutes, as a receiver says them.

    They have a hemisphere beside them and no parts, and go beyond what an angle can be or are
    filled up with zeros.
    """
    widest = 90 if axis == NORTH_SOUTH else 180
    for text, half in zip(texts, halves, strict=True):
        match = _match(text.strip())
        if (
            match is None
            or match["minutes"]
            or not (match["first"] or match["last"] or half.strip())
        ):
            continue
        whole = re.split("[.,]", match["degrees"])[0]
        if float(match["degrees"].replace(",", ".")) > widest or len(whole) >= 4:
            return True
    return False


def _angle(text: str, half: str, axis: str, packed: bool) -> float:
    match = _match(text)
    if not text:
        raise ValueError("a number is missing")
    if match is None:
        raise ValueError(f"{brief(text)!r} is not a number, nor an angle")
    sides = {side.upper() for side in (match["first"], match["last"], half) if side}
    if len(sides) > 1 or not sides <= set(axis):
        odd = ", ".join(sorted(sides - set(axis))) or ", ".join(sorted(sides))
        raise ValueError(f"{brief(text)!r}: hemisphere {odd} is not one of {axis[0]} and {axis[1]}")
    degrees, minutes, seconds = (
        float((match[part] or "0").replace(",", ".")) for part in ("degrees", "minutes", "seconds")
    )
    if packed and not match["minutes"]:
        degrees, minutes = divmod(degrees, 100)
    if minutes >= 60 or seconds >= 60:
        raise ValueError(f"{brief(text)!r} has 60 minutes or seconds, or more")
    if match["minus"] == "-" and sides:
        raise ValueError(f"{brief(text)!r} has a minus and a hemisphere")
    south_west = match["minus"] == "-" or sides & set(_SOUTH_WEST)
    return (-1 if south_west else 1) * (degrees + minutes / 60 + seconds / 3600)
