"""Readings of instruments and robots: where, how hard by depth, and what was left out and why.

A file that cannot be used at all is an error. A row that cannot be used is a finding, and the
others are used: nothing is dropped in silence, and nothing is mended by guessing.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import shapely
from numpy.typing import NDArray

from subsoil.errors import ReadingsError
from subsoil.field import Field
from subsoil.frames import WGS84, looks_swapped, project, utm_crs
from subsoil.io.readings_csv import read_readings_csv
from subsoil.io.records import Finding, Floats, Recording, kpa_per_unit
from subsoil.io.robot_yaml import read_robot_yaml
from subsoil.io.text import check_file
from subsoil.io.usable import usable
from subsoil.layers import Layers
from subsoil.penetrometer import Cone, Profile

Integers = NDArray[np.int64]

READERS: dict[str, Callable[[Path], Recording]] = {
    ".csv": read_readings_csv,
    ".yaml": read_robot_yaml,
    ".yml": read_robot_yaml,
}
"""Reader of each suffix. Another instrument needs no more than a function from a path to a
:class:`~subsoil.io.records.Recording`, put here."""

_SPOT_M = 0.05


@dataclass(frozen=True)
class Readings:
    """Usable readings of a file.

    Attributes
    ----------
    at
        (n, 2) easting and northing in m.
    profiles
        Soil strength by depth of each reading. Files do not say why a push ended early, so
        nothing is assumed of the soil below it.
    rows
        (n,) row or record number of each reading in the file.
    refused
        What was left out and why, by row.
    crs
        Frame of ``at``; empty for a local frame.
    source
        The file.
    """

    at: Floats
    profiles: tuple[Profile, ...]
    rows: Integers
    refused: tuple[Finding, ...]
    crs: str
    source: Path

    def __post_init__(self) -> None:
        for array in (self.at, self.rows):
            array.setflags(write=False)

    def __len__(self) -> int:
        return len(self.profiles)

    def layer_means(self, layers: Layers) -> Floats:
        """(m, n) means in kPa of every layer at every reading, NaN where not measured through."""
        samples = (
            layers.sample(profile, at) for profile, at in zip(self.profiles, self.at, strict=True)
        )
        return np.column_stack([sample.measured_kpa for sample in samples])


def read_readings(
    path: str | Path,
    *,
    field: Field | None = None,
    crs: str | None = None,
    cone: Cone | None = None,
    units: str | None = None,
) -> Readings:
    """Read readings from a robot's YAML or a CSV table.

    Zeros and blanks at the end of a profile mean that the depth was not reached. One with
    readings below it makes the row unusable.

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
    path = Path(path)
    recording = _recording(path)
    factor = kpa_per_unit(recording.unit, units, cone, path.name)
    records, profiles, refused = usable(recording, factor)
    if not records:
        raise _none_usable(refused, path.name)
    rows = np.array([record.row for record in records], dtype=np.int64)
    places = _Places(
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
            raise _elsewhere(places, field, at, crs)
        refused += _outside(rows[~inside], at[~inside], field)
    return Readings(
        at[inside],
        tuple(profile for profile, kept in zip(profiles, inside, strict=True) if kept),
        rows[inside],
        tuple(sorted(refused, key=lambda finding: finding.row)),
        home,
        path,
    )


@dataclass(frozen=True)
class _Places:
    """Positions of records, (n,) x and y, in degrees or metres, with their file's name."""

    x: Floats
    y: Floats
    lonlat: bool
    file: str

    def metres(self, field: Field | None, crs: str | None) -> tuple[Floats, str]:
        """(n, 2) easting and northing, and their frame."""
        if self.lonlat and field is not None:
            return field.to_metres(self.x, self.y), field.crs
        if self.lonlat:
            home = self._utm()
            return project(WGS84, home, self.x, self.y), home
        self._check_metres()
        home = field.crs if field is not None else (crs or "")
        if crs is None or crs == home:
            return np.column_stack([self.x, self.y]), home
        return project(crs, home, self.x, self.y), home

    def _utm(self) -> str:
        longitude, latitude = float(np.median(self.x)), float(np.median(self.y))
        if looks_swapped(longitude, latitude):
            raise ReadingsError(
                f"longitude {longitude:.3f}, latitude {latitude:.3f} is open sea: "
                "latitude and longitude look swapped",
                where=self.file,
                remedy="swap the names of the two columns",
            )
        return utm_crs(longitude, latitude)

    def _check_metres(self) -> None:
        span = max(float(np.ptp(self.x)), float(np.ptp(self.y)))
        degrees = np.abs(self.x).max() <= 180 and np.abs(self.y).max() <= 180
        if degrees and 0 < span < _SPOT_M:
            raise ReadingsError(
                f"all readings lie within {span:.2g} m: these look like degrees, not metres",
                where=self.file,
                remedy="name the columns lat,lon",
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


def _outside(rows: Integers, at: Floats, field: Field) -> list[Finding]:
    return [
        Finding(
            int(row), f"it lies {_far(away)} outside the field" if away else "it lies in a keep-out"
        )
        for row, away in zip(rows, _metres_away(at, field), strict=True)
    ]


def _elsewhere(places: _Places, field: Field, at: Floats, crs: str | None) -> ReadingsError:
    """Complaint about readings most of which lie outside the field."""
    outside = at[~field.contains(at)]
    away = _far(float(np.median(_metres_away(outside, field))))
    what = f"{len(outside)} of {len(at)} readings lie outside {field.name}, typically {away} away"
    mirrored, _ = replace(places, x=places.y, y=places.x).metres(field, crs)
    if 2 * field.contains(mirrored).sum() > len(at):
        columns = "latitude and longitude" if places.lonlat else "easting and northing"
        return ReadingsError(
            f"{what}; swapping {columns} puts them inside",
            where=places.file,
            remedy="swap the names of the two columns",
        )
    remedy = "check that file and field belong together"
    return ReadingsError(
        what,
        where=places.file,
        remedy=remedy if places.lonlat else f"{remedy}, and name the CRS of the readings",
    )


def _metres_away(at: Floats, field: Field) -> Floats:
    away = np.asarray(shapely.distance(shapely.points(at), field.boundary))
    return np.where(np.isfinite(away), away, np.inf)


def _far(metres: float) -> str:
    if not np.isfinite(metres):
        return "half a world"
    return (
        f"{metres:.2g} m"
        if metres < 10
        else f"{metres:.0f} m"
        if metres < 10_000
        else f"{metres / 1000:.0f} km"
    )
