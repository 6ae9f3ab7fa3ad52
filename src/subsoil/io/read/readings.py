"""Readings of instruments and robots: where, how hard by depth, and what was left out and why.

A file that cannot be used at all is an error. A row that cannot be used is a finding, and the
others are used: nothing is dropped in silence, and nothing is mended by guessing.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from importlib.metadata import entry_points
from pathlib import Path

import numpy as np

from subsoil.arrays import Floats
from subsoil.errors import ReadingsError
from subsoil.findings import Finding, left_out
from subsoil.io.read.instruments import INSTRUMENTS, Reader
from subsoil.io.read.joining import located
from subsoil.io.read.missing import without_codes
from subsoil.io.read.places import Places, elsewhere, outside
from subsoil.io.read.plausible import doubts, stray
from subsoil.io.read.position_files import read_positions
from subsoil.io.read.recording import Recording, kpa_per_unit
from subsoil.io.read.screening import Push, screened
from subsoil.io.read.table import looks_like_table, read_table
from subsoil.io.read.text import check_file
from subsoil.land.field import Field
from subsoil.penetrometer import Cone
from subsoil.readings import Readings, extent_of
from subsoil.registry import Registry, handed_over

Read = Callable[[Path], Recording]

READERS: dict[str, Reader] = {
    **INSTRUMENTS,
    "table": Reader("table of readings", looks_like_table, read_table),
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
    positions: str | Path | None = None,
) -> Readings:
    """Read readings from an instrument's file or a table.

    Zeros, blanks and codes such as NA and -999 at the end of a profile mean that the depth was
    not reached. With readings below it, such a depth is left out, and the findings name it.

    Parameters
    ----------
    path
        File, told apart by its content (:data:`READERS`).
    field
        Field they belong to: sets the frame, and what lies outside or in a keep-out is left out.
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
    positions
        File with the places of pushes by number or time, where the instrument has none.

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
    places = read_positions(positions) if positions is not None else None
    recording = located(_recording(path, reader), places, path.name)
    records, codes = without_codes(recording.records, path.name)
    factor = kpa_per_unit(recording.unit, units, cone, path.name)
    pushes, unfit = screened(records, factor, recording.frame, path.name)
    findings = (*recording.findings, *codes, *unfit)
    if not pushes:
        raise _none_usable(left_out(findings), path.name)
    rows = np.array([push.record.row for push in pushes], dtype=np.int64)
    at, home = _places(pushes, recording, path.name).metres(field, crs or recording.crs or None)
    if field is not None:
        inside = _inside(at, field, _places(pushes, recording, path.name), crs)
        findings += outside(rows[~inside], at[~inside], field, path.name)
    else:
        strays = stray(at, rows, path.name)
        inside = ~np.isin(rows, [finding.row for finding in left_out(strays)])
        findings += strays
    kept = [push for push, here in zip(pushes, inside, strict=True) if here]
    findings += doubts(kept, at[inside], recording.frame, cone, path.name)
    return Readings(
        at[inside],
        tuple(push.profile for push in kept),
        extent_of(at[inside]) if field is None else field.extent_m,
        rows[inside],
        home,
        str(path),
        (*(field.findings if field else ()), *sorted(findings, key=lambda f: f.row)),
    )


def _recording(path: Path, reader: str | Read) -> Recording:
    check_file(path, ReadingsError)
    if reader:
        return _REGISTRY.named(*handed_over(reader))(path)
    with path.open("rb") as file:
        head = file.read(_HEAD)
    for each in (*_installed(), *READERS.values()):
        if each.sniff(head, path.name):
            return each.read(path)
    raise ReadingsError(
        "nothing here reads it as readings",
        where=path.name,
        remedy=f"save it as CSV, or name one of the readers {', '.join(READERS)}",
    )


def _installed() -> Iterator[Reader]:
    """Readers of installed packages."""
    found = (point.load() for point in entry_points(group=READER_POINTS))
    return (each for each in found if isinstance(each, Reader))


def _places(pushes: Sequence[Push], recording: Recording, file: str) -> Places:
    x = np.array([push.record.x for push in pushes])
    y = np.array([push.record.y for push in pushes])
    return Places(x, y, recording.frame == "lonlat", file)


def _inside(at: Floats, field: Field, places: Places, crs: str | None) -> np.ndarray:
    inside = field.contains(at)
    if 2 * inside.sum() < inside.size:
        raise elsewhere(places, field, at, crs)
    return inside


def _none_usable(refused: Sequence[Finding], file: str) -> ReadingsError:
    if not refused:
        return ReadingsError("it holds no readings", where=file, remedy="export it again")
    return ReadingsError(
        f"none of {len(refused)} readings can be used; {min(refused, key=lambda f: f.row)}",
        where=file,
        remedy="correct the rows, or export it again",
    )
