"""What the owner of a file should know of it: what was seen, where, and what was done about it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

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


def others(findings: Iterable[Finding]) -> tuple[str, ...]:
    """All else that there is to know, in words."""
    return tuple(str(finding) for finding in findings if finding.severity != "left out")
