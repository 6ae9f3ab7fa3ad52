"""Layers of a map that are kriged together."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from subsoil.arrays import Floats, Integers
from subsoil.kriging import Kriged
from subsoil.layers import Sample
from subsoil.variogram import Nested
from subsoil.variogram.models import Variogram


@dataclass(frozen=True)
class Stack:
    """Layers that the same samples reached, kriged together: all with drift, or all without.

    Attributes
    ----------
    layers
        Their indices.
    estimate
        What they were kriged to, cell by cell.
    unit
        (g,) or (1,) what the variances of the estimate are multiples of: the sills of nested models
        of one shape, which one system of sill 1 krigs all of, or else 1.
    samples
        Number of samples taken into account, those that did not reach these layers included.
    """

    layers: tuple[int, ...]
    estimate: Kriged
    unit: Floats
    samples: int

    @property
    def mean(self) -> Floats:
        """(g, N) kriged means of the layers."""
        return self.estimate.prediction.mean

    @property
    def variance(self) -> Floats:
        """(g, N) kriging variance of the layers."""
        return self.unit[:, None] * self.estimate.prediction.variance

    def at_targets(self, targets: ArrayLike) -> Stack:
        """The same layers kriged from the same samples at (k, 2) other places in m."""
        return replace(self, estimate=self.estimate.at_targets(targets))

    def variance_drop(self, cells: Integers) -> Floats:
        """(g, k, N) fall of the variance if one of k cells were probed."""
        return self.unit[:, None, None] * self.estimate.variance_drop(cells)


def in_units(
    models: tuple[Variogram, ...], error: Floats
) -> tuple[Variogram | tuple[Variogram, ...], Floats]:
    """Models to krige with, one where one does for all layers, and the unit of their variances.

    Nested models of one shape give the same weights whatever their sills: unless readings have
    errors, which are in units of the data.
    """
    first = models[0]
    alike = isinstance(first, Nested) and all(
        isinstance(model, Nested) and model.structures == first.structures and model.sill > 0
        for model in models
    )
    if isinstance(first, Nested) and alike and not error.any():
        return first.with_sill(1.0), np.array([model.sill for model in models])
    return (first if len(set(models)) == 1 else models), np.ones(1)


def parted(layers: Integers, drift: tuple[int, ...]) -> Iterator[tuple[int, ...]]:
    """Those of some layers that follow no covariate, and those that do."""
    follows = np.isin(layers, drift)
    for part in (layers[~follows], layers[follows]):
        if len(part):
            yield tuple(part.tolist())


def measured(samples: Sequence[Sample], layers: tuple[int, ...]) -> tuple[Floats, Floats, Floats]:
    """(n, 2) places, (g, n) kPa and (n,) error variances of samples that reached g layers."""
    reached = [s for s in samples if np.isfinite(s.measured_kpa[layers[0]])]
    at = np.array([s.at for s in reached])
    kpa = np.array([s.measured_kpa[list(layers)] for s in reached]).T
    return at, kpa, np.array([s.error_variance for s in reached])
