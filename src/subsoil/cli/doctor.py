"""What this machine has and lacks."""

from __future__ import annotations

import os
import platform
import shutil
import sqlite3
import sys
from importlib.metadata import PackageNotFoundError, version

import typer

from subsoil.cli.output import AsJson, tell, tell_table

_NEEDED = ("numpy", "scipy", "shapely", "pyproj", "pydantic", "filelock", "typer")
_EXTRAS = {
    "rasterio": "geo",
    "xarray": "geo",
    "pyogrio": "geo",
    "matplotlib": "plot",
    "jinja2": "plot",
    "pooch": "data",
}
_GIB = 1024**3


def doctor(as_json: AsJson = False) -> None:
    """Say what this machine has and lacks; exit code 1 if something needed is missing."""
    needed = {name: _version(name) for name in _NEEDED}
    extras = {name: _version(name) for name in _EXTRAS}
    missing = [name for name, found in needed.items() if not found]
    machine = {
        "subsoil": _version("subsoil"),
        "python": sys.version.split()[0],
        "system": platform.platform(),
        "cores": os.cpu_count() or 1,
        "free_disk_gib": round(shutil.disk_usage(".").free / _GIB, 1),
        "sqlite": sqlite3.sqlite_version,
        "riseholme_data": os.environ.get("SUBSOIL_DATA", "fetched when first used"),
    }
    if as_json:
        tell({**machine, "needed": needed, "extras": extras, "missing": missing}, as_json)
    else:
        tell(machine, as_json)
        rows = [(name, found or "missing", "") for name, found in needed.items()]
        rows += [
            (name, found or "not installed", "" if found else f"pip install 'subsoil[{extra}]'")
            for (name, extra), found in zip(_EXTRAS.items(), extras.values(), strict=True)
        ]
        tell_table("Libraries", ("library", "version", "remedy"), rows)
    if missing:
        raise typer.Exit(1)


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return ""
