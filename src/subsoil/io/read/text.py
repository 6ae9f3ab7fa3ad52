"""Text files as people and instruments leave them: byte order marks, blanks, decimal commas."""

from __future__ import annotations

import math
import re
from pathlib import Path

from subsoil.errors import InputError, brief

POSITION_COLUMNS = {
    "lat": "latitude",
    "latitude": "latitude",
    "lon": "longitude",
    "longitude": "longitude",
    "easting": "easting",
    "northing": "northing",
}
"""Headings of columns of positions, and what they mean."""

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
    """Text of a file in UTF-8, or in UTF-16 with its mark; marks are taken off.

    Raises
    ------
    InputError
        Of the kind ``wrong``, if the file is missing, unreadable, empty, or not text.
    """
    check_file(path, wrong)
    try:
        data = path.read_bytes()
    except OSError as error:
        raise wrong(f"it cannot be read: {error.strerror}", where=str(path)) from error
    utf_16 = data.startswith((b"\xff\xfe", b"\xfe\xff"))
    try:
        text = data.decode("utf-16" if utf_16 else "utf-8-sig")
    except UnicodeDecodeError as error:
        raise wrong(
            f"byte {error.start} is not text", where=path.name, remedy="save the file as UTF-8"
        ) from error
    if not text.strip():
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
