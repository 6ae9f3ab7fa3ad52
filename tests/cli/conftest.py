"""Files and a way to run the command line in this process."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from subsoil.cli import run


@dataclass(frozen=True)
class Outcome:
    """What a call of the command line gave."""

    code: int
    out: str
    err: str

    @property
    def json(self) -> Any:
        return json.loads(self.out)


Cli = Callable[..., Outcome]


@pytest.fixture
def cli(capsys: pytest.CaptureFixture[str]) -> Cli:
    """Run the command line; arguments may be paths and numbers."""

    def call(*arguments: object) -> Outcome:
        code = run([str(argument) for argument in arguments])
        captured = capsys.readouterr()
        return Outcome(code, captured.out, captured.err)

    return call


@pytest.fixture
def outline(tmp_path: Path) -> Path:
    """A field of 60 x 40 m."""
    path = tmp_path / "plot.csv"
    path.write_text("easting,northing\n0,0\n60,0\n60,40\n0,40\n")
    return path


def write_readings(path: Path, rows: list[str]) -> Path:
    """CSV of readings at two depths in a 60 x 40 m field."""
    path.write_text("easting,northing,kpa_5cm,kpa_10cm\n" + "\n".join(rows) + "\n")
    return path


@pytest.fixture
def readings(tmp_path: Path) -> Path:
    """Twelve readings whose strength rises to the east."""
    rows = [
        f"{5 + 15 * i},{5 + 15 * j},{400 + 50 * i + 7 * j},{900 + 80 * i - 11 * j}"
        for i in range(4)
        for j in range(3)
    ]
    return write_readings(tmp_path / "readings.csv", rows)
