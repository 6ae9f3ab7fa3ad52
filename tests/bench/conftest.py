"""A small field, strategies that go wrong, and a way to run the command line."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest
import shapely

from subsoil.bench import Entrant, Setting, Task
from subsoil.cli import run

BAD = """
import os
import pathlib
import signal

from subsoil.strategies import Plan, area_split


def deadly(view):
    os.kill(os.getpid(), signal.SIGKILL)


def deadly_once(view):
    died = pathlib.Path(__file__).with_name("died")
    if not died.exists():
        died.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return area_split(view)


def broken(view):
    raise ValueError("broken on purpose")


def short(view):
    return Plan(tuple(c for c in (0, 1, 2) if c not in view.visited), "three stops only")
"""


@dataclass(frozen=True)
class Said:
    code: int
    out: str
    err: str


Bench = Callable[..., Said]


@pytest.fixture
def setting() -> Setting:
    """Soils of a field of 60 x 40 m, 96 cells."""
    return Setting("signal", 1, (5, 8), shapely.box(0, 0, 60, 40).wkt)


@pytest.fixture
def area_split(setting: Setting) -> Task:
    return Task(setting, 0, Entrant("area-split", "paper-10"))


@pytest.fixture
def bad_strategies(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Module ``bad_strategies`` that workers can import too."""
    (tmp_path / "bad_strategies.py").write_text(BAD)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "bad_strategies", raising=False)


@pytest.fixture
def bench(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Bench:
    """Run ``subsoil bench run`` on the small field, one worker."""
    outline = tmp_path / "plot.csv"
    outline.write_text("easting,northing\n0,0\n60,0\n60,40\n0,40\n")

    def call(
        out: Path,
        *more: object,
        strategies: str = "area-split,greedy",
        samples: str = "5,8",
        seed: int = 1,
        fields: int = 2,
    ) -> Said:
        code = run(
            [str(word) for word in (
                "bench", "run", "--out", out, "--boundary", outline, "--protocol", "signal",
                "--fields", fields, "--seed", seed, "--strategies", strategies,
                "--samples", samples, "--workers", 1, *more,
            )]
        )  # fmt: skip
        captured = capsys.readouterr()
        return Said(code, captured.out, captured.err)

    return call
