"""What the owner of a file should know of it: what was seen, where, and what was done about it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

from subsoil.errors import listed

Severity = Literal["note", "doubt", "left out"]
"""A note asks for nothing, a doubt for a look at the file; what could have counted is left out."""


@dataclass(frozen=True)
class Finding:
    """Something about a file that its owner should know.

    Attributes
    ----------
    seen
        What was seen, in a few words.
    done
        What was done about it, or is to be done.
    severity
        Whether to look at it.
    file
        Name of the file.
    row
        Row of a table, its heading being row 1 as a rule, or record or feature of another file,
        the first being 1; 0 for the file as a whole.
    column
        Heading or depth; empty for a row as a whole.

    Examples
    --------
    >>> str(Finding("'stone' is not a number", "left out", "left out", "a.csv", 6, "kpa_15cm"))
    "row 6, column kpa_15cm: 'stone' is not a number; left out"
    >>> str(Finding("columns left alone: id", file="a.csv"))
    'a.csv: columns left alone: id'
    """

    seen: str
    done: str = ""
    severity: Severity = "note"
    file: str = ""
    row: int = 0
    column: str = ""

    def __str__(self) -> str:
        where = f"row {self.row}" if self.row else self.file
        where += f", column {self.column}" if self.column else ""
        said = f"{self.seen}; {self.done}" if self.done else self.seen
        return f"{where}: {said}" if where else said


def left_out(findings: Iterable[Finding]) -> tuple[Finding, ...]:
    """Those about what could have counted and does not."""
    return tuple(finding for finding in findings if finding.severity == "left out")


def together(findings: Iterable[Finding], most: int = 30) -> tuple[str, ...]:
    """Findings in words for a screen: a line for all rows of which the same is to be said.

    Parameters
    ----------
    findings
        What is to be said.
    most
        Most lines; a last one says how many findings are not shown.

    Examples
    --------
    >>> rows = [Finding("no position", "left out", "left out", "a.csv", row) for row in range(2, 9)]
    >>> for line in together([*rows, Finding("12 positions", file="p.gpx")]):
    ...     print(line)
    a.csv, rows 2, 3, 4, 5, 6, 7 and 1 more: no position; left out
    p.gpx: 12 positions
    """
    grouped: dict[tuple[str, str, str, str], list[Finding]] = {}
    for each in findings:
        grouped.setdefault((each.file, each.column, each.seen, each.done), []).append(each)
    files = {file for file, *_ in grouped if file}
    lines = [_line(group, named=len(files) > 1) for group in grouped.values()]
    rest = sum(len(group) for group in list(grouped.values())[most:])
    return (*lines[:most], *([f"{rest} more; --json lists all"] if rest else ()))


def _line(group: Sequence[Finding], *, named: bool) -> str:
    first, rows = group[0], [str(each.row) for each in group]
    if not first.row:
        return str(first)
    line = str(first)
    if len(rows) > 1:
        line = line.replace(f"row {first.row}", f"rows {listed(rows)}", 1)
    return f"{first.file}, {line}" if named and first.file else line


def others(findings: Iterable[Finding]) -> tuple[str, ...]:
    """All else that there is to know, in words."""
    return tuple(str(finding) for finding in findings if finding.severity != "left out")
