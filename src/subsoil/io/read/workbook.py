"""Workbooks as sheets: ``.xlsx`` through openpyxl, values only."""

from __future__ import annotations

import re
import zipfile
from collections.abc import Iterator
from datetime import date, datetime, time
from pathlib import Path
from typing import Any

from subsoil.errors import ReadingsError, brief, listed
from subsoil.findings import Finding
from subsoil.io.read.sheet import MOST_CELLS, Row, Sheet
from subsoil.io.read.text import check_file
from subsoil.optional import load

_MOST_BYTES = 300_000_000
"""Unpacked; a zip bomb has more."""
_DECLARES = re.compile(rb"<!(DOCTYPE|ENTITY)", re.IGNORECASE)
_HEAD = 4096


def looks_like_workbook(head: bytes, name: str) -> bool:
    """Whether a file is one, by its first bytes and its name."""
    return name.lower().endswith((".xlsx", ".xlsm")) or (
        head.startswith(b"PK\x03\x04") and b"[Content_Types].xml" in head
    )


def read_workbook(path: Path) -> tuple[Sheet, ...]:
    """Read the visible sheets of a workbook; formulas give what was last computed.

    Raises
    ------
    ReadingsError
        If it is damaged, locked, too large when unpacked, or declares entities.
    MissingExtraError
        If openpyxl is not installed.
    """
    check_file(path, ReadingsError)
    openpyxl: Any = load(
        "openpyxl", "geo", "reading .xlsx files", where=path.name, instead="save it as CSV"
    )
    _check_archive(path)
    try:
        book = openpyxl.load_workbook(path, read_only=True, data_only=True, keep_links=False)
        visible = [sheet for sheet in book.worksheets if sheet.sheet_state == "visible"]
        hidden = [sheet.title for sheet in book.worksheets if sheet.sheet_state != "visible"]
        budget = MOST_CELLS
        sheets = []
        for sheet in visible:
            rows = list(_rows(sheet, path.name, budget))
            budget -= sum(len(cells) for _, cells in rows)
            name = sheet.title if len(book.worksheets) > 1 else ""
            sheets.append(Sheet(path.name, rows, by_program=True, name=name))
        book.close()
    except ReadingsError:
        raise
    except Exception as error:  # openpyxl raises whatever its parsers do
        raise ReadingsError(
            f"it cannot be read: {brief(' '.join(str(error).split()), 120)}",
            where=path.name,
            remedy="save it again as .xlsx, or as CSV",
        ) from error
    note = Finding(f"hidden sheets left alone: {listed(hidden)}", file=path.name)
    return tuple(
        Sheet(s.file, s.rows, by_program=True, findings=(note,) if hidden else (), name=s.name)
        for s in sheets
    )


def _check_archive(path: Path) -> None:
    try:
        with zipfile.ZipFile(path) as archive:
            parts = archive.infolist()
            if sum(part.file_size for part in parts) > _MOST_BYTES:
                raise _refused(path, "unpacked it is larger than any survey")
            if any(part.flag_bits & 1 for part in parts):
                raise _refused(path, "it is locked by a password")
            for part in parts:
                if part.filename.lower().endswith((".xml", ".rels")):
                    with archive.open(part) as file:
                        if _DECLARES.search(file.read(_HEAD)):
                            raise _refused(path, f"{brief(part.filename)} declares entities")
    except (
        zipfile.BadZipFile,
        OSError,
        NotImplementedError,
        RuntimeError,
        EOFError,
        ValueError,
    ) as error:
        raise _refused(path, "it is no workbook by its content, or is damaged") from error


def _refused(path: Path, what: str) -> ReadingsError:
    return ReadingsError(what, where=path.name, remedy="save it again as .xlsx, or as CSV")


def _rows(sheet: Any, file: str, budget: int) -> Iterator[Row]:
    count = 0
    for row, values in enumerate(sheet.iter_rows(values_only=True), 1):
        count += len(values)
        if count > budget:
            raise ReadingsError(
                f"it has more than {MOST_CELLS // 1_000_000} million cells",
                where=file,
                remedy="split it by field or by day",
            )
        if any(value is not None for value in values):
            yield row, [_text(value) for value in values]


def _text(value: Any) -> str:
    """Cell as text: numbers as Python writes them, times as ISO 8601 does."""
    if value is None:
        return ""
    if isinstance(value, bool):
        return str(value)
    if isinstance(value, float) and value.is_integer() and abs(value) < 1e15:
        return str(int(value))
    if isinstance(value, datetime | date | time):
        return value.isoformat()
    return str(value)
