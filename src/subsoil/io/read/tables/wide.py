"""Tables with a row a push and a column a depth."""

from __future__ import annotations

import numpy as np

from subsoil.arrays import Floats
from subsoil.errors import brief
from subsoil.findings import Finding
from subsoil.io.read.recording import Record
from subsoil.io.read.tables.grid import Grid, Said
from subsoil.io.read.tables.summaries import is_mean


def wide_records(grid: Grid) -> tuple[list[Record], list[Finding]]:
    """Pushes of a table, and findings about the rows that make none."""
    columns, said = grid.columns, Said(grid.file)
    numbers = grid.numbers(columns.layers, grid.hardest)
    values = np.array([each.values for each in numbers]).reshape(len(numbers), -1).T
    wrong = dict(grid.positions.wrong)
    for k, each in zip(columns.layers, numbers, strict=True):
        for i, why in each.wrong.items():
            wrong.setdefault(i, (columns.names[k], why))
    bounds = np.zeros(values.shape, dtype=bool)
    for j, each in enumerate(numbers):
        bounds[sorted(each.at_least), j] = True
    labels = grid.texts(grid.labels[0]) if grid.labels else [""] * len(grid.rows)
    usual = np.array_equal(columns.top_m, np.concatenate([[0.0], columns.depth_m[:-1]]))
    tops = np.empty(0) if usual else columns.top_m
    last = len(grid.rows) - 1 if _ends_in_mean(grid, values) else -1
    records = []
    for i, row in enumerate(grid.rows):
        if i in wrong:
            said.left_out(row, wrong[i][1], brief(wrong[i][0]))
        elif i == last:
            said.left_out(row, "it is the mean or the sum of all rows above")
        else:
            above = np.flatnonzero(bounds[i])
            column = columns.names[columns.layers[above[0]]] if above.size else ""
            ending = said.ending(values[i], above, row, brief(column))
            records.append(
                Record(
                    row,
                    float(grid.positions.x[i]),
                    float(grid.positions.y[i]),
                    columns.depth_m,
                    values[i],
                    tops,
                    labels[i].strip(),
                    grid.times[i],
                    grid.cones[i],
                    ending,
                )
            )
    return records, said.found


def _ends_in_mean(grid: Grid, values: Floats) -> bool:
    return bool(len(values)) and is_mean(
        np.column_stack([grid.positions.x, grid.positions.y, values])
    )
