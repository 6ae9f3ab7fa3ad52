"""Columns of numbers: values, codes for none, and words that say at least."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from subsoil.arrays import Floats
from subsoil.errors import brief
from subsoil.io.read.missing import is_missing
from subsoil.io.read.tables.marks import Writing
from subsoil.io.read.text import number

_PLAIN = set("0123456789+-eE \t")
_AT_LEAST = re.compile(r"(?:>=?|≥)\s*(?P<more>\S.*)|(?P<plus>\d.*?)\s*\+")


@dataclass(frozen=True)
class Numbers:
    """What the cells of a column hold.

    Attributes
    ----------
    values
        (n,) numbers; NaN where there is none.
    wrong
        Why a cell is no number, by its position.
    at_least
        Positions of numbers that are only known to be as large or larger.
    """

    values: Floats
    wrong: dict[int, str]
    at_least: frozenset[int] = frozenset()


def numbers_of(texts: Sequence[str], writing: Writing) -> Numbers:
    """Numbers of the cells of a column, blanks and codes for none being NaN.

    Examples
    --------
    >>> numbers_of(["1.5", "NA", ">50", "stone"], Writing())
    Numbers(values=array([ 1.5,  nan, 50. ,  nan]), wrong={3: "'stone' is not a number"}, \
at_least=frozenset({2}))
    """
    if (plain := _plain(texts, writing)) is not None:
        return Numbers(plain, {})
    values = np.full(len(texts), np.nan)
    wrong: dict[int, str] = {}
    at_least: set[int] = set()
    for k, cell in enumerate(texts):
        if is_missing(cell):
            continue
        text = cell.strip()
        if bound := _AT_LEAST.fullmatch(text):
            text = bound["more"] or bound["plus"]
            at_least.add(k)
        try:
            values[k] = _number(text, writing)
        except ValueError as error:
            wrong[k] = str(error)
    return Numbers(values, wrong, frozenset(at_least - wrong.keys()))


def _plain(texts: Sequence[str], writing: Writing) -> Floats | None:
    """Numbers of cells that are nothing but plain numbers and codes for none, else ``None``."""
    words = set(texts)
    codes = {word for word in words if not word[-1:].isdigit()}
    numbers = words - codes
    if writing.thousands or not all(map(is_missing, codes)):
        return None
    if not set().union(*numbers) <= _PLAIN | {writing.decimal}:
        return None
    try:
        meant = {word: float(word.replace(",", ".")) for word in numbers}
    except ValueError:
        return None
    meant.update(dict.fromkeys(codes, np.nan))
    values = np.array([meant[text] for text in texts], dtype=float)
    return None if np.isinf(values).any() else values


def _number(text: str, writing: Writing) -> float:
    plain = writing.plain(text.replace("−", "-"))
    if writing.decimal == "," and not writing.thousands and "." in text:
        raise ValueError(f"{brief(text)!r} has a decimal point where others have commas")
    try:
        return number(plain)
    except ValueError as error:
        if plain == text:
            raise
        raise ValueError(f"{brief(text)!r} is not a number") from error
