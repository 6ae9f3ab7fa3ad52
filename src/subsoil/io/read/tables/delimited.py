"""Delimited text as a sheet: commas, semicolons, tabs, bars or blanks, in any usual encoding."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterator
from pathlib import Path

from subsoil.errors import ReadingsError
from subsoil.io.read.tables.heading_row import understood
from subsoil.io.read.tables.sheet import MOST_CELLS, Row, Sheet
from subsoil.io.read.text import read_any_text

_DELIMITERS = ";\t,|"
_FIRST_LINES = 60
_NAMED = re.compile(r"\s*\"?sep=(.)\"?[;,\t ]*", re.IGNORECASE)
_LONGEST_CELL = 131_072


def read_delimited(path: Path) -> tuple[Sheet, ...]:
    """Read delimited text; rows count from 1, blank ones and a line that names the delimiter too.

    Raises
    ------
    ReadingsError
        If it is no text, too large, or no table.
    """
    text, findings = read_any_text(path, ReadingsError)
    text = text.replace("\r\n", "\n").replace("\r", "\n").rstrip("\x1a\n")
    first, _, rest = text.partition("\n")
    named = _NAMED.fullmatch(first)
    delimiter = named[1] if named else _delimiter(text)
    lines = text.count("\n") + 1
    if lines + text.count(delimiter) > MOST_CELLS:
        raise ReadingsError(
            f"its {lines} rows have more than {MOST_CELLS // 1_000_000} million cells",
            where=path.name,
            remedy="split it by field or by day",
        )
    rows = list(
        _rows(rest, delimiter, 2, path.name) if named else _rows(text, delimiter, 1, path.name)
    )
    return (Sheet(path.name, rows, findings=findings),)


def looks_like_table(head: bytes, name: str) -> bool:
    """Whether a file is one, by its name: its heading is asked for later."""
    return name.lower().endswith((".csv", ".txt", ".tsv", ".asc", ".dat")) and head[:2] != b"PK"


def _delimiter(text: str) -> str:
    """What parts cells, by which the most headings are understood; blanks if nothing else does."""
    lines = [
        line for line in text.split("\n", 4 * _FIRST_LINES)[: 4 * _FIRST_LINES] if line.strip()
    ]
    head = "\n".join(line[:20_000] for line in lines[:_FIRST_LINES])
    scores = {}
    for delimiter in _DELIMITERS:
        if delimiter in head:
            rows = csv.reader(io.StringIO(head, newline=""), delimiter=delimiter)
            try:
                scores[delimiter] = max((understood(cells) for cells in rows), default=0)
            except csv.Error:
                scores[delimiter] = 0
    apart = max((understood(line.split()) for line in lines[:_FIRST_LINES]), default=0)
    best = max(scores, key=lambda each: scores[each], default=" ")
    return " " if apart > 1 >= scores.get(best, 0) else best


def _rows(text: str, delimiter: str, start: int, file: str) -> Iterator[Row]:
    if delimiter == " ":
        split = (line.split() for line in text.split("\n"))
        yield from ((row, cells) for row, cells in enumerate(split, start) if cells)
        return
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=delimiter)
    row = start
    try:
        for cells in reader:
            if any(map(str.strip, cells)):
                yield row, cells
            ends = start + reader.line_num
            if ends > row + 1 and ends > start + text.count("\n") and text.count('"') % 2:
                raise csv.Error("a quotation mark is never closed")
            row = ends
    except csv.Error as error:
        raise ReadingsError(
            f"this is not a table: {error}", where=f"{file}, row {row}", remedy="export it again"
        ) from error
