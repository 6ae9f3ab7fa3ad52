"""Starting: light, and with an answer to Ctrl-C before anything is loaded."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path

import pytest

HEAVY = {"numpy", "scipy", "shapely", "pyproj", "pydantic", "typer", "rich", "yaml"}


@pytest.mark.parametrize("module", ["subsoil", "subsoil.__main__"])
def test_nothing_is_loaded_before_ctrl_c_has_an_answer(module: str) -> None:
    done = subprocess.run(
        [sys.executable, "-c", f"import sys, {module}\nprint(*sys.modules)"],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert not HEAVY & set(done.stdout.split())


def test_ctrl_c_while_libraries_load_is_one_line(tmp_path: Path) -> None:
    (tmp_path / "threadpoolctl.py").write_text(
        "import time\nprint('loading', flush=True)\ntime.sleep(60)\n"
    )
    start = "from subsoil.__main__ import main; main()"
    code = f"import sys; sys.path.insert(0, {str(tmp_path)!r}); {start}"
    with subprocess.Popen(
        [sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as running:
        assert running.stdout
        assert running.stderr
        assert running.stdout.readline() == "loading\n"
        running.send_signal(signal.SIGINT)
        said = running.stderr.read()
    assert running.returncode == 3
    assert said == "error: stopped before anything was done\n"
