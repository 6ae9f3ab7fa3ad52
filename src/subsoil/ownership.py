"""One writer at a time: the lock of a survey file, and the name of who holds it.

The lock is the operating system's, on a file beside the survey, so it goes with the process that
holds it, however that ends. The name is in the survey itself.
"""

from __future__ import annotations

import getpass
import os
import socket
import sqlite3
from contextlib import closing
from datetime import UTC, datetime
from pathlib import Path

from filelock import FileLock, Timeout

from subsoil.errors import JournalError, SurveyBusyError

OWNER_TABLE = "subsoil_owner"
OWNER_COLUMNS = {"who": "TEXT NOT NULL", "since": "TEXT NOT NULL"}


def lock_for_writing(path: Path) -> FileLock:
    """Lock a survey file.

    Raises
    ------
    SurveyBusyError
        If another process holds it; names that process.
    JournalError
        If nothing can be written there.
    """
    lock = FileLock(path.parent / f".{path.name}.lock", timeout=0)
    try:
        lock.acquire()
    except Timeout:
        raise SurveyBusyError(
            f"{_owner(path)} is writing to it",
            where=str(path),
            remedy="wait until it is done, or stop it",
        ) from None
    except OSError as error:
        raise JournalError(
            f"the file cannot be written: {error.strerror}",
            where=str(path),
            remedy="choose a folder you may write to",
        ) from error
    return lock


def unlock(lock: FileLock) -> None:
    """Give a lock back and take its file away; a rival that waits on that file starts over."""
    Path(lock.lock_file).unlink(missing_ok=True)
    lock.release()


def name_owner(database: sqlite3.Connection) -> None:
    """Write into a survey that this process is its writer."""
    who = f"process {os.getpid()} of {getpass.getuser()} on {socket.gethostname()}"
    since = datetime.now(UTC).isoformat(timespec="seconds")
    database.execute(f"DELETE FROM {OWNER_TABLE}")
    database.execute(f"INSERT INTO {OWNER_TABLE} VALUES (?, ?)", (who, since))


def _owner(path: Path) -> str:
    """Name of the writer; it may not have written it yet."""
    try:
        with closing(sqlite3.connect(path)) as database:
            row = database.execute(f"SELECT who, since FROM {OWNER_TABLE}").fetchone()
    except sqlite3.Error:
        return "another process"
    return f"{row[0]}, since {row[1]}," if row else "another process"
