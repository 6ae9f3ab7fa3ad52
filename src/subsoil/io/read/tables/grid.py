"""The body of a table whose columns are known: texts, numbers, labels, times, cones."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from subsoil.arrays import Floats, Integers
from subsoil.errors import ReadingsError
from subsoil.findings import Finding
from subsoil.io.read.recording import HARDEST_KPA, KPA
from subsoil.io.read.tables.clock import Times, times_of
from subsoil.io.read.tables.columns import Columns
from subsoil.io.read.tables.cones import cones_of
from subsoil.io.read.tables.marks import Writing, writing_of
from subsoil.io.read.tables.numbers import Numbers, numbers_of
from subsoil.io.read.tables.row_places import Positions
from subsoil.io.read.tables.sheet import Row, Sheet
from subsoil.io.read.tables.vocabulary import NUMBERS, UNIT, plain, unit_named, words_of
from subsoil.penetrometer import Cone
from subsoil.reports import Ending


@dataclass(frozen=True)
class Grid:
    """Rows of a table, its columns, and the places of its rows.

    Attributes
    ----------
    file, where
        Name of the file, and file and sheet, for messages.
    by_program
        Whether a program wrote the numbers.
    columns, rows, cells
        What columns mean, (n,) numbers of rows in the file, and (n,) rows of texts.
    positions
        Places of the rows.
    unit
        Unit of strength by the heading or else by the owner.
    """

    file: str
    where: str
    by_program: bool
    columns: Columns
    rows: list[int]
    cells: list[list[str]]
    positions: Positions
    unit: str

    def texts(self, column: int) -> list[str]:
        """(n,) texts of a column."""
        return [cells[column] for cells in self.cells]

    def numbers(self, columns: Sequence[int], most: float | None) -> list[Numbers]:
        """Numbers of columns of one kind, none of which is beyond the most there is.

        Raises
        ------
        ReadingsError
            If a mark in them may be a thousands mark.
        """
        texts = [self.texts(column) for column in columns]
        writing = Writing()
        if not self.by_program:
            try:
                writing = writing_of(
                    [text for column in texts for text in column],
                    most=most,
                    decimal=self.positions.decimal,
                )
            except ValueError as error:
                raise ReadingsError(
                    str(error),
                    where=self.where,
                    remedy="write numbers without thousands marks, 1119 or 1119.5",
                ) from error
        return [numbers_of(column, writing) for column in texts]

    @property
    def hardest(self) -> float:
        """Largest strength there is, in the unit of the table."""
        return HARDEST_KPA / KPA.get(self.unit_said or self.unit, 1.0)

    @cached_property
    def labels(self) -> tuple[int, ...]:
        """Columns of what pushes are called, the most usual word first."""
        found = self.columns.of("number")
        words = {k: words_of(plain(self.columns.names[k])) for k in found}
        rank = {
            k: min((NUMBERS.index(w) for w in words[k] if w in NUMBERS), default=99) for k in found
        }
        return tuple(sorted(found, key=lambda k: rank[k]))

    @cached_property
    def times(self) -> Times:
        """(n,) times of the rows, none where the table does not say."""
        found = self.columns.of("time")
        texts = [self.texts(k) for k in found]
        tries = (
            [[" ".join(each).strip() for each in zip(*texts, strict=True)], *texts] if texts else []
        )
        for each in tries:
            if times := times_of(each):
                return times
        return [None] * len(self.rows)

    @cached_property
    def cones(self) -> list[Cone | None]:
        """(n,) cones of the rows, none where the table does not say."""
        column = self.columns.first("cone")
        if column is None:
            return [None] * len(self.rows)
        return cones_of(self.texts(column), self.columns.names[column])

    @cached_property
    def unit_said(self) -> str:
        """Unit by the column of a tidy table that holds nothing but it; empty without one.

        Raises
        ------
        ReadingsError
            If rows differ in it, or it is unknown.
        """
        column = self.columns.first("unit")
        if column is None or self.columns.layers:
            return ""
        words = sorted({plain(text) for text in self.texts(column)} - {""})
        units = {unit_named(match) if (match := UNIT.fullmatch(word)) else word for word in words}
        if self.columns.unit:
            units |= {self.columns.unit}
        if len(units) > 1:
            raise ReadingsError(
                f"rows mix the units {', '.join(sorted(units))}",
                where=self.where,
                remedy="use one unit for all rows",
            )
        return units.pop() if units else ""

    @cached_property
    def used(self) -> set[int]:
        """Columns that are read."""
        columns = self.columns
        found = {*columns.place, *columns.layers, *self.labels[: 1 if columns.layers else None]}
        for kind in ("north or south", "east or west", "cone"):
            found |= set(columns.of(kind))
        if any(self.times):
            found |= set(columns.of("time"))
        if not columns.layers:
            for kind in ("depth", "top", "strength", "unit"):
                found |= set(columns.of(kind))  # type: ignore[arg-type]
        return found


def grid_of(
    sheet: Sheet, columns: Columns, body: list[Row], positions: Positions, unit: str
) -> Grid:
    """Body of a sheet."""
    rows, cells = [row for row, _ in body], [cells for _, cells in body]
    return Grid(sheet.file, sheet.where, sheet.by_program, columns, rows, cells, positions, unit)


@dataclass
class Said:
    """Findings about the rows of a table, one by one."""

    file: str
    found: list[Finding] = field(default_factory=list)

    def left_out(self, row: int, seen: str, column: str = "") -> None:
        """Say that a row is left out."""
        self.found.append(Finding(seen, "left out", "left out", self.file, row, column))

    def ending(self, values: Floats, bounds: Integers, row: int, column: str = "") -> Ending:
        """Take values that are only bounds out, and say so; returns what ended the push."""
        if not bounds.size:
            return "stroke"
        seen = f"it says {values[bounds[0]]:g} or more"
        values[bounds] = np.nan
        ends = not np.isfinite(values[bounds[0] :]).any()
        done = "taken as the end of the push, not as a value" if ends else "not taken as a value"
        self.found.append(Finding(seen, done, "doubt", self.file, row, column))
        return "force" if ends else "stroke"
