"""Instruments, each a pair of functions in a file of its own: ``sniff`` a head, ``read`` a path.

Another instrument needs no more than such a file, and a line in :data:`INSTRUMENTS`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from subsoil.io.read.instruments import gef, penetrologger, probe_log, robot_yaml, sc900
from subsoil.io.read.recording import Recording


@dataclass(frozen=True)
class Reader:
    """How files of an instrument, or of one kind, are known and read; called, it reads a path.

    Attributes
    ----------
    name
        What people call it.
    sniff
        Whether a file is one, by its first 4 096 bytes and its name.
    read
        Reads a path.
    """

    name: str
    sniff: Callable[[bytes, str], bool]
    read: Callable[[Path], Recording]

    def __call__(self, path: Path) -> Recording:
        """Read a path."""
        return self.read(path)


INSTRUMENTS: dict[str, Reader] = {
    "sc900": Reader(sc900.NAME, sc900.sniff, sc900.read),
    "penetrologger": Reader(penetrologger.NAME, penetrologger.sniff, penetrologger.read),
    "gef": Reader(gef.NAME, gef.sniff, gef.read),
    "probe-log": Reader(probe_log.NAME, probe_log.sniff, probe_log.read),
    "robot-yaml": Reader(robot_yaml.NAME, robot_yaml.sniff, robot_yaml.read),
}
"""By the name that forces one."""
