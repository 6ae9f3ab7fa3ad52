"""What is implausible about readings is said, and nothing is said of honest surveys."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from subsoil.findings import Finding
from subsoil.io.read.plausible import doubts, stray
from subsoil.io.read.readings import read_readings
from subsoil.io.read.recording import Frame, Record
from subsoil.io.read.screening import Push
from subsoil.land.crs import project
from subsoil.penetrometer import Cone, Profile
from subsoil.simulation import Truth, draw_field
from subsoil.simulation.probe import mean_resistance

HOME, EAST, NORTH = "EPSG:32631", 681_000.0, 5_775_000.0
DEPTH_M = np.linspace(0.025, 0.45, 18)


@dataclass(frozen=True)
class Survey:
    """Pushes as read from a file."""

    at: np.ndarray
    profiles: tuple[Profile, ...]
    decimals: int = 7
    frame: Frame = "lonlat"
    cone: Cone | None = None
    seconds_a_metre: float = 0.0

    def findings(self) -> tuple[Finding, ...]:
        rows = np.arange(2, 2 + len(self.at))
        x, y = self.at.T
        if self.frame == "lonlat":
            x, y = project(HOME, "EPSG:4326", x, y).round(self.decimals).T
        pushes = [
            Push(Record(int(row), *xy, p.depth_m, p.kpa, seconds=self.seconds(p)), p)
            for row, xy, p in zip(rows, zip(x, y, strict=True), self.profiles, strict=True)
        ]
        said = doubts(pushes, self.at, self.frame, self.cone, "walk.csv")
        return (*stray(self.at, rows, "walk.csv"), *said)

    def seconds(self, profile: Profile) -> np.ndarray:
        return profile.depth_m * self.seconds_a_metre if self.seconds_a_metre else np.empty(0)

    def scaled(self, factor: float) -> Survey:
        return replace(self, profiles=tuple(replace(p, kpa=p.kpa * factor) for p in self.profiles))

    def moved(self, which: Sequence[int] | slice, to: Sequence[float]) -> Survey:
        at = self.at.copy()
        at[which] = to
        return replace(self, at=at)


@pytest.fixture(scope="module")
def soils() -> list[Truth]:
    return [draw_field(np.random.default_rng(seed), "signal") for seed in range(8)]


def measured(soil: Truth, cells: np.ndarray, rng: np.random.Generator) -> tuple[Profile, ...]:
    """Profiles every 2.5 cm, with the noise of a load cell."""
    return tuple(
        Profile(
            DEPTH_M,
            np.maximum(mean_resistance(soil.layers, soil.reading(int(cell)), DEPTH_M), 0.0)
            * rng.uniform(0.9, 1.1, DEPTH_M.size),
        )
        for cell in cells
    )


def laid_out(soil: Truth, kind: str, rng: np.random.Generator) -> Survey:
    """An honest survey of a soil in one of several layouts."""
    field = soil.field.cells
    n = int(rng.integers(12, 60))
    cells = rng.choice(len(field), n, replace=False)
    if kind == "transect":
        cells = np.flatnonzero(np.abs(field[:, 1] - 67.5) < 1)
    if kind == "grid":
        cells = np.flatnonzero((field % 20 == 7.5).all(axis=1))
    at = field[cells] + rng.normal(0, 1.0, (len(cells), 2)) + (EAST, NORTH)
    if kind == "two fields":
        at[: len(at) // 3] += (1000.0, 0.0)
    if kind == "strip":
        at = (at - (EAST, NORTH)) * (20.0, 0.2) + (EAST, NORTH)
    if kind == "three a plot":
        cells = np.repeat(cells, 3)
        at = np.repeat(at, 3, axis=0)
    profiles = measured(soil, cells, rng)
    if kind == "some end early":
        profiles = tuple(
            Profile(p.depth_m[:k], p.kpa[:k])
            for p in profiles
            for k in [p.depth_m.size if rng.random() < 0.8 else int(rng.integers(6, 18))]
        )
    return Survey(at, profiles, seconds_a_metre=1 / 0.03)


LAYOUTS = ("anywhere", "transect", "grid", "two fields", "strip", "three a plot", "some end early")


@pytest.fixture(scope="module")
def honest(soils: list[Truth]) -> list[Survey]:
    """200 surveys, each of a kind."""
    rngs = (np.random.default_rng((1, k)) for k in range(200))
    return [
        laid_out(soils[k % len(soils)], LAYOUTS[k % len(LAYOUTS)], rng)
        for k, rng in enumerate(rngs)
    ]


def test_nothing_is_said_of_two_hundred_honest_surveys(honest: list[Survey]) -> None:
    said = {(k, LAYOUTS[k % len(LAYOUTS)]): s.findings() for k, s in enumerate(honest)}
    assert {key: found for key, found in said.items() if found} == {}


def test_nothing_is_said_of_the_robots_real_survey(real_data: Path) -> None:
    assert read_readings(real_data / "riseholme" / "cosmos-gt.yaml").findings == ()


@pytest.fixture(scope="module")
def some(honest: list[Survey]) -> list[Survey]:
    """One honest survey of each layout, to be spoilt."""
    return honest[: len(LAYOUTS)]


def only(survey: Survey) -> Finding:
    (found,) = survey.findings()
    return found


@pytest.mark.parametrize(
    ("factor", "words"),
    [
        (1 / 1000, "MPa would be"),
        (1 / 6.894757, "psi would be"),
        (6.894757, "kPa under a heading of psi"),
    ],
)
def test_another_unit_than_the_heading_says_is_found(
    some: list[Survey], factor: float, words: str
) -> None:
    for survey in some:
        found = only(survey.scaled(factor))
        assert words in found.done
        assert (found.severity, found.row) == ("doubt", 0)


def test_an_extra_digit_is_named_by_row_and_depth(some: list[Survey]) -> None:
    for survey in some:
        kpa = survey.profiles[5].kpa.copy()
        kpa[4] *= 10
        spoilt = (*survey.profiles[:5], replace(survey.profiles[5], kpa=kpa), *survey.profiles[6:])
        found = only(replace(survey, profiles=spoilt))
        assert (found.row, found.column, found.severity) == (7, "0.125 m", "doubt")
        assert f"{kpa[4]:.5g} kPa" in found.seen


@pytest.mark.parametrize("metres", [3_000, 44_000, 1_000_000])
def test_one_position_far_from_all_others_is_left_out(honest: list[Survey], metres: float) -> None:
    for survey in (honest[k] for k in (0, 1, 2, 6)):
        found = only(survey.moved([3], (EAST + metres, NORTH)))
        assert (found.row, found.severity) == (5, "left out")
        assert f"{metres / 1000:.0f} km" in found.seen or "2.8" in found.seen or "2.9" in found.seen


def test_one_position_alone_within_a_kilometre_is_a_doubt(honest: list[Survey]) -> None:
    survey = honest[0]
    found = only(survey.moved([3], survey.at.max(axis=0) + np.array([900, 0])))
    assert (found.row, found.severity) == (5, "doubt")
    assert found.seen == "its position is 0.9 km from all others"


def test_several_positions_at_one_far_place_are_left_out(honest: list[Survey]) -> None:
    found = honest[0].moved([3, 7], (EAST - 80_000, NORTH + 10)).findings()
    assert [each.row for each in found if each.severity == "left out"] == [5, 9]


def test_a_place_that_no_projection_has_is_astray(honest: list[Survey]) -> None:
    at = honest[0].at.copy()
    at[2] = np.inf
    (found,) = stray(at, np.arange(2, 2 + len(at)), "walk.csv")
    assert (found.row, found.seen) == (4, "its position is half a world from all others")


@given(
    gap=st.floats(0, 900),
    first=st.integers(5, 40),
    second=st.sampled_from([0, *range(2, 41)]),
    seed=st.integers(0, 1000),
)
def test_fields_within_a_kilometre_are_never_taken_apart(
    gap: float, first: int, second: int, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    at = rng.uniform(0, 100, (first + second, 2))
    at[first:, 0] += gap
    assert stray(at, np.arange(len(at)), "walk.csv") == ()


@given(ratio=st.floats(1.0, 1.3), n=st.integers(5, 60))
def test_stops_ever_farther_apart_are_never_taken_apart(ratio: float, n: int) -> None:
    along = np.cumsum(np.minimum(10 * ratio ** np.arange(n), 900.0))
    at = np.column_stack([along, np.zeros(n)])
    assert stray(at, np.arange(n), "walk.csv") == ()


def test_a_receiver_that_stands_still_is_found(honest: list[Survey]) -> None:
    survey = honest[0]
    found = only(survey.moved(slice(4, 10), survey.at[3]))
    assert found.row == 5
    assert "7 pushes in a row, to row 11, share a position" in found.seen


def test_many_pushes_on_one_point_are_found(honest: list[Survey]) -> None:
    survey = honest[0]
    found = only(survey.moved([2, 4, 6, 8, 10], survey.at[0]))
    assert "6 pushes share a position, rows 2, 4, 6, 8, 10, 12" in found.seen


def test_all_pushes_on_one_point_are_found(honest: list[Survey]) -> None:
    survey = honest[0]
    assert "share one position" in only(survey.moved(slice(None), survey.at[0])).seen


@pytest.mark.parametrize(("decimals", "step"), [(4, "11 m"), (3, "111 m")])
def test_positions_of_few_decimals_are_found(
    honest: list[Survey], decimals: int, step: str
) -> None:
    found = replace(honest[2], decimals=decimals).findings()
    assert any(step in each.seen for each in found)


def test_a_national_grid_rounded_to_ten_metres_is_found(honest: list[Survey]) -> None:
    survey = honest[2]
    rounded = replace(survey, at=survey.at.round(-1), frame="metres").findings()
    assert any("steps of 10 m" in each.seen for each in rounded)
    assert replace(survey, frame="metres").findings() == ()


@pytest.mark.parametrize("speed", [0.002, 0.2])
def test_a_push_much_slower_or_faster_than_the_standard_is_found(
    some: list[Survey], speed: float
) -> None:
    found = only(replace(some[0], seconds_a_metre=1 / speed))
    assert f"went at {speed:g} m/s" in found.seen


@pytest.mark.parametrize(("area", "meant"), [(12.83, "129"), (20.27, "323")])
def test_a_diameter_given_for_the_area_of_a_cone_is_found(
    some: list[Survey], area: float, meant: str
) -> None:
    assert f"give {meant}" in only(replace(some[0], cone=Cone(area))).done


def test_depths_in_another_unit_are_found(some: list[Survey]) -> None:
    thin = tuple(replace(p, depth_m=p.depth_m / 20, top_m=p.top_m / 20) for p in some[0].profiles)
    found = replace(some[0], profiles=thin, seconds_a_metre=0.0)
    assert only(found).done == "check the unit of depths"


def test_pushes_that_end_at_the_hardest_spots_are_noted(soils: list[Truth]) -> None:
    rng = np.random.default_rng(3)
    survey = laid_out(soils[0], "anywhere", rng)
    ends = []
    limit = np.quantile([p.kpa.max() for p in survey.profiles], 0.7)
    for p in survey.profiles:
        over = np.flatnonzero(p.kpa > limit)
        k = int(over[0]) + 1 if over.size else p.depth_m.size
        ends.append(Profile(p.depth_m[:k], p.kpa[:k]))
    found = only(replace(survey, profiles=tuple(ends)))
    assert found.severity == "note"
    stopped = sum(p.depth_m[-1] < 0.45 for p in ends)
    assert f"{stopped} of {len(ends)} pushes ended above 0.45 m" in found.seen
    assert "too soft" in found.done
