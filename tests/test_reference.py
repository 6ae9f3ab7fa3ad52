"""The reference has a page for every verb and name; the site is built without a warning."""

from __future__ import annotations

import re
import runpy
import shutil
import subprocess
import sys
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


@pytest.fixture(scope="module")
def homes() -> dict[str, dict[str, str]]:
    pytest.importorskip("sphinx")
    rooms = runpy.run_path(str(ROOT / "docs" / "_ext" / "rooms.py"))
    found: dict[str, dict[str, str]] = rooms["homes"]()
    return found


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The site, built from a copy of its sources, without a warning."""
    pytest.importorskip("sphinx")
    folder = tmp_path_factory.mktemp("site")
    made = shutil.ignore_patterns("_build", "examples", "api", "commands", "rooms")
    shutil.copytree(ROOT / "docs", folder / "docs", ignore=made)
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
    text = COMMANDS["page"]("map", VERBS["map"])
    assert re.search(r"option:: --cell M\n\n   .*\n\n   \*default\\: 5\.0\*", text)
    assert re.search(r"option:: --boundary FILE\n\n   .*\n\n   \*required\*", text)
    assert "option:: --drift <auto|always|never>" in text


def test_every_verb_of_the_command_line_is_in_the_reference() -> None:
    top = typer.main.get_command(app).commands  # type: ignore[attr-defined]
    assert {name.split()[0] for name in VERBS} == set(top)


def test_every_name_of_the_face_and_of_every_room_has_one_page(
    homes: dict[str, dict[str, str]],
) -> None:
    assert set(homes["subsoil"]) == {f"subsoil.{name}" for name in subsoil.__all__}
    assert all(homes.values())
    pages = {home for offered in homes.values() for home in offered.values()}
    own = {name for offered in homes.values() for name, home in offered.items() if name == home}
    assert pages == own


@pytest.mark.slow
def test_the_site_has_a_page_for_each_name_and_verb(
    site: Path, homes: dict[str, dict[str, str]]
) -> None:
    words = (site / "genindex.html").read_text()
    for home in {home for offered in homes.values() for home in offered.values()}:
        assert f"#{home}" in words, home
    for name in VERBS:
        assert (site / "reference" / "commands" / f"{name.replace(' ', '-')}.html").exists()


@pytest.mark.slow
def test_no_page_asks_another_machine_for_anything(site: Path) -> None:
    asks = re.compile(
        r"""<(?:script|img|iframe|source)[^>]*src="(?:https?:)?//|<link[^>]*href="(?:https?:)?//"""
    )
    for page in site.rglob("*.html"):
        assert not asks.search(page.read_text()), page
    for sheet in site.rglob("*.css"):
        asked = re.findall(r"""(?:url\(|@import )['"]?((?:https?:)?//[^'")]*)""", sheet.read_text())
        assert not asked, sheet


@pytest.mark.slow
def test_a_figure_of_an_example_is_shown_where_it_is_made(site: Path) -> None:
    page = (site / "examples" / "plot_first_map.html").read_text()
    shown = re.findall(
        r'class="sphx-glr-single-img"[^>]*|<img [^>]*plot_first_map_00\d[^>]*>', page
    )
    assert len({re.search(r"map_00\d", tag)[0] for tag in shown if "map_00" in tag}) == 3  # type: ignore[index]
