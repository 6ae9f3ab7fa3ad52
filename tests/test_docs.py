"""The code in the documentation works."""

from __future__ import annotations

import csv
import re
import subprocess
import sys
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[1] / "docs"
PAGE = DOCS / "strategies.md"
ROBOTS = DOCS / "robots.md"
FILES = DOCS / "files.md"
NAME = "mine:variance_per_second"


def subsoil(folder: Path, *arguments: str) -> None:
    call = [sys.executable, "-m", "subsoil", *arguments]
    done = subprocess.run(call, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.slow
def test_the_strategy_of_the_page_surveys_and_is_benchmarked(tmp_path: Path) -> None:
    code = re.search(r"```python\n(# mine\.py\n.*?)```", PAGE.read_text(), re.DOTALL)
    assert code
    body = code[1].split('"""')[2]
    assert len(body.strip().splitlines()) <= 20
    (tmp_path / "mine.py").write_text(code[1])
    (tmp_path / "plot.csv").write_text("easting,northing\n0,0\n60,0\n60,40\n0,40\n")
    subsoil(tmp_path, "init", "s.gpkg", "--boundary", "plot.csv")
    subsoil(
        tmp_path, "run", "s.gpkg", "--strategy", NAME, "--strategy-setting", "candidates=20",
        "--samples", "8",
    )  # fmt: skip
    subsoil(tmp_path, "verify", "s.gpkg")
    subsoil(tmp_path, "bench", "check", NAME)
    subsoil(
        tmp_path, "bench", "run", "--protocol", "signal", "--fields", "1", "--seed", "1",
        "--strategies", f"random,{NAME}", "--estimator", "pmc", "--samples", "5",
        "--out", "compare",
    )  # fmt: skip
    subsoil(tmp_path, "bench", "report", "compare")
    with (tmp_path / "compare" / "results.csv").open() as file:
        assert {row["strategy"] for row in csv.DictReader(file)} == {"random", NAME}


def test_the_page_names_every_strategy() -> None:
    from subsoil.strategies import STRATEGIES

    assert set(STRATEGIES) <= set(re.findall(r"^\| `([\w-]+)` \|", PAGE.read_text(), re.MULTILINE))


def test_the_page_names_every_rule_of_the_check() -> None:
    from subsoil.bench.conformance import RULES

    cells = re.findall(r"(?<=\| )[^|]+(?= \|)", PAGE.read_text())
    for rules in RULES.values():
        assert {rule.words.removeprefix("it ") for rule in rules} <= set(cells)


def test_the_robot_of_the_page_surveys(tmp_path: Path) -> None:
    blocks = re.findall(r"```python\n# (\w+\.py)\n(.*?)```", ROBOTS.read_text(), re.DOTALL)
    for name, code in blocks:
        (tmp_path / name).write_text(code)
    done = subprocess.run(
        [sys.executable, "main.py"], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert "6 samples" in done.stdout


def test_the_reader_of_the_page_reads(tmp_path: Path) -> None:
    code = re.search(r"```python\n(# mine\.py\n.*?)```", FILES.read_text(), re.DOTALL)
    assert code
    body = code[1].split("def read")[1]
    assert len(body.strip().splitlines()) <= 20
    (tmp_path / "mine.py").write_text(code[1])
    (tmp_path / "walk.probe").write_text(
        "".join(
            f"{k};52.09{60 + k % 5};5.64{20 + 3 * k};0.{4 + k % 3};1.{k % 7};1.{k}\n"
            for k in range(1, 9)
        )
    )
    subsoil(tmp_path, "cv", "walk.probe", "--reader", "mine:read", "--layers", "0,0.05,0.1,0.15")
    subsoil(tmp_path, "cv", "walk.probe", "--reader", "mine:READER", "--layers", "0,0.05,0.1,0.15")


def test_the_page_names_every_reader() -> None:
    from subsoil.io.read.readings import READERS

    assert set(READERS) <= set(re.findall(r"^\| `([\w-]+)` \|", FILES.read_text(), re.MULTILINE))
