"""Arrays that grow by a row and can still be shared by frozen values."""

from __future__ import annotations

import numpy as np

from subsoil.arrays import Floats

_ROOM, _GROWTH = 32, 4
"""Rows of a new buffer, at least and per row there is. Memory is not touched before it is used."""


class GrowingStack:
    """A stack of matrices (g, n, w) to which rows are appended.

    Values made one from the other by appending share one buffer: rows already written never
    change, so each value sees just its own first n of them. The first to append to a given
    length writes in place; a second branch from the same length gets a copy.
    """

    def __init__(self, array: Floats) -> None:
        self._buffer = array
        self._count = array.shape[1]
        self._claims: dict[int, object] = {self._count: None}

    @property
    def array(self) -> Floats:
        """The rows so far, (g, n, w), read-only; w is the width of the buffer."""
        view = self._buffer[:, : self._count]
        view.flags.writeable = False
        return view

    def grown(self, width: int) -> tuple[GrowingStack, Floats]:
        """A stack with one more row, of a width or wider, and that row (g, w), to be written."""
        n = self._count
        room = n < self._buffer.shape[1] and width <= self._buffer.shape[2]
        mine = object()
        grown = GrowingStack.__new__(GrowingStack)
        if room and self._claims.setdefault(n + 1, mine) is mine:
            grown._buffer, grown._claims = self._buffer, self._claims
        else:
            grown._buffer, grown._claims = self._copy(width), {n + 1: mine}
        grown._count = n + 1
        return grown, grown._buffer[:, n]

    def _copy(self, width: int) -> Floats:
        groups, capacity, old_width = self._buffer.shape
        n = self._count
        rows = capacity if n < capacity else max(_ROOM, _GROWTH * n)
        columns = old_width if width <= old_width else max(_ROOM, _GROWTH * width)
        bigger = np.empty((groups, rows, columns))
        bigger[:, :n, :old_width] = self._buffer[:, :n]
        bigger[:, :n, old_width:] = 0.0
        return bigger
