"""The survey file: one GeoPackage that holds every event and shows the survey to any GIS.

The ``events`` table is the truth. Layers ``boundary``, ``samples``, ``refusals``, ``targets`` and
``route`` are drawn from it in the same transaction. An event is on disk (``synchronous=FULL``)
when :meth:`Journal.append` returns; a power cut at any byte loses none that was acknowledged.
Each row carries a digest of itself and of all rows before it.

Look at a running survey with GDAL or QGIS from another process than the one that writes: GDAL
brings a sqlite of its own, and two of them in one process do not see each other's locks.
"""

from __future__ import annotations

import errno
import os
import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from hashlib import sha256
from pathlib import Path

from filelock import FileLock
from pydantic import ValidationError

from subsoil import layout
from subsoil.errors import CorruptJournalError, JournalError
from subsoil.events import Event, Opened, from_json, to_json
from subsoil.geopackage import APPLICATION_ID, add_table, initialise
from subsoil.ownership import (
    OWNER_COLUMNS,
    OWNER_TABLE,
    lock_for_writing,
    name_owner,
    unlock,
)
from subsoil.survey import Survey, opened

_EVENTS = {
    "seq": "INTEGER PRIMARY KEY AUTOINCREMENT",
    "id": "TEXT NOT NULL UNIQUE",
    "kind": "TEXT NOT NULL",
    "recorded": "TEXT NOT NULL",
    "body": "TEXT NOT NULL",
    "digest": "TEXT NOT NULL",
}
_BUSY_SECONDS = 30.0
_ROOT = "subsoil"
_HEADER_BYTES = 100
_GPKG = APPLICATION_ID.to_bytes(4, "big")


class Journal:
    """A survey file open for writing; made by :func:`create` or :func:`open_journal`.

    A context manager: leaving it closes the file, which is then one self-contained GeoPackage.
    """

    def __init__(self, path: Path, database: sqlite3.Connection, lock: FileLock, srs: int) -> None:
        self.path = path
        self._database = database
        self._lock = lock
        self._srs = srs

    def __enter__(self) -> Journal:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()

    def append(self, event: Event, survey: Survey) -> None:
        """Keep an event; on disk when this returns.

        Parameters
        ----------
        event
            What happened. An id that is in already is not taken twice.
        survey
            The state after it, for the layers a GIS shows.

        Raises
        ------
        JournalError
            If it could not be written; the file is as it was before.
        """
        with self._transaction() as database:
            if database.execute("SELECT 1 FROM events WHERE id = ?", (event.id,)).fetchone():
                return
            _insert_event(database, event)
            layout.draw(database, self._srs, event, survey)

    def events(self) -> tuple[Event, ...]:
        """Everything that happened, in order."""
        return _events(self._database, self.path)

    def close(self) -> None:
        """Give the file back as one self-contained GeoPackage, and let others write."""
        with _explained(self.path):
            self._database.execute(f"DELETE FROM {OWNER_TABLE}")
            self._database.execute("PRAGMA wal_checkpoint(TRUNCATE)")
            self._database.execute("PRAGMA journal_mode = DELETE")
            self._database.close()
        unlock(self._lock)

    @contextmanager
    def _transaction(self) -> Iterator[sqlite3.Connection]:
        with _explained(self.path):
            self._database.execute("BEGIN IMMEDIATE")
            try:
                yield self._database
                self._database.execute("COMMIT")
            except BaseException:
                if self._database.in_transaction:
                    self._database.execute("ROLLBACK")
                raise


def create(path: Path, opening: Opened) -> Journal:
    """Start a survey file.

    Raises
    ------
    JournalError
        If there is a file already, or none can be made there.
    """
    if path.exists():
        raise JournalError(
            "the file exists already",
            where=str(path),
            remedy="choose another name, or go on with `subsoil run` or `subsoil resume`",
        )
    if not path.parent.is_dir():
        raise JournalError("there is no such folder", where=str(path.parent), remedy="create it")
    lock = lock_for_writing(path)
    try:
        with _explained(path):
            database = _connect(path)
            database.execute("BEGIN IMMEDIATE")
            srs = initialise(database, opening.crs)
            add_table(database, "events", _EVENTS, "Everything that happened; the truth")
            add_table(database, OWNER_TABLE, OWNER_COLUMNS, "Who is writing now")
            survey = opened(opening)
            layout.create(database, srs, survey)
            _insert_event(database, opening)
            name_owner(database)
            database.execute("COMMIT")
            database.execute("PRAGMA journal_mode = WAL")
    except BaseException:
        path.unlink(missing_ok=True)
        unlock(lock)
        raise
    return Journal(path, database, lock, srs)


def open_journal(path: Path) -> Journal:
    """Open a survey file to go on with it.

    Raises
    ------
    SurveyBusyError
        If another process is writing to it.
    JournalError
        If it is missing, cannot be written, or is not a survey file.
    """
    _check_file(path)
    if not os.access(path, os.W_OK):
        raise JournalError("the file cannot be written", where=str(path), remedy="check its rights")
    lock = lock_for_writing(path)
    try:
        with _explained(path):
            database = _connect(path)
            _check_survey(database, path)
            database.execute("PRAGMA journal_mode = WAL")
            name_owner(database)
            srs = layout.srs_of(database)
    except BaseException:
        unlock(lock)
        raise
    return Journal(path, database, lock, srs)


def read_events(path: Path) -> tuple[Event, ...]:
    """Events of a survey file, running or not, without touching it.

    Raises
    ------
    JournalError
        If it is missing or not a survey file.
    CorruptJournalError
        If an event cannot be read or was changed.
    """
    with reading(path) as database:
        return _events(database, path)


@contextmanager
def reading(path: Path) -> Iterator[sqlite3.Connection]:
    """Connect to a survey file without being able to change it.

    sqlite itself may: after a power cut it first brings the file in order.

    Raises
    ------
    JournalError
        If it is missing or not a survey file.
    """
    _check_file(path)
    mode = "rw" if os.access(path, os.W_OK) else "ro"
    with _explained(path):
        database = sqlite3.connect(
            f"{path.resolve().as_uri()}?mode={mode}", uri=True, timeout=_BUSY_SECONDS
        )
        try:
            database.execute("PRAGMA query_only = ON")
            _check_survey(database, path)
            yield database
        finally:
            database.close()


def _insert_event(database: sqlite3.Connection, event: Event) -> None:
    last = database.execute("SELECT digest FROM events ORDER BY seq DESC LIMIT 1").fetchone()
    body = to_json(event)
    database.execute(
        "INSERT INTO events(id, kind, recorded, body, digest) VALUES (?, ?, ?, ?, ?)",
        (event.id, event.kind, _now(), body, _digest(last[0] if last else _ROOT, body)),
    )


def _events(database: sqlite3.Connection, path: Path) -> tuple[Event, ...]:
    events: list[Event] = []
    digest = _ROOT
    for seq, body, recorded in database.execute(
        "SELECT seq, body, digest FROM events ORDER BY seq"
    ):
        digest = _digest(digest, body)
        if digest != recorded:
            raise CorruptJournalError(
                "the event, or one before it, was changed after it was recorded",
                where=f"{path}, event {seq}",
                remedy="go back to a copy of the file",
            )
        try:
            events.append(from_json(body))
        except ValidationError as error:
            raise CorruptJournalError(
                f"the event cannot be read: {error.errors()[0]['msg']}",
                where=f"{path}, event {seq}",
                remedy="use the version of subsoil that wrote the file, or a newer one",
            ) from error
    return tuple(events)


def _digest(before: str, body: str) -> str:
    return sha256(f"{before}\n{body}".encode()).hexdigest()


def _connect(path: Path) -> sqlite3.Connection:
    database = sqlite3.connect(path, timeout=_BUSY_SECONDS, isolation_level=None)
    database.execute("PRAGMA synchronous = FULL")
    return database


def _check_file(path: Path) -> None:
    """Check from its header that a file is there and is a GeoPackage."""
    if not path.is_file():
        raise JournalError(
            "there is no such file", where=str(path), remedy="start a survey with `subsoil init`"
        )
    with _explained(path), path.open("rb") as file:
        header = file.read(_HEADER_BYTES)
    if not header.startswith(b"SQLite format 3\0") or header[68:72] != _GPKG:
        raise _foreign(path, "no GeoPackage")


def _check_survey(database: sqlite3.Connection, path: Path) -> None:
    tables = {row[0] for row in database.execute("SELECT name FROM sqlite_master")}
    if not {"events", OWNER_TABLE} <= tables:
        raise _foreign(path, "another program's GeoPackage")


def _foreign(path: Path, kind: str) -> JournalError:
    return JournalError(
        f"not a subsoil survey but {kind}",
        where=str(path),
        remedy="start a survey with `subsoil init` under another name",
    )


@contextmanager
def _explained(path: Path) -> Iterator[None]:
    """Say in one line what sqlite could not do."""
    try:
        yield
    except sqlite3.Error as error:
        raise JournalError(str(error), where=str(path), remedy=_remedy(error)) from error
    except OSError as error:
        raise JournalError(
            f"{error.strerror or error}", where=str(path), remedy=_remedy(error)
        ) from error


def _remedy(error: Exception) -> str:
    text = str(error).lower()
    if "full" in text or getattr(error, "errno", None) == errno.ENOSPC or "disk i/o" in text:
        return "free some space on the disk, then `subsoil resume`: nothing recorded is lost"
    if "readonly" in text or "unable to open" in text:
        return "check that you may write to the file and its folder"
    if "locked" in text:
        return "close programs that hold the file open for editing"
    return "go back to a copy of the file"


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="milliseconds")
