"""The row that holds the headings: below titles, beside a row of units."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from subsoil.errors import ReadingsError
from subsoil.io.read.tables.headings import meaning_of, without
from subsoil.io.read.tables.sheet import Meanings, Row, Sheet
from subsoil.io.read.tables.vocabulary import UNIT, length_named, plain, words_of

_MOST_TITLES = 60
_ANGLES = {"°", "deg", "degrees", "dd"}
_SAYS_NOTHING = ("other", "bare", "unclear")


@dataclass(frozen=True)
class Heading:
    """Headings of a sheet, their row, and the rows below."""

    names: list[str]
    row: int
    body: list[Row]


def heading_of(sheet: Sheet, meanings: Meanings) -> Heading:
    """Find the row of headings: that with most cells which are understood.

    A row below it that holds units alone belongs to it, and so does a row above where headings
    are numbers alone and a title over them says in which unit.

    Raises
    ------
    ReadingsError
        If the sheet has no rows.
    """
    if not sheet.rows:
        raise ReadingsError("all its cells are blank", where=sheet.where, remedy="export it again")
    said = {plain(key) for key in meanings}
    scores = [understood(cells, said) for _, cells in sheet.rows[:_MOST_TITLES]]
    at = scores.index(max(scores))
    row, cells = sheet.rows[at]
    names, body = list(cells), sheet.rows[at + 1 :]
    if body and _all_units(body[0][1]):
        units = body[0][1]
        names = [
            f"{n} {u}".strip() for n, u in zip(names, [*units, *[""] * len(names)], strict=False)
        ]
        body = body[1:]
    if at:
        names = _under_titles(names, sheet.rows[at - 1][1])
    return Heading(names, row, body)


def understood(cells: Sequence[str], said: set[str] = frozenset()) -> int:  # type: ignore[assignment]
    """How many cells of a row are headings that mean something."""
    return sum(_says(cell) or plain(cell) in said for cell in cells if cell.strip())


def _says(cell: str) -> bool:
    if not any(c.isalpha() or c in "\"'" for c in cell):
        return False
    try:
        return meaning_of(cell[:200]).kind not in _SAYS_NOTHING
    except ValueError:
        return True


def _all_units(cells: Sequence[str]) -> bool:
    texts = [plain(cell) for cell in cells if cell.strip()]
    return bool(texts) and all(
        UNIT.fullmatch(text) or length_named(text) or text in _ANGLES for text in texts
    )


def _under_titles(names: list[str], titles: Sequence[str]) -> list[str]:
    """Headings, those that are numbers alone with the units that a title over them says."""
    title, found = "", []
    for k, name in enumerate(names):
        title = titles[k].strip() if k < len(titles) and titles[k].strip() else title
        text = plain(title)
        unit = UNIT.search(text)
        lengths = [word for word in words_of(without(unit, text)) if length_named(word)]
        if re.fullmatch(r"\s*\d+(?:[.,]\d+)?\s*", name) and lengths:
            found.append(f"{unit[0] if unit else ''} {name.strip()} {lengths[-1]}".strip())
        else:
            found.append(name)
    return found
