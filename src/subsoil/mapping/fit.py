"""Variograms of all layers of readings, ready to krige with."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from subsoil.kriging.drift import NO_COVARIATE, Covariate
from subsoil.layers import Layers
from subsoil.mapping.drift_choice import DriftRule, learn
from subsoil.notebook import table
from subsoil.readings import Readings
from subsoil.registry import handed_over
from subsoil.variogram import (
    Bounded,
    Estimator,
    Fit,
    Nested,
    Own,
    estimator_named,
    name_of,
)

DEFAULT_LAYERS = Layers()
DEFAULT_ESTIMATOR = "pmc"


@dataclass(frozen=True)
class Fits:
    """Variograms of m layers, and how they were come by.

    Attributes
    ----------
    layers
        The layers.
    fits
        (m,) reports, one a layer.
    covariate
        What layers may follow.
    drift
        Indices of the layers that follow it.
    """

    layers: Layers
    fits: tuple[Fit, ...]
    covariate: Covariate = NO_COVARIATE
    drift: tuple[int, ...] = ()

    def __len__(self) -> int:
        return len(self.fits)

    def __iter__(self) -> Iterator[Fit]:
        return iter(self.fits)

    def __getitem__(self, layer: int) -> Fit:
        return self.fits[layer]

    @property
    def variograms(self) -> tuple[Bounded | Nested, ...]:
        """(m,) models."""
        return tuple(fit.variogram for fit in self.fits)

    def __repr__(self) -> str:
        named = list(zip(self.layers.names, self.fits, strict=True))
        if len(self) > 1 == len({fit.why for fit in self.fits}):
            lines = [f"{name}: {in_words(fit)}" for name, fit in named]
            return "\n".join([*lines, f"all: {self.fits[0].why}"])
        return "\n".join(f"{name}: {in_words(fit)}; {fit.why}" for name, fit in named)

    def _repr_html_(self) -> str:
        head = ("layer", "model", "nugget (kPa²)", "sill (kPa²)", "range (m)", "how")
        pairs = zip(self.layers.names, self.fits, strict=True)
        return table(head, [(name, *_numbers(fit), fit.why) for name, fit in pairs])


def fit(
    readings: Readings,
    layers: Layers = DEFAULT_LAYERS,
    estimator: str | Estimator | Own = DEFAULT_ESTIMATOR,
    *,
    covariate: Covariate = NO_COVARIATE,
    drift: DriftRule = "auto",
) -> Fits:
    """Estimate a variogram for every layer of readings.

    Parameters
    ----------
    readings
        Readings, from :func:`subsoil.read_readings` or :meth:`subsoil.Readings.of`.
    layers
        Depth bands.
    estimator
        Name of an estimator, ``module:attribute``, or a callable from (n, 2) places and (m, n)
        values, NaN where not measured, to m :class:`~subsoil.variogram.Fit` or models.
    covariate
        What layers may follow, if anything is known of the field beforehand.
    drift
        When they do: ``"auto"`` where that predicts better, ``"always"`` or ``"never"``.

    Raises
    ------
    ParameterError
        If there is no such estimator, it fails, or it does not give one variogram a layer.

    Examples
    --------
    >>> import numpy as np
    >>> rng = np.random.default_rng(1)
    >>> at = rng.uniform(0, 100, (40, 2))
    >>> kpa = 900 + 200 * np.sin(at[:, :1] / 30) + rng.normal(0, 20, (40, 2))
    >>> fits = fit(Readings.of(at, [0.1, 0.2], kpa), Layers((0.0, 0.1, 0.2)), "spherical")
    >>> len(fits), fits[0].is_prior
    (2, False)
    """
    name, allowed = handed_over(estimator)
    chosen = estimator_named(name, readings.extent_m, allowed=allowed)
    learnt = learn(readings.at, readings.layer_means(layers), covariate, chosen, drift)
    return Fits(layers, learnt.fits, covariate, learnt.drift)


def in_words(fit: Fit) -> str:
    """Model of a fit, with its parameters."""
    name, nugget, sill, reach = _numbers(fit)
    return f"{name}, nugget {nugget} kPa2, sill {sill} kPa2, range {reach} m"


def _numbers(fit: Fit) -> tuple[str, str, str, str]:
    model = fit.variogram
    nugget, sill = (f"{x:.0f}" if x >= 100 else f"{x:.3g}" for x in (model.nugget, model.sill))
    return name_of(model), nugget, sill, f"{model.range:.0f}"
