"""What a metre of way is worth, and how stops are exchanged in a sweep."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf


@dataclass(frozen=True)
class Price:
    """What a metre of way is worth, in mean variance of the map (in sills).

    Attributes
    ----------
    per_m
        So much a metre.
    elasticity
        So many percent of the variance for a percent of the way: the trade does not change with
        the size of the field, the number of stops or how smooth the soil is.
    """

    per_m: float = 0.0
    elasticity: float = 0.0

    def at(self, variance: float, metres: float) -> float:
        """Price of a metre where a map has a variance and its way a length."""
        return self.per_m + self.elasticity * variance / max(metres, 1.0)

    def cost(self, variance: float, metres: float) -> float:
        """What is minimised: the variance and the way, traded at this price."""
        return float(variance * max(metres, 1.0) ** self.elasticity + self.per_m * metres)


@dataclass(frozen=True)
class SweepOptions:
    """How stops are exchanged in a sweep.

    Attributes
    ----------
    temperature
        Of the draw among cells, in sills; zero for the best.
    reach_m
        Distance in m by which a stop may move.
    budget_m
        Length in m that the way keeps to if it does so now, metres costing nothing up to it;
        infinite to pay for every metre.
    """

    temperature: float = 0.0
    reach_m: float = inf
    budget_m: float = inf
