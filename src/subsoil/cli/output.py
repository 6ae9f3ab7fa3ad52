"""What the command line says: tables for people, JSON for programs, progress for the patient."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer
from rich.cells import cell_len
from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    ProgressColumn,
    SpinnerColumn,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from rich.table import Table

from subsoil.cli.parsing import OUTPUT
from subsoil.cli.words import label, text
from subsoil.errors import ParameterError, SubsoilError, printable
from subsoil.units import METRIC, System, Units

AsJson = Annotated[
    bool,
    typer.Option("--json", help="Print the result as JSON.", rich_help_panel=OUTPUT),
]
Out = Annotated[
    Path,
    typer.Option(
        metavar="DIR", help="Folder to write to; made if missing.", rich_help_panel=OUTPUT
    ),
]

Shown = Annotated[
    System,
    typer.Option(
        "--units",
        help="Units of what is shown: kPa, m, ha, or psi, ft, acres. Files and JSON stay metric.",
        rich_help_panel=OUTPUT,
    ),
]

_GAP = "  "
_WORDY = 30
"""Letters from which on a column of words may be wrapped."""

Advance = Callable[[int, str], None]
"""Told how far the work is and what to say about it."""


def tell(result: Mapping[str, object], as_json: bool, units: Units = METRIC) -> None:
    """Print a result: as JSON, or as lines of names and values without those that are empty.

    Several words are one to a line. What does not go to a terminal has a tab between name and
    value, and the name on each line.
    """
    if as_json:
        print(json.dumps(_plain(result), indent=2))
        return
    rows = [(label(name, units), _lines(name, value, units)) for name, value in result.items()]
    console = _console()
    if not console.is_terminal:
        for name, lines in rows:
            for line in lines:
                print(name, line, sep="\t")
        return
    table = Table.grid(padding=(0, 2, 0, 0))
    for name, lines in rows:
        if lines:
            table.add_row(name, "\n".join(lines))
    console.print(table)


def say(line: str) -> None:
    """Print a sentence, broken between words where a terminal ends."""
    console = _console()
    console.print(printable(line), soft_wrap=not console.is_terminal)


def tell_table(
    title: str,
    columns: Sequence[str],
    rows: Sequence[Sequence[object]],
    units: Units = METRIC,
) -> None:
    """Print rows under a title and under the names of their columns, for people.

    On a terminal no number is cut: columns that find no room beside the others come below, with
    the first column again. What does not go to a terminal has a tab between columns.
    """
    if not rows:
        return
    console = _console()
    heads = [label(name, units) for name in columns]
    cells = [[text(n, v, units) for n, v in zip(columns, row, strict=True)] for row in rows]
    print()
    for sentence in title.split("\n"):
        say(sentence)
    if not console.is_terminal:
        for line in (heads, *cells):
            print("\t".join(line).rstrip("\t"))
        return
    widths = [
        max(map(cell_len, (*head.split(), *column)))
        for head, column in zip(heads, zip(*cells, strict=True), strict=True)
    ]
    numeric = [all(isinstance(row[k], int | float) for row in rows) for k in range(len(columns))]
    for n, part in enumerate(_side_by_side([min(w, _WORDY) for w in widths], console.width)):
        if n:
            print()
        table = Table(box=None, padding=(0, 2, 0, 0), pad_edge=False, header_style="bold")
        for k in part:
            table.add_column(
                heads[k].replace(" ", "\n") if numeric[k] else heads[k],
                justify="right" if numeric[k] else "left",
                vertical="bottom" if numeric[k] else "top",
                no_wrap=widths[k] <= _WORDY,
            )
        for row in cells:
            table.add_row(*(row[k] for k in part))
        console.print(table)


@contextmanager
def progress(what: str, total: int, *, first: str = "") -> Iterator[Advance]:
    """Show progress with a rate on a terminal, from the start; quiet when piped.

    Parameters
    ----------
    what
        What is done.
    total
        How many times.
    first
        What is done before the first time, if that takes long.
    """
    with _live(BarColumn(), MofNCompleteColumn(), TimeRemainingColumn()) as bar:
        task = bar.add_task(printable(first or what), total=total, note="")

        def advance(done: int, note: str) -> None:
            bar.update(task, completed=done, note=printable(note), description=printable(what))

        yield advance


@contextmanager
def working(what: str) -> Iterator[None]:
    """Show on a terminal that something long is being done; quiet when piped."""
    with _live(TimeElapsedColumn(), transient=True) as line:
        line.add_task(printable(what), total=None, note="")
        yield


@contextmanager
def resumable() -> Iterator[None]:
    """Say after Ctrl-C how to go on.

    Raises
    ------
    SubsoilError
        After Ctrl-C.
    """
    try:
        yield
    except KeyboardInterrupt:
        raise SubsoilError(
            "stopped; nothing recorded is lost, go on with `subsoil resume`"
        ) from None


def _live(*columns: ProgressColumn, transient: bool = False) -> Progress:
    console = Console(stderr=True)
    return Progress(
        SpinnerColumn(),
        TextColumn("{task.description}", markup=False),
        *columns,
        TextColumn("{task.fields[note]}", markup=False),
        console=console,
        disable=not console.is_terminal,
        transient=transient,
    )


def folder(path: Path) -> Path:
    """Make a folder if it is missing.

    Raises
    ------
    ParameterError
        If its name is no text, which libraries that write rasters cannot take.
    """
    try:
        str(path).encode()
    except UnicodeEncodeError:
        raise ParameterError(
            f"the name {printable(str(path))!r} is no text in UTF-8",
            where="--out",
            remedy="write to a folder of another name",
        ) from None
    path.mkdir(parents=True, exist_ok=True)
    return path


def _lines(name: str, value: object, units: Units) -> list[str]:
    """Value on lines: several words one to a line; none if there is nothing to say."""
    if isinstance(value, list | tuple) and all(isinstance(item, str | Path) for item in value):
        return [text(name, item, units) for item in value]
    empty = value in (None, "") or (isinstance(value, float) and math.isnan(value))
    return [] if empty else [text(name, value, units)]


def _side_by_side(widths: Sequence[int], room: int) -> Iterator[list[int]]:
    """Columns that have room beside each other, with the first one each time."""
    part, used = [0], widths[0]
    for k, width in enumerate(widths[1:], start=1):
        if len(part) > 1 and used + len(_GAP) + width > room:
            yield part
            part, used = [0], widths[0]
        part.append(k)
        used += len(_GAP) + width
    yield part


def _console() -> Console:
    return Console(markup=False, emoji=False, highlight=False)


def _plain(value: object) -> object:
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    return str(value) if isinstance(value, Path) else value
