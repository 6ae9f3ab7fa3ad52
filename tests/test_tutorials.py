"""Tutorials work when somebody types what they say, and show what one then sees."""

from __future__ import annotations

import contextlib
import doctest
import io
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import zip_longest
from pathlib import Path
from typing import Any

import pytest

TUTORIALS = Path(__file__).parents[1] / "docs" / "tutorials"
PAGES = sorted(page for page in TUTORIALS.glob("*.md") if page.stem != "index")
every_page = pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)

_FENCE = re.compile(r"^```(python|sh|text)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
_NAMED = re.compile(r"# (\w+\.py)\n")
_LIKE = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
_SHELL = """
subsoil() { "$PYTHON" -m subsoil "$@"; }
python() { "$PYTHON" "$@"; }
set -e
"""


@dataclass(frozen=True)
class Step:
    """A block of a page, and what the page shows of its output; None if nothing."""

    kind: str
    code: str
    where: str
    shown: str | None


def steps(page: Path) -> Iterator[Step]:
    """Blocks of Python and shell in order."""
    text = page.read_text(encoding="utf-8")
    found = list(_FENCE.finditer(text))
    for block, after in zip_longest(found, found[1:]):
        if block[1] != "text":
            line = text.count("\n", 0, block.start()) + 1
            shown = after[2] if after and after[1] == "text" else None
            yield Step(block[1], block[2], f"{page.name}, line {line}", shown)


def follow(page: Path, folder: Path) -> None:
    """Do in a folder, which is the current one, what a page says, and compare what it shows.

    Python that begins with the name of a file is saved under it; all other is one session. Shell
    is a script that ends at the first command that fails.
    """
    session: dict[str, Any] = {"__name__": "__main__"}
    for step in steps(page):
        if name := (step.kind == "python" and _NAMED.match(step.code)):
            (folder / name[1]).write_text(step.code, encoding="utf-8")
            continue
        said = in_python(step, session) if step.kind == "python" else in_shell(step, folder)
        if step.shown is not None:
            same = doctest.OutputChecker().check_output(step.shown, said, _LIKE)
            assert same, f"{step.where} shows\n{step.shown}\nand it is\n{said}"


def in_python(step: Step, session: dict[str, Any]) -> str:
    with contextlib.redirect_stdout(io.StringIO()) as said:
        exec(compile(step.code, step.where, "exec"), session)
    return said.getvalue()


def in_shell(step: Step, folder: Path) -> str:
    done = subprocess.run(
        ["bash", "-c", _SHELL + step.code], cwd=folder, stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT, text=True, check=False,
        env=os.environ | {"PYTHON": sys.executable},
    )  # fmt: skip
    assert done.returncode == 0, f"{step.where}: {done.stdout}"
    return done.stdout


@pytest.mark.slow
@every_page
def test_a_tutorial_that_is_followed_leads_to_what_it_shows(
    page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copytree(TUTORIALS / "data", tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    follow(page, tmp_path)
    for saved in tmp_path.glob("*.py"):
        sys.modules.pop(saved.stem, None)


@every_page
def test_a_tutorial_shows_what_its_commands_say(page: Path) -> None:
    assert any(step.shown for step in steps(page))


def test_a_page_that_shows_something_else_is_noticed(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text("```python\nprint(1 + 1)\n```\n\n```text\n3\n```\n")
    with pytest.raises(AssertionError, match="line 1 shows"):
        follow(page, tmp_path)
