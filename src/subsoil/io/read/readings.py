"""Readings of instruments and robots: where, how hard by depth, and what was left out and why.

A file that cannot be used at all is an error. A row that cannot be used is a finding, and the
others are used: nothing is dropped in silence, and nothing is mended by guessing.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from importlib.metadata import entry_points
from pathlib import Path

import numpy as np

from subsoil.arrays import Bools, Floats, Integers
from subsoil.errors import ReadingsError
from subsoil.findings import Finding, left_out
from subsoil.io.read.instruments import INSTRUMENTS, Reader
from subsoil.io.read.joining import located
from subsoil.io.read.missing import without_codes
from subsoil.io.read.places import Places
from subsoil.io.read.plausible import doubts, stray
from subsoil.io.read.position_files import read_positions
from subsoil.io.read.recording import Recording, kpa_per_unit
from subsoil.io.read.screening import Push, screened
from subsoil.io.read.strays import FENCE_M, at_field, elsewhere, strays
from subsoil.io.read.tables.sheet import NO_MEANINGS, Meanings
from subsoil.io.read.tables.tables import SHEETS, read_sheets
from subsoil.io.read.text import check_file
from subsoil.land.field import Field
from subsoil.penetrometer import Cone
from subsoil.readings import Readings, extent_of
from subsoil.registry import Registry, handed_over

Read = Callable[[Path], Recording]

READERS: dict[str, Reader] = {
    **INSTRUMENTS,
    **{
        name: Reader(kind.name, kind.sniff, partial(read_sheets, kind))
        for name, kind in SHEETS.items()
    },
}
"""In the order in which they are asked whether a file is theirs."""
READER_POINTS = "subsoil.readers"
"""Entry points at which installed packages offer a :class:`Reader`; these are asked first."""

_REGISTRY: Registry[Read] = Registry("reader", READER_POINTS, READERS)
_HEAD = 4096


def read_readings(
    path: str | Path,
    *,
    field: Field | None = None,
    crs: str | None = None,
    cone: Cone | None = None,
    units: str | None = None,
    reader: str | Read = "",
    meanings: Meanings = NO_MEANINGS,
    positions: str | Path | None = None,
    fence_m: float = FENCE_M,
) -> Readings:
    """Read readings from an instrument's file or a table.

    Zeros, blanks and codes such as NA and -999 at the end of a profile mean that the depth was
    not reached. With readings below it, such a depth is left out, and the findings name it.

    Parameters
    ----------
    path
        File, told apart by its content (:data:`READERS`).
    field
        Field they belong to: sets the frame, and what lies outside its fence is left out.
        Without one, longitude and latitude go to the UTM zone of their median.
    crs
        Frame of easting and northing in the file, if not the field's.
    cone
        Cone that was used, where the file holds force.
    units
        Unit of pressure or force, where the file does not say.
    reader
        Where the content does not tell: name of one of :data:`READERS`, ``module:attribute``, or
        a function from a path to a :class:`~subsoil.io.read.recording.Recording`.
    meanings
        What headings of a table mean, where they do not say: ``{"pen1": "kpa at 10 cm"}``.
    positions
        File with the places of pushes by number or time, where the instrument has none.
    fence_m
        Distance in m from the field up to which a reading is used, where it was taken.

    Raises
    ------
    ReadingsError
        If the file is missing, unreadable or without a usable reading, its units are unknown, or
        more than half of the readings lie outside the field.
    ParameterError
        If the file is in longitude and latitude and the field in a local frame.
    BoundaryError
        If the CRS is unknown or cannot be brought to the field's.
    """
    path = Path(path)
    beside = read_positions(positions) if positions is not None else None
    recording = _recording(path, reader, meanings, units or "", placed=beside is not None)
    recording = located(recording, beside, path.name)
    factor = kpa_per_unit(recording.unit, units, cone, path.name)
    pushes, findings = _usable(recording, factor, path.name)
    rows = np.array([push.record.row for push in pushes], dtype=np.int64)
    places, source = _places(pushes, recording, path.name), crs or recording.crs or None
    at, home = places.metres(field, source)
    inside, astray = _kept(at, rows, places, source, field, fence_m)
    kept = [push for push, here in zip(pushes, inside, strict=True) if here]
    findings += (*places.findings(field, source), *astray)
    findings += doubts(kept, at[inside], recording.frame, cone, path.name)
    return Readings(
        at[inside],
        tuple(push.profile for push in kept),
        extent_of(at[inside]) if field is None else field.extent_m,
        rows[inside],
        home,
        str(path),
        (*(field.findings if field else ()), *sorted(findings, key=lambda f: f.row)),
        numbers=tuple(push.record.number for push in kept),
        times=tuple(push.record.time for push in kept),
        instrument=recording.instrument,
    )


def _recording(
    path: Path, reader: str | Read, meanings: Meanings, unit: str, *, placed: bool
) -> Recording:
    check_file(path, ReadingsError)
    name, read = _chosen(path, reader)
    if name in SHEETS:
        return read_sheets(SHEETS[name], path, meanings, unit=unit, placed=placed)
    if meanings:
        raise ReadingsError(
            "it is no table, and has no headings to map", where=path.name, remedy="leave --map out"
        )
    return read(path)


def _chosen(path: Path, reader: str | Read) -> tuple[str, Read]:
    """Name of a reader, if it has one, and how it reads: that asked for, or the file's own."""
    if reader:
        named = reader if isinstance(reader, str) else ""
        return named, _REGISTRY.named(*handed_over(reader))
    with path.open("rb") as file:
        head = file.read(_HEAD)
    for name, each in (*(("", each) for each in _installed()), *READERS.items()):
        if each.sniff(head, path.name):
            return name, each.read
    raise ReadingsError(
        "nothing here reads it as readings",
        where=path.name,
        remedy=f"save it as CSV, or name one of the readers {', '.join(READERS)}",
    )


def _installed() -> Iterator[Reader]:
    """Readers of installed packages."""
    found = (point.load() for point in entry_points(group=READER_POINTS))
    return (each for each in found if isinstance(each, Reader))


def _usable(
    recording: Recording, kpa_per_unit: float, file: str
) -> tuple[tuple[Push, ...], tuple[Finding, ...]]:
    """Pushes of a recording that can be used, one at least, and all findings so far."""
    records, codes = without_codes(recording.records, file)
    pushes, unfit = screened(records, kpa_per_unit, recording.frame, file)
    findings = (*recording.findings, *codes, *unfit)
    if not pushes:
        raise _none_usable(left_out(findings), file)
    return pushes, findings


def _places(pushes: Sequence[Push], recording: Recording, file: str) -> Places:
    x = np.array([push.record.x for push in pushes])
    y = np.array([push.record.y for push in pushes])
    return Places(x, y, recording.frame == "lonlat", file)


def _kept(
    at: Floats,
    rows: Integers,
    places: Places,
    crs: str | None,
    field: Field | None,
    fence_m: float,
) -> tuple[Bools, tuple[Finding, ...]]:
    """Which of (n, 2) places in m are used, and what is to be said of the others."""
    if field is None:
        far = stray(at, rows, places.file)
        return ~np.isin(rows, [finding.row for finding in left_out(far)]), tuple(far)
    inside = at_field(at, field, fence_m)
    if 2 * inside.sum() < inside.size:
        raise elsewhere(places, field, at, crs)
    return inside, strays(rows, at, field, fence_m, places.file)


def _none_usable(refused: Sequence[Finding], file: str) -> ReadingsError:
    if not refused:
        return ReadingsError("it holds no readings", where=file, remedy="export it again")
    return ReadingsError(
        f"none of {len(refused)} readings can be used; {min(refused, key=lambda f: f.row)}",
        where=file,
        remedy="correct the rows, or export it again",
    )
