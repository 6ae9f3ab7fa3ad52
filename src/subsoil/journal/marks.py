"""What a survey file tells of itself that a reader should know before trusting it."""

from __future__ import annotations

import sqlite3
from pathlib import Path

from subsoil.errors import JournalError, printable
from subsoil.journal import owner
from subsoil.journal.foreign import foreign

COPIED = "copied while open, may lack the last events"


def marks(database: sqlite3.Connection, path: Path) -> tuple[str, ...]:
    """Say whether the last events may be missing from a file; empty for nearly every one."""
    notes: list[str] = []
    if owner.copied_while_open(database, path):
        notes.append(f"{COPIED}: {owner.name(database)} was writing to the original")
    if left := owner.wal_elsewhere(database, path):
        notes.append(f"renamed or linked while open, may lack the last events: they are in {left}")
    return tuple(map(printable, notes))


def notes(database: sqlite3.Connection, path: Path) -> tuple[str, ...]:
    """What the user of a file should know before going on: marks, and what may change it."""
    return (*marks(database, path), *map(printable, foreign(database).strange))


def refuse_left_behind(database: sqlite3.Connection, path: Path) -> None:
    """Refuse to write where the last events lie in a ``-wal`` file under another name.

    Raises
    ------
    JournalError
        If they do.
    """
    if left := owner.wal_elsewhere(database, path):
        raise JournalError(
            f"it was renamed or linked while open, and its last events are in {left}",
            where=str(path),
            remedy=f"open it as {str(left).removesuffix('-wal')}, or move {left.name} along",
        )
