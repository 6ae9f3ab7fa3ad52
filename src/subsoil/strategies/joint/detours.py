"""Metres from the stops of a route to every cell and back, while stops are exchanged."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from subsoil.arrays import Floats, Integers
from subsoil.ways.access import Access, finite
from subsoil.ways.moves import shorten

_START = -1
"""Row of the place where the route begins: the last one, behind those of the stops."""


class Detours:
    """Distances between some slots, each of which holds a cell, and all cells of a field.

    Parameters
    ----------
    access
        Ways between the N cells of the field.
    cells
        Cell that each slot holds.
    start
        Where routes begin.
    """

    def __init__(self, access: Access, cells: Sequence[int], start: tuple[float, float]) -> None:
        self._access = access
        places = np.concatenate([access.at[list(cells)], np.array([start], dtype=float)])
        self._there, self._back = self._ways(places)

    def insert(self, slot: int, cell: int) -> None:
        """Put in a slot that holds a cell, before another one."""
        there, back = self._ways(self._access.at[[cell]])
        self._there, self._back = self._both(
            np.insert(self._there, slot, there, axis=0),
            lambda: np.insert(self._back, slot, back, axis=0),
        )

    def delete(self, slot: int) -> None:
        """Take a slot out."""
        self._there, self._back = self._both(
            np.delete(self._there, slot, axis=0), lambda: np.delete(self._back, slot, axis=0)
        )

    def put(self, slot: int, cell: int) -> None:
        """Let a slot hold another cell."""
        (self._there[slot],), (self._back[slot],) = self._ways(self._access.at[[cell]])

    def near(self, slot: int, reach_m: float) -> Integers:
        """Cells within reach of the one that a slot holds."""
        return np.flatnonzero(self._there[slot] <= reach_m)

    def legs(self, order: Sequence[int], cells: Sequence[int]) -> list[float]:
        """Metres from the start through slots in order, leg by leg; their cells in order."""
        if not order:
            return []
        legs: list[float] = self._there[[_START, *order[:-1]], cells].tolist()
        return legs

    def of(
        self, order: Sequence[int], legs: Sequence[float], columns: Integers | slice
    ) -> tuple[Floats, Integers]:
        """Metres by which a route grows with each of some cells in its best gap, and that gap.

        Parameters
        ----------
        order
            Slots of the route.
        legs
            Metres of its legs.
        columns
            Cells to put in; all of them as a slice, which copies nothing.
        """
        detours = self._there[[_START, *order]][:, columns]
        onward = detours[1:] if self._back is self._there else self._back[list(order)][:, columns]
        detours[:-1] += onward - np.array(legs).reshape(-1, 1)
        return detours.min(axis=0), detours.argmin(axis=0)

    def shortened(self, order: Sequence[int], cells: Sequence[int]) -> list[int]:
        """Slots in an order that makes the route shorter; their cells in the present order."""
        among = np.zeros((len(order) + 1,) * 2)
        among[:, 1:] = self._there[[_START, *order]][:, list(cells)]
        among[1:, 0] = among[0, 1:]
        return [order[node - 1] for node in shorten(among)]

    def _ways(self, places: Floats) -> tuple[Floats, Floats]:
        """(k, N) metres from places to all cells, and back: one array where they are the same."""
        access = self._access
        return self._both(
            finite(access.between(places, access.at)),
            lambda: finite(access.between(access.at, places).T),
        )

    def _both(self, there: Floats, back: Callable[[], Floats]) -> tuple[Floats, Floats]:
        return there, there if self._access.is_symmetric else back()
