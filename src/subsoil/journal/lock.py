"""One writer at a time, told by the survey file itself and not by its name.

On Linux the lock is the operating system's, on the file that holds the survey: every link to it
and every name it is moved to is the same lock, and it goes with the process that holds it, however
that ends. It is an open file description lock on a byte far beyond those that sqlite locks: a
``flock`` is on the whole file, and on network file systems the two would shut each other out.

Its descriptor is opened before sqlite opens the file and closed after sqlite has closed it, because
closing *any* descriptor of a file drops the locks that sqlite has on it. For the same reason a file
that this process holds is never opened a second time.

Elsewhere a file beside the survey is locked.
"""

from __future__ import annotations

import os
import struct
import sys
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from threading import Lock as Guard

from subsoil.errors import JournalError, SurveyBusyError

Identity = tuple[str, str]
"""Device and number of a file, which stay when it is renamed or linked."""

_HELD: set[Identity] = set()
_GUARD = Guard()


class TakenError(Exception):
    """Somebody else has the lock."""


@dataclass(frozen=True)
class Lock:
    """A survey file that this process alone may write to; made by :func:`lock`."""

    identity: Identity
    _taken: ExitStack

    def release(self) -> None:
        """Let others write; not before sqlite has closed the file."""
        with _GUARD:
            self._taken.close()
            _HELD.discard(self.identity)


def identity_of(path: Path) -> Identity:
    """Device and number of a file."""
    found = path.stat()
    return str(found.st_dev), str(found.st_ino)


def lock(path: Path) -> Lock:
    """Lock a survey file for writing.

    Raises
    ------
    TakenError
        If this or another process holds it.
    JournalError
        If it may not be written to, or its file system has no locks.
    """
    try:
        with _GUARD:
            identity = identity_of(path)
            if identity in _HELD:
                raise TakenError
            taken = _take(path.resolve())
            _HELD.add(identity)
    except OSError as error:
        raise JournalError(
            f"the file cannot be locked for writing: {error.strerror or error}",
            where=str(path),
            remedy="check its rights, or work on a copy on a disk of this machine",
        ) from error
    return Lock(identity, taken)


def busy(path: Path, owner: str) -> SurveyBusyError:
    """Error that says who is writing."""
    return SurveyBusyError(
        f"{owner or 'another process'} is writing to it",
        where=str(path),
        remedy="wait until it is done, or stop it",
    )


if sys.platform == "linux":
    import fcntl

    _FAR_BYTE = 2**62
    _ONE_BYTE = struct.pack("hhqqi4x", fcntl.F_WRLCK, os.SEEK_SET, _FAR_BYTE, 1, 0)
    """``struct flock``: kind, whence, start, length, process."""

    def _take(path: Path) -> ExitStack:
        with ExitStack() as taken:
            descriptor = os.open(path, os.O_RDWR)
            taken.callback(os.close, descriptor)
            try:
                fcntl.fcntl(descriptor, fcntl.F_OFD_SETLK, _ONE_BYTE)
            except BlockingIOError:
                raise TakenError from None
            return taken.pop_all()

else:
    from filelock import FileLock, Timeout

    def _take(path: Path) -> ExitStack:
        if not os.access(path, os.W_OK):
            raise PermissionError(13, "Permission denied")
        beside = FileLock(path.parent / f".{path.name}.lock", timeout=0)
        with ExitStack() as taken:
            try:
                beside.acquire()
            except Timeout:
                raise TakenError from None
            taken.callback(beside.release)
            return taken.pop_all()
