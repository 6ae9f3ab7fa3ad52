"""Readings of files as reports, each with an id that follows from what it says.

The same push has the same id wherever and whenever it is read again, so that what is in a survey
already is not taken twice, and a file that grew adds what is new.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator
from datetime import UTC, datetime
from math import hypot
from pathlib import Path
from uuid import UUID, uuid5

import numpy as np

from subsoil.errors import brief, printable
from subsoil.penetrometer import Profile
from subsoil.readings import Readings
from subsoil.reports import Place, Reading, Sampled, Source
from subsoil.stopping import Pace

_SPACE = UUID("6d1c9f0e-58f2-4a53-9e6f-0d4e1f4b7a52")
"""Space of the ids that follow from what a push says."""
_LONGEST_NAME = 100


def imported(readings: Readings, agent: str, start: Place, pace: Pace) -> Iterator[Sampled]:
    """Reports of the readings of one file, in its order.

    Parameters
    ----------
    readings
        In the frame of the survey's field.
    agent
        Who took them.
    start
        Where that was before, easting and northing in m.
    pace
        How fast that goes, by which way and time are reckoned.
    """
    file = brief(printable(Path(readings.source).name), _LONGEST_NAME)
    ids, here = ids_of(readings), start
    for k, (profile, at) in enumerate(zip(readings.profiles, readings.at.tolist(), strict=True)):
        time = readings.times[k] if readings.times else None
        metres = hypot(at[0] - here[0], at[1] - here[1])
        yield Sampled(
            id=ids[k],
            time=None if time is None else time.astimezone(UTC),
            clock="unknown" if time is None else "file",
            agent=agent,
            source=Source(kind="file", file=file, row=int(readings.rows[k])),
            at=(at[0], at[1]),
            metres=metres,
            seconds=60.0 * pace.minutes(metres, 1),
            reading=reading_of_profile(profile),
        )
        here = (at[0], at[1])


def ids_of(readings: Readings) -> tuple[str, ...]:
    """Id of each reading: of its instrument, number, place, time and values.

    Pushes of one file that say the same are told apart by how many there were before.

    Examples
    --------
    >>> twice = Readings.of([(5, 5), (5, 5)], [0.1], [[800.0], [800.0]])
    >>> one, other = ids_of(twice)
    >>> one == other, (one, other) == ids_of(twice)
    (False, True)
    """
    before: Counter[str] = Counter()
    ids = []
    for k, profile in enumerate(readings.profiles):
        said = json.dumps(
            [
                readings.instrument,
                readings.numbers[k] if readings.numbers else "",
                _moment(readings.times[k]) if readings.times else "",
                _rounded(readings.at[k], 3),
                _rounded(profile.depth_m, 4),
                _rounded(profile.top_m, 4),
                _rounded(profile.kpa, 1),
            ]
        )
        ids.append(str(uuid5(_SPACE, f"{said}{before[said]}")))
        before[said] += 1
    return tuple(ids)


def reading_of_profile(profile: Profile) -> Reading:
    """Plain data of a profile, with tops only where they are not the depths above."""
    above = np.concatenate([[0.0], profile.depth_m[:-1]])[: profile.depth_m.size]
    gaps = not np.array_equal(above, profile.top_m)
    return Reading(
        depth_m=tuple(profile.depth_m.tolist()),
        kpa=tuple(profile.kpa.tolist()),
        ending=profile.ending,
        top_m=tuple(profile.top_m.tolist()) if gaps else (),
    )


def _rounded(numbers: np.ndarray, digits: int) -> list[float]:
    """Numbers to so many digits, zero without a sign."""
    rounded: list[float] = (np.round(numbers, digits) + 0.0).tolist()
    return rounded


def _moment(time: datetime | None) -> str:
    return time.isoformat() if time else ""
