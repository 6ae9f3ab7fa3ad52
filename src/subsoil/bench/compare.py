"""A benchmark from its settings to its results: what ``subsoil bench run`` does."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import shapely

from subsoil.bench.running import Failed, Outcome, on_dask, on_pool
from subsoil.bench.store import Benchmark, enter, keep, kept, write_results
from subsoil.bench.task import Result, Setting, Task
from subsoil.bench.truths import land_of
from subsoil.errors import ParameterError
from subsoil.land.field import Field


@dataclass(frozen=True)
class Compared:
    """What came of a benchmark.

    Attributes
    ----------
    benchmark
        What was compared.
    before
        Tasks that had been done before.
    failed
        Tasks without a result.
    results
        Path of ``results.csv``.
    """

    benchmark: Benchmark
    before: int
    failed: tuple[Failed, ...]
    results: Path

    @property
    def now(self) -> int:
        """Tasks that were done now."""
        return len(self.benchmark.tasks) - self.before - len(self.failed)


def waiting(folder: Path, benchmark: Benchmark) -> tuple[Task, ...]:
    """Tasks of a benchmark whose result is not there."""
    return tuple(task for task in benchmark.tasks if not kept(folder, task))


def compare(
    benchmark: Benchmark,
    folder: Path,
    *,
    workers: int | None = None,
    dask: str | None = None,
    told: Callable[[Outcome], None] = lambda _: None,
) -> Compared:
    """Do what a benchmark has still to do, and keep the results in a folder.

    Parameters
    ----------
    benchmark
        What to compare.
    folder
        Of this benchmark, or empty.
    workers
        Processes on this machine. Default: one a core.
    dask
        Address of a Dask scheduler, or ``"local"``.
    told
        Told of each outcome once it is kept.

    Raises
    ------
    ParameterError
        If the folder holds another benchmark, or no scheduler answers.
    """
    enter(folder, benchmark)
    tasks, failed = waiting(folder, benchmark), list[Failed]()
    count = workers or os.cpu_count() or 1
    outcomes = on_pool(tasks, count) if dask is None else on_dask(tasks, dask, count)
    for outcome in outcomes if tasks else ():
        match outcome:
            case Failed():
                failed.append(outcome)
            case Result():
                keep(folder, outcome)
        told(outcome)
    before = len(benchmark.tasks) - len(tasks)
    return Compared(benchmark, before, tuple(failed), write_results(folder))


def setting_on(
    boundary: Field | None, protocol: str, seed: int, samples: tuple[int, ...]
) -> Setting:
    """Setting of a benchmark, once its field and real readings are there if it needs them.

    Parameters
    ----------
    boundary
        The field, or the protocol's own.
    protocol, seed, samples
        As in :class:`~subsoil.bench.task.Setting`.

    Raises
    ------
    ParameterError
        If there is no such protocol, or there are more samples than cells.
    DataUnavailableError
        If real readings are needed and not at hand.
    """
    outline, crs = "", ""
    if boundary is not None:
        outline = shapely.to_wkt(boundary.boundary, rounding_precision=-1)
        crs = boundary.crs
    setting = Setting(protocol, seed, samples, outline, crs)
    if protocol == "riseholme":
        from subsoil.datasets import riseholme

        riseholme()
    cells = len(land_of(setting).cells)
    if setting.samples[-1] > cells:
        raise ParameterError(
            f"{setting.samples[-1]} samples are more than the field's {cells} cells",
            where="--samples",
            remedy="take fewer",
        )
    return setting
