"""Cones, pushes and profiles: newtons to kilopascals, and series that make no sense."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from subsoil.errors import ParameterError, ReadingsError
from subsoil.penetrometer import LARGE_CONE, SMALL_CONE, Cone, Insertion, profile

DEPTH = np.array([0.025, 0.05, 0.075])


def test_the_standard_cones_have_the_base_areas_of_their_diameters() -> None:
    for cone, diameter_mm in ((LARGE_CONE, 20.27), (SMALL_CONE, 12.83)):
        assert cone.area_mm2 == pytest.approx(math.pi * diameter_mm**2 / 4, rel=0.006)
        assert cone.angle_deg == 30.0


def test_pressure_is_force_over_area_in_si_units() -> None:
    newtons, square_metres = 600.0, 130e-6
    assert Cone(130.0).pressure_kpa(newtons) == pytest.approx(newtons / square_metres / 1000)


@given(st.floats(1.0, 2000.0), st.floats(0.0, 5000.0))
def test_force_and_pressure_undo_each_other(area: float, force: float) -> None:
    cone = Cone(area)
    assert cone.force_n(cone.pressure_kpa(force)) == pytest.approx(force, abs=1e-9)


@pytest.mark.parametrize("area", [0.0, -1.0, math.nan, math.inf])
def test_a_cone_without_a_positive_area_is_refused_with_the_usual_areas(area: float) -> None:
    with pytest.raises(ParameterError, match=r"cone area.*323 .*130"):
        Cone(area)


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


@pytest.mark.parametrize("value", [-1.0, math.nan, math.inf])
def test_a_pressure_that_is_none_is_refused_at_its_depth(value: float) -> None:
    with pytest.raises(ReadingsError, match=r"pressure is .* at 0\.050 m"):
        profile(DEPTH, [1.0, value, 3.0])


def test_a_force_that_is_none_is_refused_at_its_depth() -> None:
    with pytest.raises(ReadingsError, match=r"force is -5 at 0\.075 m"):
        Insertion(DEPTH, np.array([1.0, 2.0, -5.0]))


@pytest.mark.parametrize("kpa", [[1.0], [[1.0, 2.0, 3.0]]])
def test_every_reading_needs_its_depth(kpa: object) -> None:
    with pytest.raises(ReadingsError, match=r"3 depths do not pair with \d pressure readings"):
        profile(DEPTH, kpa)  # type: ignore[arg-type]
