"""What the command line says: tables for people, JSON for programs, progress for the patient."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table

from subsoil.cli.parsing import OUTPUT
from subsoil.errors import printable

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

_LABELS = {"metres": "way (m)", "minutes": "time (min)", "mean_kv": "mean KV (kPa²)"}
_PIPE_COLUMNS = 160
_UNITS = {"ha": "ha", "kpa": "kPa", "kpa2": "kPa²", "mm2": "mm²", "m": "m", "gib": "GiB"}

Advance = Callable[[int, str], None]
"""Told how far the work is and what to say about it."""


def tell(result: Mapping[str, object], as_json: bool) -> None:
    """Print a result as JSON or as a table of names and values."""
    if as_json:
        print(json.dumps(_plain(result), indent=2))
        return
    table = Table.grid(padding=(0, 2))
    for name, value in result.items():
        table.add_row(_label(name), _shown(value))
    _console().print(table)


def tell_table(title: str, columns: Sequence[str], rows: Sequence[Sequence[object]]) -> None:
    """Print rows under a title, for people."""
    lines = (printable(line) for line in title.split("\n"))
    table = Table(title="\n".join(lines), title_justify="left")
    for k, name in enumerate(columns):
        table.add_column(_label(name), justify="right" if k else "left")
    for row in rows:
        table.add_row(*(_shown(value) for value in row))
    _console().print(table)


@contextmanager
def progress(what: str, total: int) -> Iterator[Advance]:
    """Show progress with a rate on a terminal; quiet when piped."""
    console = Console(stderr=True)
    with Progress(
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[note]}", markup=False),
        TimeRemainingColumn(),
        console=console,
        disable=not console.is_terminal,
    ) as bar:
        task = bar.add_task(printable(what), total=total, note="")
        yield lambda done, note: bar.update(task, completed=done, note=printable(note))


def folder(path: Path) -> Path:
    """Make a folder if it is missing."""
    path.mkdir(parents=True, exist_ok=True)
    return path


def _label(name: str) -> str:
    """Name of a number with its unit, for people."""
    if name in _LABELS:
        return _LABELS[name]
    name = printable(name)
    words, _, unit = name.rpartition("_")
    return (
        f"{words.replace('_', ' ')} ({_UNITS[unit]})" if unit in _UNITS else name.replace("_", " ")
    )


def _console() -> Console:
    """Terminal as wide as it is; files and pipes as wide as any table."""
    width = None if Console().is_terminal else _PIPE_COLUMNS
    return Console(width=width, markup=False, emoji=False, highlight=False)


def _plain(value: object) -> object:
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    return str(value) if isinstance(value, Path) else value


def _number(value: float) -> str:
    if not math.isfinite(value):
        return "-"
    return f"{value:.1f}" if abs(value) >= 1000 else f"{value:.3f}".rstrip("0").rstrip(".")


def _shown(value: object) -> str:
    if isinstance(value, float):
        return _number(value)
    if isinstance(value, Mapping):
        return ", ".join(f"{printable(key)} {_shown(item)}" for key, item in value.items())
    if isinstance(value, list | tuple):
        return ", ".join(_shown(item) for item in value) or "-"
    return printable(str(value))
