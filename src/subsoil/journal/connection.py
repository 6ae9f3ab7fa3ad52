"""Connections to a survey file, and in one line what sqlite could not do.

Nothing here opens the file but sqlite: closing a descriptor of one's own would drop the locks that
sqlite has on it in this process, and the next program to close the file would then take away its
``-wal`` under a writer.
"""

from __future__ import annotations

import errno
import os
import sqlite3
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from subsoil.errors import CorruptJournalError, JournalError, brief, printable
from subsoil.journal.geopackage import APPLICATION_ID
from subsoil.journal.owner import OWNER

BUSY_SECONDS = 30.0
_DAMAGED = ("malformed", "could not decode", "corrupt")
_BACK_TO_A_COPY = "go back to a copy of the file"


@contextmanager
def reading(path: Path) -> Iterator[sqlite3.Connection]:
    """Connect to a survey file, running or not, as it is at one moment, unable to change it.

    sqlite itself may: after a power cut it first brings the file in order.

    Raises
    ------
    JournalError
        If it is missing or not a survey file.
    """
    check_file(path)
    mode = "rw" if os.access(path, os.W_OK) else "ro"
    with explained(path):
        database = sqlite3.connect(
            f"{path.resolve().as_uri()}?mode={mode}",
            uri=True,
            timeout=BUSY_SECONDS,
            isolation_level=None,
        )
        try:
            database.execute("PRAGMA query_only = ON")
            check_survey(database, path)
            database.execute("BEGIN")
            yield database
        finally:
            database.close()


def connect(path: Path) -> sqlite3.Connection:
    """Connect for writing, from any thread; what is committed is on disk."""
    database = sqlite3.connect(
        f"{path.resolve().as_uri()}?mode=rw", uri=True, timeout=BUSY_SECONDS,
        isolation_level=None, check_same_thread=False,
    )  # fmt: skip
    database.execute("PRAGMA synchronous = FULL")
    return database


def check_file(path: Path) -> None:
    """Check that there is a file."""
    what = ""
    with explained(path):
        try:
            mode = path.stat().st_mode
        except (FileNotFoundError, NotADirectoryError):
            what = "there is no such file"
        else:
            if not stat.S_ISREG(mode):
                what = "this is a folder" if stat.S_ISDIR(mode) else "this is no file"
    if what:
        raise JournalError(what, where=str(path), remedy="start a survey with `subsoil init`")


def check_survey(database: sqlite3.Connection, path: Path) -> None:
    """Check that a database is a survey."""
    (application,) = database.execute("PRAGMA application_id").fetchone()
    tables = {row[0] for row in database.execute("SELECT name FROM sqlite_master")}
    if application != APPLICATION_ID:
        raise _foreign(path, "no GeoPackage")
    if not {"events", OWNER} <= tables:
        raise _foreign(path, "another program's GeoPackage")


def _foreign(path: Path, kind: str) -> JournalError:
    return JournalError(
        f"not a subsoil survey but {kind}",
        where=str(path),
        remedy="start a survey with `subsoil init` under another name",
    )


@contextmanager
def explained(path: Path) -> Iterator[None]:
    """Say in one line what sqlite could not do."""
    try:
        yield
    except UnicodeDecodeError as error:
        raise _damaged(path, "text in it is not UTF-8") from error
    except sqlite3.Error as error:
        if getattr(error, "sqlite_errorcode", None) == sqlite3.SQLITE_NOTADB:
            raise _foreign(path, "no GeoPackage") from error
        said = brief(printable(str(error)), 200)
        if any(word in said.lower() for word in _DAMAGED):
            raise _damaged(path, said) from error
        raise JournalError(said, where=str(path), remedy=_remedy(error)) from error
    except OSError as error:
        what = error.strerror or brief(printable(str(error)), 200)
        raise JournalError(what, where=str(path), remedy=_remedy(error)) from error


def _damaged(path: Path, how: str) -> CorruptJournalError:
    return CorruptJournalError(
        f"the file is damaged: {how}", where=str(path), remedy=_BACK_TO_A_COPY
    )


def _remedy(error: Exception) -> str:
    text = str(error).lower()
    if "full" in text or getattr(error, "errno", None) == errno.ENOSPC or "disk i/o" in text:
        return "free some space on the disk, then `subsoil resume`: nothing recorded is lost"
    if "readonly" in text or "unable to open" in text or isinstance(error, PermissionError):
        return "check that you may write to the file and its folder"
    if "locked" in text:
        return "close programs that hold the file open for editing"
    if isinstance(error, OSError):
        return "check its name and the links in it"
    return _BACK_TO_A_COPY
