"""Cones, pushes and resistance profiles: from force in newtons to pressure in kilopascals.

A penetrometer measures the force on a cone; soil strength is that force over the area of the
cone's base (cone index, ASABE S313.3). The area differs sixfold between common cones, so nothing
here assumes one.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike

from subsoil.arrays import Bools, Floats
from subsoil.errors import ParameterError, ReadingsError
from subsoil.reports import Ending, Reading, Tip

SLIGHT_N, SLIGHT_KPA = 50.0, 400.0
"""How far below zero a force or pressure may be: a load cell drifts by as much after its tare."""
HARDEST_N, HARDEST_KPA = 200_000.0, 100_000.0
"""Force and pressure that no penetrometer measures."""
DEEPEST_M = 3.0
"""Depth that no penetrometer reaches."""
_OVERLAP = "the stretches of soil that its values stand for overlap"
BOUNCED, BELOW_ZERO = "bounced", "below-zero"
"""Flags of readings whose rod went up again on its way, and whose force was below zero."""

SMALLEST_MM2, LARGEST_MM2 = 10.0, 10_000.0
"""Base areas in mm2 beyond which there is no cone in use. ASABE S313.3 has 130 and 323 mm2, hand
penetrometers have 100 to 500, cone penetration tests (ISO 22476-1) 500 to 2000 mm2."""
Strength = TypeVar("Strength", float, Floats)
"""A force or a pressure, or an array of them."""


@dataclass(frozen=True)
class Cone:
    """The tip of a penetrometer.

    Parameters
    ----------
    area_mm2
        Area of the cone's base in mm2.
    angle_deg
        Full apex angle in degrees.

    Raises
    ------
    ParameterError
        If the area is not between :data:`SMALLEST_MM2` and :data:`LARGEST_MM2`, or the angle is
        not between 0 and 180 degrees.

    Examples
    --------
    The same 600 N are 1858 kPa on the large ASABE cone and 4615 kPa on the small one:

    >>> round(LARGE_CONE.pressure_kpa(600.0)), round(SMALL_CONE.pressure_kpa(600.0))
    (1858, 4615)
    """

    area_mm2: float
    angle_deg: float = 30.0

    def __post_init__(self) -> None:
        if not SMALLEST_MM2 <= self.area_mm2 <= LARGEST_MM2:
            raise ParameterError(
                f"a cone's base area lies between {SMALLEST_MM2:g} and {LARGEST_MM2:g} mm2, "
                f"not {self.area_mm2:g}",
                where="cone area",
                remedy="323 (large ASABE cone) or 130 (small) are usual; 1 cm2 is 100 mm2",
            )
        if not 0 < self.angle_deg < 180:
            raise ParameterError(
                f"a cone's apex angle lies between 0 and 180 degrees, not {self.angle_deg:g}",
                where="cone angle",
            )

    def pressure_kpa(self, force_n: Strength) -> Strength:
        """Cone index in kPa under a force, or forces, in N."""
        return force_n / self.area_mm2 * 1000.0

    def force_n(self, pressure_kpa: Strength) -> Strength:
        """Force in N that a cone index, or several, in kPa ask for."""
        return pressure_kpa * self.area_mm2 / 1000.0


LARGE_CONE = Cone(323.0)
"""ASABE S313.3 large cone: 20.27 mm base, 30 degrees."""
SMALL_CONE = Cone(130.0)
"""ASABE S313.3 small cone: 12.83 mm base, 30 degrees."""


@dataclass(frozen=True)
class Insertion:
    """One push of the rod as the machine saw it.

    Attributes
    ----------
    depth_m
        (k,) increasing depths in m, positive down.
    force_n
        (k,) force at each depth in N.
    ending
        What ended the push.
    """

    depth_m: Floats
    force_n: Floats
    ending: Ending = "stroke"

    def __post_init__(self) -> None:
        _check_series(self.depth_m, self.force_n, "force", SLIGHT_N)

    def profile(self, cone: Cone) -> Profile:
        """Cone index by depth under this cone."""
        return Profile(self.depth_m, cone.pressure_kpa(self.force_n), self.ending)


@dataclass(frozen=True)
class Profile:
    """Soil strength by depth at one place.

    Attributes
    ----------
    depth_m
        (k,) increasing depths in m, positive down, to which each reading stands for the soil.
    kpa
        (k,) cone index at each depth in kPa.
    ending
        What ended the push; after ``"force"`` the soil below is at least as hard as the last
        reading says at its own depth.
    top_m
        (k,) depths in m from which on each reading stands for the soil, where it is not since the
        reading above it: nobody knows the soil between one reading and the top of the next.

    Raises
    ------
    ReadingsError
        If depths do not increase, stretches of soil overlap, or a number cannot be.
    """

    depth_m: Floats
    kpa: Floats
    ending: Ending = "stroke"
    top_m: Floats = field(default_factory=lambda: np.empty(0))

    def __post_init__(self) -> None:
        _check_series(self.depth_m, self.kpa, "pressure", SLIGHT_KPA)
        if not self.top_m.size:
            object.__setattr__(self, "top_m", np.concatenate([[0.0], self.depth_m])[:-1])
        elif _overlap(self.top_m, self.depth_m):
            raise ReadingsError(_OVERLAP, where="profile")
        self.top_m.setflags(write=False)


def reading_of(insertion: Insertion) -> Reading:
    """Return a push as plain data."""
    return Reading(
        depth_m=tuple(insertion.depth_m.tolist()),
        force_n=tuple(insertion.force_n.tolist()),
        ending=insertion.ending,
    )


def profile_of(reading: Reading, cone: Cone) -> Profile:
    """Cone index by depth of a reading.

    Where the rod went up again, what it read until it was deeper than ever before does not count:
    it was in its own hole.

    Parameters
    ----------
    reading
        What the instrument saw.
    cone
        What it was measured with, where the reading does not say.

    Raises
    ------
    ReadingsError
        If :func:`faults` finds any.

    Examples
    --------
    >>> bounced = Reading(depth_m=(0.01, 0.02, 0.015, 0.03), force_n=(13.0, 26.0, 1.0, 39.0))
    >>> profile_of(bounced, SMALL_CONE).kpa
    array([100., 200., 300.])
    """
    if fault := faults(reading, cone):
        raise ReadingsError(fault, where="reading")
    depth, top = np.array(reading.depth_m), np.array(reading.top_m)
    new = _new(depth)
    return Profile(
        depth[new], _kpa(reading, cone)[new], reading.ending, top[new] if top.size else top
    )


def flags_of(reading: Reading) -> tuple[str, ...]:
    """What is odd about a reading, beside what it says itself."""
    depth = np.array(reading.depth_m)
    found = dict.fromkeys(reading.flags)
    if not _new(depth).all():
        found[BOUNCED] = None
    if any(value < 0 for value in (*reading.force_n, *reading.kpa)):
        found[BELOW_ZERO] = None
    return tuple(found)


def faults(reading: Reading, cone: Cone) -> str:
    """Why a reading cannot be true; empty if it can."""
    tip, values = reading.tip or cone, reading.force_n or reading.kpa
    if bool(reading.force_n) == bool(reading.kpa) and reading.depth_m:
        return "it gives neither force nor pressure" if not values else "it gives both"
    if len(values) != len(reading.depth_m):
        return f"{len(reading.depth_m)} depths do not pair with {len(values)} readings"
    if not SMALLEST_MM2 <= tip.area_mm2 <= LARGEST_MM2:
        return (
            f"a cone of {tip.area_mm2:g} mm2 is none: "
            f"they have {SMALLEST_MM2:g} to {LARGEST_MM2:g} mm2"
        )
    if not 0 < tip.angle_deg < 180:
        return f"a cone with an apex angle of {tip.angle_deg:g} degrees is none"
    depth = np.array(reading.depth_m)
    if not np.isfinite(depth).all() or (np.abs(depth) > DEEPEST_M).any():
        return f"depths are not all within {DEEPEST_M:g} m: they are in m, positive down"
    if depth.size and (depth < 0).all():
        return "all depths are above the ground: they are in m, positive down"
    if reading.top_m and _overlap(np.array(reading.top_m), depth):
        return _OVERLAP
    return _wrong_values(reading, tip)


def _overlap(top_m: Floats, depth_m: Floats) -> bool:
    """Whether stretches of soil from some tops to depths, (k,) in m, overlap or do not pair."""
    above = np.concatenate([[0.0], depth_m])[:-1]
    return top_m.shape != depth_m.shape or bool(((top_m < above) | (top_m > depth_m)).any())


def _wrong_values(reading: Reading, tip: Cone | Tip) -> str:
    """Which force or pressure no load cell says."""
    name, unit = ("force", "N") if reading.force_n else ("pressure", "kPa")
    values = np.array(reading.force_n or reading.kpa)
    least, most = (SLIGHT_N, HARDEST_N) if reading.force_n else (SLIGHT_KPA, HARDEST_KPA)
    if reading.force_n:
        most = min(most, HARDEST_KPA * tip.area_mm2 / 1000.0)
    wrong = np.flatnonzero(~((values >= -least) & (values <= most)))
    if not wrong.size:
        return ""
    return (
        f"{name} is {values[wrong[0]]:g} {unit} at {reading.depth_m[wrong[0]]:.3f} m, "
        f"and a load cell says {-least:g} to {most:g}"
    )


def _kpa(reading: Reading, cone: Cone) -> Floats:
    if reading.kpa:
        return np.array(reading.kpa)
    return np.array(reading.force_n) / (reading.tip or cone).area_mm2 * 1000.0


def _new(depth: Floats) -> Bools:
    """(k,) whether the rod was deeper than ever before, in the ground."""
    before = np.concatenate([[-np.inf], np.maximum.accumulate(depth)[:-1]])
    return (depth > before) & (depth >= 0)


def profile(depth_m: ArrayLike, kpa: ArrayLike, ending: Ending = "stroke") -> Profile:
    """Build a :class:`Profile` from anything array-like.

    Raises
    ------
    ReadingsError
        If depths do not increase, lengths differ, or a value is not finite or clearly below zero.
    """
    return Profile(np.array(depth_m, dtype=float), np.array(kpa, dtype=float), ending)


def _check_series(depth_m: Floats, values: Floats, name: str, slight: float) -> None:
    for array in (depth_m, values):
        array.setflags(write=False)
    if depth_m.ndim != 1 or depth_m.shape != values.shape:
        raise ReadingsError(
            f"{depth_m.size} depths do not pair with {values.size} {name} readings",
            remedy="give one depth a reading",
        )
    descending = (depth_m[1:] > depth_m[:-1]).all() and np.isfinite(depth_m).all()
    if depth_m.size and not (descending and depth_m[0] >= 0):
        raise ReadingsError(
            "depths must increase downwards from the surface",
            remedy="give depth in metres, positive down, shallowest first",
        )
    fine = np.isfinite(values) & (values >= -slight)
    if not fine.all():
        bad = np.flatnonzero(~fine)
        raise ReadingsError(
            f"{name} is {values[bad[0]]:g} at {depth_m[bad[0]]:.3f} m",
            remedy="leave out readings that were not taken",
        )
