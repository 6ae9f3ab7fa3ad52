"""Cones, pushes and resistance profiles: from force in newtons to pressure in kilopascals.

A penetrometer measures the force on a cone; soil strength is that force over the area of the
cone's base (cone index, ASABE S313.3). The area differs sixfold between common cones, so nothing
here assumes one.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from subsoil.errors import ParameterError, ReadingsError

Floats = NDArray[np.float64]
Ending = Literal["stroke", "force"]
"""Why a push ended: the rod reached the end of its stroke, or the force its limit."""


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
        If the area is not positive or the angle is not between 0 and 180 degrees.

    Examples
    --------
    The same 600 N are 1858 kPa on the large ASABE cone and 4615 kPa on the small one:

    >>> round(LARGE_CONE.pressure_kpa(600.0)), round(SMALL_CONE.pressure_kpa(600.0))
    (1858, 4615)
    """

    area_mm2: float
    angle_deg: float = 30.0

    def __post_init__(self) -> None:
        if not (np.isfinite(self.area_mm2) and self.area_mm2 > 0):
            raise ParameterError(
                f"a cone needs a positive base area in mm2, not {self.area_mm2:g}",
                where="cone area",
                remedy="323 (large ASABE cone) or 130 (small) are the usual ones",
            )
        if not 0 < self.angle_deg < 180:
            raise ParameterError(
                f"a cone's apex angle lies between 0 and 180 degrees, not {self.angle_deg:g}",
                where="cone angle",
            )

    def pressure_kpa(self, force_n: float) -> float:
        """Cone index in kPa under a force in N."""
        return force_n / self.area_mm2 * 1000.0

    def force_n(self, pressure_kpa: float) -> float:
        """Force in N that a cone index in kPa asks for."""
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
        _check_series(self.depth_m, self.force_n, "force")

    def profile(self, cone: Cone) -> Profile:
        """Cone index by depth under this cone."""
        return Profile(self.depth_m, self.force_n / cone.area_mm2 * 1000.0, self.ending)


@dataclass(frozen=True)
class Profile:
    """Soil strength by depth at one place.

    Attributes
    ----------
    depth_m
        (k,) increasing depths in m, positive down. A reading stands for the soil since the
        reading above it.
    kpa
        (k,) cone index at each depth in kPa.
    ending
        What ended the push; after ``"force"`` the soil below is at least as hard as the last
        reading says at its own depth.
    """

    depth_m: Floats
    kpa: Floats
    ending: Ending = "stroke"

    def __post_init__(self) -> None:
        _check_series(self.depth_m, self.kpa, "pressure")


def profile(depth_m: ArrayLike, kpa: ArrayLike, ending: Ending = "stroke") -> Profile:
    """Build a :class:`Profile` from anything array-like.

    Raises
    ------
    ReadingsError
        If depths do not increase, lengths differ, or a value is not finite or is negative.
    """
    return Profile(np.array(depth_m, dtype=float), np.array(kpa, dtype=float), ending)


def _check_series(depth_m: Floats, values: Floats, name: str) -> None:
    for array in (depth_m, values):
        array.setflags(write=False)
    if depth_m.ndim != 1 or depth_m.shape != values.shape:
        raise ReadingsError(
            f"{depth_m.size} depths do not pair with {values.size} {name} readings",
            remedy="give one depth a reading",
        )
    descending = np.all(np.diff(depth_m) > 0) and np.all(np.isfinite(depth_m))
    if depth_m.size and not (descending and depth_m[0] >= 0):
        raise ReadingsError(
            "depths must increase downwards from the surface",
            remedy="give depth in metres, positive down, shallowest first",
        )
    bad = np.flatnonzero(~np.isfinite(values) | (values < 0))
    if bad.size:
        raise ReadingsError(
            f"{name} is {values[bad[0]]:g} at {depth_m[bad[0]]:.3f} m",
            remedy="leave out readings that were not taken",
        )
