"""Marks in numbers: thousands marks, which must never be read as decimal ones.

``1.119`` beside ``834`` is 1119, and ``1.119`` beside ``0.834`` is not. What a mark means is
decided by all the numbers of a kind in a file, and a file that leaves doubt is refused.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from dataclasses import dataclass

from subsoil.errors import brief

_GROUPS = r"[\s'’_]"
_GROUPED = re.compile(rf"[+-]?\d{{1,3}}(?:{_GROUPS}\d{{3}})+(?:[.,]\d*)?")
_APART = re.compile(rf"(?<=\d){_GROUPS}(?=\d{{3}}(?!\d))")
_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2}[.,]\d{3}")
_REPEATED = re.compile(r"[+-]?\d{1,3}([.,])\d{3}(?:\1\d{3})+")
_BOTH = re.compile(r"[+-]?\d{1,3}(?:([.,])\d{3})(?:\1\d{3})*(?!\1)[.,]\d*")
_BELOW_THOUSAND = re.compile(r"[+-]?[1-9]\d{0,2}")
_ONE_MARK = re.compile(r"[+-]?\d*[.,]\d*(?:e[+-]?\d+)?", re.IGNORECASE)
_LEAST = re.compile(r"^[>≥=\s]+|\s*\+$")
_NUMBER = re.compile(r"[+-]?[\d.,\s'’_]*\d[\d.,\s'’_]*(?:e[+-]?\d+)?", re.IGNORECASE)
_SURE = {
    mark: re.compile(rf"(?m)^[+-]?(?:0\d*{m}\d*|\d{{4,}}{m}\d*|\d*{m}(?:\d{{0,2}}|\d{{4,}}))$")
    for mark, m in ((".", r"\."), (",", ","))
}
"""Numbers, one a line, whose mark can only be a decimal one."""


@dataclass(frozen=True)
class Writing:
    """How numbers of a kind are written.

    Attributes
    ----------
    decimal
        Decimal mark.
    thousands
        Point or comma before groups of three digits; empty if numbers have none.
    """

    decimal: str = "."
    thousands: str = ""

    def plain(self, text: str) -> str:
        """Number with a decimal point and no other marks, as far as it is written so.

        Examples
        --------
        >>> Writing(",", ".").plain("1.119,5"), Writing().plain("1 119")
        ('1119.5', '1119')
        """
        if _GROUPED.fullmatch(text):
            text = _APART.sub("", text)
        if self.thousands:
            text = text.replace(self.thousands, "")
        return text.replace(self.decimal, ".") if self.decimal not in self.thousands else text


def writing_of(cells: Iterable[str], *, most: float | None = None, decimal: str = "") -> Writing:
    """How the numbers of a kind are written, by all of them together.

    Parameters
    ----------
    cells
        Texts of the numbers; blanks and words do not count.
    most
        Largest number of this kind there is.
    decimal
        Decimal mark of other numbers of the file, where they leave no doubt.

    Raises
    ------
    ValueError
        If a mark may be one or the other; the message names the number.

    Examples
    --------
    >>> writing_of(["834", "1.350", "2.119"], most=50_000.0)
    Writing(decimal=',', thousands='.')
    >>> writing_of(["0.834", "1.119"], most=50_000.0)
    Writing(decimal='.', thousands='')
    >>> writing_of(["834", "1.119"], most=50_000.0)
    Traceback (most recent call last):
    ValueError: '1.119' may be 1119 or 1.119
    """
    texts = list(cells)
    if quick := _quick("\n".join(texts), decimal):
        return quick
    numbers = [
        text for text in (_LEAST.sub("", cell.strip()) for cell in texts) if _NUMBER.fullmatch(text)
    ]
    marked = {mark: [text for text in numbers if mark in text] for mark in ".,"}
    both = [text for text in marked["."] if "," in text]
    if both:
        return _of_both(both)
    for mark, other in (".,", ",."):
        if any(_REPEATED.fullmatch(text) for text in marked[mark]):
            return Writing(other, mark)
    sure = {mark: _decimals(texts, most) for mark, texts in marked.items()}
    if sure["."] or sure[","]:
        best = "." if sure["."] >= sure[","] else ","
        other = ",."[best == ","]
        grouped = (
            marked[other] and not sure[other] and all(map(_THOUSANDS.fullmatch, marked[other]))
        )
        return Writing(best, other if grouped else "")
    return _of_groups(numbers, marked, most, decimal)


def _quick(text: str, decimal: str) -> Writing | None:
    """Writing of numbers, one a line, where a glance tells."""
    points, commas = "." in text, "," in text
    if not (points or commas):
        return Writing(decimal or ".")
    if points and commas:
        return None
    mark = "." if points else ","
    again = re.search(rf"\{mark}\d*\{mark}", text)
    return Writing(mark) if not again and _SURE[mark].search(text) else None


def _of_both(both: list[str]) -> Writing:
    """Writing of numbers that have points and commas: the last mark is the decimal one."""
    last = {max(".,", key=text.rfind) for text in both}
    if len(last) > 1 or not all(_BOTH.fullmatch(text) for text in both):
        raise ValueError(
            f"{brief(both[0])!r} has points and commas in an order that others have not"
        )
    (decimal,) = last
    return Writing(decimal, ".,"[decimal == "."])


def _decimals(marked: list[str], most: float | None) -> int:
    """How many numbers with a mark can only have decimals after it."""
    sure = sum(
        bool(_ONE_MARK.fullmatch(text)) and not _THOUSANDS.fullmatch(text) for text in marked
    )
    if sure or not marked or not all(map(_THOUSANDS.fullmatch, marked)):
        return sure
    most = math.inf if most is None else most
    return sum(abs(float(re.sub(r"[.,]", "", text))) > most for text in marked)


def _of_groups(
    numbers: list[str], marked: dict[str, list[str]], most: float | None, decimal: str
) -> Writing:
    """Writing of numbers all of whose marks stand before three digits, if they have any."""
    found = [mark for mark in ".," if marked[mark]]
    if not found:
        return Writing(decimal or ".")
    if len(found) == 2:
        raise ValueError(f"{brief(marked['.'][0])!r} and {brief(marked[','][0])!r} do not agree")
    (mark,) = found
    other = ",."[mark == ","]
    if decimal == other:
        return Writing(other, mark)
    texts = marked[mark]
    bare = [text for text in numbers if mark not in text and text.strip("+-0")]
    if most is None and not bare:
        return Writing(mark)
    fixed = any(text.endswith("0") for text in texts)
    if most is not None and fixed and bare and all(map(_BELOW_THOUSAND.fullmatch, bare)):
        return Writing(other, mark)
    whole = texts[0].replace(mark, "")
    raise ValueError(f"{texts[0]!r} may be {whole} or {whole[:-3]}.{whole[-3:]}")


def check_marks(cells: Iterable[str], *, most: float | None = None) -> None:
    """Check that no number of a kind has, or may have, a thousands mark.

    Parameters
    ----------
    cells, most
        As in :func:`writing_of`.

    Raises
    ------
    ValueError
        If one has, or may have; the message names it.

    Examples
    --------
    >>> check_marks(["483.125", "1119.250"], most=50_000.0)
    """
    texts = [cell.strip() for cell in cells]
    thousands = writing_of(texts, most=most).thousands
    for text in texts:
        if _GROUPED.fullmatch(text) or (thousands and thousands in text):
            raise ValueError(f"{brief(text)!r} has a thousands mark")
