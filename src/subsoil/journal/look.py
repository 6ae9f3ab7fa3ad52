"""Survey files looked at, running or not, without touching them."""

from __future__ import annotations

import sqlite3
from dataclasses import replace
from pathlib import Path

from subsoil.errors import CorruptJournalError, JournalError
from subsoil.journal import owner
from subsoil.journal.connection import reading
from subsoil.journal.content import Content, Last, content_of, last_of
from subsoil.journal.marks import marks
from subsoil.journal.publish import published
from subsoil.survey.events import Event


def read_survey(path: Path) -> Content:
    """Read a survey file, running or not, without touching it.

    Raises
    ------
    JournalError
        If it is missing or not a survey file, or of a newer format.
    CorruptJournalError
        If an event cannot be read, was changed, or is missing at the end.
    """
    with reading(path) as database:
        return replace(content_of(database, path), notes=marks(database, path))


def read_events(path: Path) -> tuple[Event, ...]:
    """Events of a survey file, as :func:`read_survey` finds them."""
    return read_survey(path).events


def is_survey(path: Path) -> bool:
    """Whether a file is a survey, if a damaged one."""
    try:
        with reading(path):
            return True
    except CorruptJournalError:
        return True
    except JournalError:
        return False


def last_event(path: Path) -> Last:
    """Number and digest of the last event of a survey file, whatever the others say.

    Raises
    ------
    JournalError
        If it is missing or not a survey file.
    """
    with reading(path) as database:
        return last_of(database)


def copy(path: Path, to: Path) -> None:
    """Copy a survey file, running or not, with all that was acknowledged; never over another.

    Raises
    ------
    JournalError
        If it is missing or not a survey, or the copy cannot be written.
    """
    with reading(path) as database, published(to) as unfinished:
        target = sqlite3.connect(unfinished, isolation_level=None)
        try:
            database.backup(target)
            target.execute("PRAGMA journal_mode = DELETE")
            if not marks(database, path):
                owner.sign_off(target)
        finally:
            target.close()
