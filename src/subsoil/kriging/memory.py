"""Memory that kriging many readings takes, said before the work starts."""

from __future__ import annotations

import os
from pathlib import Path

from subsoil.errors import ReadingsError

_PAIRS, _TARGETS = 12, 2
"""Numbers held at the peak for each pair of readings, and each reading and target: as measured."""
_NUMBER = 8
_GIB = 2**30
_KNOWN = Path("/proc/meminfo")


def needed_gib(readings: int, targets: int = 0) -> float:
    """GiB that estimating variograms of readings and kriging them at targets takes at its peak.

    All layers are taken to be reached by the same readings.

    Examples
    --------
    >>> round(needed_gib(6000, targets=12_500), 1), round(needed_gib(1_000_000))
    (4.3, 89407)
    """
    return _NUMBER * readings * (_PAIRS * readings + _TARGETS * targets) / _GIB


def available_gib() -> float:
    """GiB that this machine, and the limits of this process, leave."""
    free = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    if _KNOWN.exists():
        lines = dict(line.split(":", 1) for line in _KNOWN.read_text().splitlines() if ":" in line)
        free = 1024 * int(lines["MemAvailable"].split()[0]) if "MemAvailable" in lines else free
    return min(free, _limit()) / _GIB


def check_memory(readings: int, targets: int = 0) -> None:
    """Check that there is memory for kriging readings at targets.

    Raises
    ------
    ReadingsError
        If there is not.
    """
    needed, available = needed_gib(readings, targets), available_gib()
    if needed > available:
        raise ReadingsError(
            f"{readings} readings take about {needed:.0f} GiB of memory, and {available:.0f} GiB "
            "are free",
            where="kriging",
            remedy="thin the readings, map a part of the field, or use larger cells",
        )


def _limit() -> float:
    """Bytes that this process may take in all."""
    try:
        import resource
    except ImportError:  # not POSIX
        return float("inf")
    soft, _ = resource.getrlimit(resource.RLIMIT_AS)
    return float("inf") if soft == resource.RLIM_INFINITY else float(soft)
