"""The README's own code works."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

README = Path(__file__).parents[1] / "README.md"


def test_the_strategy_of_the_readme_runs_a_survey(tmp_path: Path) -> None:
    code = re.search(r"```python\n(# mine\.py\n.*?)```", README.read_text(), re.DOTALL)
    assert code
    (tmp_path / "mine.py").write_text(code[1])
    (tmp_path / "plot.csv").write_text("easting,northing\n0,0\n60,0\n60,40\n0,40\n")
    call = [sys.executable, "-m", "subsoil"]
    for arguments in (
        ["init", "s.gpkg", "--boundary", "plot.csv"],
        ["run", "s.gpkg", "--strategy", "mine:least_sure_nearby", "--samples", "5"],
        ["verify", "s.gpkg"],
    ):
        subprocess.run([*call, *arguments], cwd=tmp_path, check=True, capture_output=True)


def test_every_verb_of_the_readme_exists() -> None:
    from subsoil.cli import app

    verbs = {command.name or command.callback.__name__ for command in app.registered_commands}  # type: ignore[union-attr]
    shell = "".join(re.findall(r"```sh\n(.*?)```", README.read_text(), re.DOTALL))
    named = set(re.findall(r"(?:^|; )subsoil +(\w+)", shell, re.MULTILINE))
    assert len(named) > 8
    assert named <= verbs
