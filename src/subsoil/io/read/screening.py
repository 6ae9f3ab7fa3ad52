"""What makes a record usable: a place on Earth, and pressures down to some depth."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from subsoil.arrays import Bools, Floats
from subsoil.findings import Finding
from subsoil.io.read.recording import HARDEST_KPA, Frame, Record
from subsoil.penetrometer import Profile


@dataclass(frozen=True, slots=True)
class Push:
    """A record that can be used, and its profile in kPa."""

    record: Record
    profile: Profile


def screened(
    records: Iterable[Record], kpa_per_unit: float, frame: Frame, file: str
) -> tuple[tuple[Push, ...], tuple[Finding, ...]]:
    """Records that can be used, and findings about the others, and about single depths.

    Zeros and blanks at the end of a record are depths that were not reached, and end its profile.
    A blank above a reading, or a zero between two, is a gap in which nobody knows the soil. Zeros
    above the first reading are a loose surface. A record that repeats the place and all values of
    an earlier one is used, and named.
    """
    pushes: list[Push] = []
    findings: list[Finding] = []
    first_row: dict[tuple[float, float, str, bytes], int] = {}
    for record in records:
        try:
            if frame == "lonlat":
                _check_degrees(record.x, record.y)
            profile, gaps = _profile(record, kpa_per_unit)
        except ValueError as error:
            findings.append(Finding(str(error), "left out", "left out", file, record.row))
            continue
        findings += _missed(gaps, file, record.row)
        content = record.x, record.y, record.number, record.values.tobytes()
        row = first_row.setdefault(content, record.row)
        if row != record.row:
            seen = f"it repeats row {row}: same place, same values"
            done = "kept as a push of its own; take it out if it is a copy"
            findings.append(Finding(seen, done, "doubt", file, record.row))
        pushes.append(Push(record, profile))
    return tuple(pushes), tuple(findings)


def _missed(depths: Floats, file: str, row: int) -> Iterator[Finding]:
    """A finding about depths with nothing read above others with something, if there are any."""
    if len(depths):
        first = f"nothing was read at {depths[0]:g} m"
        seen = f"{first} and {len(depths) - 1} other depths" if len(depths) > 1 else first
        done = "that depth is left out" if len(depths) == 1 else "those depths are left out"
        yield Finding(f"{seen}, yet below", done, "left out", file, row)


def _check_degrees(longitude: float, latitude: float) -> None:
    if longitude == 0 and latitude == 0:
        raise ValueError("latitude 0, longitude 0 means that the receiver had no fix")
    if abs(latitude) <= 90 and abs(longitude) <= 180:
        return
    guess = ""
    if abs(longitude) <= 90 and abs(latitude) <= 180:
        guess = ": latitude and longitude look swapped"
    elif abs(latitude) < 9060 and abs(latitude) % 100 < 60:
        guess = ": degrees and minutes in one number need N or S, and E or W"
    raise ValueError(f"latitude {latitude:g}, longitude {longitude:g} is no place on Earth{guess}")


def _profile(record: Record, kpa_per_unit: float) -> tuple[Profile, Floats]:
    """Profile of a record down to its last reading, and the depths in it that are not known."""
    depth_m, kpa = record.depth_m, record.values * kpa_per_unit
    tops = record.top_m
    if kpa.size and kpa.min() > 0 and kpa.max() <= HARDEST_KPA:
        return Profile(depth_m, kpa, record.ending, tops), np.empty(0)
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
    known: Bools = ~np.isnan(kpa[:end])
    known[reached[0] :] &= kpa[reached[0] : end] > 0
    tops = tops if tops.size else np.concatenate([[0.0], depth_m[:-1]])
    profile = Profile(depth_m[:end][known], kpa[:end][known], record.ending, tops[:end][known])
    return profile, depth_m[:end][~known]
