"""Imports point down, room by room, and edges' libraries stay at the edges."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

import subsoil

PACKAGE = Path(subsoil.__file__).parent

FLOORS: dict[str, tuple[str, ...]] = {
    "1 values": (
        "errors", "arrays", "findings", "optional", "notebook", "registry", "reports", "outcomes",
        "agent", "penetrometer",
        "layers", "land", "readings",
    ),
    "2 maths": ("variogram", "kriging", "mapping"),
    "3 decisions": ("ways", "stopping", "strategies"),
    "4 world": ("simulation",),
    "5 loop": ("survey", "journal"),
    "6 edges": ("io", "datasets", "worlds", "units", "plots", "report", "bench", "cli", "__main__"),
}  # fmt: skip
"""Rooms from the bottom up: each may import those named before it."""
ROOMS = tuple(room for rooms in FLOORS.values() for room in rooms)
EDGE_LIBRARIES = {
    "typer", "click", "rich", "rasterio", "xarray", "matplotlib", "jinja2", "pooch", "yaml",
    "pyogrio", "dask", "distributed",
}  # fmt: skip


def room(path: Path) -> str:
    return path.relative_to(PACKAGE).parts[0].removesuffix(".py")


def imported(path: Path, *, for_types: bool = True) -> set[str]:
    """Names that a module imports, at any time, or also where only types are checked."""
    names: set[str] = set()
    tree = ast.parse(path.read_text())
    if not for_types:
        tree.body = [node for node in tree.body if not isinstance(node, ast.If)]
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            assert node.level == 0, f"{path}: relative import"
            names |= {f"{node.module}.{alias.name}" for alias in node.names}
    return names


MODULES = sorted(p for p in PACKAGE.rglob("*.py") if p != PACKAGE / "__init__.py")


@pytest.mark.parametrize("path", MODULES, ids=lambda p: str(p.relative_to(PACKAGE)))
def test_a_room_imports_only_rooms_below_it(path: Path) -> None:
    here = ROOMS.index(room(path))
    for name in imported(path):
        parts = name.split(".")
        if parts[0] == "subsoil" and len(parts) > 1:
            assert ROOMS.index(parts[1]) <= here, f"{path.name} imports {name}"


@pytest.mark.parametrize("path", MODULES, ids=lambda p: str(p.relative_to(PACKAGE)))
def test_libraries_of_the_edges_stay_there(path: Path) -> None:
    if room(path) not in FLOORS["6 edges"]:
        libraries = {name.split(".")[0] for name in imported(path, for_types=False)}
        assert not libraries & EDGE_LIBRARIES


@pytest.mark.parametrize("path", MODULES, ids=lambda p: str(p.relative_to(PACKAGE)))
def test_strategies_never_see_the_truth(path: Path) -> None:
    if room(path) in {"strategies", "ways", "stopping"}:
        assert not any("simulation" in name for name in imported(path))


def test_every_room_has_its_place_and_the_guide_for_contributors_names_it() -> None:
    assert {room(path) for path in MODULES} == set(ROOMS)
    guide = (PACKAGE.parents[1] / "CONTRIBUTING.md").read_text()
    floors = re.findall(r"^\| (\d [a-z]+) \| (.*?) \|", guide, re.MULTILINE)
    named = {floor: tuple(re.findall(r"`([a-z_]+)/?`", rooms)) for floor, rooms in floors}
    assert named == {
        floor: tuple(each for each in rooms if each != "__main__")
        for floor, rooms in FLOORS.items()
    }
