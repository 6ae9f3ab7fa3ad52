"""Logs of the probe of the penetrometer robot at Riseholme, of August 2017.

A line is ``unix seconds, effort, target, speed`` without a heading, some 90 a second: effort of
the motor in percent, where the rod is to be in mm (480 is a push, 0 the way back), and how fast it
moves in mm/s. Also as ``.log.gz``.

Effort of a motor is no force: it holds friction of the drive, and 12 % are met in air. So these
logs are not mapped; :func:`read_probe_log` gives them for looking at.
"""

from __future__ import annotations

import re
import zlib
from dataclasses import dataclass
from datetime import UTC, datetime
from itertools import groupby
from pathlib import Path

import numpy as np

from subsoil.arrays import Floats
from subsoil.errors import ReadingsError
from subsoil.io.read.recording import Recording
from subsoil.io.read.text import check_file

NAME = "robot probe log (motor effort)"

_LINE = re.compile(rb"\s*(\d{9,10}),\s*(\d{1,3}),\s*(\d{1,4}(?:\.\d*)?),\s*(\d{1,4})\s*")
_GZIP = b"\x1f\x8b"
_MOST_BYTES = 50_000_000
_LEAST_M = 0.05
"""A rod that moved less made no push."""
_USUAL_HZ = 90.0


@dataclass(frozen=True)
class MotorEffort:
    """What the motor did on a push of the rod.

    Attributes
    ----------
    began
        When it began.
    depth_m
        (k,) depths in m below where the rod started, not below the ground; they do not decrease.
    percent
        (k,) effort of the motor in percent at each of them.
    """

    began: datetime
    depth_m: Floats
    percent: Floats


def sniff(head: bytes, name: str) -> bool:  # noqa: ARG001 - its suffix says nothing
    """Whether a file is one, by its first bytes and its name."""
    return bool(_LINE.fullmatch(_unpacked(head, 256).partition(b"\n")[0]))


def read(path: Path) -> Recording:
    """Refuse a log as readings of soil strength.

    Raises
    ------
    ReadingsError
        Always, with the reason.
    """
    raise ReadingsError(
        f"a log of motor effort in percent ({len(read_probe_log(path))} pushes), which is no force",
        where=path.name,
        remedy="give readings of a load cell; read_probe_log in Python shows effort by depth",
    )


def read_probe_log(path: str | Path) -> tuple[MotorEffort, ...]:
    """Read the pushes of a log, first one first; none where the rod did not move 5 cm.

    The log says whole seconds and a speed without its sign. Lines are taken to follow each other
    evenly, as many a second as is typical of the log, and depth is the sum of speed times time
    from when the rod is sent down until it is where it was sent or is called back.

    Raises
    ------
    ReadingsError
        If there is no such file, or it is not such a log.
    """
    path = Path(path)
    check_file(path, ReadingsError)
    lines = _unpacked(path.read_bytes(), _MOST_BYTES).split(b"\n")
    matches = [_LINE.fullmatch(line) for line in lines[:-1]]
    if None in matches:
        raise ReadingsError(
            "this is no line of seconds, effort, target and speed",
            where=f"{path.name}, line {matches.index(None) + 1}",
            remedy="copy the log from the robot again",
        )
    rows = np.array([[float(each) for each in match.groups()] for match in matches if match])
    if not rows.size:
        return ()
    step_s = 1 / _rate_hz(rows[:, 0])
    pushes = [
        _push(rows[[k for k, _ in group]], step_s)
        for down, group in groupby(enumerate(rows[:, 2] > 0), key=lambda pair: pair[1])
        if down
    ]
    return tuple(push for push in pushes if push.depth_m[-1] >= _LEAST_M)


def _rate_hz(seconds: Floats) -> float:
    """Lines a second, by those that are whole."""
    whole = np.unique(seconds, return_counts=True)[1][1:-1]
    return float(np.median(whole)) if whole.size else _USUAL_HZ


def _push(rows: Floats, step_s: float) -> MotorEffort:
    deep = np.minimum(np.cumsum(rows[:, 3]) * step_s, rows[:, 2]) / 1000
    there = int(np.searchsorted(deep, deep[-1])) + 1
    began = datetime.fromtimestamp(rows[0, 0], UTC)
    return MotorEffort(began, deep[:there], rows[:there, 1])


def _unpacked(data: bytes, most: int) -> bytes:
    """The first bytes of what a file holds, also of one that ends early."""
    if not data.startswith(_GZIP):
        return data[:most]
    try:
        return zlib.decompressobj(wbits=31).decompress(data, most)
    except zlib.error:
        return b""
