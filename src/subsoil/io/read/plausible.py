"""Strengths that no soil has as a rule: most often another unit than the heading says."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from subsoil.findings import Finding
from subsoil.penetrometer import Profile

_SOFTEST_KPA = 50.0
_SOFT_KPA = 300.0
_HARD_KPA = 8000.0
_TILLED_M = 0.2


def strength_doubts(profiles: Sequence[Profile], file: str) -> tuple[Finding, ...]:
    """Say if the typical strength of all readings together is none of soil.

    Freshly tilled topsoil may have 100 kPa; below it there is more.
    """
    kpa = np.concatenate([np.zeros(0), *(profile.kpa for profile in profiles)])
    deep = max((profile.depth_m[-1] for profile in profiles), default=0.0) > _TILLED_M
    typical = float(np.median(kpa[kpa > 0])) if (kpa > 0).any() else _SOFT_KPA
    if typical < _SOFTEST_KPA:
        seen = f"the typical reading is {typical:.3g} kPa, a small part of any soil's strength"
        done = "check the unit (MPa or psi under a heading of kPa?)"
        return (Finding(seen, done, "doubt", file),)
    if typical < _SOFT_KPA and deep:
        seen = f"the typical reading is {typical:.3g} kPa, softer than almost any soil"
        return (Finding(seen, "check the unit (psi under a heading of kPa?)", "doubt", file),)
    if typical > _HARD_KPA:
        seen = f"the typical reading is {typical:.4g} kPa, harder than almost any soil"
        return (Finding(seen, "check the unit (kPa under a heading of psi?)", "doubt", file),)
    return ()
