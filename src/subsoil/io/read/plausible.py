"""Readings that no soil gives as a rule: another unit, a slip of the pen, a probe out of hand.

Each function looks at arrays and says what is odd in findings. Only positions far from all others
(:func:`stray`) are left out; all else is kept, for its owner to look at.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from subsoil.arrays import Bools, Floats, Integers
from subsoil.findings import Finding
from subsoil.io.read.plausible_places import coarse, crowded, frozen, stray
from subsoil.io.read.recording import KPA, Frame
from subsoil.io.read.screening import Push
from subsoil.penetrometer import Cone, Profile

__all__ = ["doubts", "stray"]

_SOFTEST_KPA, _SOFT_KPA, _HARD_KPA = 50.0, 300.0, 8000.0
_USUAL_KPA = (300.0, 5000.0)
"""What the typical reading of a survey lies between as a rule."""
_TILLED_M, _SHALLOW_M = 0.2, 0.04
_TIMES_IN_DEPTH, _TIMES_IN_SPACE, _BEYOND_TYPICAL = 4.0, 3.0, 1.5
_NEIGHBOURS, _MOST_SPIKES = 8, 100
_SLOW_MPS, _FAST_MPS = 0.005, 0.06
_SMALL_MM2 = 50.0
_SIGMAS = 2.5
_FEWEST_ENDED, _MOST_ENDS = 4, 50
_SPEEDS = "0.03 m/s is the rule (ASABE S313.3), and soil resists more the faster it is pushed"


def doubts(
    pushes: Sequence[Push], at: Floats, frame: Frame, cone: Cone | None, file: str
) -> tuple[Finding, ...]:
    """What is odd about pushes at (n, 2) places in m, read from a file in a frame."""
    if not pushes:
        return ()
    rows = np.array([push.record.row for push in pushes], dtype=np.int64)
    x = np.array([push.record.x for push in pushes])
    y = np.array([push.record.y for push in pushes])
    flat = Flat.of([push.profile for push in pushes])
    return (
        *strength(flat, file),
        *depths(flat, file),
        *cone_area(cone, file),
        *spikes(flat, at, rows, file),
        *ended_early(flat, file),
        *speed([(push.record.depth_m, push.record.seconds) for push in pushes], file),
        *coarse(x, y, frame, file),
        *frozen(x, y, rows, file),
        *crowded(x, y, rows, file),
    )


@dataclass(frozen=True)
class Flat:
    """All readings of all pushes, one push after the other.

    Attributes
    ----------
    push
        (k,) which push each is of, from 0 on.
    top_m, depth_m
        (k,) depths in m between which it stands for the soil.
    kpa
        (k,) pressures in kPa.
    ends_m
        (n,) depth in m of the last reading of each push.
    """

    push: Integers
    top_m: Floats
    depth_m: Floats
    kpa: Floats
    ends_m: Floats

    @classmethod
    def of(cls, profiles: Sequence[Profile]) -> Flat:
        """Readings of (n,) pushes, each of which has one or more."""
        sizes = np.array([profile.kpa.size for profile in profiles])
        depth_m = np.concatenate([profile.depth_m for profile in profiles])
        return cls(
            np.repeat(np.arange(sizes.size), sizes),
            np.concatenate([profile.top_m for profile in profiles]),
            depth_m,
            np.concatenate([profile.kpa for profile in profiles]),
            depth_m[np.cumsum(sizes) - 1],
        )

    @cached_property
    def typical_kpa(self) -> float:
        """Median of all readings above zero; zero if there is none."""
        above = self.kpa[self.kpa > 0]
        return float(np.median(above)) if above.size else 0.0

    def covering(self, depth_m: float) -> Bools:
        """(k,) which readings stand for the soil just above a depth."""
        return np.asarray((self.top_m < depth_m) & (self.depth_m >= depth_m))


def strength(flat: Flat, file: str) -> Iterator[Finding]:
    """Say if the typical strength of all readings together is none of soil.

    Freshly tilled topsoil may have 100 kPa; below it there is more.
    """
    deep = flat.ends_m.max() > _TILLED_M
    typical = flat.typical_kpa
    if not typical:
        return
    if typical > _HARD_KPA:
        seen = f"the typical reading is {typical:.4g} kPa, harder than almost any soil"
        done = "check the unit: kPa under a heading of psi? the cone area?"
    elif typical < _SOFTEST_KPA or (typical < _SOFT_KPA and deep):
        how = "a small part of any soil's strength"
        how = how if typical < _SOFTEST_KPA else "softer than almost any soil"
        seen = f"the typical reading is {typical:.3g} kPa, {how}"
        units = [
            f"{unit} would be {factor * typical:.4g} kPa"
            for unit, factor in (("MPa", KPA["mpa"]), ("psi", KPA["psi"]), ("bar", KPA["bar"]))
            if _USUAL_KPA[0] <= factor * typical <= _USUAL_KPA[1]
        ]
        done = "check the unit: " + (" or ".join(units) or "none that is known makes it usual")
    else:
        return
    yield Finding(seen, done, "doubt", file)


def depths(flat: Flat, file: str) -> Iterator[Finding]:
    """Say if no push went deeper than a finger is thick."""
    deepest = flat.ends_m.max()
    if deepest < _SHALLOW_M:
        seen = f"the deepest reading is at {deepest:.3g} m"
        yield Finding(seen, "check the unit of depths", "doubt", file)


def cone_area(cone: Cone | None, file: str) -> Iterator[Finding]:
    """Say if the area of a cone looks like its diameter, or like an area in cm2."""
    if cone and cone.area_mm2 < _SMALL_MM2:
        area = np.pi / 4 * cone.area_mm2**2
        seen = f"a cone of {cone.area_mm2:g} mm2 is smaller than any in use on fields"
        done = f"if that is its diameter in mm, give {area:.0f}; if its area in cm2, 100 times that"
        yield Finding(seen, done, "doubt", file)


def spikes(flat: Flat, at: Floats, rows: Integers, file: str) -> Iterator[Finding]:
    """Name single readings far beyond those above and below, and those of the pushes around.

    A stone is hard too, but is rarely met in one reading alone that is several times as hard as
    all around: an extra digit is.
    """
    same = flat.push[1:] == flat.push[:-1]
    above = np.concatenate([[np.nan], np.where(same, flat.kpa[:-1], np.nan)])
    below = np.concatenate([np.where(same, flat.kpa[1:], np.nan), [np.nan]])
    beside = np.fmax(above, below)
    beyond = flat.kpa - beside > _BEYOND_TYPICAL * flat.typical_kpa
    found = np.flatnonzero(beyond & (flat.kpa > _TIMES_IN_DEPTH * beside))
    if found.size > _MOST_SPIKES:
        seen = f"{found.size} readings are several times as hard as those above and below"
        yield Finding(seen, "kept; check the instrument, or the decimal marks", "doubt", file)
        return
    for k in found:
        around = _around(flat, at, int(flat.push[k]), flat.depth_m[k])
        if around.size and flat.kpa[k] <= _TIMES_IN_SPACE * around.max():
            continue
        hardest = float(np.max([beside[k], *around]))
        seen = f"{flat.kpa[k]:.5g} kPa, where readings around it have {hardest:.4g} kPa at most"
        done = "kept; correct it if it is a slip of the pen"
        column = f"{flat.depth_m[k]:g} m"
        yield Finding(seen, done, "doubt", file, int(rows[flat.push[k]]), column)


def _around(flat: Flat, at: Floats, push: int, depth_m: float) -> Floats:
    """Readings at a depth of the pushes nearest to one, kPa."""
    others = flat.covering(depth_m) & (flat.push != push)
    away = np.hypot(*(at[flat.push[others]] - at[push]).T)
    return np.asarray(flat.kpa[others][np.argsort(away, kind="stable")[:_NEIGHBOURS]])


def ended_early(flat: Flat, file: str) -> Iterator[Finding]:
    """Say if pushes ended where it was harder than others had it: below them the map is too soft.

    Where pushes end by chance, the shares of other pushes that had it softer at that depth are
    evenly spread, and their mean over m pushes has a standard deviation of ``(12 m) ** -0.5``.
    """
    ends = flat.ends_m
    depths_m, counts = np.unique(ends, return_counts=True)
    full = depths_m[np.argmax(counts)]
    early = np.flatnonzero(ends < full)
    if early.size < _FEWEST_ENDED:
        return
    shares: list[float] = []
    met: list[tuple[float, float]] = []
    for end in np.unique(ends[early])[-_MOST_ENDS:]:
        here = flat.covering(end)
        others = flat.kpa[here & (ends[flat.push] > end)]
        for last in flat.kpa[here & (ends[flat.push] == end)] if others.size else ():
            shares.append(float((others < last).mean() + (others == last).mean() / 2))
            met.append((float(last), float(np.median(others))))
    if not shares or np.mean(shares) < 0.5 + _SIGMAS / np.sqrt(12 * len(shares)):
        return
    harder, usual = np.median(met, axis=0)
    seen = (
        f"{early.size} of {ends.size} pushes ended above {full:g} m, at {harder:.4g} kPa "
        f"where others had {usual:.4g} kPa (typical)"
    )
    done = "deep layers rest on the pushes that got through, so the map is too soft there"
    yield Finding(seen, done, file=file)


def speed(pushes: Sequence[tuple[Floats, Floats]], file: str) -> Iterator[Finding]:
    """Say if pushes, depths in m and times in s, were much slower or faster than the standard."""
    speeds = [
        float((depth_m[-1] - depth_m[0]) / (seconds[-1] - seconds[0]))
        for depth_m, seconds in pushes
        if seconds.size > 1 and seconds[-1] > seconds[0]
    ]
    odd = [each for each in speeds if not _SLOW_MPS <= each <= _FAST_MPS]
    if odd:
        seen = f"{len(odd)} of {len(speeds)} pushes went at {np.median(odd):.2g} m/s"
        yield Finding(seen, _SPEEDS, "doubt", file)
