"""A new file appears under its name when it is whole, or not at all, and never over another."""

from __future__ import annotations

import errno
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from uuid import uuid4

from subsoil.errors import JournalError
from subsoil.journal.connection import explained

_UNFINISHED = ".subsoil-unfinished-"
_NO_LINKS = {errno.EPERM, errno.EOPNOTSUPP, errno.ENOSYS, errno.EMLINK}


@contextmanager
def published(path: Path) -> Iterator[Path]:
    """Name under which to build a file; it is synced and gets its own name at the end.

    What a process that was killed left unfinished in the folder is taken away first.

    Raises
    ------
    JournalError
        If something of that name is there, or nothing can be written there.
    """
    if not path.parent.is_dir():
        raise JournalError("there is no such folder", where=str(path.parent), remedy="create it")
    with explained(path), _alone_in(path.parent) as alone:
        _check_free(path)
        for left in path.parent.glob(f"{_UNFINISHED}*") if alone else ():
            left.unlink(missing_ok=True)
        unfinished = path.parent / f"{_UNFINISHED}{uuid4().hex}"
        try:
            yield unfinished
            _sync(unfinished)
            _name(unfinished, path)
        finally:
            unfinished.unlink(missing_ok=True)


def _check_free(path: Path) -> None:
    """Check that nothing has a name, nor left there what sqlite would take for the file's own."""
    if os.path.lexists(path):
        raise _exists(path)
    for left in (Path(f"{path}{end}") for end in ("-wal", "-journal")):
        if os.path.lexists(left):
            raise JournalError(
                f"{left.name} is there, left from another survey, and may hold its last events",
                where=str(path),
                remedy=f"choose another name, or move {left.name} to the survey it belongs to",
            )


def _name(unfinished: Path, path: Path) -> None:
    """Give a file its name; where the file system has no links, by renaming it."""
    try:
        os.link(unfinished, path)
    except FileExistsError:
        raise _exists(path) from None
    except OSError as error:
        if error.errno not in _NO_LINKS:
            raise
        unfinished.rename(path)


def _sync(path: Path) -> None:
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _exists(path: Path) -> JournalError:
    return JournalError(
        "the file exists already",
        where=str(path),
        remedy="choose another name, or go on with `subsoil run` or `subsoil resume`",
    )


@contextmanager
def _alone_in(folder: Path) -> Iterator[bool]:
    """Have a folder to oneself and sync it at the end; whether that is so: not all systems can."""
    if sys.platform == "win32":
        yield False
        return
    import fcntl

    descriptor = os.open(folder, os.O_RDONLY)
    try:
        alone = True
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX)
        except OSError:
            alone = False
        yield alone
        with suppress(OSError):
            os.fsync(descriptor)
    finally:
        os.close(descriptor)
