"""What a survey file says: its events in order, and whether they are as they were recorded."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from hashlib import sha256
from pathlib import Path

from pydantic import ValidationError

from subsoil.errors import CorruptJournalError, JournalError, SubsoilError, brief
from subsoil.survey.events import Event, Opened
from subsoil.survey.formats import Reader

ROOT = "subsoil"
"""What the digest of the first event stands on."""
EVENT_COLUMNS = {
    "seq": "INTEGER PRIMARY KEY AUTOINCREMENT",
    "id": "TEXT NOT NULL UNIQUE",
    "kind": "TEXT NOT NULL",
    "recorded": "TEXT NOT NULL",
    "body": "TEXT NOT NULL",
    "digest": "TEXT NOT NULL",
}
ANCHOR_TABLE = "subsoil_anchor"
ANCHOR_COLUMNS = {"seq": "INTEGER NOT NULL", "digest": "TEXT NOT NULL"}
Last = tuple[int, str]
"""Number and digest of the last event."""
_SHOWN = 16
"""Digits of a digest that people compare."""


@dataclass(frozen=True)
class Recorded:
    """A row of the events, as it is in the file."""

    seq: int
    id: str
    kind: str
    recorded: str
    body: str
    digest: str


@dataclass(frozen=True)
class Content:
    """What a survey file says.

    Attributes
    ----------
    numbered
        Number of each event in the file, and the event; one row of an older format may be several.
    last
        Number and digest of the last event.
    format
        Format that the file is in at its end.
    notes
        What to know of the file.
    """

    numbered: tuple[tuple[int, Event], ...]
    last: Last
    format: int
    notes: tuple[str, ...] = ()

    @cached_property
    def events(self) -> tuple[Event, ...]:
        """Everything that happened, in order."""
        return tuple(event for _, event in self.numbered)

    @property
    def fingerprint(self) -> str:
        """Digits that two files share if they hold the same events, and hardly otherwise."""
        return fingerprint(self.last[1])


def fingerprint(digest: str) -> str:
    """Digits of a digest for people to compare.

    Examples
    --------
    >>> fingerprint("0123456789abcdef" * 4)
    '0123-4567-89ab-cdef'
    """
    shown = digest[:_SHOWN]
    return "-".join(shown[k : k + 4] for k in range(0, _SHOWN, 4))


def last_of(database: sqlite3.Connection) -> Last:
    """Return the last event that is in a file."""
    query = "SELECT seq, digest FROM events ORDER BY seq DESC LIMIT 1"
    return database.execute(query).fetchone() or (0, ROOT)


def digest_of(before: str, body: str) -> str:
    """Digest of an event, given that of the one before."""
    return sha256(f"{before}\n{body}".encode()).hexdigest()


def rows_of(database: sqlite3.Connection) -> Iterator[Recorded]:
    """Rows of the events in order."""
    query = "SELECT seq, id, kind, recorded, body, digest FROM events ORDER BY seq"
    for row in database.execute(query):
        yield Recorded(*row)


def content_of(database: sqlite3.Connection, path: Path) -> Content:
    """Read all events of a survey file.

    Raises
    ------
    JournalError
        If its format is newer than is read here.
    CorruptJournalError
        If an event cannot be read, was changed, or is missing at the end.
    """
    numbered: list[tuple[int, Event]] = []
    reader, digest, seq = Reader(), ROOT, 0
    for row in rows_of(database):
        digest = digest_of(digest, row.body)
        seq = row.seq
        if digest != row.digest:
            raise CorruptJournalError(
                "the event, or one before it, was changed after it was recorded",
                where=f"{path}, event {seq}",
                remedy="go back to a copy of the file",
            )
        numbered += [(seq, event) for event in read_row(reader, row, path)]
    if cut := cut_off(database, (seq, digest)):
        raise CorruptJournalError(cut, where=str(path), remedy="go back to a copy of the file")
    if not numbered or not isinstance(numbered[0][1], Opened):
        raise CorruptJournalError(
            "it has no event that sets the survey up", where=str(path), remedy="subsoil init"
        )
    return Content(tuple(numbered), (seq, digest), reader.format)


def read_row(reader: Reader, row: Recorded, path: Path) -> tuple[Event, ...]:
    """Events of a row.

    Raises
    ------
    JournalError
        If its format is newer than is read here.
    CorruptJournalError
        If it cannot be read.
    """
    where = f"{path}, event {row.seq}"
    try:
        return reader.read(row.body, row.recorded)
    except (CorruptJournalError, JournalError) as error:
        raise JournalError(error.what, where=where, remedy=error.remedy) from error
    except ValidationError as error:
        first = error.errors()[0]
        what = ": ".join(filter(None, (".".join(map(str, first["loc"])), first["msg"])))
    except (ValueError, KeyError, TypeError, AttributeError, SubsoilError) as error:
        what = f"{type(error).__name__}: {error}"
    raise CorruptJournalError(
        f"the event cannot be read: {brief(what, 200)}",
        where=where,
        remedy="use the version of subsoil that wrote the file, or a newer one",
    )


def anchor_of(database: sqlite3.Connection) -> Last | None:
    """Number and digest that the file keeps of its last event; none in files of format 0."""
    query = "SELECT 1 FROM sqlite_master WHERE name = ?"
    if not database.execute(query, (ANCHOR_TABLE,)).fetchone():
        return None
    row = database.execute(f"SELECT seq, digest FROM {ANCHOR_TABLE}").fetchone()
    return row or (0, ROOT)


def cut_off(database: sqlite3.Connection, last: Last) -> str:
    """What is missing at the end of the events; empty if nothing is."""
    anchor = anchor_of(database)
    row = database.execute("SELECT seq FROM sqlite_sequence WHERE name = 'events'").fetchone()
    counts = [anchor[0] if anchor else 0, row[0] if row else 0]
    if not all(isinstance(count, int) for count in counts):
        return "the number of its last event is none"
    if (highest := max(counts)) > last[0]:
        return f"the last events are missing: {highest} were recorded, and {last[0]} are left"
    if anchor is not None and anchor != last:
        return f"event {last[0]} is not the one that was recorded last"
    return ""
