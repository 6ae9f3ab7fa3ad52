"""The layered map of a field: kriged means and variances of every layer, and how sure it is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from subsoil.errors import ParameterError
from subsoil.kriging import Estimate, condition, over
from subsoil.kriging.estimate import broken_layers
from subsoil.layers import Layers, Sample
from subsoil.variogram import Estimator, Fit
from subsoil.variogram.models import Variogram

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Stack:
    """Layers that the same samples reached, kriged together."""

    layers: tuple[int, ...]
    estimate: Estimate


@dataclass(frozen=True)
class SoilMap:
    """Soil strength of every cell and layer, given samples and one variogram a layer.

    A value: appending a sample or refitting returns a new map. A sample that did not reach a
    layer is not in that layer's system. Kriging happens when a result is first asked for.

    Parameters
    ----------
    cells
        (N, 2) cell centres in m.
    layers
        Depth bands, m of them.
    variograms
        m models; may be empty while there is no sample.
    samples
        Readings so far.

    Raises
    ------
    ParameterError
        If there are samples and not one variogram a layer.
    """

    cells: Floats
    layers: Layers
    variograms: tuple[Variogram, ...] = ()
    samples: tuple[Sample, ...] = ()

    def __post_init__(self) -> None:
        if self.samples and len(self.variograms) != len(self.layers):
            raise ParameterError(
                f"{len(self.variograms)} variograms for {len(self.layers)} layers",
                where="soil map",
                remedy="give one a layer",
            )

    def append(self, sample: Sample) -> SoilMap:
        """Map with one more sample under the same variograms; exact, and cheap once kriged."""
        grown = replace(self, samples=(*self.samples, sample))
        if "stacks" in self.__dict__ and self.samples:
            stacks = _grown(self.stacks, sample)
            if stacks and np.isfinite(sample.measured_kpa[list(_missing(self))]).sum() == 0:
                grown.__dict__["stacks"] = stacks
        return grown

    def refit(self, variograms: Sequence[Variogram]) -> SoilMap:
        """Map of the same samples under other variograms, one a layer."""
        return replace(self, variograms=tuple(variograms))

    def fit(self, estimator: Estimator) -> tuple[Fit, ...]:
        """Fit reports of an estimator on the samples of this map, one a layer."""
        return estimator(self.at, self.kpa)

    @property
    def at(self) -> Floats:
        """(n, 2) places of the samples in m."""
        return np.array([s.at for s in self.samples], dtype=float).reshape(-1, 2)

    @property
    def kpa(self) -> Floats:
        """(m, n) measured layer means in kPa, NaN where a layer was not measured."""
        rows = [s.measured_kpa for s in self.samples]
        return np.array(rows, dtype=float).reshape(-1, len(self.layers)).T

    @cached_property
    def stacks(self) -> tuple[Stack, ...]:
        """Layers by the samples that reached them; layers without any are in none."""
        reached = np.isfinite(self.kpa)
        patterns: dict[bytes, list[int]] = {}
        for layer, row in enumerate(reached):
            if row.any():
                patterns.setdefault(row.tobytes(), []).append(layer)
        return tuple(self._stack(tuple(layers)) for layers in patterns.values())

    def _stack(self, layers: tuple[int, ...]) -> Stack:
        chosen = list(layers)
        values = self.kpa[chosen]
        reached = np.isfinite(values[0])
        error = np.array([s.error_variance for s in self.samples])[reached]
        models = tuple(self.variograms[k] for k in layers)
        ok = condition(
            models[0] if len(set(models)) == 1 else models,
            self.at[reached],
            values[:, reached],
            error_variance=error,
        )
        estimate = over(ok, self.cells)
        broken = broken_layers(ok, estimate.prediction.variance)
        return Stack(
            layers, over(ok.with_circular(broken), self.cells) if broken.any() else estimate
        )

    @cached_property
    def mean(self) -> Floats:
        """(m, N) kriged kPa; NaN in layers that no sample reached."""
        return self._spread("mean")

    @cached_property
    def variance(self) -> Floats:
        """(m, N) kriging variance in kPa2; NaN in layers that no sample reached."""
        return self._spread("variance")

    def _spread(self, what: str) -> Floats:
        result = np.full((len(self.layers), len(self.cells)), np.nan)
        for stack in self.stacks:
            result[list(stack.layers)] = getattr(stack.estimate.prediction, what)
        result.flags.writeable = False
        return result

    @cached_property
    def kv(self) -> Floats:
        """(N,) kriging variance of each cell in kPa2, averaged over the layers by their weights.

        The paper's eq. 4, as the mean over the m layers. Layers without a sample do not count;
        with no sample at all, every cell is NaN.
        """
        return self._average(self.variance)

    @property
    def mean_kv(self) -> float:
        """Field average of :attr:`kv` in kPa2."""
        return float(self.kv.mean())

    @cached_property
    def mean_kpa(self) -> Floats:
        """(N,) kriged kPa of each cell, averaged over the layers by their weights."""
        return self._average(self.mean)

    def _average(self, layers: Floats) -> Floats:
        weights = self._weights
        if not weights.any():
            return np.full(len(self.cells), np.nan)
        average: Floats = weights @ np.nan_to_num(layers, nan=0.0)
        return average

    @property
    def _weights(self) -> Floats:
        known = np.zeros(len(self.layers))
        for stack in self.stacks:
            known[list(stack.layers)] = 1.0
        weights: Floats = known * np.array(self.layers.weights)
        total = weights.sum()
        return weights / total if total > 0 else weights

    def kv_drop(self, candidates: ArrayLike) -> Floats:
        """(k, N) fall of :attr:`kv` everywhere if one of k cells were probed next; exact."""
        index = np.asarray(candidates, dtype=np.int64)
        drop = np.zeros((len(index), len(self.cells)))
        for stack in self.stacks:
            weights = self._weights[list(stack.layers)]
            drop += np.einsum("m,mkn->kn", weights, stack.estimate.variance_drop(index))
        return drop

    @property
    def notes(self) -> tuple[str, ...]:
        """What a reader of the map should know, such as a model that had to be replaced."""
        return tuple(
            f"{', '.join(self.layers.names[k] for k in stack.layers)}: {note}"
            for stack in self.stacks
            for note in stack.estimate.kriging.notes
        )


def _missing(soil_map: SoilMap) -> set[int]:
    present = {k for stack in soil_map.stacks for k in stack.layers}
    return set(range(len(soil_map.layers))) - present


def _grown(stacks: tuple[Stack, ...], sample: Sample) -> tuple[Stack, ...]:
    """Stacks with one more sample, or none if it reached only some layers of a stack."""
    grown = []
    for stack in stacks:
        values = sample.measured_kpa[list(stack.layers)]
        reached = np.isfinite(values)
        if reached.all():
            estimate = stack.estimate.append(
                sample.at, values, error_variance=sample.error_variance
            )
            if broken_layers(estimate.kriging, estimate.prediction.variance).any():
                return ()
            grown.append(Stack(stack.layers, estimate))
        elif reached.any():
            return ()
        else:
            grown.append(stack)
    return tuple(grown)
