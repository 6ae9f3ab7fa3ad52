"""Reference of the Python names, one page a room, made from what each room makes public."""

from __future__ import annotations

import inspect
import pkgutil
from functools import cache
from importlib import import_module
from pathlib import Path
from types import GenericAlias, ModuleType
from typing import TYPE_CHECKING, Any

from sphinx.pycode import ModuleAnalyzer

import subsoil

if TYPE_CHECKING:
    from sphinx.application import Sphinx
    from sphinx.config import Config

FOLDER = "reference/rooms"
ROOMS = (
    "errors", "findings", "layers", "penetrometer", "readings", "land",
    "agent", "outcomes", "reports",
    "variogram", "kriging", "mapping",
    "ways", "stopping", "strategies",
    "simulation",
    "survey", "journal",
    "datasets", "worlds", "plots", "report", "bench",
)  # fmt: skip
"""Rooms that somebody's own program may use, from the bottom up."""


def public(module: ModuleType) -> dict[str, Any]:
    """What a module makes public, by full name: its ``__all__``, or else what it documents."""
    names = getattr(module, "__all__", None)
    if names is not None:
        values = {f"{module.__name__}.{name}": getattr(module, name) for name in names}
        return {name: value for name, value in values.items() if not inspect.ismodule(value)}
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
            pages.setdefault(key(name, value), name)
    return {
        room: {name: pages[key(name, value)] for name, value in names.items()}
        for room, names in offered.items()
    }


def key(name: str, value: Any) -> object:
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


def explain() -> None:
    """Let Sphinx know what is said of the constants of a room where they are defined."""
    for room in ROOMS:
        module = import_module(_module(room))
        paths = getattr(module, "__path__", ())
        within = [each.name for each in pkgutil.walk_packages(paths, f"{module.__name__}.")]
        here = ModuleAnalyzer.for_module(module.__name__).find_attr_docs()
        for name in within:
            there = ModuleAnalyzer.for_module(name).find_attr_docs()
            here |= {key: said for key, said in there.items() if key[1] in vars(module)}


def write(app: Sphinx, config: Config) -> None:
    """Write the pages where Sphinx finds them."""
    explain()
    folder, offered = Path(app.srcdir) / FOLDER, homes()
    config.autosummary_filename_map = file_names(offered)
    folder.mkdir(parents=True, exist_ok=True)
    for room, names in offered.items():
        (folder / f"{room}.rst").write_text(page(room, names))
    (folder / "index.rst").write_text(index())


def setup(app: Sphinx) -> dict[str, bool]:
    """Tell Sphinx."""
    app.connect("config-inited", write)
    return {"parallel_read_safe": True}
