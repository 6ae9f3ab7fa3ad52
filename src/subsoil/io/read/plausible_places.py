"""Positions that a survey does not have as a rule: far off, frozen, coarse, or on one point."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import scipy

from subsoil.arrays import Bools, Floats, Integers
from subsoil.errors import listed
from subsoil.findings import Finding
from subsoil.io.read.recording import Frame

_FEWEST = 5
"""Pushes below which nothing is typical."""
_FAR_M, _FAR_TIMES = 1_000.0, 4.0
_VERY_FAR_M, _VERY_FAR_TIMES = 10_000.0, 20.0
_OFF_M, _OFF_TIMES = 300.0, 2.0
_ASTRAY = 0.2
"""Share of pushes that may be astray; of more, nobody knows which."""
_SIZE = 4.0
"""A field is about this many times as long as the typical way to its middle."""
_RUN = 4
"""Pushes in a row at one position that no receiver gives by chance."""
_HALF_A_WORLD_M = 5e6
_METRES_A_DEGREE = 111_320.0
_COARSE_M = 5.0
_GRID_M = 10.0
_NATIONAL_M = 10_000.0
"""Coordinates that are larger are of a country's grid, not of a field's."""


def stray(at: Floats, rows: Integers, file: str) -> tuple[Finding, ...]:
    """Positions, (n, 2) m, far from all others; those that are astray for sure are left out.

    A push is astray if nothing lies within 1 km of it nor within four lengths of the survey, or if
    it belongs to a few beyond ten times as much. The length is four times the median distance from
    the median place, so fields side by side, strips and transects have none. A push alone within
    that, but beyond 300 m and two lengths, is a doubt.
    """
    if len(at) < _FEWEST:
        return ()
    finite: Bools = np.isfinite(at[:, 0]) & np.isfinite(at[:, 1])
    middle = np.median(at[finite], axis=0) if finite.any() else np.zeros(2)
    away = np.where(finite, np.hypot(*(np.where(finite[:, None], at, 0.0) - middle).T), np.inf)
    length = _SIZE * float(np.median(away))
    astray = _alone(at, away, max(_FAR_M, _FAR_TIMES * length))
    astray |= _apart(at, away, max(_VERY_FAR_M, _VERY_FAR_TIMES * length))
    doubtful = _alone(at, away, max(_OFF_M, _OFF_TIMES * length))
    if not (astray | doubtful).any() or (astray | doubtful).mean() > _ASTRAY:
        return ()
    gap = _gap(at, away, astray | doubtful)
    return tuple(
        _far_off(gap[k], bool(astray[k]), file, int(rows[k]))
        for k in np.flatnonzero(astray | doubtful)
    )


def _far_off(metres: float, astray: bool, file: str, row: int) -> Finding:
    seen = f"its position is {_far(metres)} from all others"
    if astray:
        done = "left out; correct it, or give the outline of the field"
        return Finding(seen, done, "left out", file, row)
    return Finding(seen, "kept; correct it if it was taken elsewhere", "doubt", file, row)


def _alone(at: Floats, away: Floats, least_m: float) -> Bools:
    """(n,) whether the nearest other place is farther than a distance."""
    far = ~(away <= least_m)
    alone = np.zeros(len(at), dtype=bool)
    alone[~np.isfinite(away)] = True
    known = np.flatnonzero(far & np.isfinite(away))
    if known.size:
        nearest = np.asarray(scipy.spatial.KDTree(at[np.isfinite(away)]).query(at[known], k=2)[0])
        alone[known] = nearest[:, 1] > least_m
    return alone


def _apart(at: Floats, away: Floats, least_m: float) -> Bools:
    """(n,) whether a place is farther than a distance from all that are not so far themselves."""
    far = ~(away <= least_m)
    if not far.any() or far.all():
        return np.zeros(len(at), dtype=bool)
    apart = far.copy()
    known = far & np.isfinite(away)
    apart[known] = scipy.spatial.KDTree(at[~far]).query(at[known])[0] > least_m
    return apart


def _gap(at: Floats, away: Floats, astray: Bools) -> Floats:
    """(n,) metres from the nearest place that is not astray."""
    gap = np.full(len(at), np.inf)
    known = np.isfinite(away)
    gap[known] = scipy.spatial.KDTree(at[~astray]).query(at[known])[0]
    return gap


def _far(metres: float) -> str:
    if not metres < _HALF_A_WORLD_M:
        return "half a world"
    return f"{metres / 1000:.0f} km" if metres >= 10_000 else f"{metres / 1000:.1f} km"


def frozen(x: Floats, y: Floats, rows: Integers, file: str) -> Iterator[Finding]:
    """Name pushes in a row that share a position to its last digit, where others do not."""
    starts = np.concatenate([[True], (np.diff(x) != 0) | (np.diff(y) != 0)])
    first = np.flatnonzero(starts)
    lengths = np.diff(np.append(first, len(x)))
    if len(first) == 1:
        return
    for run in np.flatnonzero((lengths >= _RUN) & (lengths > 2 * np.median(lengths))):
        start, length = first[run], lengths[run]
        last = rows[start + length - 1]
        seen = f"{length} pushes in a row, to row {last}, share a position to its last digit"
        done = "kept as repeats at one place; did the receiver stand still?"
        yield Finding(seen, done, "doubt", file, int(rows[start]))


def crowded(x: Floats, y: Floats, rows: Integers, file: str) -> Iterator[Finding]:
    """Name a position that many pushes share, here and there in the file, or all of them."""
    places, which, counts = np.unique(
        np.column_stack([x, y]), axis=0, return_inverse=True, return_counts=True
    )
    which = which.reshape(-1)
    if len(places) == 1:
        if len(x) >= _FEWEST:
            seen = f"all {len(x)} pushes share one position"
            yield Finding(seen, "nothing can be mapped; check the receiver", "doubt", file)
        return
    order = np.split(np.argsort(which, kind="stable"), np.cumsum(counts)[:-1])
    for place in np.flatnonzero((counts >= _RUN) & (counts > 2 * np.median(counts))):
        here = order[place]
        if np.ptp(here) == here.size - 1:
            continue
        seen = f"{here.size} pushes share a position, rows {listed([str(r) for r in rows[here]])}"
        done = (
            "kept as repeats at one place; an old position, one typed twice, or too few decimals?"
        )
        yield Finding(seen, done, "doubt", file, int(rows[here[0]]))


def coarse(x: Floats, y: Floats, frame: Frame, file: str) -> Iterator[Finding]:
    """Say if positions are rounded to more than the accuracy of a receiver."""
    both = np.concatenate([x, y])
    if len(x) < _FEWEST or max(np.ptp(x), np.ptp(y)) == 0:
        return
    if frame == "lonlat":
        step = _degrees_step(both) * _METRES_A_DEGREE
        if step >= _COARSE_M:
            yield _rounded(step, file)
    elif np.abs(both).max() > _NATIONAL_M and not (both % _GRID_M).any():
        yield _rounded(_GRID_M, file)


def _degrees_step(values: Floats) -> float:
    """Degrees to which all values are rounded: decimals of a degree, a minute or a second."""
    steps = [
        10.0**-decimals / parts
        for parts in (1, 60, 3600)
        for decimals in range(5)
        if np.abs(values * parts * 10**decimals - np.round(values * parts * 10**decimals)).max()
        < 1e-7 * parts * 10**decimals + 1e-9
    ]
    return max(steps, default=0.0)


def _rounded(step_m: float, file: str) -> Finding:
    seen = f"positions are rounded to steps of {step_m:.0f} m"
    done = f"each may be {step_m / 2:.0f} m off; export more decimals"
    return Finding(seen, done, "doubt", file)
