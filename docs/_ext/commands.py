"""Reference of the command line, one page a verb, made from the command line itself."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from subsoil.cli import app as subsoil
from subsoil.cli.examples import EXAMPLES

if TYPE_CHECKING:
    from sphinx.application import Sphinx
    from sphinx.config import Config

FOLDER = "reference/commands"


def verbs(command: Any = None, name: str = "") -> dict[str, Any]:
    """All verbs by name, in the order of the help; those under another verb by both words."""
    command = command or typer.main.get_command(subsoil)
    if not hasattr(command, "commands"):
        return {name: command}
    found: dict[str, Any] = {}
    for word, below in command.commands.items():
        found |= verbs(below, f"{name} {word}".strip())
    return found


def page(name: str, verb: Any) -> str:
    """Page of a verb in reStructuredText: what its help says."""
    title = f"subsoil {name}"
    context = typer.Context(verb, info_name=title)
    usage = " ".join(verb.collect_usage_pieces(context))
    parts = [
        f"{title}\n{'=' * len(title)}",
        verb.help,
        _code([f"subsoil {name} {usage}"]),
        "Examples\n--------" if len(EXAMPLES[name]) > 1 else "Example\n-------",
        _code(EXAMPLES[name]),
        f".. program:: {title}",
        *_groups(verb.get_params(context), context),
    ]
    return "\n\n".join(parts) + "\n"


def _groups(params: list[Any], context: Any) -> Iterator[str]:
    groups: dict[str, list[Any]] = {}
    for param in params:
        groups.setdefault(param.rich_help_panel or "Arguments", []).append(param)
    for group, of_it in groups.items():
        yield f"{group}\n{'-' * len(group)}"
        for param in of_it:
            record = param.get_help_record(context)
            if record:
                yield _option(*record)


def _option(written: str, said: str) -> str:
    """Return an option as it is written, and what is said of it."""
    said, _, facts = said.partition("  [")
    shown = f"\n\n   *{_plain(facts.rstrip(']'))}*" if facts else ""
    return f".. option:: {written}\n\n   {_plain(said)}{shown}"


def _plain(text: str) -> str:
    from sphinx.util.rst import escape

    return str(escape(" ".join(text.split())))


def _code(lines: tuple[str, ...] | list[str]) -> str:
    return ".. code-block:: sh\n\n   " + "\n   ".join(lines)


def index() -> str:
    """Page that leads to all verbs, in the order of the help."""
    found = verbs()
    said = [f":doc:`subsoil {name} <{_file(name)}>`\n   {_first(found[name])}" for name in found]
    files = "\n   ".join(_file(name) for name in found)
    return "\n\n".join(
        (
            "Command line\n============",
            "Every verb takes ``--help``, which says what is said here.",
            *said,
            f".. toctree::\n   :hidden:\n\n   {files}\n",
        )
    )


def _first(verb: Any) -> str:
    """Return the first paragraph of a verb's help."""
    return _plain(verb.help.split("\n\n")[0])


def _file(name: str) -> str:
    return name.replace(" ", "-")


def write(app: Sphinx, _: Config) -> None:
    """Write the pages where Sphinx finds them."""
    folder = Path(app.srcdir) / FOLDER
    folder.mkdir(parents=True, exist_ok=True)
    for name, verb in verbs().items():
        (folder / f"{_file(name)}.rst").write_text(page(name, verb))
    (folder / "index.rst").write_text(index())


def setup(app: Sphinx) -> dict[str, bool]:
    """Tell Sphinx."""
    app.connect("config-inited", write)
    return {"parallel_read_safe": True}
