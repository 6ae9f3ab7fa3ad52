"""Broken files are read, or refused in a line: no traceback, no hang, no run on the memory."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

COUNT = int(os.environ.get("SUBSOIL_FUZZ", "2000"))
"""Files in all: ``make fuzz`` asks for 20 000."""
AT_A_TIME = 250


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="the memory is read from /proc")
@pytest.mark.parametrize("first", range(0, COUNT, AT_A_TIME))
def test_a_broken_file_is_read_or_refused_in_a_line(first: int) -> None:
    count = min(AT_A_TIME, COUNT - first)
    done = subprocess.run(
        [sys.executable, "-m", "tests.fuzz.reading", str(first), str(count)],
        cwd=Path(__file__).parents[2], capture_output=True, text=True, check=False,
        timeout=AT_A_TIME * 11,
    )  # fmt: skip
    lines = done.stdout.splitlines()
    wrong = "\n".join(done.stdout.split("WRONG ")[1:])
    assert not wrong, wrong
    assert lines[-1:] == ["done"], f"ended {lines[-1:]} with {done.stderr[-2000:]}"
