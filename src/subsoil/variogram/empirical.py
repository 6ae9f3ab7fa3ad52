"""Empirical variograms: how much samples differ, by the distance between them.

Every pair of samples closer than a cut-off falls into a bin of lags. A bin's semivariance is half
the mean squared difference of its pairs (Matheron), or a robust version of that (Cressie &
Hawkins). Layers share places, so the pairs, their distances and bins are worked out
once for all layers.

The cut-off is a third of the diagonal of the samples' bounding box unless given: beyond about
half the field's extent the same few corners make all pairs. Up to the cut-off lie roughly half of
all pairs; a twelfth of it as the bin width leaves the 30 pairs a bin that Journel & Huijbregts
(*Mining Geostatistics*, 1978, p. 194) ask for from about 40 samples on.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from subsoil.arrays import Floats, Integers
from subsoil.errors import ParameterError, ReadingsError

Formula = Literal["matheron", "cressie-hawkins"]
"""How the differences in a bin are averaged; Cressie and Hawkins' way bears outliers."""

CUTOFF_SHARE = 1 / 3
"""Default cut-off as a share of the diagonal of the samples' bounding box."""
BINS = 12
"""Bins up to the cut-off where no bin width is given."""
_PAIRS = 1 << 21
"""Pairs, near and far, that are worked on at a time."""


@dataclass(frozen=True)
class EmpiricalVariogram:
    """Semivariance by lag as the samples show it; bins without pairs are left out.

    Attributes
    ----------
    lag
        (b,) mean distance of each bin's pairs in m, increasing.
    semivariance
        (b,) estimate in squared units of the data.
    pairs
        (b,) number of pairs behind each estimate.
    formula
        Formula of the estimate.
    """

    lag: Floats
    semivariance: Floats
    pairs: Integers
    formula: Formula = "matheron"

    def __post_init__(self) -> None:
        for array in (self.lag, self.semivariance, self.pairs):
            array.setflags(write=False)


@dataclass(frozen=True)
class _Pairs:
    """Pairs of places within the cut-off: who, how far apart and in which bin; all (p,)."""

    one: Integers
    other: Integers
    distance: Floats
    bin: Integers


def empirical(
    at: ArrayLike,
    z: ArrayLike,
    *,
    bin_width: float | None = None,
    cutoff: float | None = None,
    formula: Formula = "matheron",
) -> EmpiricalVariogram:
    """Empirical variogram of one layer.

    Bin k holds the pairs with ``k <= distance / bin_width < k + 1``, up to the cut-off (itself
    excluded). Repeats at one place are pairs at distance 0 and count in the first bin.

    Parameters
    ----------
    at
        (n, 2) eastings and northings in m.
    z
        (n,) values; NaN where the layer was not measured.
    bin_width
        Width of the bins in m. Default: a twelfth of the cut-off.
    cutoff
        Distance in m from which pairs are left out. Default: a third of the diagonal of the
        bounding box of the samples measured.
    formula
        ``"matheron"`` (1962), or ``"cressie-hawkins"``: the fourth power of the mean root
        difference, which outliers move less (*Math. Geol.* 12, 1980, 115-125).

    Raises
    ------
    ReadingsError
        If shapes do not match, a coordinate or value is not finite, there are fewer than two
        values, or all are at one place.
    ParameterError
        If bin width or cut-off is not positive, or there is no such formula.

    Examples
    --------
    Three samples on a line, 10 m apart: two pairs at 10 m and one at 20 m.

    >>> curve = empirical([[0, 0], [10, 0], [20, 0]], [1.0, 3.0, 2.0], bin_width=8.0, cutoff=30.0)
    >>> curve.lag, curve.semivariance, curve.pairs
    (array([10., 20.]), array([1.25, 0.5 ]), array([2, 1]))
    """
    places, values = _checked(at, np.asarray(z, dtype=float)[None])
    known = ~np.isnan(values[0])
    if known.sum() < 2:
        raise ReadingsError(
            f"{known.sum()} of {known.size} samples have a value, which makes no pair",
            where="empirical variogram",
            remedy="take at least two samples of the layer",
        )
    if not np.ptp(places[known], axis=0).any():
        raise ReadingsError(
            f"all {known.sum()} samples are at one place",
            where="empirical variogram",
            remedy="take samples some distance apart",
        )
    return empirical_layers(
        places[known],
        values[:, known],
        bin_width=bin_width,
        cutoff=cutoff,
        formula=formula,
    )[0]


def empirical_layers(
    at: ArrayLike,
    z: ArrayLike,
    *,
    bin_width: float | None = None,
    cutoff: float | None = None,
    formula: Formula = "matheron",
) -> tuple[EmpiricalVariogram, ...]:
    """Empirical variogram of each of several layers sampled at the same places.

    As :func:`empirical`, with one cut-off and bin width for all layers (from the box around all
    places). A layer without a single pair has no bins; that is not an error, because a survey
    begins that way.

    Parameters
    ----------
    at
        (n, 2) eastings and northings in m.
    z
        (m, n) values; NaN where a layer was not measured.
    bin_width, cutoff, formula
        As in :func:`empirical`.

    Raises
    ------
    ReadingsError
        If shapes do not match, or a coordinate or value is not finite.
    ParameterError
        If bin width or cut-off is not positive, or there is no such formula.
    """
    check_binning(bin_width, cutoff, formula)
    places, values = _checked(at, z)
    if cutoff is None:
        extent = np.ptp(places, axis=0) if len(places) else np.zeros(2)
        cutoff = CUTOFF_SHARE * float(np.hypot(*extent))
    width = cutoff / BINS if bin_width is None else bin_width
    sums = [np.zeros((3, 0)) for _ in values]
    for pairs in _pairs(places, width, cutoff):
        further = (_sums(pairs, layer, formula) for layer in values)
        sums = [_more(*both) for both in zip(sums, further, strict=True)]
    return tuple(_curve(each, formula) for each in sums)


def check_binning(bin_width: float | None, cutoff: float | None, formula: str) -> None:
    """Raise ParameterError for a setting of :func:`empirical` that is outside what it may be."""
    for name, given in (("bin width", bin_width), ("cut-off", cutoff)):
        if given is not None and not 0 < given < np.inf:
            raise ParameterError(
                f"must be a positive distance in metres, not {given:g}",
                where=f"variogram {name}",
            )
    if formula not in get_args(Formula):
        raise ParameterError(
            f"there is no formula {formula!r}",
            where="variogram formula",
            remedy=f"one of {', '.join(get_args(Formula))}",
        )


def _checked(at: ArrayLike, z: ArrayLike) -> tuple[Floats, Floats]:
    """Places (n, 2) and values (m, n) as arrays that can be used."""
    places, values = np.asarray(at, dtype=float), np.asarray(z, dtype=float)
    if places.ndim != 2 or places.shape[1] != 2 or values.shape[1:] != places.shape[:1]:
        raise ReadingsError(
            f"places of shape {places.shape} do not pair with values of shape {values.shape[-1:]}",
            where="variogram samples",
            remedy="give one easting and northing a sample",
        )
    bad = np.flatnonzero(~np.isfinite(places).all(axis=1))
    if bad.size:
        raise ReadingsError(
            "a coordinate is missing or infinite",
            where=f"variogram sample {bad[0]}",
            remedy="leave out samples without a position",
        )
    bad = np.flatnonzero(np.isinf(values).any(axis=0))
    if bad.size:
        raise ReadingsError(
            "a value is infinite",
            where=f"variogram sample {bad[0]}",
            remedy="give NaN where a layer was not measured",
        )
    return places, values


def _pairs(at: Floats, width: float, cutoff: float) -> Iterator[_Pairs]:
    """Pairs of places nearer than the cut-off, those of some places at a time."""
    step = max(1, _PAIRS // max(1, len(at)))
    for start in range(0, len(at), step):
        rest = at[start:]
        one, other = np.triu_indices(min(step, len(rest)), 1, len(rest))
        distance = np.hypot(*(rest[one] - rest[other]).T)
        near = distance < cutoff
        distance = distance[near]
        in_bin = (distance / width).astype(np.int64)
        yield _Pairs(one[near] + start, other[near] + start, distance, in_bin)


def _sums(pairs: _Pairs, z: Floats, formula: Formula) -> Floats:
    """(3, b) pairs in each bin of one layer, their distances and powers of their differences.

    Of (n,) values with NaN where the layer was not measured.
    """
    difference = np.abs(z[pairs.one] - z[pairs.other])
    known = ~np.isnan(difference)
    difference, in_bin = difference[known], pairs.bin[known]
    power = difference**2 if formula == "matheron" else np.sqrt(difference)
    number = np.bincount(in_bin).astype(float)
    return np.stack(
        [number, np.bincount(in_bin, pairs.distance[known]), np.bincount(in_bin, power)]
    )


def _more(sums: Floats, further: Floats) -> Floats:
    """(3, b) sums by bin of two lots of pairs, either of which may reach further bins."""
    short, long = sorted((sums, further), key=lambda each: each.shape[1])
    total = long.copy()
    total[:, : short.shape[1]] += short
    return total


def _curve(sums: Floats, formula: Formula) -> EmpiricalVariogram:
    """Bin means of one layer by its (3, b) sums."""
    filled = np.flatnonzero(sums[0])
    number, distance, power = sums[:, filled]
    mean = power / number
    if formula == "cressie-hawkins":
        mean = mean**4 / (0.457 + 0.494 / number + 0.045 / number**2)
    return EmpiricalVariogram(distance / number, mean / 2, number.astype(np.int64), formula)
