"""Tasks spread over processes of this machine, or over a Dask cluster.

Either way results come back to the caller, who keeps them: workers need no common disk.
"""

from __future__ import annotations

import os
import signal
from collections import Counter, deque
from collections.abc import Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import get_context, parent_process
from threading import Thread
from typing import Any

from subsoil.bench.scoring import scored
from subsoil.bench.task import Result, Task
from subsoil.errors import ParameterError
from subsoil.optional import load

RETRIES = 2
"""Times that a task is tried again after its worker died."""
LOCAL = "local"
"""Address that means: a Dask cluster on this machine."""

_CONNECT_S = 10


@dataclass(frozen=True)
class Failed:
    """A task that has no result, and why."""

    task: Task
    why: str


@dataclass(frozen=True)
class Retried:
    """A task whose worker died and that is tried again."""

    task: Task
    deaths: int


Outcome = Result | Failed | Retried


def on_pool(tasks: Sequence[Task], workers: int) -> Iterator[Outcome]:
    """Do tasks in processes of this machine, and yield what comes of them as it comes.

    Every worker is a pool of its own: when one dies it is known which task it had, and no other
    task suffers. An exception in a task is its failure, since it would be raised again.

    Parameters
    ----------
    tasks
        What to do, in order.
    workers
        Number of processes.
    """
    waiting, deaths = deque(tasks), Counter[Task]()
    slots = [_worker() for _ in range(min(workers, len(tasks)))]
    idle = list(range(len(slots)))
    running: dict[Future[Result], tuple[int, Task]] = {}
    try:
        while waiting or running:
            while waiting and idle:
                slot, task = idle.pop(), waiting.popleft()
                running[_submit(slots, slot, task)] = (slot, task)
            for future in wait(running, return_when=FIRST_COMPLETED).done:
                slot, task = running.pop(future)
                idle.append(slot)
                error = future.exception()
                if not isinstance(error, BrokenProcessPool):
                    yield Failed(task, _said(error)) if error else future.result()
                    continue
                slots[slot] = _worker()
                deaths[task] += 1
                if deaths[task] > RETRIES:
                    yield Failed(task, f"its worker died {deaths[task]} times")
                else:
                    waiting.appendleft(task)
                    yield Retried(task, deaths[task])
    finally:
        for worker in slots:
            worker.shutdown(wait=False, cancel_futures=True)


def on_dask(tasks: Sequence[Task], address: str, workers: int) -> Iterator[Outcome]:
    """Do tasks on a Dask cluster, and yield what comes of them as it comes.

    A task whose worker died is tried again by the scheduler: twice on a cluster of this machine,
    elsewhere as often as its ``distributed.scheduler.allowed-failures`` says. Workers elsewhere
    need the same subsoil, and for the protocol ``riseholme`` its readings.

    Parameters
    ----------
    tasks
        What to do, in order.
    address
        Of the scheduler, such as ``tcp://10.0.0.5:8786``; or ``"local"``.
    workers
        Number of processes of a local cluster.

    Raises
    ------
    MissingExtraError
        If dask.distributed is not installed.
    ParameterError
        If no scheduler answers at the address.
    """
    distributed = load("distributed", "dask", "--dask")
    with _client(distributed, address, min(workers, len(tasks))) as client:
        futures = {client.submit(scored, task, key=task.name): task for task in tasks}
        for future in distributed.as_completed(futures):
            error = future.exception()
            yield Failed(futures[future], _said(error)) if error else future.result()
            future.release()


def _worker() -> ProcessPoolExecutor:
    """Process for one task after the other."""
    return ProcessPoolExecutor(1, mp_context=get_context("spawn"), initializer=_begin)


def _begin() -> None:
    """Make a worker end quietly: at Ctrl-C at once, and when its parent was killed."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _submit(slots: list[ProcessPoolExecutor], slot: int, task: Task) -> Future[Result]:
    """Give a task to a worker; to a new one where it died while it had nothing to do."""
    try:
        return slots[slot].submit(scored, task)
    except BrokenProcessPool:
        slots[slot] = _worker()
        return slots[slot].submit(scored, task)


def _said(error: BaseException) -> str:
    """Say an error on one line."""
    return " ".join(f"{type(error).__name__}: {error}".split())


@contextmanager
def _client(distributed: Any, address: str, workers: int) -> Iterator[Any]:
    if address != LOCAL:
        with _connected(distributed, address) as client:
            yield client
        return
    dask = load("dask", "dask", "--dask")
    with (
        dask.config.set({"distributed.scheduler.allowed-failures": RETRIES}),
        distributed.LocalCluster(
            n_workers=workers, threads_per_worker=1, dashboard_address=None
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        yield client


def _connected(distributed: Any, address: str) -> Any:
    try:
        return distributed.Client(address, timeout=_CONNECT_S)
    except (OSError, ValueError) as error:
        raise ParameterError(
            f"no Dask scheduler answers at {address}",
            where="--dask",
            remedy="give its address, such as tcp://10.0.0.5:8786, or local",
        ) from error
