"""Foreign binary files for GDAL: checked to be what they say, in a folder without neighbours.

GDAL picks the driver by content and reads whatever lies beside a file or is named in it: other
files, archives, addresses on the network. So text never comes to it, a file has to begin as its
format does, and what GDAL opens is a copy with only the parts that belong to the format.
"""

from __future__ import annotations

import re
import shutil
import sqlite3
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from subsoil.errors import InputError, brief

_TIFF = (b"II*\x00", b"MM\x00*", b"II+\x00", b"MM\x00+")
_BEGINNINGS = {
    ".gpkg": (b"SQLite format 3\x00",),
    ".shp": (b"\x00\x00\x27\x0a",),
    ".tif": _TIFF,
    ".tiff": _TIFF,
}
_PARTS = {".shp": (".shx", ".dbf", ".cpg", ".prj")}
_UNWRITTEN = ("-wal", "-journal")
_HARMLESS_TABLE = re.compile(r"using\s+\"?(rtree|fts\d)\b", re.IGNORECASE)
_CALLS_OUT = re.compile(r"\b(ogr|gdal)_|load_extension", re.IGNORECASE)


@contextmanager
def alone(path: Path, wrong: type[InputError]) -> Iterator[Path]:
    """Copy of a GeoPackage, shapefile or GeoTIFF in a folder of its own.

    Parameters
    ----------
    path
        The file; its suffix says what it is.
    wrong
        Kind of error to raise.

    Yields
    ------
    Path
        The copy, which is gone afterwards.

    Raises
    ------
    InputError
        Of the kind ``wrong``, if the file does not begin as its format does, runs something when
        it is read, or is being written by another program.
    """
    suffix = path.suffix.lower()
    _check_beginning(path, suffix, wrong)
    with TemporaryDirectory(prefix="subsoil-") as folder:
        copy = Path(folder) / f"copy{suffix}"
        shutil.copyfile(path, copy)
        for part in path.parent.iterdir() if suffix in _PARTS else ():
            if part.stem == path.stem and part.suffix.lower() in _PARTS[suffix]:
                shutil.copyfile(part, copy.with_suffix(part.suffix.lower()))
        if suffix == ".gpkg":
            _check_database(copy, path.name, wrong)
        yield copy


def _check_beginning(path: Path, suffix: str, wrong: type[InputError]) -> None:
    with path.open("rb") as file:
        head = file.read(16)
    if not head.startswith(_BEGINNINGS[suffix]):
        raise wrong(
            f"it is no {suffix.removeprefix('.')} file by its content",
            where=path.name,
            remedy="export it again",
        )
    for ending in _UNWRITTEN if suffix == ".gpkg" else ():
        rest = path.with_name(path.name + ending)
        if rest.is_file() and rest.stat().st_size:
            raise wrong(
                f"another program has it open, or left {rest.name} behind",
                where=path.name,
                remedy="close it there, or export a copy",
            )


def _check_database(copy: Path, file: str, wrong: type[InputError]) -> None:
    """Refuse tables, views and triggers that reach beyond the file when they are read."""
    try:
        with closing(sqlite3.connect(f"{copy.as_uri()}?mode=ro", uri=True)) as database:
            items = database.execute("select name, coalesce(sql, '') from sqlite_master").fetchall()
    except (sqlite3.Error, UnicodeDecodeError) as error:
        raise wrong(
            f"it is damaged: {brief(str(error), 200)}", where=file, remedy="export it again"
        ) from error
    for name, sql in items:
        virtual = re.match(r"\s*create\s+virtual\s+table", sql, re.IGNORECASE)
        if _CALLS_OUT.search(sql) or (virtual and not _HARMLESS_TABLE.search(sql)):
            raise wrong(
                f"reading its table or view {brief(str(name))!r} would run something",
                where=file,
                remedy="export the layer alone",
            )
