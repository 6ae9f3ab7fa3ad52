"""Places of pushes from a second file, where the instrument has none: by number, or by time.

GPX is read with Python's own parser, and a file that declares entities is refused: GDAL would read
GPX too, but it takes any text for what its content says, and is not needed for so little.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime

import numpy as np

from subsoil.arrays import Floats
from subsoil.errors import ReadingsError, listed
from subsoil.findings import Finding
from subsoil.io.read.recording import Frame, Record, Recording

TOLERANCE_S = 30.0
"""Seconds within which a push and a position are of one time."""
_SAME_S, _SAME_M = 1.0, 10.0
"""Positions that are as near in time and further apart in space leave it open where a push was."""
_METRES_A_DEGREE = 111_320.0
_HALF_HOURS = range(-28, 29)


@dataclass(frozen=True)
class Positions:
    """Positions as their file gives them.

    Attributes
    ----------
    file
        Its name.
    frame, crs
        As in :class:`~subsoil.io.read.recording.Recording`.
    x, y
        (n,) longitude and latitude in degrees, or easting and northing in m.
    numbers
        What each is called; empty if nothing.
    times
        When each was taken; ``None`` if the file does not say.
    findings
        What was left out of the file.
    """

    file: str
    frame: Frame
    x: Floats
    y: Floats
    numbers: Sequence[str]
    times: Sequence[datetime | None]
    crs: str = ""
    findings: tuple[Finding, ...] = ()


def located(recording: Recording, positions: Positions | None, file: str) -> Recording:
    """Recording of those records that have a place, their own or by the positions.

    Positions are joined by the number of the push where any number is in both files, else by
    time, the nearest within :data:`TOLERANCE_S`. A push without a position, or with several that
    differ, is left out and named.

    Raises
    ------
    ReadingsError
        If no record has a place, or the two files cannot be joined.
    """
    lacking = [each for each in recording.records if not _placed(each)]
    own = [each for each in recording.records if _placed(each)]
    if positions is None:
        return _without(recording, own, lacking, file)
    if not lacking:
        unused = Finding("every push has a position of its own", "not used", file=positions.file)
        return replace(recording, findings=(*recording.findings, unused))
    if own and (positions.frame, positions.crs) != (recording.frame, recording.crs):
        raise ReadingsError(
            "some pushes have positions of their own, in another frame",
            where=positions.file,
            remedy=f"give positions in the frame of {file}",
        )
    taken, findings = _joined(lacking, positions, file)
    findings += _spare(recording.records, positions)
    if not (taken or own):
        raise ReadingsError(
            f"none of {len(lacking)} pushes gets a position from {positions.file}; {findings[0]}",
            where=file,
            remedy="give both files the same numbers, or times of the same clock",
        )
    places = {id(record): k for record, k in taken}
    moved = (
        replace(
            each, x=float(positions.x[places[id(each)]]), y=float(positions.y[places[id(each)]])
        )
        if id(each) in places
        else each
        for each in recording.records
    )
    return replace(
        recording,
        records=tuple(each for each in moved if _placed(each)),
        findings=(*recording.findings, *positions.findings, *findings),
        frame=positions.frame,
        crs=positions.crs or recording.crs,
    )


def _placed(record: Record) -> bool:
    return math.isfinite(record.x) and math.isfinite(record.y)


def _without(
    recording: Recording, own: Sequence[Record], lacking: Sequence[Record], file: str
) -> Recording:
    """Recording without the records that have no place."""
    if lacking and not own:
        raise ReadingsError(
            f"none of {len(lacking)} pushes has a position",
            where=file,
            remedy="give --positions FILE (CSV, GPX or points) with the number or time of each",
        )
    findings = (
        Finding("no position", "left out, or give --positions", "left out", file, each.row)
        for each in lacking
    )
    return replace(recording, records=tuple(own), findings=(*recording.findings, *findings))


Taken = list[tuple[Record, int]]
"""Records, and which position each takes."""


def _joined(
    records: Sequence[Record], positions: Positions, file: str
) -> tuple[Taken, list[Finding]]:
    named: dict[str, list[int]] = {}
    for k, number in enumerate(positions.numbers):
        if number:
            named.setdefault(_key(number), []).append(k)
    if any(_key(each.number) in named for each in records):
        matches: Mapping[int, list[int]] = {
            id(each): named.get(_key(each.number), []) for each in records
        }
        how = "its number"
    elif any(each.time for each in records) and any(positions.times):
        matches = _by_time(records, positions)
        how = f"a time within {TOLERANCE_S:g} s of it"
    else:
        raise ReadingsError(
            "it has neither the number nor the time of any push",
            where=positions.file,
            remedy=f"number positions as {file} does, first "
            + listed([each.number or "without a number" for each in records], 3),
        )
    taken: Taken = []
    findings: list[Finding] = []
    for each in records:
        fault = _fault(matches[id(each)], positions, how)
        if fault:
            seen = f"push {each.number or 'without a number'}: {fault}"
            findings.append(Finding(seen, "left out", "left out", file, each.row))
        else:
            taken.append((each, matches[id(each)][0]))
    return taken, [*findings, *_shared(taken, file)]


def _key(number: str) -> str:
    """Number of a push for comparing: 007 and 7 are one."""
    number = number.strip().casefold()
    return str(int(number)) if number.isdecimal() else number


def _fault(matches: Sequence[int], positions: Positions, how: str) -> str:
    """Why a push gets no position; empty if it does."""
    if not matches:
        return f"{positions.file} has no position with {how}"
    if any(_metres(positions, matches[0], k) > _SAME_M for k in matches[1:]):
        return f"{positions.file} has {len(matches)} positions with {how}, not at one place"
    return ""


def _metres(positions: Positions, one: int, other: int) -> float:
    dx, dy = positions.x[one] - positions.x[other], positions.y[one] - positions.y[other]
    if positions.frame != "lonlat":
        return float(np.hypot(dx, dy))
    narrower = np.cos(np.radians(positions.y[one]))
    return float(np.hypot(dx * narrower, dy) * _METRES_A_DEGREE)


def _by_time(records: Sequence[Record], positions: Positions) -> Mapping[int, list[int]]:
    """Positions nearest in time to each record, by its identity; none beyond the tolerance."""
    index = np.array([k for k, time in enumerate(positions.times) if time])
    there = np.array([_seconds(time) for time in positions.times if time])
    order = np.argsort(there, kind="stable")
    index, there = index[order], there[order]
    timed = [each for each in records if each.time]
    here = np.array([_seconds(each.time) for each in timed if each.time])
    _check_clocks(here, there, positions.file)
    matches: dict[int, list[int]] = {id(each): [] for each in records}
    for each, second in zip(timed, here, strict=True):
        away = np.abs(there - second)
        nearest = float(away.min())
        if nearest <= TOLERANCE_S:
            near = np.flatnonzero(away <= nearest + _SAME_S)
            matches[id(each)] = index[near[np.argsort(away[near], kind="stable")]].tolist()
    return matches


def _check_clocks(here: Floats, there: Floats, file: str) -> None:
    """Refuse times that fit only when one clock is put forward or back."""

    def fitting(shift: float) -> int:
        after = np.clip(np.searchsorted(there, here + shift), 1, max(there.size - 1, 1))
        ends = np.stack([there[after - 1], there[np.minimum(after, there.size - 1)]])
        return int((np.abs(ends - here - shift).min(axis=0) <= TOLERANCE_S).sum())

    best = max(_HALF_HOURS, key=lambda half: (fitting(half * 1800.0), -abs(half)))
    if best and not fitting(0.0):
        hours = best / 2
        raise ReadingsError(
            f"no push is within {TOLERANCE_S:g} s of a position, but {fitting(best * 1800.0)} of "
            f"{here.size} are if the instrument's clock is put {abs(hours):g} h "
            f"{'forward' if hours > 0 else 'back'}",
            where=file,
            remedy="bring the times of the two files to one time zone",
        )


def _seconds(time: datetime) -> float:
    """Seconds of a time; one without a zone is taken for universal time."""
    return (time if time.tzinfo else time.replace(tzinfo=UTC)).timestamp()


def _shared(taken: Taken, file: str) -> Iterator[Finding]:
    """Findings about pushes that take one and the same position."""
    counts = Counter(k for _, k in taken)
    for k, count in counts.items():
        if count > 1:
            rows = [record.row for record, other in taken if other == k]
            seen = f"{count} pushes take one position: rows {listed([str(row) for row in rows])}"
            yield Finding(seen, "check their numbers or times", "doubt", file, rows[0])


def _spare(records: Sequence[Record], positions: Positions) -> Iterator[Finding]:
    """A note on positions with a number that no push has, where others have one."""
    known = {_key(record.number) for record in records}
    numbers = [number for number in positions.numbers if number]
    spare = [number for number in numbers if _key(number) not in known]
    if spare and len(spare) < len(numbers):
        seen = f"{len(spare)} positions are of no push: {listed(spare)}"
        yield Finding(seen, "not used", file=positions.file)
