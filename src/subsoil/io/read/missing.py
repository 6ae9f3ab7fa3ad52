"""Codes for numbers that are not there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from subsoil.findings import Finding
from subsoil.io.read.recording import Record

_LETTERS = {"na", "nan", "null", "none", "nil", "nd", "nodata", "no data", "missing", "not reached"}
_SIGNS = {
    "n/a",
    "#n/a",
    "#value!",
    "#div/0!",
    "#null!",
    "n.a.",
    "n.d.",
    "?",
    "*",
    ".",
    "-",
    "--",
    "---",
    "–",
    "—",
}
_NEVER = (-99.0, -999.0, -9999.0, -99999.0, -999999.0, -32768.0)
_RARELY = (9999.0, 99999.0, 999999.0, 32767.0, 65535.0)
_MINUS_ONE = -1.0
_FAR_BEYOND = 1.5


def is_missing(text: str) -> bool:
    """Whether a cell says that there is no number, by being blank or by a code such as ``NA``.

    Examples
    --------
    >>> is_missing(" N/A "), is_missing("-"), is_missing("-5"), is_missing("0")
    (True, True, False, False)
    """
    text = text.strip().lower()
    return not text or text in _LETTERS | _SIGNS


def without_codes(
    records: Sequence[Record], file: str
) -> tuple[tuple[Record, ...], tuple[Finding, ...]]:
    """Records with NaN in place of numbers that stand for none, and what was replaced.

    -999 and its kin are no strength, nor is -1 where nothing else is below zero.
    9999 and its kin may be: they are codes only where they lie far beyond all other values of the
    file.
    """
    values = np.concatenate([np.zeros(0), *(record.values for record in records)])
    others = values[np.isfinite(values) & ~np.isin(values, (*_NEVER, *_RARELY, _MINUS_ONE))]
    hardest = others.max(initial=0.0)
    codes = [v for v in _NEVER if (values == v).any()]
    codes += [v for v in _RARELY if (values == v).any() and v > _FAR_BEYOND * hardest > 0]
    codes += [_MINUS_ONE] if (values == _MINUS_ONE).any() and not (others < 0).any() else []
    findings = tuple(
        Finding(f"{code:g} is taken for 'not read', in {(values == code).sum()} numbers", file=file)
        for code in codes
    )
    if not codes:
        return tuple(records), findings
    ends = np.cumsum([len(record.values) for record in records])[:-1]
    cleaned = np.split(np.where(np.isin(values, codes), np.nan, values), ends)
    pairs = zip(records, cleaned, strict=True)
    return tuple(replace(record, values=numbers) for record, numbers in pairs), findings
