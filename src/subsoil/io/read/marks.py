"""Marks in numbers: thousands marks, which must never be read as decimal ones.

``1.119`` beside ``834`` is 1119, and ``1.119`` beside ``0.834`` is not. What a mark means is
decided by all the numbers of a kind in a file, and a file that leaves doubt is refused.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable

from subsoil.errors import brief

_GROUPED = re.compile(
    r"[+-]?\d{1,3}(?:[\s'’_]\d{3})+(?:[.,]\d*)?|[+-]?\d{1,3}([.,])\d{3}(?:\1\d{3})+"
)
_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2}[.,]\d{3}")


def check_marks(cells: Iterable[str], *, most: float | None = None) -> None:
    """Check that no number of a kind may have a thousands mark.

    Parameters
    ----------
    cells
        Texts of the numbers; blanks and words do not count.
    most
        Largest number of this kind there is. Marks before groups of three digits throughout are
        decimal marks if thousands would go beyond it. Without one, they are if all numbers have
        them, as a program writes that gives three decimals.

    Raises
    ------
    ValueError
        If one has, or may have; the message names it.

    Examples
    --------
    >>> check_marks(["834", "1.119"], most=50_000.0)
    Traceback (most recent call last):
    ValueError: '1.119' may be 1119 or 1.119
    >>> check_marks(["0.834", "1.119"], most=50_000.0)
    >>> check_marks(["483.125", "1119.250"], most=50_000.0)
    """
    texts = (cell.strip() for cell in cells)
    numbers = [text for text in texts if any(c.isdigit() for c in text)]
    for text in numbers:
        if _GROUPED.fullmatch(text) or ("." in text and "," in text):
            raise ValueError(f"{brief(text)!r} has a thousands mark")
    for mark in ".,":
        marked = [text for text in numbers if mark in text]
        if not marked or not all(_THOUSANDS.fullmatch(text) for text in marked):
            continue
        whole = [text.replace(mark, "") for text in marked]
        possible = max(abs(float(text)) for text in whole) <= (math.inf if most is None else most)
        if possible and (most is not None or len(marked) < len(numbers)):
            raise ValueError(f"{marked[0]!r} may be {whole[0]} or {whole[0][:-3]}.{whole[0][-3:]}")
