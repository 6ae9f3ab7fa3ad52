"""Waiting: long work shows itself at once on a terminal, and Ctrl-C says only what is true."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

Cli = Callable[..., Any]
NEVER = "import time\n\ndef ending(view):\n    print('asked', flush=True)\n    time.sleep(600)\n"


@pytest.fixture
def survey(cli: Cli, outline: Path, tmp_path: Path) -> Path:
    path = tmp_path / "survey.gpkg"
    assert cli("init", path, "--boundary", outline).code == 0
    (tmp_path / "never.py").write_text(NEVER)
    return path


def planning(folder: Path, verb: str, **more: str) -> subprocess.Popen[str]:
    """A survey whose strategy, once asked, does not answer."""
    return subprocess.Popen(
        [sys.executable, "-m", "subsoil", verb, "survey.gpkg", "--strategy", "never:ending"],
        cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        env={**os.environ, **more},
    )  # fmt: skip


@pytest.mark.parametrize(
    ("verb", "said"),
    [
        ("plan", "error: stopped\n"),
        ("run", "error: stopped; nothing recorded is lost, go on with `subsoil resume`\n"),
    ],
)
def test_ctrl_c_speaks_of_going_on_only_where_there_is_something_to_go_on_with(
    survey: Path, verb: str, said: str
) -> None:
    process = planning(survey.parent, verb)
    assert process.stdout
    assert process.stdout.readline() == "asked\n"
    process.send_signal(signal.SIGINT)
    _, error = process.communicate()
    assert process.returncode == 3
    assert error == said


@pytest.mark.parametrize("verb", ["plan", "run"])
def test_a_terminal_shows_planning_while_the_strategy_still_thinks(survey: Path, verb: str) -> None:
    process = planning(survey.parent, verb, FORCE_COLOR="1", COLUMNS="80")
    assert process.stderr
    shown = ""
    while "planning" not in shown:
        letter = process.stderr.read(1)
        assert letter, shown
        shown += letter
    process.kill()
    process.communicate()


def test_planning_gives_way_to_surveying(
    cli: Cli, survey: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("FORCE_COLOR", "1")
    shown = cli("run", survey, "--samples", 3).err
    assert shown.index("planning") < shown.index("surveying")
    assert "planning" not in shown.rpartition("\n")[0].rpartition("\r")[2]


def test_nothing_is_said_of_waiting_where_nobody_looks(cli: Cli, survey: Path) -> None:
    assert cli("plan", survey, "--samples", 3).err == ""
    assert cli("run", survey, "--samples", 3).err == ""


@pytest.mark.parametrize("words", [(), ("bench",)])
def test_no_verb_is_answered_with_help_alone(cli: Cli, words: tuple[str, ...]) -> None:
    outcome = cli(*words)
    assert outcome.code == 2
    assert "Usage: subsoil" in outcome.out
    assert outcome.err == ""
