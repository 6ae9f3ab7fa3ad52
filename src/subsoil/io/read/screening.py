"""What makes a record usable: a place on Earth, and pressures without holes down to some depth."""

from __future__ import annotations

import numpy as np

from subsoil.io.read.records import HARDEST_KPA, Record, Recording
from subsoil.penetrometer import Profile
from subsoil.readings import Finding


def screened(
    recording: Recording, kpa_per_unit: float
) -> tuple[list[Record], list[Profile], list[Finding]]:
    """Records that can be used, their profiles in kPa, and findings about all others.

    Zeros and blanks at the end of a record are depths that were not reached, and end its profile.
    A blank above a reading, or a zero between two, is a hole where nobody knows the soil: the
    record is refused. Zeros above the first reading are a loose surface. A record that repeats
    the place and all values of an earlier one is refused too.

    Returns
    -------
    records, profiles, refused
        The first two side by side.
    """
    records: list[Record] = []
    profiles: list[Profile] = []
    refused = list(recording.refused)
    first_row: dict[tuple[float, float, bytes], int] = {}
    for record in recording.records:
        try:
            if recording.lonlat:
                _check_degrees(record.x, record.y)
            profile = _profile(record, kpa_per_unit)
            row = first_row.setdefault((record.x, record.y, record.values.tobytes()), record.row)
            if row != record.row:
                raise ValueError(f"it repeats row {row}: same place, same values")
        except ValueError as error:
            refused.append(Finding(record.row, str(error)))
            continue
        records.append(record)
        profiles.append(profile)
    return records, profiles, refused


def _check_degrees(longitude: float, latitude: float) -> None:
    if longitude == 0 and latitude == 0:
        raise ValueError("latitude 0, longitude 0 means that the receiver had no fix")
    if abs(latitude) <= 90 and abs(longitude) <= 180:
        return
    swappable = abs(longitude) <= 90 and abs(latitude) <= 180
    raise ValueError(
        f"latitude {latitude:g}, longitude {longitude:g} is no place on Earth"
        + (": latitude and longitude look swapped" if swappable else "")
    )


def _profile(record: Record, kpa_per_unit: float) -> Profile:
    depth_m, kpa = record.depth_m, record.values * kpa_per_unit
    wrong = np.flatnonzero((kpa < 0) | (kpa > HARDEST_KPA))
    if wrong.size:
        raise ValueError(
            f"{kpa[wrong[0]]:.6g} kPa at {depth_m[wrong[0]]:g} m is no soil strength: "
            "a bad reading, or the wrong unit"
        )
    reached = np.flatnonzero(kpa > 0)
    if not reached.size:
        raise ValueError("no depth was reached")
    end = reached[-1] + 1
    hole = np.isnan(kpa[:end])
    hole[reached[0] :] |= kpa[reached[0] : end] == 0
    if hole.any():
        raise ValueError(f"nothing was read at {depth_m[hole.argmax()]:g} m, yet below it")
    return Profile(depth_m[:end], kpa[:end])
