"""The reference has a page for every verb and name; the site is built without a warning."""

from __future__ import annotations

import re
import runpy
import shutil
import subprocess
import sys
from inspect import ismodule
from pathlib import Path
from typing import Any

import pytest
import typer

import subsoil
from subsoil.cli import app
from subsoil.cli.examples import EXAMPLES

ROOT = Path(__file__).parents[1]
COMMANDS = runpy.run_path(str(ROOT / "docs" / "_ext" / "commands.py"))
VERBS: dict[str, Any] = COMMANDS["verbs"]()

ASKS = re.compile(
    r"""<(?:script|img|iframe|source)[^>]*\ssrc="(?:https?:)?//"""
    r"""|<link[^>]*\shref="(?:https?:)?//"""
    r"""|(?:url\(|@import )['"]?(?:https?:)?//"""
)
"""What makes a browser ask another machine: a script, picture or style sheet of its own."""


@pytest.fixture(scope="module")
def homes() -> dict[str, dict[str, str]]:
    pytest.importorskip("sphinx")
    rooms = runpy.run_path(str(ROOT / "docs" / "_ext" / "rooms.py"))
    found: dict[str, dict[str, str]] = rooms["homes"]()
    return found


def built(folder: Path) -> Path:
    """The site, built from a copy of its sources, without a warning."""
    made = shutil.ignore_patterns("_build", "examples", "api", "commands", "rooms")
    shutil.copytree(ROOT / "docs", folder / "docs", ignore=made)
    shutil.copy(ROOT / "README.md", folder)
    call = [sys.executable, "-m", "sphinx", "-b", "html", "-W", "--keep-going", "-q"]
    done = subprocess.run(
        [*call, str(folder / "docs"), str(folder / "html")],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return folder / "html"


def test_every_verb_that_has_an_example_has_a_page_in_the_order_of_the_help() -> None:
    assert list(VERBS) == list(EXAMPLES)
    assert re.findall(r":doc:`subsoil (.*?) <", COMMANDS["index"]()) == list(VERBS)


@pytest.mark.parametrize("name", VERBS)
def test_the_page_of_a_verb_has_its_options_in_groups_and_its_examples(name: str) -> None:
    text = COMMANDS["page"](name, VERBS[name])
    for param in VERBS[name].get_params(typer.Context(VERBS[name])):
        written = (
            param.opts[-1] if param.param_type_name == "option" else param.metavar or param.name
        )
        assert f".. option:: {written}" in text
        if param.param_type_name == "option":
            assert f"\n{param.rich_help_panel}\n---" in text
    for line in EXAMPLES[name]:
        assert f"\n   {line}\n" in text


def test_a_page_tells_defaults_and_what_is_required() -> None:
    text = COMMANDS["page"]("init", VERBS["init"])
    assert re.search(r"option:: --cell M\n\n   .*\n\n   \*default\\: 5\.0\*", text)
    assert re.search(r"option:: --boundary FILE\n\n   .*\n\n   \*required\*", text)
    assert "option:: --drift <auto|always|never>" in text


def test_every_verb_of_the_command_line_is_in_the_reference() -> None:
    top = typer.main.get_command(app).commands  # type: ignore[attr-defined]
    assert {name.split()[0] for name in VERBS} == set(top)


def test_every_name_of_the_face_and_of_every_room_has_one_page(
    homes: dict[str, dict[str, str]],
) -> None:
    face = {name for name in subsoil.__all__ if not ismodule(getattr(subsoil, name))}
    assert set(homes["subsoil"]) == {f"subsoil.{name}" for name in face}
    assert set(subsoil.__all__) - face <= homes.keys()
    assert all(homes.values())
    pages = {home for offered in homes.values() for home in offered.values()}
    own = {name for offered in homes.values() for name, home in offered.items() if name == home}
    assert pages == own


@pytest.mark.slow
def test_the_site_is_built_without_a_warning_and_whole_and_asks_nobody(
    tmp_path: Path, homes: dict[str, dict[str, str]]
) -> None:
    site = built(tmp_path)
    for name in {home for offered in homes.values() for home in offered.values()}:
        assert f"#{name}" in (site / "genindex.html").read_text(), name
    for name in VERBS:
        assert (site / "reference" / "commands" / f"{name.replace(' ', '-')}.html").exists()
    for example in (ROOT / "docs" / "gallery").glob("plot_*.py"):
        page = (site / "examples" / f"{example.stem}.html").read_text()
        assert re.search(rf"<img [^>]*sphx_glr_{example.stem}_001\.png", page), example
    for file in (*site.rglob("*.html"), *site.rglob("*.css")):
        assert not ASKS.search(file.read_text()), file
