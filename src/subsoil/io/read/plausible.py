"""Strengths that no soil has as a rule: most often another unit than the heading says."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from subsoil.penetrometer import Profile

_SOFTEST_KPA = 50.0
_SOFT_KPA = 300.0
_HARD_KPA = 8000.0
_TILLED_M = 0.2


def strength_notes(profiles: Sequence[Profile]) -> tuple[str, ...]:
    """Say if the typical strength of all readings together is none of soil.

    Freshly tilled topsoil may have 100 kPa; below it there is more.
    """
    kpa = np.concatenate([np.zeros(0), *(profile.kpa for profile in profiles)])
    deep = max((profile.depth_m[-1] for profile in profiles), default=0.0) > _TILLED_M
    typical = float(np.median(kpa[kpa > 0])) if (kpa > 0).any() else _SOFT_KPA
    if typical < _SOFTEST_KPA:
        return (
            f"the typical reading is {typical:.3g} kPa, a small part of any soil's strength: "
            "check the unit (MPa or psi under a heading of kPa?)",
        )
    if typical < _SOFT_KPA and deep:
        return (
            f"the typical reading is {typical:.3g} kPa, softer than almost any soil: "
            "check the unit (psi under a heading of kPa?)",
        )
    if typical > _HARD_KPA:
        return (
            f"the typical reading is {typical:.4g} kPa, harder than almost any soil: "
            "check the unit (kPa under a heading of psi?)",
        )
    return ()
