"""Instruments, each a pair of functions in a file of its own: ``sniff`` a head, ``read`` a path.

Another instrument needs no more than such a file, and a line in :data:`INSTRUMENTS`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from subsoil.io.read.instruments import robot_yaml
from subsoil.io.read.recording import Recording


@dataclass(frozen=True)
class Reader:
    """How files of an instrument, or of one kind, are known and read.

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


INSTRUMENTS: dict[str, Reader] = {
    "robot-yaml": Reader(robot_yaml.NAME, robot_yaml.sniff, robot_yaml.read),
}
"""By the name that forces one."""
