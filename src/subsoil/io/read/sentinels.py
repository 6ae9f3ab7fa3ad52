"""Sentinels: numbers that stand for no data in a file that does not say so."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from subsoil.arrays import Bools, Floats

_CODES = (
    -9999, -999, -99, -99999, -32768, -32767, 32767, 65535, 9999, 99999, 999999, -999999, -1e20,
    1e20, -1e30, 1e30, -2147483648, 2147483647, 4294967295,
)  # fmt: skip
"""What programs write where they know nothing."""
_HUGEST = 1e30
_WIDTHS = 2.0


@dataclass(frozen=True)
class Sentinels:
    """Numbers among others that stand for no data, or may.

    Attributes
    ----------
    codes
        Those that surely do.
    odd
        A number that several places share, far from all others; NaN if there is none.
    low, high
        What the others lie between.
    """

    codes: tuple[float, ...]
    odd: float
    low: float
    high: float

    def are(self, values: Floats) -> Bools:
        """Which of the values are surely none."""
        return np.isin(values, self.codes) | (np.abs(values) >= _HUGEST)


def sentinels_in(values: Floats) -> Sentinels:
    """Numbers that stand for no data among (n,) values; NaN counts for nothing.

    A code does where it lies farther from all other values than these reach twice.

    Examples
    --------
    >>> found = sentinels_in(np.array([24.0, 30.0, -9999.0, 36.0, -9999.0]))
    >>> found.codes, found.low, found.high
    ((-9999.0,), 24.0, 36.0)
    >>> sentinels_in(np.array([0.0, 0.0, 24.0, 30.0])).odd
    0.0
    """
    known = values[np.isfinite(values)]
    known = known[np.abs(known) < _HUGEST]
    rest = known[~np.isin(known, _CODES)]
    if not rest.size:
        return Sentinels((), np.nan, np.nan, np.nan)
    low, high = float(rest.min()), float(rest.max())
    far = _WIDTHS * (high - low)
    present = np.unique(known[np.isin(known, _CODES)]).tolist()
    codes = tuple(code for code in present if code < low - far or code > high + far)
    kept = known[~np.isin(known, codes)]
    odd = _odd(kept)
    others = kept[kept != odd]
    return Sentinels(codes, odd, float(others.min()), float(others.max()))


def _odd(values: Floats) -> float:
    """Least or greatest value if several share it and it is farther off than the others reach."""
    different, count = np.unique(values, return_counts=True)
    if len(different) < 3:
        return np.nan
    for end, near, far in ((0, 1, -1), (-1, -2, 0)):
        gap = abs(different[end] - different[near])
        if count[end] > 1 and gap > abs(different[near] - different[far]):
            return float(different[end])
    return np.nan
