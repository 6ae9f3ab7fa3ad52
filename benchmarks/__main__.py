"""``make bench``: run every workload in a process of its own and print one table.

``--full`` lets slow peers do the whole of a dense map instead of a tenth; ``--only NAME`` runs one
workload.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from dataclasses import asdict

from rich.console import Console
from rich.table import Table
from threadpoolctl import threadpool_limits

from benchmarks.workloads import Result, workloads

_SLOWED = ("OPENBLAS_CORETYPE", "OPENBLAS_L2_SIZE")
"""Settings that hold a current numpy back to kernels for an old processor."""


def measured(name: str, share: float) -> Result:
    """Run a workload in a fresh process with one BLAS thread."""
    environment = {k: v for k, v in os.environ.items() if k not in _SLOWED}
    command = [sys.executable, "-m", "benchmarks", "--worker", name, "--share", str(share)]
    done = subprocess.run(command, env=environment, check=True, stdout=subprocess.PIPE, text=True)
    return Result(**json.loads(done.stdout.splitlines()[-1]))


def shown(value: float, style: str) -> str:
    """Format a number, or nothing where there is none."""
    return format(value, style) if value == value else ""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--full", action="store_true")
    parser.add_argument("--only")
    parser.add_argument("--worker", help=argparse.SUPPRESS)
    parser.add_argument("--share", type=float, default=0.1, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.worker:
        with threadpool_limits(1, user_api="blas"):
            result = workloads(arguments.share)[arguments.worker]()
        print(json.dumps(asdict(result)))
        return
    share = 1.0 if arguments.full else arguments.share
    table = Table(title="Each workload and its peer in one process, one BLAS thread")
    for column in ("workload", "ours s", "peer s", "ratio", "max error", "MB", "goal", "note"):
        table.add_column(column)
    for name in [arguments.only] if arguments.only else workloads(share):
        result = measured(name, share)
        table.add_row(
            name,
            shown(result.ours_s, ".4f"),
            shown(result.peer_s, ".2f"),
            shown(result.peer_s / result.ours_s, ".0f"),
            shown(result.error, ".1e"),
            shown(result.memory_mb, ".0f"),
            result.goal,
            result.note,
        )
        print(f"{name}: {result.ours_s:.4f} s", file=sys.stderr)
    Console(width=170).print(table)


if __name__ == "__main__":
    main()
