"""What this machine has and lacks."""

from __future__ import annotations

import os
import platform
import re
import shutil
import sqlite3
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, requires, version

import typer

from subsoil.cli.output import AsJson, tell, tell_table
from subsoil.io.read.readings import READERS
from subsoil.optional import install

_EXTRAS = ("geo", "plot", "data", "dask")
"""Extras that users take; the others are for developers."""
_GIB = 1024**3


@dataclass(frozen=True)
class _Library:
    """A library that subsoil takes, by the package's own metadata; needed if of no extra."""

    name: str
    extra: str

    @property
    def version(self) -> str:
        """Version installed; empty if it is missing."""
        try:
            return version(self.name)
        except PackageNotFoundError:
            return ""

    @property
    def found(self) -> str:
        """Version installed, or in words that there is none."""
        return self.version or ("not installed" if self.extra else "missing")

    @property
    def remedy(self) -> str:
        """What installs it."""
        return install(self.extra) if self.extra else f"pip install {self.name}"


def doctor(as_json: AsJson = False) -> None:
    """Say what this machine has and lacks; exit code 1 if something needed is missing."""
    libraries = list(_libraries())
    missing = [each.name for each in libraries if not (each.version or each.extra)]
    machine = {
        "subsoil": version("subsoil"),
        "python": sys.version.split()[0],
        "system": platform.platform(),
        "cores": os.cpu_count() or 1,
        "free_disk_gib": round(shutil.disk_usage(".").free / _GIB, 1),
        "sqlite": sqlite3.sqlite_version,
        "riseholme_data": os.environ.get("SUBSOIL_DATA", "fetched when first used"),
    }
    if as_json:
        found = {
            "needed": {each.name: each.version for each in libraries if not each.extra},
            "extras": {each.name: each.version for each in libraries if each.extra},
            "missing": missing,
            "remedies": {each.name: each.remedy for each in libraries if not each.version},
            "readers": {name: reader.name for name, reader in READERS.items()},
        }
        tell({**machine, **found}, as_json)
    else:
        tell(machine, as_json)
        columns = ("library", "version", "remedy")
        rows = [(each.name, each.found, "" if each.version else each.remedy) for each in libraries]
        shown = 2 if all(each.version for each in libraries) else 3
        tell_table("Libraries", columns[:shown], [row[:shown] for row in rows])
        files = [(name, reader.name) for name, reader in READERS.items()]
        tell_table("Readings are read from", ("reader", "files of"), files)
    if missing:
        raise typer.Exit(1)


def _libraries() -> Iterator[_Library]:
    for line in requires("subsoil") or ():
        name = re.match(r"[\w.-]+", line)
        extra = re.search(r"extra == ['\"](\w+)['\"]", line)
        assert name
        if extra is None or extra[1] in _EXTRAS:
            yield _Library(name[0], extra[1] if extra else "")
