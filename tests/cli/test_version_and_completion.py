"""Version and shell completion, as of any program of the shell."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path
from typing import Any

import pytest

import subsoil
from subsoil.strategies import STRATEGIES
from subsoil.variogram import ESTIMATORS

Cli = Callable[..., Any]


def completed(*words: str) -> list[str]:
    """What a Bash would offer for the last of the words."""
    answers = subprocess.run(
        [sys.executable, "-c", "from subsoil.__main__ import main; main()"],
        capture_output=True, text=True, check=False,
        env={
            **os.environ, "_SUBSOIL_COMPLETE": "complete_bash",
            "COMP_WORDS": " ".join(["subsoil", *words]), "COMP_CWORD": str(len(words)),
        },
    )  # fmt: skip
    assert answers.stderr == ""
    return answers.stdout.split()


def test_the_version_is_that_of_the_installed_package(cli: Cli) -> None:
    assert subsoil.__version__ == version("subsoil")
    assert cli("--version").out == f"subsoil {subsoil.__version__}\n"
    assert cli("--version").code == 0


def test_the_version_costs_nothing_until_it_is_asked_for() -> None:
    code = "import sys, subsoil; print('importlib.metadata' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    started = subprocess.run(
        [sys.executable, "-c", "import sys; print('importlib.metadata' in sys.modules)"],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert done.stdout == started.stdout


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_the_completion_of_a_shell_is_shown_and_installed(tmp_path: Path, shell: str) -> None:
    own = {
        **os.environ, "HOME": str(tmp_path), "_TYPER_COMPLETE_TEST_DISABLE_SHELL_DETECTION": "1",
    }  # fmt: skip
    for option in ("--show-completion", "--install-completion"):
        done = subprocess.run(
            [sys.executable, "-m", "subsoil", option, shell],
            capture_output=True, text=True, check=False, env=own,
        )  # fmt: skip
        assert done.returncode == 0, done.stderr
        assert shell in done.stdout or "_subsoil_completion" in done.stdout
    assert any("subsoil" in path.name for path in tmp_path.rglob("*"))


def test_verbs_and_options_complete() -> None:
    assert completed("re") == ["resume", "replay"]
    assert "--strategy-setting" in completed("run", "--strat")


def test_names_of_strategies_and_estimators_complete() -> None:
    assert completed("run", "--strategy", "") == list(STRATEGIES)
    assert completed("plan", "--strategy", "joint") == ["joint", "joint-adaptive"]
    assert completed("demo", "--estimator", "") == list(ESTIMATORS)
    assert completed("map", "--estimator", "p") == ["paper-10", "pmc"]
    assert completed("bench", "run", "--strategies", "random,gr") == ["random,greedy"]
    assert completed("bench", "run", "--estimator", "pmc,re") == ["pmc,reml"]
