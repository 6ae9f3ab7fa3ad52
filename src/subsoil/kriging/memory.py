"""Memory that variograms and a map take, said before the work starts."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from subsoil.errors import ReadingsError
from subsoil.kriging.covariance import AT_A_TIME

_ITSELF_GIB = 0.2
"""What the program takes before it has read anything, its figures and rasters included."""
_PAIR, _ANSWER, _AT_WORK = 4, 7, 4
"""Numbers held at the peak for a pair of readings, a mean of a map, and a covariance at work."""
_NUMBER = 8
_GIB = 2**30
_KNOWN = Path("/proc/meminfo")


def needed_gib(
    readings: int, *, systems: Sequence[int] = (), cells: int = 0, layers: int = 0
) -> float:
    """GiB that the program takes at its peak for variograms, leaving out, and a map.

    Variograms and leaving readings out hold matrices of all pairs of readings, a few at a time. A
    map keeps the inverse factor of each of its systems, and beside it as much as its answers and a
    strip of the work on them take: it does not grow with readings times cells. docs/benchmarks.md
    has the measured peaks that this is good for.

    Parameters
    ----------
    readings
        Number of readings.
    systems
        Readings in each kriging system of a map. Layers that the same readings reached share one
        if their variograms have one shape.
    cells, layers
        Those of the map.

    Examples
    --------
    >>> round(needed_gib(500, systems=[500], cells=200_000, layers=8), 2), round(needed_gib(20_000))
    (0.42, 12)
    """
    pairs = max(_PAIR * readings**2, sum(n**2 for n in systems))
    at_work = min(readings * max(readings, cells), AT_A_TIME)
    numbers = pairs + _AT_WORK * at_work + _ANSWER * cells * layers
    return _ITSELF_GIB + _NUMBER * numbers / _GIB


def available_gib() -> float:
    """GiB that this machine, and the limits of this process, leave."""
    free = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    if _KNOWN.exists():
        lines = dict(line.split(":", 1) for line in _KNOWN.read_text().splitlines() if ":" in line)
        free = 1024 * int(lines["MemAvailable"].split()[0]) if "MemAvailable" in lines else free
    return min(free, _limit()) / _GIB


def check_memory(
    readings: int, *, systems: Sequence[int] = (), cells: int = 0, layers: int = 0
) -> None:
    """Check that there is memory for readings; parameters as in :func:`needed_gib`.

    Raises
    ------
    ReadingsError
        If there is not.
    """
    needed = needed_gib(readings, systems=systems, cells=cells, layers=layers)
    available = available_gib()
    if needed > available:
        on = f" mapped on {cells} cells" if cells else ""
        raise ReadingsError(
            f"{readings} readings{on} take about {needed:.1f} GiB of memory, and "
            f"{available:.1f} GiB are free",
            where="kriging",
            remedy="thin the readings, map a part of the field, or use larger cells"
            if cells
            else "thin the readings",
        )


def _limit() -> float:
    """Bytes that this process may take in all."""
    try:
        import resource
    except ImportError:  # not POSIX
        return float("inf")
    soft, _ = resource.getrlimit(resource.RLIMIT_AS)
    return float("inf") if soft == resource.RLIM_INFINITY else float(soft)
