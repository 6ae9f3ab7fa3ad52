"""Codes for numbers that are not there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from subsoil.findings import Finding
from subsoil.io.read.recording import Record

_LETTERS = {"na", "nan", "null", "none", "nil", "nd", "nodata", "no data", "missing", "not reached"}
_SIGNS = {"n/a", "n.a.", "#n/a", "n.d.", "?", "*", ".", "-", "--", "---", "–", "—"}
_NEVER = (-99.0, -999.0, -9999.0, -99999.0, -999999.0, -32768.0)
_RARELY = (9999.0, 99999.0, 999999.0, 32767.0, 65535.0)
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

    -999 and its kin are no strength. 9999 and its kin may be: they are codes only where they lie
    far beyond all other values of the file.
    """
    values = np.concatenate([np.zeros(0), *(record.values for record in records)])
    others = values[np.isfinite(values) & ~np.isin(values, (*_NEVER, *_RARELY))]
    hardest = others.max(initial=0.0)
    codes = [v for v in _NEVER if (values == v).any()]
    codes += [v for v in _RARELY if (values == v).any() and v > _FAR_BEYOND * hardest > 0]
    findings = tuple(
        Finding(f"{code:g} is taken for 'not read', in {(values == code).sum()} numbers", file=file)
        for code in codes
    )
    if not codes:
        return tuple(records), findings
    cleaned = (
        replace(r, values=np.where(np.isin(r.values, codes), np.nan, r.values)) for r in records
    )
    return tuple(cleaned), findings
