"""The README's own code works."""

from __future__ import annotations

import re
from pathlib import Path

README = Path(__file__).parents[1] / "README.md"


def test_every_verb_of_the_readme_exists() -> None:
    from subsoil.cli import app

    verbs = {command.name or command.callback.__name__ for command in app.registered_commands}  # type: ignore[union-attr]
    verbs |= {group.name for group in app.registered_groups if group.name}
    shell = "".join(re.findall(r"```sh\n(.*?)```", README.read_text(), re.DOTALL))
    named = set(re.findall(r"(?:^|; )subsoil +(\w+)", shell, re.MULTILINE))
    assert len(named) > 8
    assert named <= verbs
