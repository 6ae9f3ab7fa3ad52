"""Columns of numbers: values, codes for none, and words that say at least."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from subsoil.arrays import Floats
from subsoil.errors import brief
from subsoil.io.read.marks import Writing
from subsoil.io.read.missing import is_missing
from subsoil.io.read.text import number

_PLAIN = set("0123456789.+-eE \t")
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
    if writing == Writing() and set().union(*texts) <= _PLAIN:
        try:
            return Numbers(
                np.array([float(text) if text.strip() else np.nan for text in texts]), {}
            )
        except ValueError:
            pass
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
