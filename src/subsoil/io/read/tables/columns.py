"""What the columns of a table of readings are, by its heading and by what its owner says."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from subsoil.arrays import Floats
from subsoil.errors import ReadingsError, brief, listed
from subsoil.io.read.tables.headings import OTHER, Kind, Meaning, in_metres, meaning_of
from subsoil.io.read.tables.sheet import NO_MEANINGS, Meanings
from subsoil.io.read.tables.vocabulary import LENGTH, UNIT, length_named, plain, unit_named

MAP = "--map 'heading=meaning'"
_EXAMPLES = (
    "latitude, longitude, easting, northing, number, time, depth cm, kpa, kpa at 10 cm, "
    "kpa 10-20 cm, ignore"
)
_SAYABLE: tuple[Kind, ...] = (
    "latitude", "longitude", "easting", "northing", "x", "y", "north or south", "east or west",
    "number", "time", "cone", "unit", "depth", "top", "ignore",
)  # fmt: skip
_RANGE = re.compile(r"(\d+(?:\.\d+)?) *\.\. *(\d+(?:\.\d+)?)")
_STEP = re.compile(rf"(\d+(?:\.\d+)?)? ?({LENGTH})")
_PAIRS: tuple[tuple[Kind, Kind], ...] = (
    ("longitude", "latitude"), ("easting", "northing"), ("x", "y"),
)  # fmt: skip
_TOUCH_M = 1e-9


@dataclass(frozen=True)
class Columns:
    """What a heading says.

    Attributes
    ----------
    names
        All headings.
    meanings
        What each of them means.
    place
        Columns of longitude and latitude, easting and northing, or x and y; none if the place
        comes from elsewhere.
    kind
        ``"longitude"``, ``"easting"`` or ``"x"``: what the first of them is.
    layers
        Columns of strength in layers, shallowest first; none in a tidy table.
    depth_m, top_m
        (k,) bottoms and tops in m of the soil that they stand for.
    unit
        Unit of strength; empty if no heading says.
    """

    names: tuple[str, ...]
    meanings: tuple[Meaning, ...]
    place: tuple[int, ...] = ()
    kind: str = ""
    layers: tuple[int, ...] = ()
    depth_m: Floats = field(default_factory=lambda: np.empty(0))
    top_m: Floats = field(default_factory=lambda: np.empty(0))
    unit: str = ""

    def of(self, kind: Kind) -> tuple[int, ...]:
        """Columns of a kind."""
        return tuple(k for k, meaning in enumerate(self.meanings) if meaning.kind == kind)

    def first(self, kind: Kind) -> int | None:
        """First column of a kind, if there is one."""
        return next(iter(self.of(kind)), None)


def columns_of(
    header: Sequence[str],
    where: str,
    meanings: Meanings = NO_MEANINGS,
    *,
    placed: bool = False,
) -> Columns:
    """Tell the columns of a table apart by their headings.

    Parameters
    ----------
    header
        The headings.
    where
        File and row of the header, for messages.
    meanings
        What their owner says that headings mean; these go before what they say themselves.
    placed
        Whether places come from elsewhere.

    Raises
    ------
    ReadingsError
        If no columns give the place or strength at a depth, one is there twice, units are mixed or
        unknown, or a heading looks like a depth and cannot be read. The message lists the headings.
    """
    names = tuple(" ".join(cell.split()) for cell in header)
    found = Columns(names, _meanings(names, where, meanings))
    place, kind = _place(found, where, placed)
    found = replace(found, place=place, kind=kind)
    _check_clear(found, where)
    if found.of("layer"):
        return _wide(found, where)
    return _tidy(found, where)


def seen(names: Sequence[str]) -> str:
    """Headings of a table, for messages about them."""
    return f"headings seen: {listed([name for name in names if name], 12) or 'none'}"


def _meanings(names: tuple[str, ...], where: str, said: Meanings) -> tuple[Meaning, ...]:
    found = []
    for name in names:
        try:
            found.append(meaning_of(name) if name else OTHER)
        except ValueError as error:
            if plain(name) not in {plain(key) for key in said}:
                raise ReadingsError(
                    str(error),
                    where=f"{where}, column {brief(name)}",
                    remedy=f"correct it, or {MAP}",
                ) from error
            found.append(OTHER)
    for key, meaning in said.items():
        columns = [k for k, name in enumerate(names) if plain(name) == plain(key)]
        numbers = _RANGE.fullmatch(key.strip())
        if numbers and not columns:
            columns = [k for k, each in enumerate(found) if _between(each, numbers)]
        if not columns:
            raise ReadingsError(
                f"no heading is {brief(key)!r}; {seen(names)}", where=where, remedy="check --map"
            )
        for k in columns:
            found[k] = _said(meaning, found[k], where)
    sayings = {plain(key) for key in said}
    told = {found[k].kind for k, name in enumerate(names) if plain(name) in sayings}
    return tuple(
        OTHER if each.kind in told and plain(name) not in sayings and _single(each) else each
        for each, name in zip(found, names, strict=True)
    )


def _single(meaning: Meaning) -> bool:
    """Whether a table has at most one column of a kind."""
    return meaning.kind not in ("layer", "number", "time", "other", "bare", "unclear")


def _between(meaning: Meaning, numbers: re.Match[str]) -> bool:
    return meaning.kind == "bare" and float(numbers[1]) <= meaning.depth_m <= float(numbers[2])


def _said(text: str, before: Meaning, where: str) -> Meaning:
    """What a heading means by its owner; numbers alone take a unit of depth, or a step."""
    words = plain(text)
    for kind in _SAYABLE:
        if words == kind:
            return Meaning(kind)
    unit = UNIT.search(words)
    rest = f"{words[: unit.start()]} {words[unit.end() :]}" if unit else words
    step = _STEP.fullmatch(rest.removeprefix("at ").strip())
    try:
        if before.kind == "bare" and step:
            number = before.depth_m * float(step[1] or 1)
            depth = in_metres(number, length_named(step[2]), f"{number:g} {step[2]}")
            return Meaning("layer", unit_named(unit) if unit else "", depth)
        found = meaning_of(text)
    except ValueError as error:
        raise ReadingsError(str(error), where=where, remedy="check --map") from error
    if found.kind in ("other", "unclear", "bare"):
        raise ReadingsError(
            f"nothing is meant by {brief(text)!r}", where=where, remedy=f"{MAP}: {_EXAMPLES}"
        )
    return found


def _place(columns: Columns, where: str, placed: bool) -> tuple[tuple[int, ...], str]:
    for x, y in _PAIRS:
        pair = columns.of(x), columns.of(y)
        if all(pair) and not placed:
            if len(pair[0]) > 1 or len(pair[1]) > 1:
                raise ReadingsError(
                    f"two columns hold the same coordinate; {seen(columns.names)}",
                    where=where,
                    remedy=f"keep one, or {MAP} with the meaning ignore",
                )
            return (pair[0][0], pair[1][0]), x
    if placed:
        return (), ""
    raise ReadingsError(
        f"no columns say where the readings were taken; {seen(columns.names)}",
        where=where,
        remedy="start the table with a header that has lat,lon or easting,northing, or name them: "
        "--map 'heading=latitude'",
    )


def _check_clear(columns: Columns, where: str) -> None:
    unread = [columns.names[k] for k in (*columns.of("unclear"), *columns.of("bare"))]
    if unread:
        raise ReadingsError(
            f"{'columns' if len(unread) > 1 else 'column'} {listed(unread)} "
            f"{'look' if len(unread) > 1 else 'looks'} like a depth and cannot be read",
            where=where,
            remedy="name depth columns like kpa_10cm, or say what is meant: --map "
            f"'{brief(unread[0])}=kpa at 10 cm' or '{brief(unread[0])}=ignore', for numbers alone "
            "--map '1..80=cm'",
        )


def _wide(columns: Columns, where: str) -> Columns:
    found = sorted((columns.meanings[k].depth_m, k) for k in columns.of("layer"))
    layers = tuple(k for _, k in found)
    meant = [columns.meanings[k] for k in layers]
    depth_m = np.array([meaning.depth_m for meaning in meant])
    below = [meaning.above for meaning in meant if meaning.depth_m > 0]
    if any(below) and not all(below):
        raise ReadingsError(
            "some depths have a minus and others do not", where=where, remedy="write all alike"
        )
    above = np.concatenate([[0.0], depth_m[:-1]])
    tops = np.array([meaning.top_m for meaning in meant])
    top_m = np.where(np.isnan(tops), above, tops)
    twice = np.flatnonzero(top_m[1:] < depth_m[:-1] - _TOUCH_M)
    twice = np.append(twice, np.flatnonzero(np.diff(depth_m) == 0))
    if twice.size:
        both = listed([columns.names[k] for k in layers[twice[0] : twice[0] + 2]])
        raise ReadingsError(
            f"two columns have the same depth: {both}",
            where=where,
            remedy=f"drop one, or {MAP} with the meaning ignore",
        )
    unit = _one_unit([meaning.unit for meaning in meant], where)
    return replace(columns, layers=layers, depth_m=depth_m, top_m=top_m, unit=unit)


def _one_unit(units: Sequence[str], where: str) -> str:
    different = sorted(set(units))
    if len(different) > 1:
        raise ReadingsError(
            f"columns mix the units {', '.join(unit or 'none' for unit in different)}",
            where=where,
            remedy=f"use one unit for all depths, or {MAP} with the meaning ignore",
        )
    return different[0]


def _tidy(columns: Columns, where: str) -> Columns:
    depths, strengths = columns.of("depth"), columns.of("strength")
    if not (depths and strengths):
        missing = "no column names a depth" if not depths else "no column names the strength"
        raise ReadingsError(
            f"{missing}; {seen(columns.names)}",
            where=where,
            remedy="name depth columns like kpa_10cm, or a row a depth with depth_cm and kpa, "
            "or say what is meant: --map 'heading=kpa at 10 cm'",
        )
    for kind, found in (("depth", depths), ("strength", strengths)):
        if len(found) > 1:
            raise ReadingsError(
                f"columns {listed([columns.names[k] for k in found])} are both of {kind}",
                where=where,
                remedy=f"keep one, or {MAP} with the meaning ignore",
            )
    if not columns.meanings[depths[0]].unit:
        name = brief(columns.names[depths[0]])
        raise ReadingsError(
            f"column {name} does not say in which unit depths are",
            where=where,
            remedy=f"--map '{name}=depth cm'",
        )
    return replace(columns, unit=columns.meanings[strengths[0]].unit)
