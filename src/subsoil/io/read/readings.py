"""Readings of instruments and robots: where, how hard by depth, and what was left out and why.

A file that cannot be used at all is an error. A row that cannot be used is a finding, and the
others are used: nothing is dropped in silence, and nothing is mended by guessing.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from subsoil.errors import ReadingsError
from subsoil.io.read.missing import without_codes
from subsoil.io.read.places import Places, elsewhere, outside
from subsoil.io.read.plausible import strength_notes
from subsoil.io.read.readings_csv import read_readings_csv
from subsoil.io.read.records import Recording, kpa_per_unit
from subsoil.io.read.robot_yaml import read_robot_yaml
from subsoil.io.read.screening import screened
from subsoil.io.read.text import check_file
from subsoil.land.field import Field
from subsoil.penetrometer import Cone
from subsoil.readings import Finding, Readings, extent_of

READERS: dict[str, Callable[[Path], Recording]] = {
    ".csv": read_readings_csv,
    ".yaml": read_robot_yaml,
    ".yml": read_robot_yaml,
}
"""Reader of each suffix. Another instrument needs no more than a function from a path to a
:class:`~subsoil.io.read.records.Recording`, put here."""


def read_readings(
    path: str | Path,
    *,
    field: Field | None = None,
    crs: str | None = None,
    cone: Cone | None = None,
    units: str | None = None,
) -> Readings:
    """Read readings from a robot's YAML or a CSV table.

    Zeros, blanks and codes such as NA and -999 at the end of a profile mean that the depth was
    not reached. One with readings below it makes the row unusable.

    Parameters
    ----------
    path
        File, told apart by its suffix (:data:`READERS`).
    field
        Field they belong to: sets the frame, and what lies outside or in a keep-out is refused.
        Without one, longitude and latitude go to the UTM zone of their median.
    crs
        Frame of easting and northing in the file, if not the field's.
    cone
        Cone that was used, where the file holds force in N.
    units
        Unit of pressure (``"kpa"``, ``"mpa"``, ``"psi"``) or ``"n"``, where the file does not say.

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
    path, of_field = Path(path), field.notes if field else ()
    recording = _recording(path)
    coded, codes = without_codes(recording.records)
    recording = replace(recording, records=coded)
    factor = kpa_per_unit(recording.unit, units, cone, path.name)
    records, profiles, refused = screened(recording, factor)
    if not records:
        raise _none_usable(refused, path.name)
    rows = np.array([record.row for record in records], dtype=np.int64)
    places = Places(
        np.array([record.x for record in records]),
        np.array([record.y for record in records]),
        recording.lonlat,
        path.name,
    )
    at, home = places.metres(field, crs)
    inside = np.ones(len(rows), dtype=bool)
    if field is not None:
        inside = field.contains(at)
        if 2 * inside.sum() < inside.size:
            raise elsewhere(places, field, at, crs)
        refused += outside(rows[~inside], at[~inside], field)
    return Readings(
        at[inside],
        tuple(profile for profile, kept in zip(profiles, inside, strict=True) if kept),
        extent_of(at[inside]) if field is None else field.extent_m,
        rows[inside],
        tuple(sorted(refused, key=lambda finding: finding.row)),
        home,
        str(path),
        (*of_field, *recording.notes, *codes, *strength_notes(profiles)),
    )


def _recording(path: Path) -> Recording:
    check_file(path, ReadingsError)
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise ReadingsError(
            "nothing reads readings from files with this suffix",
            where=path.name,
            remedy=f"save it as one of {' '.join(READERS)}",
        )
    return reader(path)


def _none_usable(refused: list[Finding], file: str) -> ReadingsError:
    if not refused:
        return ReadingsError("it holds no readings", where=file, remedy="export it again")
    return ReadingsError(
        f"none of {len(refused)} readings can be used; {min(refused, key=lambda f: f.row)}",
        where=file,
        remedy="correct the rows, or export it again",
    )
