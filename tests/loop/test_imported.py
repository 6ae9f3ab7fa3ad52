"""Reports of files have ids of what their pushes say, so that each is taken once."""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime, timedelta

import numpy as np
import pytest

from subsoil.penetrometer import Profile
from subsoil.readings import Readings
from subsoil.stopping import Pace
from subsoil.survey.imported import ids_of, imported

NOON = datetime(2026, 5, 4, 12, 0, 0)


@pytest.fixture
def readings() -> Readings:
    at = [(5.0, 5.0), (15.0, 5.0), (15.0, 15.0)]
    plain = Readings.of(at, [0.1, 0.2], [[800.0, 900.0], [700.0, 950.0], [720.0, np.nan]])
    times = tuple(NOON + timedelta(minutes=k) for k in range(3))
    return replace(
        plain, numbers=("1", "2", "3"), times=times, instrument="SC900", source="/a/b.csv"
    )


def test_an_id_follows_from_instrument_number_place_time_and_values(readings: Readings) -> None:
    before = ids_of(readings)
    at, profiles = readings.at.copy(), list(readings.profiles)
    at[0] += 0.002
    profiles[0] = Profile(np.array([0.1, 0.2]), np.array([800.0, 901.0]))
    for change in (
        {"numbers": ("7", "2", "3")}, {"times": (NOON.replace(year=2025), *readings.times[1:])},
        {"at": at}, {"profiles": tuple(profiles)},
    ):  # fmt: skip
        after = ids_of(replace(readings, **change))
        assert [a == b for a, b in zip(before, after, strict=True)] == [False, True, True]
    other = ids_of(replace(readings, instrument="Penetrologger"))
    assert not set(before) & set(other)


def test_an_id_does_not_follow_from_the_file_its_rows_or_rounding(readings: Readings) -> None:
    same = replace(
        readings, source="c.csv", rows=readings.rows + 40, at=readings.at + 1e-6, findings=()
    )
    assert ids_of(same) == ids_of(readings)
    turned = replace(
        readings, at=readings.at[::-1], profiles=readings.profiles[::-1],
        numbers=readings.numbers[::-1], times=readings.times[::-1],
    )  # fmt: skip
    assert ids_of(turned) == ids_of(readings)[::-1]


def test_equal_pushes_of_one_file_are_told_apart_by_how_many_there_were() -> None:
    plain = Readings.of([(5, 5)] * 3, [0.1], [[800.0]] * 3)
    assert len(set(ids_of(plain))) == 3
    two = replace(plain, at=plain.at[:2], profiles=plain.profiles[:2], rows=plain.rows[:2])
    assert ids_of(two) == ids_of(plain)[:2]


def test_reports_say_file_row_and_time_and_reckon_way_and_time(readings: Readings) -> None:
    first, second, third = imported(readings, "hand", (5.0, 0.0), Pace(speed_mps=2.0, stop_s=60.0))
    assert (first.source.kind, first.source.file, first.source.row) == ("file", "b.csv", 1)
    assert first.clock == "file"
    assert first.time == NOON.astimezone()
    assert (first.metres, second.metres, third.metres) == (5.0, 10.0, 10.0)
    assert second.seconds == pytest.approx(65.0)
    assert third.reading.kpa == (720.0,)
    known = replace(readings, times=(NOON.replace(tzinfo=UTC), None, None))
    first, second, _ = imported(known, "hand", (5.0, 0.0), Pace())
    assert first.time == NOON.replace(tzinfo=UTC)
    assert (second.time, second.clock) == (None, "unknown")
