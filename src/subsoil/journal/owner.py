"""Who has a survey file open for writing: one row in the file, there before the first event.

The row tells a rival who is writing. It also tells a copy that was made meanwhile from the file
itself, which has the same device and number still: what the writer wrote since may lie in the
``-wal`` file that was not copied along.
"""

from __future__ import annotations

import getpass
import os
import socket
import sqlite3
from collections.abc import Mapping
from datetime import UTC, datetime
from pathlib import Path

from subsoil.errors import brief
from subsoil.journal.geopackage import add_table
from subsoil.journal.lock import identity_of

OWNER = "subsoil_owner"
_COLUMNS = {
    "who": "TEXT NOT NULL",
    "since": "TEXT NOT NULL",
    "path": "TEXT NOT NULL",
    "device": "TEXT NOT NULL",
    "number": "TEXT NOT NULL",
    "boot": "TEXT NOT NULL",
}
_BOOT = Path("/proc/sys/kernel/random/boot_id")


def create(database: sqlite3.Connection) -> None:
    """Add the table, empty."""
    add_table(database, OWNER, _COLUMNS, "Who is writing now")


def sign(database: sqlite3.Connection, path: Path) -> None:
    """Write that this process has the file open; a table of another shape is made anew."""
    columns = ", ".join(f"{name} {kind}" for name, kind in _COLUMNS.items())
    database.execute(f"DROP TABLE IF EXISTS {OWNER}")
    database.execute(f"CREATE TABLE {OWNER} ({columns})")
    device, number = identity_of(path)
    row = (
        f"process {os.getpid()} of {_user()} on {socket.gethostname()}",
        datetime.now(UTC).isoformat(timespec="seconds"),
        str(path.resolve()).encode(errors="replace").decode(),
        device,
        number,
        _boot(),
    )
    database.execute(f"INSERT INTO {OWNER} VALUES ({', '.join('?' * len(row))})", row)


def sign_off(database: sqlite3.Connection) -> None:
    """Write that nobody has the file open."""
    database.execute(f"DELETE FROM {OWNER}")


def name(database: sqlite3.Connection) -> str:
    """Who has the file open, or had it when it ended without closing; empty for nobody."""
    row = _row(database)
    if not row:
        return ""
    who, since = row.get("who", "another process"), row.get("since", "unknown")
    return f"{brief(who, 200)}, since {brief(since)},"


def wal_elsewhere(database: sqlite3.Connection, path: Path) -> Path | None:
    """The ``-wal`` file that a survey left behind under another name of its, if any."""
    row = _row(database)
    if not _names_file(row) or path.resolve() == Path(row["path"]):
        return None
    left = Path(f"{row['path']}-wal")
    here = Path(f"{path.resolve()}-wal")
    return left if _same_file(row, path) and _filled(left) and not _filled(here) else None


def copied_while_open(database: sqlite3.Connection, path: Path) -> bool:
    """Whether the file is a copy of one that was being written to."""
    row = _row(database)
    return _names_file(row) and not _same_file(row, path)


def _names_file(row: Mapping[str, str]) -> bool:
    """Whether there is a writer, and one that says which file it had open; 0.1 did not."""
    return row.keys() >= _COLUMNS.keys()


def _same_file(row: Mapping[str, str], path: Path) -> bool:
    """Whether the file was signed itself; devices may be numbered anew at each start."""
    device, number = identity_of(path)
    return row["number"] == number and (row["device"] == device or row["boot"] != _boot())


def _filled(path: Path) -> bool:
    try:
        return path.stat().st_size > 0
    except (OSError, ValueError):
        return False


def _row(database: sqlite3.Connection) -> dict[str, str]:
    cursor = database.execute(f"SELECT * FROM {OWNER}")
    names = [column[0] for column in cursor.description]
    return {key: str(value) for key, value in zip(names, cursor.fetchone() or (), strict=False)}


def _user() -> str:
    try:
        return getpass.getuser()
    except (KeyError, OSError):
        return "an unnamed user"


def _boot() -> str:
    try:
        return _BOOT.read_text().strip()
    except OSError:
        return ""
