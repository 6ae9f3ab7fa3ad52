"""What a strategy sees, and what it answers."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, isfinite
from typing import Protocol

import numpy as np

from subsoil.arrays import Bools
from subsoil.land.field import Field
from subsoil.mapping.soilmap import SoilMap
from subsoil.notebook import table
from subsoil.stopping import Pace
from subsoil.ways.access import Access

_PACE = Pace()
_SHOWN = 6
"""Cells of a plan that are shown in short."""


@dataclass(frozen=True)
class View:
    """A survey as a strategy sees it: never the truth, only what was measured.

    Attributes
    ----------
    field
        The field and its cells.
    access
        Where one may stop, and the ways between.
    soil_map
        The map so far.
    position
        Where the agent is: easting and northing in m.
    plan
        Cells still to visit in order, from the last plan.
    visited
        Cells probed, in order.
    refused
        Cells at which no push gave a reading, in order.
    budget
        Samples to take in all.
    fresh
        Whether there is no plan yet, so that one has to be made from scratch.
    rng
        Random generator of this step; the same at every replay.
    metres
        Way driven so far in m.
    pace
        How fast stops are made.
    metres_left, minutes_left
        Way in m and time in min that the survey's limits leave; infinite where there is none.
    pushes
        How often to push at each stop of the plan; empty for once.
    repeats
        Cells of readings beyond the first of their cell, in order.
    taken
        Samples taken, those outside all cells included.
    leased
        Cells that agents are on their way to: taken, for a strategy.
    """

    field: Field
    access: Access
    soil_map: SoilMap
    position: tuple[float, float]
    plan: tuple[int, ...]
    visited: tuple[int, ...]
    refused: tuple[int, ...]
    budget: int
    fresh: bool
    rng: np.random.Generator
    metres: float = 0.0
    pace: Pace = _PACE
    metres_left: float = inf
    minutes_left: float = inf
    pushes: tuple[int, ...] = ()
    repeats: tuple[int, ...] = ()
    taken: int = 0
    leased: tuple[int, ...] = ()

    @property
    def remaining(self) -> int:
        """Samples still to take, at most as many as cells are left for them."""
        left = self.budget - max(self.taken, len(self.visited)) - len(self.leased)
        return max(0, min(left, int(self.free.sum()) + len(self.plan)))

    @property
    def readings(self) -> tuple[int, ...]:
        """Cells of all readings: a cell pushed more than once is in as often."""
        return (*self.visited, *self.repeats)

    @property
    def free(self) -> Bools:
        """(N,) cells in reach that are neither probed, refused, planned nor on anybody's way."""
        (away,) = self.access.between(self.position, self.access.at)
        mask: Bools = self.access.stops & np.isfinite(away)
        mask[[*self.visited, *self.refused, *self.leased, *self.plan]] = False
        return mask

    @property
    def informed(self) -> bool:
        """Whether the map has a KV: some sample reached some layer that counts."""
        return isfinite(self.soil_map.field_kv)


@dataclass(frozen=True)
class Plan:
    """Cells to visit, in order.

    Attributes
    ----------
    cells
        Cell indices; each at most once.
    reason
        Why this plan, in a sentence.
    pushes
        How often to push the rod at each stop; empty for once.
    """

    cells: tuple[int, ...]
    reason: str
    pushes: tuple[int, ...] = ()

    def __repr__(self) -> str:
        shown = ", ".join(map(str, self.cells[:_SHOWN])) + (", ..." if self.cells[_SHOWN:] else "")
        return f"<plan of {len(self.cells)} stops in cells {shown}: {self.reason}>"

    def _repr_html_(self) -> str:
        pushes = self.pushes or (1,) * len(self.cells)
        stops = enumerate(zip(self.cells, pushes, strict=True), start=1)
        rows = [(f"{k}", f"{cell}", f"{number}") for k, (cell, number) in stops]
        return table(("stop", "cell", "pushes"), rows, self.reason)


class Strategy(Protocol):
    """Decides where to probe: called before the first stop and after every one."""

    def __call__(self, view: View) -> Plan:
        """Plan the stops still to make."""
