"""Workbooks as sheets: ``.xlsx``, ``.ods`` and ``.xls`` through calamine, values only."""

from __future__ import annotations

import re
import zipfile
import zlib
from datetime import date, datetime, time
from pathlib import Path
from typing import Any

from subsoil.errors import ReadingsError, brief, listed
from subsoil.findings import Finding
from subsoil.io.read.tables.sheet import MOST_CELLS, Row, Sheet
from subsoil.io.read.text import check_file
from subsoil.optional import load

_SUFFIXES = (".xlsx", ".xlsm", ".ods", ".xls")
_MOST_BYTES = 300_000_000
"""Unpacked; a zip bomb has more."""
_DECLARES = re.compile(rb"<!(DOCTYPE|ENTITY)", re.IGNORECASE)
_NO_VALUE = re.compile(rb"(?:</f>|<f[^<>]*/>)\s*(?:<v\s*/>|<v>\s*</v>|</c>)")
_HEAD = 4096
_OLE = b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"
_DAMAGED = (
    zipfile.BadZipFile, zlib.error, OSError, NotImplementedError, RuntimeError, EOFError,
    ValueError,
)  # fmt: skip


def looks_like_workbook(head: bytes, name: str) -> bool:
    """Whether a file is one, by its first bytes and its name."""
    return name.lower().endswith(_SUFFIXES) or (
        head.startswith(b"PK\x03\x04") and b"[Content_Types].xml" in head
    )


def read_workbook(path: Path) -> tuple[Sheet, ...]:
    """Read the visible sheets of a workbook; formulas give what was last computed.

    Raises
    ------
    ReadingsError
        If it is damaged, locked, too large when unpacked, declares entities, or has formulas that
        nobody computed yet.
    MissingExtraError
        If python-calamine is not installed.
    """
    check_file(path, ReadingsError)
    calamine: Any = load(
        "python_calamine", "geo", "reading workbooks", where=path.name, instead="save it as CSV"
    )
    _check_archive(path)
    try:
        book = calamine.CalamineWorkbook.from_path(str(path))
        names = {each.name: each.visible for each in book.sheets_metadata}
        shown = [name for name, how in names.items() if how == calamine.SheetVisibleEnum.Visible]
        rows = {name: _rows(book.get_sheet_by_name(name), path.name) for name in shown}
    except (KeyboardInterrupt, MemoryError, ReadingsError):
        raise
    except BaseException as error:  # a panic of the library is no Exception
        said = brief(" ".join(str(error).split()), 120)
        raise _refused(path, f"it cannot be read: {said}") from error
    hidden = [name for name in names if name not in shown]
    notes = [Finding(f"hidden sheets left alone: {listed(hidden)}", file=path.name)]
    return tuple(
        Sheet(
            path.name,
            found,
            by_program=True,
            findings=tuple(notes) if hidden else (),
            name=name if len(names) > 1 else "",
        )
        for name, found in rows.items()
    )


def _check_archive(path: Path) -> None:
    """Refuse what unpacks without end, and formulas without a value; ``.xls`` is no archive."""
    with path.open("rb") as file:
        if file.read(len(_OLE)) == _OLE:
            return
    try:
        with zipfile.ZipFile(path) as archive:
            parts = archive.infolist()
            if sum(part.file_size for part in parts) > _MOST_BYTES:
                raise _refused(path, "unpacked it is larger than any survey")
            for part in parts:
                if part.filename.lower().endswith((".xml", ".rels")):
                    _check_part(path, part.filename, archive.read(part))
    except _DAMAGED as error:
        raise _refused(path, "it is no workbook by its content, or is damaged") from error


def _check_part(path: Path, name: str, data: bytes) -> None:
    if _DECLARES.search(data[:_HEAD]):
        raise _refused(path, f"{brief(name)} declares entities")
    if name.startswith("xl/worksheets/") and b"<f" in data and _NO_VALUE.search(data):
        raise ReadingsError(
            f"formulas in {brief(name.rpartition('/')[2])} have no values yet",
            where=path.name,
            remedy="open it in a spreadsheet program and save it there",
        )


def _refused(path: Path, what: str) -> ReadingsError:
    return ReadingsError(what, where=path.name, remedy="save it again as .xlsx, or as CSV")


def _rows(sheet: Any, file: str) -> list[Row]:
    if sheet.total_height * sheet.total_width > MOST_CELLS:
        raise ReadingsError(
            f"its {sheet.total_height} rows have more than {MOST_CELLS // 1_000_000} million cells",
            where=file,
            remedy="split it by field or by day",
        )
    return [
        (row, [_text(value) for value in values])
        for row, values in enumerate(sheet.to_python(skip_empty_area=False), 1)
        if any(value != "" for value in values)
    ]


def _text(value: Any) -> str:
    """Cell as text: numbers as Python writes them, times as ISO 8601 does."""
    if isinstance(value, float):
        return str(int(value)) if value.is_integer() and abs(value) < 1e15 else repr(value)
    if isinstance(value, datetime | date | time):
        return value.isoformat()
    return str(value)
