"""The survey file: one GeoPackage that holds every event and shows the survey to any GIS.

The ``events`` table is the truth. Layers ``boundary``, ``samples``, ``refusals``, ``targets`` and
``route`` are drawn from it in the same transaction. An event is on disk (``synchronous=FULL``)
when :meth:`Journal.append` returns; a power cut at any byte loses none that was acknowledged.
Each row carries a digest of itself and of all rows before it, and the anchor that of the last one.

Look at a running survey with GDAL or QGIS from another process than the one that writes: GDAL
brings a sqlite of its own, and two of them in one process do not see each other's locks.
"""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

from subsoil.errors import JournalError
from subsoil.journal import gis, owner
from subsoil.journal.ahead import NOTHING_DRAWN, Ahead
from subsoil.journal.connection import check_file, check_survey, connect, explained, reading
from subsoil.journal.content import (
    ANCHOR_COLUMNS,
    ANCHOR_TABLE,
    EVENT_COLUMNS,
    ROOT,
    Content,
    Last,
    anchor_of,
    content_of,
    digest_of,
    last_of,
)
from subsoil.journal.geopackage import add_columns, add_table, initialise
from subsoil.journal.lock import Lock, TakenError, busy, identity_of, lock
from subsoil.journal.marks import notes, refuse_left_behind
from subsoil.journal.publish import published
from subsoil.journal.spatial_index import know_functions
from subsoil.survey import Survey, opened
from subsoil.survey.events import FORMAT, Continued, Event, Opened, to_json

_PATIENCE_S = 1.0
"""Time for which closing waits for programs that look at the file."""
_LEFT_AS_IT_IS = {sqlite3.SQLITE_BUSY, sqlite3.SQLITE_READONLY_DBMOVED}
"""What sqlite says where another program has a file open, or it was renamed meanwhile."""


class Journal:
    """A survey file open for writing; made by :func:`create` or :func:`open_journal`.

    A context manager: leaving it closes the file, which is then one self-contained GeoPackage.
    Its methods may be called from several threads, by one at a time.

    Attributes
    ----------
    path
        The file.
    notes
        What to tell the user of it before going on.
    """

    def __init__(
        self, path: Path, database: sqlite3.Connection, held: Lock, content: Content
    ) -> None:
        self.path = path
        self.notes = content.notes
        self._database = database
        self._held = held
        self._last = content.last
        self._format = content.format
        self._srs = gis.srs_of(database)
        self._drawn = NOTHING_DRAWN

    def __enter__(self) -> Journal:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()

    def append(self, event: Event, survey: Survey) -> None:
        """Keep an event; on disk when this returns.

        The first event that goes into a file of an older format is preceded by one that says so.

        Parameters
        ----------
        event
            What happened. An id that is in already is not taken twice.
        survey
            The state after it, for the layers a GIS shows.

        Raises
        ------
        JournalError
            If it could not be written, or another program wrote to the file; it is as it was
            before.
        """
        with self._transaction() as database:
            self._check_last(self._last)
            if database.execute("SELECT 1 FROM events WHERE id = ?", (event.id,)).fetchone():
                return
            last = self._upgraded(survey) if self._format < FORMAT else self._last
            last = _insert_event(database, event, last)
            self._check_last(last)
            drawn = self._draw(event, survey)
        self._last, self._drawn, self._format = last, drawn, FORMAT

    @contextmanager
    def together(self) -> Iterator[None]:
        """Keep all events that are appended within, or none of them if it ends in an error."""
        before = self._last, self._drawn, self._format
        try:
            with self._transaction():
                yield
        except BaseException:
            self._last, self._drawn, self._format = before
            raise

    def events(self) -> tuple[Event, ...]:
        """Everything that happened, in order."""
        with explained(self.path):
            return content_of(self._database, self.path).events

    def close(self) -> None:
        """Give the file back as one self-contained GeoPackage, and let others write.

        Where a GIS has the file open or somebody renamed it, what was written last stays in the
        ``-wal`` file until the next program closes it.
        """
        try:
            with explained(self.path):
                owner.sign_off(self._database)
                self._database.execute(f"PRAGMA busy_timeout = {int(1000 * _PATIENCE_S)}")
                self._database.execute("PRAGMA wal_checkpoint(TRUNCATE)")
                with _unless_looked_at_or_renamed():
                    self._database.execute("PRAGMA journal_mode = DELETE")
        finally:
            self._database.close()
            self._held.release()

    def _draw(self, event: Event, survey: Survey) -> Ahead:
        """Show an event in the layers; what is drawn of the stops still to make."""
        database = self._database
        if self._format < FORMAT:
            gis.redraw(database, self._srs, survey)
        else:
            gis.draw(database, self._srs, event, survey)
        if self._drawn is NOTHING_DRAWN:
            gis.clear_targets(database)
        return gis.draw_targets(database, self._srs, survey, self._drawn)

    def _upgraded(self, survey: Survey) -> Last:
        """Note that a file of an older format goes on in that of today; its tables follow."""
        for table, (_, columns, _) in gis.tables_of(survey.layers).items():
            add_columns(self._database, table, columns)
        return _insert_event(self._database, Continued().stamped(_now()), self._last)

    def _check_last(self, expected: Last) -> None:
        """Check that the last event is the one that it should be."""
        if (found := last_of(self._database)) != expected:
            raise JournalError(
                f"another program wrote to the file: it ends with event {found[0]}, digest "
                f"{found[1][:8]}, and not with event {expected[0]} of this one",
                where=str(self.path),
                remedy="stop the other program, then `subsoil verify` and `subsoil resume`",
            )

    @contextmanager
    def _transaction(self) -> Iterator[sqlite3.Connection]:
        with explained(self.path):
            if self._database.in_transaction:
                yield self._database
                return
            self._database.execute("BEGIN IMMEDIATE")
            try:
                yield self._database
                self._database.execute("COMMIT")
            except BaseException:
                if self._database.in_transaction:
                    self._database.execute("ROLLBACK")
                raise


def create(path: Path, opening: Opened) -> Journal:
    """Start a survey file; it is there whole, or not at all.

    Raises
    ------
    JournalError
        If there is a file already, or none can be made there.
    """
    with published(path) as unfinished:
        database = sqlite3.connect(unfinished, isolation_level=None)
        try:
            database.execute("BEGIN")
            srs = initialise(database, opening.crs)
            add_table(database, "events", EVENT_COLUMNS, "Everything that happened; the truth")
            add_table(database, ANCHOR_TABLE, ANCHOR_COLUMNS, "The last event")
            owner.create(database)
            gis.create(database, srs, opened(opening))
            _insert_event(database, opening.stamped(_now()), (0, ROOT))
            database.execute("COMMIT")
        finally:
            database.close()
    return open_journal(path)


def open_journal(path: Path) -> Journal:
    """Open a survey file to go on with it.

    Raises
    ------
    SurveyBusyError
        If another process is writing to it.
    JournalError
        If it is missing, cannot be written, or is not a survey file.
    CorruptJournalError
        If an event cannot be read, was changed or is missing at the end.
    """
    check_file(path)
    try:
        held = lock(path)
    except TakenError:
        raise busy(path, _writer(path)) from None
    try:
        with explained(path):
            database = connect(path)
            try:
                return Journal(path, database, held, _signed(database, path, held))
            except BaseException:
                database.close()
                raise
    except BaseException:
        held.release()
        raise


def _signed(database: sqlite3.Connection, path: Path, held: Lock) -> Content:
    """Mark a file as open, on disk before the first event; returns what it holds."""
    check_survey(database, path)
    if identity_of(path) != held.identity:
        raise busy(path, "a program that puts another file in its place")
    refuse_left_behind(database, path)
    content = replace(content_of(database, path), notes=notes(database, path))
    know_functions(database)
    database.execute("BEGIN IMMEDIATE")
    owner.sign(database, path)
    if anchor_of(database) is None:
        add_table(database, ANCHOR_TABLE, ANCHOR_COLUMNS, "The last event")
        _set_anchor(database, content.last)
    database.execute("COMMIT")
    database.execute("PRAGMA wal_checkpoint(PASSIVE)")
    database.execute("PRAGMA journal_mode = WAL")
    return content


def _writer(path: Path) -> str:
    with suppress(JournalError), reading(path) as database:
        return owner.name(database)
    return ""


def _insert_event(database: sqlite3.Connection, event: Event, last: Last) -> Last:
    """Insert an event after the last one; returns its number and digest."""
    body = to_json(event)
    added = last[0] + 1, digest_of(last[1], body)
    recorded = (event.time or _now()).isoformat(timespec="milliseconds")
    database.execute(
        "INSERT INTO events(seq, id, kind, recorded, body, digest) VALUES (?, ?, ?, ?, ?, ?)",
        (added[0], event.id, event.kind, recorded, body, added[1]),
    )
    _set_anchor(database, added)
    return added


def _set_anchor(database: sqlite3.Connection, last: Last) -> None:
    database.execute(f"DELETE FROM {ANCHOR_TABLE}")
    database.execute(f"INSERT INTO {ANCHOR_TABLE}(seq, digest) VALUES (?, ?)", last)


@contextmanager
def _unless_looked_at_or_renamed() -> Iterator[None]:
    """Let it be where another program has the file open, or gave it another name."""
    try:
        yield
    except sqlite3.OperationalError as error:
        if error.sqlite_errorcode not in _LEFT_AS_IT_IS:
            raise


def _now() -> datetime:
    return datetime.now(UTC)
