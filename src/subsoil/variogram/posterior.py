"""What samples leave open about the correlogram of the soil."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from subsoil.arrays import Floats
from subsoil.variogram.models import Bounded, name_of_kind
from subsoil.variogram.nested import Structure, without_traces

_TRACE = 1e-3
"""Share of the whole below which a structure is left out of the mean."""


@dataclass(frozen=True)
class Posterior:
    """How likely the correlograms of a grid are: kinds of model by ranges by nugget shares.

    Attributes
    ----------
    kinds
        (a,) kinds of model.
    ranges
        (b,) practical ranges in m.
    nugget_shares
        (c,) shares of the nugget in the sill.
    weights
        (a, b, c) probabilities, summing to one.
    layers
        Number of independent layers that the readings counted for; 0 for the prior alone.
    """

    kinds: tuple[type[Bounded], ...]
    ranges: tuple[float, ...]
    nugget_shares: tuple[float, ...]
    weights: Floats
    layers: float

    @cached_property
    def structures(self) -> tuple[Structure, ...]:
        """Mean correlogram, as structures of a nested model; traces are left out."""
        shares = self.weights @ (1.0 - np.array(self.nugget_shares))
        return without_traces(
            (
                Structure(float(share), kind, reach)
                for kind, row in zip(self.kinds, shares, strict=True)
                for reach, share in zip(self.ranges, row, strict=True)
            ),
            _TRACE,
        )

    @property
    def kind_weights(self) -> dict[str, float]:
        """Probability of each kind of model, by its name."""
        by_kind = self.weights.sum(axis=(1, 2)).tolist()
        return {name_of_kind(kind): p for kind, p in zip(self.kinds, by_kind, strict=True)}

    def range_at(self, probability: float) -> float:
        """Quantile of the practical range in m, to the grid."""
        return _quantile(self.ranges, self.weights.sum(axis=(0, 2)), probability)

    def nugget_at(self, probability: float) -> float:
        """Quantile of the nugget's share, to the grid."""
        return _quantile(self.nugget_shares, self.weights.sum(axis=(0, 1)), probability)

    def __str__(self) -> str:
        kinds = ", ".join(f"{name} {p:.0%}" for name, p in self.kind_weights.items())
        return (
            f"range {self.range_at(0.5):.0f} m (90 % between {self.range_at(0.05):.0f} and "
            f"{self.range_at(0.95):.0f}), nugget {self.nugget_at(0.5):.0%} "
            f"({self.nugget_at(0.05):.0%} to {self.nugget_at(0.95):.0%}), {kinds}"
        )


def _quantile(values: Sequence[float], weights: Floats, probability: float) -> float:
    """Least of ascending values up to which the weights come to a probability."""
    order = np.argsort(values)
    summed = np.cumsum(weights[order])
    return float(values[int(order[np.searchsorted(summed, probability * summed[-1])])])
