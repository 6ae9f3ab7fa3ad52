"""Imports point down the floors, and edges' libraries stay at the edges."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

import subsoil

PACKAGE = Path(subsoil.__file__).parent

FLOORS: dict[str, int] = {
    "errors": 1, "registry": 1, "reports": 1, "agent": 1, "frames": 1, "outline": 1, "field": 1,
    "penetrometer": 1, "layers": 1,
    "variogram": 2, "kriging": 2, "soilmap": 2, "scores": 2, "uncertainty": 2,
    "ways": 3, "stopping": 3, "strategies": 3,
    "simulation": 4,
    "survey": 5,
    "journal": 5,
    "io": 6, "datasets": 6, "plots": 6, "report": 6, "bench": 6, "cli": 6, "__main__": 6,
}  # fmt: skip
EDGE_LIBRARIES = {
    "typer", "click", "rich", "rasterio", "xarray", "matplotlib", "jinja2", "pooch", "yaml",
    "pyogrio", "dask", "distributed",
}  # fmt: skip


def room(path: Path) -> str:
    return path.relative_to(PACKAGE).parts[0].removesuffix(".py")


def imported(path: Path) -> set[str]:
    names: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            assert node.level == 0, f"{path}: relative import"
            names |= {f"{node.module}.{alias.name}" for alias in node.names}
    return names


MODULES = sorted(p for p in PACKAGE.rglob("*.py") if p != PACKAGE / "__init__.py")


@pytest.mark.parametrize("path", MODULES, ids=lambda p: str(p.relative_to(PACKAGE)))
def test_a_module_imports_only_its_own_floor_and_those_below(path: Path) -> None:
    floor = FLOORS[room(path)]
    for name in imported(path):
        parts = name.split(".")
        if parts[0] == "subsoil" and len(parts) > 1:
            assert FLOORS[parts[1]] <= floor, f"{path.name} imports {name}"
        if floor < 6:
            assert parts[0] not in EDGE_LIBRARIES, f"{path.name} imports {name}"


@pytest.mark.parametrize("path", MODULES, ids=lambda p: str(p.relative_to(PACKAGE)))
def test_strategies_never_see_the_truth(path: Path) -> None:
    if room(path) in {"strategies", "ways", "stopping"}:
        assert not any("simulation" in name for name in imported(path))


def test_every_room_has_a_floor() -> None:
    assert {room(path) for path in MODULES} <= FLOORS.keys()
