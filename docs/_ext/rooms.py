"""Reference of the Python names, one page a room, made from what each room makes public."""

from __future__ import annotations

import inspect
import pkgutil
import re
import sys
from collections.abc import Iterator
from functools import cache
from importlib import import_module
from pathlib import Path
from pydoc import locate
from types import GenericAlias, ModuleType
from typing import TYPE_CHECKING, Any

from docutils.utils import get_source_line
from sphinx.pycode import ModuleAnalyzer
from sphinx.util.nodes import make_refnode

import subsoil

if TYPE_CHECKING:
    from docutils.nodes import Element
    from sphinx.addnodes import pending_xref
    from sphinx.application import Sphinx
    from sphinx.config import Config

FOLDER = "reference/rooms"
ROOMS = (
    "errors", "layers", "penetrometer", "readings", "land", "agent", "outcomes", "reports",
    "variogram", "kriging", "mapping",
    "ways", "stopping", "strategies",
    "simulation",
    "survey", "journal",
    "datasets", "worlds", "plots", "report", "bench",
)  # fmt: skip
"""Rooms that somebody's own program may use, from the bottom up."""
_ARRAY = r"~?numpy\.ndarray\[tuple\[~?typing\.Any, \.\.\.\], ~?numpy\.dtype\[[^\]]*\]\]"


def public(module: ModuleType) -> dict[str, Any]:
    """What a module makes public, by full name: its ``__all__``, or else what it documents."""
    names = getattr(module, "__all__", None)
    if names is not None:
        return {f"{module.__name__}.{name}": getattr(module, name) for name in names}
    documented = {name for _, name in ModuleAnalyzer.for_module(module.__name__).find_attr_docs()}
    found = {
        f"{module.__name__}.{name}": value
        for name, value in vars(module).items()
        if not (name.startswith("_") or isinstance(value, GenericAlias))
        and (name in documented or (_named(value) and value.__module__ == module.__name__))
    }
    for below in pkgutil.iter_modules(getattr(module, "__path__", ())):
        found |= public(import_module(f"{module.__name__}.{below.name}"))
    return found


def _named(value: Any) -> bool:
    return inspect.isclass(value) or inspect.isroutine(value)


@cache
def homes() -> dict[str, dict[str, str]]:
    """By room, what it offers and the name that each has a page by: the first that there is.

    A constant has it where it is documented, which the face is not.
    """
    offered = {"subsoil": public(subsoil)}
    offered |= {room: public(import_module(f"subsoil.{room}")) for room in ROOMS}
    pages: dict[object, str] = {}
    for names in (
        {name: value for name, value in offered["subsoil"].items() if _named(value)},
        *(offered[room] for room in ROOMS),
    ):
        for name, value in names.items():
            pages.setdefault(_key(name, value), name)
    return {
        room: {name: pages[_key(name, value)] for name, value in names.items()}
        for room, names in offered.items()
    }


def _key(name: str, value: Any) -> object:
    """Say what is the same thing under two names: the same class, function or constant."""
    if _named(value):
        return value.__module__, value.__qualname__
    return name.rpartition(".")[2], id(value)


def page(room: str, offered: dict[str, str]) -> str:
    """Page of a room in reStructuredText."""
    module = _module(room)
    own = [name.removeprefix(f"{module}.") for name, home in offered.items() if name == home]
    others = [
        f"~{home.removeprefix(f'{module}.')}" for name, home in offered.items() if name != home
    ]
    parts = [f"{module}\n{'=' * len(module)}", f".. automodule:: {module}"]
    if own:
        parts += ["Names\n-----", _table(own, "../api")]
    if others:
        parts += ["Also here\n---------", _table(others)]
    return "\n\n".join(parts) + "\n"


def index() -> str:
    """Page that leads to all rooms."""
    listed = "\n   ".join(("subsoil", *ROOMS))
    return "\n\n".join(
        (
            "Python\n======",
            "What most programs need is in ``subsoil`` itself; the rooms below it hold the rest.",
            _table([_module(room) for room in ("subsoil", *ROOMS)]),
            f".. toctree::\n   :hidden:\n\n   {listed}\n",
        )
    )


def _module(room: str) -> str:
    return room if room == "subsoil" else f"subsoil.{room}"


def _table(names: list[str], folder: str = "") -> str:
    option = f"\n   :toctree: {folder}" if folder else ""
    return f".. autosummary::{option}\n   :nosignatures:\n\n   " + "\n   ".join(names)


def file_names(offered: dict[str, dict[str, str]]) -> dict[str, str]:
    """Files of names that differ from others by capitals alone, which some disks hold for one."""
    names = sorted({home for room in offered.values() for home in room.values()})
    taken: set[str] = set()
    found: dict[str, str] = {}
    for name in reversed(names):
        if name.lower() in taken:
            found[name] = f"{name}-class"
        taken.add(name.lower())
    return found


def resolved(app: Sphinx, _: Any, node: pending_xref, text: Element) -> Element | None:
    """Link a name to the page of what it names; one without a page here stays text.

    A name of nothing is left to Sphinx, which warns of it.
    """
    if node["refdomain"] != "py":
        return None
    target = node["reftarget"].partition("[")[0]
    for name in (f"{around}.{target}".strip(".") for around in ("", *_around(node))):
        thing = locate(name) or sys.modules.get(name)
        if thing is not None:
            home = _by_key().get(_key(name, thing))
            return _link(app, node, text, home) if home else text
        owner, field = name.rpartition(".")[::2]
        if field in getattr(locate(owner), "__annotations__", ()):
            return text
    return None


def _around(node: pending_xref) -> Iterator[str]:
    """Modules and classes, the inmost first, that what names something is written in."""
    source = re.search("docstring of (.*)", get_source_line(node)[0] or "")
    inmost = source[1] if source else node.get("py:module") or ""
    parts = inmost.split(".")
    return (".".join(parts[:k]) for k in range(len(parts), 0, -1))


def explained(_: Sphinx, what: str, name: str, *rest: Any) -> None:
    """Say of a constant of a room what is said where it is defined."""
    lines: list[str] = rest[-1]
    module, constant = name.rpartition(".")[::2]
    if what == "data" and not any(lines):
        lines[:] = _constants(module).get(constant, [])


@cache
def _constants(package: str) -> dict[str, list[str]]:
    paths = getattr(import_module(package), "__path__", ())
    within = [each.name for each in pkgutil.walk_packages(paths, f"{package}.")]
    documented = [ModuleAnalyzer.for_module(name).find_attr_docs() for name in within]
    return {name: lines for of_one in documented for (_, name), lines in of_one.items()}


def shortened(*said: Any) -> tuple[str, str] | None:
    """Write arrays in a signature without their generics, and defaults without a value as dots."""
    signature, returns = said[-2:]
    if signature is None:
        return None
    return _short(signature), _short(returns)


def _short(types: str | None) -> str:
    arrays = re.sub(_ARRAY, "~numpy.ndarray", types or "")
    return re.sub(r"<[^>]*>", "...", arrays)


@cache
def _by_key() -> dict[object, str]:
    return {_key(home, locate(home)): home for room in homes().values() for home in room.values()}


def _link(app: Sphinx, node: pending_xref, text: Element, home: str) -> Element:
    file = app.config.autosummary_filename_map.get(home, home)
    return make_refnode(app.builder, node["refdoc"], f"reference/api/{file}", home, text, home)


def write(app: Sphinx, config: Config) -> None:
    """Write the pages where Sphinx finds them."""
    folder, offered = Path(app.srcdir) / FOLDER, homes()
    config.autosummary_filename_map = file_names(offered)
    folder.mkdir(parents=True, exist_ok=True)
    for room, names in offered.items():
        (folder / f"{room}.rst").write_text(page(room, names))
    (folder / "index.rst").write_text(index())


def setup(app: Sphinx) -> dict[str, bool]:
    """Tell Sphinx."""
    app.connect("config-inited", write)
    app.connect("missing-reference", resolved)
    app.connect("autodoc-process-signature", shortened)
    app.connect("autodoc-process-docstring", explained)
    return {"parallel_read_safe": True}
