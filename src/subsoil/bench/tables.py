"""Tables of a benchmark, and how they are written down."""

from __future__ import annotations

import csv
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from pathlib import Path

import numpy as np

from subsoil.bench.comparison import (
    Mean,
    ResultTable,
    by_minutes,
    correlation_over_samples,
    ended_before,
    mean_of,
    paired,
)
from subsoil.bench.hand_survey import HandSurveys
from subsoil.bench.paper import CORRELATION, MARKS, NORMALISED_RMSE, PATH_M, RMSE_KPA
from subsoil.bench.task import Snapshot
from subsoil.io.write.whole import whole

Cell = str | int | float | Mean
MINUTES = 60.0
"""Time at which surveys are compared."""

_LATEX = {
    "\\": r"\textbackslash{}", "&": r"\&", "%": r"\%", "#": r"\#", "_": r"\_", "±": r"$\pm$",
    "²": r"$^2$", "–": "--",
}  # fmt: skip


@dataclass(frozen=True)
class Table:
    """Rows under columns.

    Attributes
    ----------
    name
        Name of its files.
    title
        What it shows, with units.
    columns
        Names of the columns; a mean takes two in CSV files, the second named ``... ±``.
    rows
        Its cells. A number that is not finite is shown as a dash.
    decimals
        Decimals of floats and means in each column.
    """

    name: str
    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]
    decimals: tuple[int, ...]


def rmse_table(results: ResultTable) -> Table:
    """Error of the map by number of samples, beside the paper's table 3."""
    title = "Error of the map (RMSE, kPa) by number of samples, and the paper's table 3"
    return _by_samples("table3_rmse", title, results, lambda row: row.rmse_kpa, RMSE_KPA, 1)


def path_table(results: ResultTable) -> Table:
    """Metres driven by number of samples, beside the paper's table 4."""
    title = "Way driven (m) by number of samples, and the paper's table 4"
    return _by_samples("table4_path", title, results, lambda row: row.path_m, PATH_M, 0)


def layer_table(hand: HandSurveys) -> Table:
    """Error over mean of a survey by hand in each layer, beside the paper's table 1."""
    ratio = hand.rmse_kpa / hand.mean_kpa
    rows = tuple(
        (
            name, mean_of(hand.mean_kpa[:, k]), mean_of(hand.rmse_kpa[:, k]), mean_of(ratio[:, k]),
            _papers(NORMALISED_RMSE, k),
        )
        for k, name in enumerate(hand.layers)
    )  # fmt: skip
    title = f"A survey by hand against the dense one: {len(ratio)} fields, and the paper's table 1"
    columns = ("layer", "mean kPa", "RMSE kPa", "RMSE/mean", "paper")
    return Table("table1_layers", title, columns, rows, (0, 0, 0, 3, 2))


def correlation_table(results: ResultTable) -> Table:
    """Correlation of kriging variance and error, beside the paper's table 2."""
    last = results.samples[-1]
    rows = tuple(
        (
            results.label(entrant),
            len(results.by_entrant[entrant]),
            mean_of([correlation_over_samples(r) for r in results.by_entrant[entrant].values()]),
            mean_of(list(results.at(entrant, last, lambda row: row.kv_error_correlation).values())),
            CORRELATION.get(entrant.strategy, np.nan),
        )
        for entrant in results.entrants
    )
    title = "Correlation of kriging variance and squared error, and the paper's table 2"
    columns = ("strategy", "fields", "over samples", f"over cells, n = {last}", "paper")
    return Table("table2_correlation", title, columns, rows, (2,) * len(columns))


def paired_table(
    name: str, what: str, results: ResultTable, value: Callable[[Snapshot], float], decimals: int
) -> Table:
    """Differences to the reference strategies, paired by field."""
    rows: list[tuple[Cell, ...]] = []
    for reference in results.references:
        for entrant in (e for e in results.entrants if e != reference):
            for n in results.samples:
                found = paired(results.at(entrant, n, value), results.at(reference, n, value))
                rows.append(
                    (
                        results.label(reference), results.label(entrant), n, found.difference,
                        found.percent, 100.0 * found.won, found.difference.fields,
                    )
                )  # fmt: skip
    columns = ("against", "strategy", "n", "difference", "percent", "fields won %", "fields")
    title = f"{what}: strategy minus reference on the same fields; below zero is better"
    kinds = (0, 0, 0, decimals, 1, 0, 0)
    return Table(name, title, columns, tuple(rows), kinds)


def calibration_table(results: ResultTable) -> Table:
    """Error that maps expected over the error they had."""
    columns = ("strategy", *(f"n = {n}" for n in results.samples))
    rows: tuple[tuple[Cell, ...], ...] = tuple(
        (
            results.label(entrant),
            *(mean_of(list(results.at(entrant, n, calibration).values()))
              for n in results.samples),
        )
        for entrant in results.entrants
    )  # fmt: skip
    title = (
        "Error expected over error made (root mean KV / RMSE): 1 is right, below 1 overconfident"
    )
    return Table("calibration", title, columns, rows, (2,) * len(columns))


def calibration(row: Snapshot) -> float:
    """Error that the map expected over the error it had."""
    return row.predicted_rmse_kpa / row.rmse_kpa


def time_table(results: ResultTable) -> Table:
    """Error of the map by one hour, and differences to the reference strategies."""
    by_time = {
        entrant: {field: by_minutes(r, MINUTES) for field, r in results.by_entrant[entrant].items()}
        for entrant in results.entrants
    }
    rows: list[tuple[Cell, ...]] = []
    for entrant in results.entrants:
        surveys = results.by_entrant[entrant].values()
        done = 100.0 * float(np.mean([ended_before(result, MINUTES) for result in surveys]))
        against: list[Cell] = [
            paired(by_time[entrant], by_time[reference]).difference if entrant != reference else "–"
            for reference in results.references
        ]
        ours = mean_of(list(by_time[entrant].values()))
        rows.append((results.label(entrant), ours, ours.fields, done, *against))
    columns = (
        "strategy", f"RMSE at {MINUTES:g} min", "fields", "over by then %",
        *(f"minus {results.label(reference)}" for reference in results.references),
    )  # fmt: skip
    title = f"Error of the map (RMSE, kPa) after {MINUTES:g} minutes of driving and probing"
    decimals = (0, 1, 0, 0, *(1 for _ in results.references))
    return Table("time_quality", title, columns, tuple(rows), decimals)


def decision_table(results: ResultTable) -> Table:
    """Processor time of a decision, by number of samples."""
    rows: tuple[tuple[Cell, ...], ...] = tuple(
        (
            results.label(entrant),
            *(mean_of([r.decision_s[k] for r in results.by_entrant[entrant].values()])
              for k in range(len(results.samples))),
        )
        for entrant in results.entrants
    )  # fmt: skip
    columns = ("strategy", *(f"n = {n}" for n in results.samples))
    title = "Processor time (s) from a report to the next stop, mean over each survey"
    return Table("decision_time", title, columns, rows, (4,) * len(columns))


def markdown(table: Table) -> str:
    """Table in Markdown."""
    lines = [table.columns, tuple("---" for _ in table.columns), *_texts(table)]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines) + "\n"


def latex(table: Table) -> str:
    """Table as a plain ``tabular``; needs no package."""
    align = "l" + "r" * (len(table.columns) - 1)
    lines = [" & ".join(map(_escaped, line)) + r" \\" for line in (table.columns, *_texts(table))]
    body = "\n".join(lines[1:])
    return (
        f"% {table.title}\n\\begin{{tabular}}{{{align}}}\n\\hline\n{lines[0]}\n\\hline\n"
        f"{body}\n\\hline\n\\end{{tabular}}\n"
    )


def write_csv(table: Table, path: Path) -> None:
    """Write numbers as they are, a mean and half its interval in two columns."""
    wide = [any(isinstance(row[k], Mean) for row in table.rows) for k in range(len(table.columns))]
    header = [
        name
        for column, two in zip(table.columns, wide, strict=True)
        for name in ((column, f"{column} ±") if two else (column,))
    ]
    with whole(path) as unfinished, unfinished.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(header)
        for row in table.rows:
            cells = [c for cell, two in zip(row, wide, strict=True) for c in _plain(cell, two)]
            writer.writerow(cells)


def _by_samples(
    name: str,
    title: str,
    results: ResultTable,
    value: Callable[[Snapshot], float],
    printed: Mapping[str, Sequence[float]],
    decimals: int,
) -> Table:
    columns = ["strategy", "fields"]
    for n in results.samples:
        columns += [f"n = {n}", f"paper {n}"] if n in MARKS else [f"n = {n}"]
    rows: list[tuple[Cell, ...]] = []
    for entrant in results.entrants:
        row: list[Cell] = [results.label(entrant), len(results.by_entrant[entrant])]
        for n in results.samples:
            row.append(mean_of(list(results.at(entrant, n, value).values())))
            if n in MARKS:
                row.append(_papers(printed.get(entrant.strategy, ()), MARKS.index(n)))
        rows.append(tuple(row))
    return Table(name, title, tuple(columns), tuple(rows), (decimals,) * len(columns))


def _papers(printed: Sequence[float | None], k: int) -> str:
    """A number as the paper prints it, or a dash where it prints none."""
    number = printed[k] if k < len(printed) else None
    return "–" if number is None else f"{number:g}"


def _texts(table: Table) -> list[tuple[str, ...]]:
    return [
        tuple(_text(cell, k) for cell, k in zip(row, table.decimals, strict=True))
        for row in table.rows
    ]


def _text(cell: Cell, decimals: int) -> str:
    match cell:
        case Mean():
            half = f" ± {cell.half:.{decimals}f}" if isfinite(cell.half) else ""
            return _text(cell.mean, decimals) + half
        case float():
            return f"{cell:.{decimals}f}" if isfinite(cell) else "–"
        case _:
            return str(cell)


def _plain(cell: Cell, two: bool) -> list[str]:
    match cell:
        case Mean():
            return [*_plain(cell.mean, False), *_plain(cell.half, False)]
        case float():
            text = repr(round(cell, 6)) if isfinite(cell) else ""
        case _:
            text = "" if cell == "–" else str(cell)
    return [text, ""] if two else [text]


def _escaped(text: str) -> str:
    return "".join(_LATEX.get(letter, letter) for letter in text)
