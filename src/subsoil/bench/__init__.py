"""Comparisons of strategies on the same fields: run them, keep them, and see what they say.

A benchmark is a set of :class:`~subsoil.bench.task.Task`, each a pure function of itself. Results
are kept one file a task, so that a run can be stopped, gone on with and added to.
"""

from subsoil.bench.running import Failed, Retried, on_dask, on_pool
from subsoil.bench.scoring import scored, surveyed
from subsoil.bench.store import Benchmark, config_of, enter, keep, kept, repeatable, write_results
from subsoil.bench.task import Entrant, Result, Series, Setting, Snapshot, Task
from subsoil.bench.truths import truth_of

__all__ = [
    "Benchmark",
    "Entrant",
    "Failed",
    "Result",
    "Retried",
    "Series",
    "Setting",
    "Snapshot",
    "Task",
    "config_of",
    "enter",
    "keep",
    "kept",
    "on_dask",
    "on_pool",
    "repeatable",
    "scored",
    "surveyed",
    "truth_of",
    "write_results",
]
