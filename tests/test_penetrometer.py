"""Cones, pushes and profiles: newtons to kilopascals, and series that make no sense."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from subsoil.errors import ParameterError, ReadingsError
from subsoil.layers import Layers
from subsoil.penetrometer import (
    LARGE_CONE,
    LARGEST_MM2,
    SMALL_CONE,
    SMALLEST_MM2,
    Cone,
    Insertion,
    Profile,
    faults,
    flags_of,
    profile,
    profile_of,
)
from subsoil.reports import Reading, Tip

DEPTH = np.array([0.025, 0.05, 0.075])


def test_the_standard_cones_have_the_base_areas_of_their_diameters() -> None:
    for cone, diameter_mm in ((LARGE_CONE, 20.27), (SMALL_CONE, 12.83)):
        assert cone.area_mm2 == pytest.approx(math.pi * diameter_mm**2 / 4, rel=0.006)
        assert cone.angle_deg == 30.0


def test_pressure_is_force_over_area_in_si_units() -> None:
    newtons, square_metres = 600.0, 130e-6
    assert Cone(130.0).pressure_kpa(newtons) == pytest.approx(newtons / square_metres / 1000)


@given(st.floats(SMALLEST_MM2, LARGEST_MM2), st.floats(0.0, 5000.0))
def test_force_and_pressure_undo_each_other(area: float, force: float) -> None:
    cone = Cone(area)
    assert cone.force_n(cone.pressure_kpa(force)) == pytest.approx(force, abs=1e-9)


NO_CONES = [0.0, -1.0, 1e-300, 9.9, 10_001.0, 1e300, math.nan, math.inf]


@pytest.mark.parametrize("area", NO_CONES)
def test_a_cone_larger_or_smaller_than_any_is_refused_with_the_usual_areas(area: float) -> None:
    with pytest.raises(ParameterError, match=r"cone area.* 10 and 10000 mm2.*323 .*130"):
        Cone(area)


@pytest.mark.parametrize("area", NO_CONES)
def test_a_reading_of_such_a_cone_is_none(area: float) -> None:
    reading = Reading(depth_m=(0.1,), force_n=(1.0,), tip=Tip(area_mm2=area))
    assert re.search(r"a cone of .* mm2 is none", faults(reading, SMALL_CONE))


@pytest.mark.parametrize("area", [10.0, 100.0, 333.0, 1500.0, 2000.0, 10_000.0])
def test_cones_of_hand_penetrometers_and_of_cone_penetration_tests_are_taken(area: float) -> None:
    assert Cone(area).area_mm2 == area
    assert not faults(Reading(depth_m=(0.1,), force_n=(1.0,), tip=Tip(area_mm2=area)), SMALL_CONE)


@pytest.mark.parametrize("angle", [0.0, 180.0, -30.0, math.nan])
def test_a_cone_angle_lies_between_0_and_180_degrees(angle: float) -> None:
    with pytest.raises(ParameterError, match="cone angle"):
        Cone(130.0, angle)


def test_the_profile_of_a_push_keeps_depths_and_ending_and_divides_by_the_area() -> None:
    push = Insertion(DEPTH, np.array([13.0, 26.0, 260.0]), "force")
    seen = push.profile(SMALL_CONE)
    np.testing.assert_allclose(seen.kpa, [100.0, 200.0, 2000.0])
    np.testing.assert_array_equal(seen.depth_m, DEPTH)
    assert seen.ending == "force"


def test_a_profile_owns_its_numbers_and_nobody_can_change_them() -> None:
    kpa = [1.0, 2.0, 3.0]
    seen = profile(DEPTH, kpa)
    kpa[0] = 99.0
    assert seen.kpa[0] == 1.0
    with pytest.raises(ValueError, match="read-only"):
        seen.kpa[0] = 5.0
    with pytest.raises(ValueError, match="read-only"):
        seen.depth_m[0] = 5.0


def test_a_push_may_end_before_the_first_reading() -> None:
    assert profile([], [], "force").kpa.size == 0


@pytest.mark.parametrize(
    "depth",
    [
        [0.05, 0.025, 0.075],
        [0.025, 0.025, 0.05],
        [-0.01, 0.025, 0.05],
        [0.025, math.nan, 0.075],
        [math.nan, 0.025, 0.05],
        [0.025, 0.05, math.inf],
    ],
)
def test_depths_must_be_numbers_that_increase_from_the_surface(depth: list[float]) -> None:
    with pytest.raises(ReadingsError, match=r"depths must increase.*positive down"):
        profile(depth, [1.0, 2.0, 3.0])


@pytest.mark.parametrize("value", [-401.0, math.nan, math.inf])
def test_a_pressure_that_is_none_is_refused_at_its_depth(value: float) -> None:
    with pytest.raises(ReadingsError, match=r"pressure is .* at 0\.050 m"):
        profile(DEPTH, [1.0, value, 3.0])


def test_a_force_that_is_none_is_refused_at_its_depth() -> None:
    with pytest.raises(ReadingsError, match=r"force is -51 at 0\.075 m"):
        Insertion(DEPTH, np.array([1.0, 2.0, -51.0]))


@pytest.mark.parametrize("kpa", [[1.0], [[1.0, 2.0, 3.0]]])
def test_every_reading_needs_its_depth(kpa: object) -> None:
    with pytest.raises(ReadingsError, match=r"3 depths do not pair with \d pressure readings"):
        profile(DEPTH, kpa)  # type: ignore[arg-type]


def test_a_load_cell_that_drifted_below_zero_is_flagged_and_counts_as_it_is() -> None:
    reading = Reading(depth_m=(0.1, 0.2), force_n=(-2.0, 26.0))
    assert flags_of(reading) == ("below-zero",)
    assert profile_of(reading, SMALL_CONE).kpa == pytest.approx([-2000 / 130, 200.0])


def test_what_a_bouncing_rod_reads_in_its_own_hole_does_not_count() -> None:
    reading = Reading(
        depth_m=(-0.01, 0.05, 0.10, 0.07, 0.10, 0.15), force_n=(0.0, 13.0, 26.0, 1.0, 2.0, 39.0)
    )
    assert flags_of(reading) == ("bounced",)
    profile = profile_of(reading, SMALL_CONE)
    assert profile.depth_m.tolist() == [0.05, 0.10, 0.15]
    assert profile.kpa == pytest.approx([100.0, 200.0, 300.0])


def test_a_reading_of_pressure_needs_no_cone_and_one_of_force_may_bring_its_own() -> None:
    assert profile_of(Reading(depth_m=(0.1,), kpa=(700.0,)), SMALL_CONE).kpa.tolist() == [700.0]
    own = Reading(depth_m=(0.1,), force_n=(323.0,), tip=Tip(area_mm2=323.0))
    assert profile_of(own, SMALL_CONE).kpa == pytest.approx([1000.0])


@pytest.mark.parametrize(
    ("reading", "words"),
    [
        (Reading(depth_m=(0.1,), force_n=(1e300,)), "force is 1e+300 N at 0.100 m"),
        (Reading(depth_m=(0.1,), force_n=(math.nan,)), "force is nan N"),
        (Reading(depth_m=(0.1,), force_n=(14_000.0,)), "a load cell says -50 to 13000"),
        (Reading(depth_m=(0.1,), kpa=(2e5,)), "pressure is 200000 kPa"),
        (Reading(depth_m=(0.1,), kpa=(-500.0,)), "pressure is -500 kPa"),
        (Reading(depth_m=(0.1, 0.2), force_n=(1.0,)), "2 depths do not pair with 1 readings"),
        (Reading(depth_m=(0.1,), force_n=(1.0,), kpa=(1.0,)), "it gives both"),
        (Reading(depth_m=(0.1,)), "it gives neither force nor pressure"),
        (Reading(depth_m=(10.0, 20.0), kpa=(1.0, 2.0)), "they are in m, positive down"),
        (Reading(depth_m=(math.inf,), kpa=(1.0,)), "they are in m, positive down"),
        (Reading(depth_m=(0.1,), force_n=(1.0,), tip=Tip(area_mm2=0.0)), "a cone of 0 mm2"),
    ],
)
def test_what_no_penetrometer_says_is_named(reading: Reading, words: str) -> None:
    assert words in faults(reading, SMALL_CONE)
    with pytest.raises(ReadingsError):
        profile_of(reading, SMALL_CONE)


def test_a_push_that_read_nothing_is_no_fault() -> None:
    assert faults(Reading(depth_m=()), SMALL_CONE) == ""
    assert profile_of(Reading(depth_m=()), SMALL_CONE).depth_m.size == 0


@pytest.mark.parametrize("top", [(0.0, 0.05), (0.0, 0.25), (0.0,), (-0.1, 0.1)])
def test_stretches_of_soil_that_overlap_or_do_not_pair_are_refused(top: tuple[float, ...]) -> None:
    depth, kpa = np.array([0.1, 0.2]), np.array([500.0, 900.0])
    with pytest.raises(ReadingsError, match=r"stretches of soil .* overlap"):
        Profile(depth, kpa, top_m=np.array(top))
    reading = Reading(depth_m=(0.1, 0.2), kpa=(500.0, 900.0), top_m=top)
    assert "overlap" in faults(reading, SMALL_CONE)


def test_a_gap_between_readings_stays_one() -> None:
    reading = Reading(depth_m=(0.1, 0.3), kpa=(500.0, 900.0), top_m=(0.0, 0.2))
    found = profile_of(reading, SMALL_CONE)
    assert (found.top_m.tolist(), found.depth_m.tolist()) == ([0.0, 0.2], [0.1, 0.3])
    sample = Layers((0.0, 0.1, 0.2, 0.3)).sample(found, (0.0, 0.0))
    np.testing.assert_allclose(sample.measured_kpa, [500.0, np.nan, 900.0])
