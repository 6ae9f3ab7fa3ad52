"""What one heading of a table of readings means: a place, a depth, strength at a depth, a time.

A heading that means none of them is left alone, such as ``vwc_10cm``. One that seems to mean
strength at a depth and cannot be read, such as ``kpa_1Ocm``, is unclear, and stops the file:
without that column the layers would be taken from other depths.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Literal

from subsoil.errors import brief
from subsoil.io.read.recording import METRES
from subsoil.io.read.tables.vocabulary import (
    BOTTOMS,
    DEPTHS,
    FILLERS,
    LENGTH,
    SOIL,
    TOPS,
    UNIT,
    UNIT_WORDS,
    UNKNOWN_UNITS,
    half_named,
    length_named,
    names_cone,
    names_number,
    names_time,
    place_named,
    plain,
    unit_named,
    words_of,
)
from subsoil.penetrometer import DEEPEST_M

Kind = Literal[
    "latitude", "longitude", "easting", "northing", "x", "y", "north or south", "east or west",
    "number", "time", "cone", "unit", "depth", "top", "strength", "layer", "unclear", "bare",
    "ignore", "other",
]  # fmt: skip

_NUMBER = r"\d+(?:[.,p]\d+)?"
_INTERVAL = re.compile(
    rf"(?<![\d.,])(?P<minus>(?<![a-z0-9])-)?(?P<top>{_NUMBER}) ?(?:{LENGTH})? ?"
    rf"(?:-|/|\.\.|to|bis|a|hasta) ?-?(?P<depth>{_NUMBER}) ?-?(?P<length>{LENGTH})"
)
_SINGLE = re.compile(
    rf"(?<![\d.,])(?P<minus>(?<![a-z0-9])-)?(?P<depth>{_NUMBER})[ .-]?(?P<length>{LENGTH})"
    rf"|(?<![a-z])(?P<length_first>mm|cm) ?(?P<depth_last>{_NUMBER})(?![\d.,])"
)
_LETTER_FOR_DIGIT = re.compile(r"(?<=\d)o|o(?=\d)|(?<=\d)l|l(?=\d)|(?<![a-z])[ol](?=[ol]\d)")
_ENDS_IN_LENGTH = re.compile(r"(mm|cm)(?![a-z0-9])")
_BARE = re.compile(rf"x?({_NUMBER})")


@dataclass(frozen=True)
class Meaning:
    """What a heading means.

    Attributes
    ----------
    kind
        Its kind: strength in a ``layer`` of soil, tidy ``depth``, ``top`` and ``strength``, a
        ``bare`` number that may be a depth, or another.
    unit
        Unit of strength, or of depth for tidy depths; empty if it does not say.
    depth_m
        Depth in m; the number itself where that is bare.
    top_m
        Top of an interval in m; NaN where it stands for the soil since the depth above.
    above
        Whether the depth has a minus, as some write depths below ground.
    """

    kind: Kind
    unit: str = ""
    depth_m: float = math.nan
    top_m: float = math.nan
    above: bool = False


OTHER = Meaning("other")


def meaning_of(heading: str) -> Meaning:
    """What a heading means, as far as it says so itself.

    Raises
    ------
    ValueError
        If it names a depth beyond 3 m, or one whose top lies below its bottom.

    Examples
    --------
    >>> meaning_of("10 cm (kPa)")
    Meaning(kind='layer', unit='kpa', depth_m=0.1, top_m=nan, above=False)
    >>> meaning_of("Länge (°)").kind, meaning_of("kpa_1Ocm").kind, meaning_of("vwc_10cm").kind
    ('longitude', 'unclear', 'other')
    """
    text = plain(heading)
    if names_number(text):
        return Meaning("number")
    for kind in (place_named(text), half_named(text)):
        if kind:
            return Meaning(kind)  # type: ignore[arg-type]
    if names_time(text):
        return Meaning("time")
    if set(words_of(text)) and set(words_of(text)) <= UNIT_WORDS:
        return Meaning("unit")
    if names_cone(text):
        return Meaning("cone")
    return _layer(text) or _tidy(text) or OTHER


def _layer(text: str) -> Meaning | None:
    """Meaning of a heading of strength at a depth, or that looks like one."""
    unit = UNIT.search(text)
    rest = without(unit, text)
    if bare := _BARE.fullmatch(rest):
        return Meaning("unclear" if unit else "bare", "", _number(bare[1]))
    found = _INTERVAL.search(rest) or _SINGLE.search(rest)
    words = set(words_of(rest.replace(found[0], " ", 1) if found else rest))
    if found and words <= (SOIL | FILLERS) - UNKNOWN_UNITS:
        return _at(found, unit_named(unit) if unit else "")
    return Meaning("unclear") if _looks_like_layer(rest, bool(unit), words) else None


def _looks_like_layer(rest: str, unit: bool, words: set[str]) -> bool:
    mended = _LETTER_FOR_DIGIT.sub("0", rest)
    digits = any(c.isdigit() for c in mended)
    if unit:
        return digits or bool(_ENDS_IN_LENGTH.search(mended))
    left = {word for word in words if not length_named(word) and not word.isdigit()}
    if words & SOIL:
        return digits and (bool(_SINGLE.search(mended)) or left <= SOIL | FILLERS)
    found = _SINGLE.search(mended)
    return found is not None and set(words_of(mended.replace(found[0], " ", 1))) <= FILLERS


def _at(found: re.Match[str], unit: str) -> Meaning:
    parts = found.groupdict()
    length = length_named(parts["length"] or parts.get("length_first") or "")
    depth = in_metres(_number(parts["depth"] or parts.get("depth_last") or ""), length, found[0])
    top = in_metres(_number(parts["top"]), length, found[0]) if parts.get("top") else math.nan
    if top >= depth:
        raise ValueError(f"the top of {brief(found[0])!r} is not above its bottom")
    return Meaning("layer", unit, depth, top, bool(parts["minus"]))


def in_metres(number: float, length: str, said: str) -> float:
    """Depth in m of a number of some unit.

    Raises
    ------
    ValueError
        If it is deeper than 3 m.
    """
    depth = round(number * METRES[length], 6)
    if depth > DEEPEST_M:
        raise ValueError(f"{brief(said)!r} is deeper than 3 m")
    return depth


def _tidy(text: str) -> Meaning | None:
    """Meaning of a heading of depths, or of strength at the depth that another column says."""
    words = words_of(text)
    lengths = [found for word in words if (found := length_named(word))]
    lengths = [each for each in lengths if each != "in"] or lengths
    length = lengths[0] if lengths else ""
    left = {word for word in words if not length_named(word) and not word.isdigit()}
    about = {"soil", "of", "below", "surface", "measurement", "reading", "boden", "sol", "suelo"}
    if left & (DEPTHS | TOPS | BOTTOMS) and left <= DEPTHS | TOPS | BOTTOMS | about:
        if not left & DEPTHS and not length:
            return None
        return Meaning("top" if left & TOPS else "depth", length)
    unit = UNIT.search(text)
    left = set(words_of(without(unit, text)))
    fitting = left <= (SOIL | {"soil", "value", "of"}) - UNKNOWN_UNITS
    if fitting and (unit or left & SOIL - {"index", "cone", "load"} or {"cone", "index"} <= left):
        return Meaning("strength", unit_named(unit) if unit else "")
    return None


def without(unit: re.Match[str] | None, text: str) -> str:
    """Plain text without its unit of strength, and without a hyphen after words."""
    rest = f"{text[: unit.start()]} {text[unit.end() :].removeprefix('-')}" if unit else text
    return re.sub(r"(?<=[a-z])-(?=\d)", " ", rest).strip()


def _number(text: str) -> float:
    return float(text.replace("p", ".").replace(",", "."))
