"""The layered map of a field: kriged means and variances of every layer, and how sure it is."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import InitVar, dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from subsoil.arrays import Floats
from subsoil.errors import ParameterError
from subsoil.kriging import Kriged, Prediction, at_cells, at_targets, condition
from subsoil.kriging.drift import NO_COVARIATE, Covariate, Drifted
from subsoil.land.field import Field
from subsoil.layers import Layers, Sample
from subsoil.mapping.stack import Stack, in_units, measured, parted
from subsoil.notebook import table
from subsoil.variogram import Nested
from subsoil.variogram.models import Variogram
from subsoil.variogram.reach import by_reach

if TYPE_CHECKING:
    from xarray import Dataset


@dataclass(frozen=True)
class SoilMap:
    """Soil strength of every cell and layer, given samples and one variogram a layer.

    A value: appending a sample or refitting returns a new map. A sample that did not go through
    a layer is not in that layer's system, lower bounds included. Kriging happens when a result is
    first asked for.

    Parameters
    ----------
    field
        The field of N cells that is mapped.
    layers
        Depth bands, m of them.
    variograms
        m models; may be empty while there is no sample.
    samples
        Readings so far.
    covariate
        What the soil may follow, if anything is known of the field beforehand.
    drift
        Indices of the layers that follow it, by kriging with external drift.
    simulated
        Whether the samples are of a soil that was drawn: whatever shows the map says so.
    subset
        Indices of the cells to krige, where a part of the field is enough; empty for all.
    kriged
        Stacks of the same cells and variograms and the first of the samples, to go on from:
        what :meth:`append` hands on. They change what a result costs and not what it is, and do
        not survive :func:`dataclasses.replace`.

    Raises
    ------
    ParameterError
        If there are samples and not one variogram a layer, or layers follow no covariate.

    Examples
    --------
    >>> from subsoil.land.field import Field
    >>> from subsoil.variogram import Spherical
    >>> field, layers = Field.from_metres([(0, 0), (40, 0), (40, 30), (0, 30)]), Layers((0, 0.4))
    >>> model = Spherical(nugget=100.0, range=30.0, psill=900.0)
    >>> first = Sample((2.5, 2.5), np.array([800.0]), np.zeros(1, dtype=np.int8))
    >>> second = Sample((37.5, 27.5), np.array([900.0]), np.zeros(1, dtype=np.int8))
    >>> soil_map = SoilMap(field, layers, (model,), (first, second))
    >>> soil_map.profile_mean[[0, -1]].round(1), soil_map.kv[[0, -1]].round(1)
    (array([805., 895.]), array([95., 95.]))
    """

    field: Field
    layers: Layers
    variograms: tuple[Variogram, ...] = ()
    samples: tuple[Sample, ...] = ()
    covariate: Covariate = NO_COVARIATE
    drift: tuple[int, ...] = ()
    simulated: bool = False
    subset: tuple[int, ...] = ()
    kriged: InitVar[tuple[Stack, ...]] = ()
    _start: tuple[Stack, ...] = dataclasses.field(init=False, repr=False, compare=False)

    def __post_init__(self, kriged: tuple[Stack, ...]) -> None:
        object.__setattr__(self, "_start", kriged)
        if self.samples and len(self.variograms) != len(self.layers):
            raise ParameterError(
                f"{len(self.variograms)} variograms for {len(self.layers)} layers",
                where="soil map",
                remedy="give one a layer",
            )
        if self.drift and not len(self.covariate):
            raise ParameterError(
                "layers follow a covariate and there is none", where="soil map, drift"
            )

    def __repr__(self) -> str:
        return f"<soil map of {self._in_short}>"

    def _repr_html_(self) -> str:
        spread = np.sqrt(self.variance)
        rows = [
            (name, f"{np.isfinite(kpa).sum()}", f"{mean.mean():.0f}", f"{sd.mean():.0f}")
            for name, kpa, mean, sd in zip(
                self.layers.names, self.kpa, self.mean, spread, strict=True
            )
        ]
        head = ("layer", "samples", "mean (kPa)", "mean standard deviation (kPa)")
        return table(head, rows, f"Soil map of {self._in_short}")

    @property
    def _in_short(self) -> str:
        origin = ", simulated" if self.simulated else ""
        size = f"{len(self.layers)} layers, {len(self.cells)} cells"
        return f"{self.field.name}: {size}, {len(self.samples)} samples{origin}"

    @cached_property
    def cells(self) -> Floats:
        """(N, 2) centres of the kriged cells in m."""
        return self.field.cells[list(self.subset)] if self.subset else self.field.cells

    def append(self, sample: Sample) -> SoilMap:
        """Map with one more sample under the same variograms.

        Exact. Costs O(n N) a layer where this map was kriged already, and nothing otherwise.
        """
        kriged = vars(self).get("stacks", self._start)
        return replace(self, samples=(*self.samples, sample), kriged=kriged)

    def refit(self, variograms: Sequence[Variogram]) -> SoilMap:
        """Map of the same samples under other variograms, one a layer."""
        return replace(self, variograms=tuple(variograms))

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
        """Layers by the samples that reached them and by drift; those without samples in none."""
        before = {stack.layers: stack for stack in self._start}
        return tuple(
            self._followed(before[layers]) if layers in before else self._begun(layers)
            for _, alike in by_reach(self.kpa)
            for layers in parted(alike, self.drift)
        )

    def _begun(self, layers: tuple[int, ...]) -> Stack:
        """Krige layers from nothing."""
        at, kpa, error = measured(self.samples, layers)
        models, unit = in_units(tuple(self.variograms[k] for k in layers), error)
        ok = condition(models, at, kpa, error_variance=error)
        plain = at_targets(ok, self.cells) if self.subset else at_cells(ok, self.field)
        estimate: Kriged = Drifted(plain, self.covariate) if layers[0] in self.drift else plain
        return Stack(layers, estimate, unit, len(self.samples))

    def _followed(self, stack: Stack) -> Stack:
        """Bring a stack up to the last sample."""
        at, kpa, error = measured(self.samples[stack.samples :], stack.layers)
        if not len(at):
            return replace(stack, samples=len(self.samples))
        if error.any() and (stack.unit != 1.0).any():
            return self._begun(stack.layers)
        estimate = stack.estimate.append(at, kpa, error_variance=error)
        return replace(stack, estimate=estimate, samples=len(self.samples))

    @cached_property
    def mean(self) -> Floats:
        """(m, N) kriged kPa; NaN in layers that no sample reached."""
        return self._laid_out([stack.mean for stack in self.stacks], len(self.cells))

    @cached_property
    def variance(self) -> Floats:
        """(m, N) kriging variance in kPa2; NaN in layers that no sample reached."""
        return self._laid_out([stack.variance for stack in self.stacks], len(self.cells))

    def predict(self, places: ArrayLike) -> Prediction:
        """Mean and variance at (k, 2) places in m, each (m, k) in kPa and kPa2; NaN as in mean.

        What follows a covariate takes its value at the nearest place where it is known.
        """
        at = np.asarray(places, dtype=float)
        stacks = [stack.at_targets(at) for stack in self.stacks]
        return Prediction(
            self._laid_out([stack.mean for stack in stacks], len(at)),
            self._laid_out([stack.variance for stack in stacks], len(at)),
        )

    def _laid_out(self, by_stack: Sequence[Floats], places: int) -> Floats:
        result = np.full((len(self.layers), places), np.nan)
        for stack, values in zip(self.stacks, by_stack, strict=True):
            result[list(stack.layers)] = values
        result.setflags(write=False)
        return result

    @cached_property
    def kv(self) -> Floats:
        """(N,) kriging variance of each cell in kPa2, averaged over the layers by their weights.

        The paper's eq. 4, as the mean over the m layers. Layers without a sample do not count;
        where no layer that counts has one, every cell is NaN.
        """
        return self._averaged(self.variance)

    @cached_property
    def field_kv(self) -> float:
        """Field average of :attr:`kv` in kPa2."""
        return float(self.kv.mean())

    @cached_property
    def profile_mean(self) -> Floats:
        """(N,) kriged kPa of each cell, averaged over the layers by their weights, as in kv."""
        return self._averaged(self.mean)

    def _averaged(self, layers: Floats) -> Floats:
        weights = self._weights
        counts = weights > 0
        average = (
            weights[counts] @ layers[counts] if counts.any() else np.full(len(self.cells), np.nan)
        )
        average.setflags(write=False)
        return average

    @cached_property
    def _weights(self) -> Floats:
        """(m,) weights of the layers with a sample, summing to one; all zero if none counts."""
        reached = np.zeros(len(self.layers))
        for stack in self.stacks:
            reached[list(stack.layers)] = 1.0
        weights: Floats = reached * self.layers.weights
        return weights / (weights.sum() or 1.0)

    def to_xarray(self) -> Dataset:
        """The map as an :class:`xarray.Dataset`; see :func:`subsoil.mapping.dataset.dataset_of`.

        Raises
        ------
        MissingExtraError
            If xarray is not installed.
        """
        from subsoil.mapping.dataset import dataset_of  # xarray is loaded where it is asked for

        return dataset_of(self)

    def kv_drop(self, candidates: ArrayLike) -> Floats:
        """(k, N) fall of :attr:`kv` everywhere if one of k cells were probed next.

        Exact while the variograms hold and the push goes as deep as some push did before.
        """
        index = np.asarray(candidates, dtype=np.int64)
        drop = np.zeros((len(index), len(self.cells)))
        for stack in self.stacks:
            weights = self._weights[list(stack.layers)]
            drop += np.einsum("m,mkn->kn", weights, stack.variance_drop(index))
        return drop

    @property
    def kriged_with(self) -> tuple[Variogram, ...]:
        """Model that each layer was kriged with; its own where no sample reached it.

        It is another than in :attr:`variograms` where that gives no valid system in the plane.
        """
        used = list(self.variograms)
        for stack in self.stacks:
            models = stack.estimate.variograms
            for k, layer in enumerate(stack.layers):
                if not isinstance(used[layer], Nested):
                    used[layer] = models[k % len(models)]
        return tuple(used)

    @property
    def notes(self) -> tuple[str, ...]:
        """What to know of the map: simulated, models replaced, a covariate followed."""
        layers = zip(self.layers.names, self.variograms, self.kriged_with, strict=False)
        replaced = [name for name, model, used in layers if used != model]
        said = []
        if self.simulated:
            said.append("simulated: the readings are of a soil that was drawn, not of land")
        if replaced:
            said.append(
                f"{', '.join(replaced)}: bounded linear model not valid in the plane for these "
                "readings: kriged with the circular model of the same slope"
            )
        if self.drift:
            names = ", ".join(self.layers.names[k] for k in self.drift)
            said.append(f"{names}: the mean follows the covariate")
        return tuple(said)
