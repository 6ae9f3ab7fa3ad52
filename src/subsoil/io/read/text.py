"""Text files as people and instruments leave them: encodings, blanks, decimal commas."""

from __future__ import annotations

import codecs
import math
import re
from pathlib import Path

from subsoil.errors import InputError, brief
from subsoil.findings import Finding

POSITION_COLUMNS = {
    "lat": "latitude",
    "latitude": "latitude",
    "lon": "longitude",
    "longitude": "longitude",
    "easting": "easting",
    "northing": "northing",
}
"""Headings of columns of positions, and what they mean."""

MOST_BYTES = 100_000_000
"""No file of readings or outlines as text has more."""

_HEAD = 200
_MARKS = (
    (codecs.BOM_UTF32_LE, "utf-32"),
    (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
    (codecs.BOM_UTF8, "utf-8-sig"),
)
_CONTROL = re.compile(r"[\x00-\x08\x0e-\x19\x1b-\x1f]")
_DECIMAL_COMMA = re.compile(r"[+-]?\d+,\d+")


def check_file(path: Path, wrong: type[InputError]) -> None:
    """Check that a file is there.

    Raises
    ------
    InputError
        Of the kind ``wrong``, if it is not, or is a folder.
    """
    if not path.is_file():
        raise wrong(
            "this is a folder, not a file" if path.is_dir() else "there is no such file",
            where=str(path),
            remedy="check the path",
        )


def read_text(path: Path, wrong: type[InputError]) -> str:
    """Text of a file in UTF-8, or in UTF-16 or UTF-32 with its mark; marks are taken off.

    Raises
    ------
    InputError
        Of the kind ``wrong``, if the file is missing, unreadable, empty, or not text.
    """
    data = _bytes(path, wrong)
    try:
        return _checked(_unicode(data), path, wrong)
    except UnicodeDecodeError as error:
        raise wrong(
            f"byte {error.start} is not text", where=path.name, remedy="save the file as UTF-8"
        ) from error


def read_any_text(path: Path, wrong: type[InputError]) -> tuple[str, tuple[Finding, ...]]:
    """Text of a file as :func:`read_text`, or in Windows-1252, which a finding then names.

    Raises
    ------
    InputError
        Of the kind ``wrong``, if the file is missing, unreadable, empty, or not text.
    """
    data = _bytes(path, wrong)
    try:
        return _checked(_unicode(data), path, wrong), ()
    except UnicodeDecodeError as error:
        start = error.start
    try:
        text = data.decode("cp1252")
    except UnicodeDecodeError:
        text = "\0"
    if _CONTROL.search(text):
        raise wrong(f"byte {start} is not text", where=path.name, remedy="save the file as UTF-8")
    seen = "it is not in UTF-8 and is read as Windows-1252"
    return _checked(text, path, wrong), (Finding(seen, file=path.name),)


def _bytes(path: Path, wrong: type[InputError]) -> bytes:
    check_file(path, wrong)
    try:
        size = path.stat().st_size
        if size > MOST_BYTES:
            raise wrong(
                f"it has {size / 1e6:.0f} MB, more than any survey",
                where=path.name,
                remedy="split it by field or by day",
            )
        return path.read_bytes()
    except OSError as error:
        raise wrong(f"it cannot be read: {error.strerror}", where=str(path)) from error


def _unicode(data: bytes) -> str:
    """Text of bytes by their mark, or as UTF-16 if every second byte is zero, or as UTF-8."""
    for mark, encoding in _MARKS:
        if data.startswith(mark):
            return data.decode(encoding)
    head = data[:_HEAD]
    for first, encoding in ((0, "utf-16-be"), (1, "utf-16-le")):
        letters = head[1 - first :: 2]
        if len(head) > 3 and not any(head[first::2]) and all(letters):
            return data.decode(encoding)
    return data.decode("utf-8")


def _checked(text: str, path: Path, wrong: type[InputError]) -> str:
    if not text.strip("\ufeff \t\r\n\v\f"):
        raise wrong("the file is empty", where=path.name, remedy="export it again")
    return text


def number(text: str, decimal: str = ".") -> float:
    """Finite number of a cell.

    Raises
    ------
    ValueError
        If it is anything else; the message says what.

    Examples
    --------
    >>> number(" 1.5 "), number("1,5", decimal=",")
    (1.5, 1.5)
    >>> number("1,5")
    Traceback (most recent call last):
    ValueError: '1,5' has a decimal comma: write 1.5
    """
    text = text.strip()
    if decimal != "," and _DECIMAL_COMMA.fullmatch(text):
        written = brief(text.replace(",", "."))
        raise ValueError(f"{brief(text)!r} has a decimal comma: write {written}")
    try:
        value = float("_" if "_" in text else text.replace(decimal, "."))
    except ValueError:
        raise ValueError(
            f"{brief(text)!r} is not a number" if text else "a number is missing"
        ) from None
    if not math.isfinite(value):
        raise ValueError(f"{brief(text)!r} is not a finite number")
    return value
