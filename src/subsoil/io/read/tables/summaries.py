"""Rows below a table that hold no reading: means, totals, counts."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from subsoil.arrays import Floats
from subsoil.findings import Finding
from subsoil.io.read.tables.sheet import Row
from subsoil.io.read.tables.vocabulary import SUMMARIES, plain

_FEWEST = 3


def without_summaries(body: list[Row], file: str) -> tuple[list[Row], list[Finding]]:
    """Rows without those at the end that name themselves a summary, and findings about these."""
    end = len(body)
    findings = []
    while end and (word := _summary(body[end - 1][1])):
        end -= 1
        seen = f"{word!r} is a summary, not a reading"
        findings.append(Finding(seen, "left out", "left out", file, body[end][0]))
    return body[:end], findings


def _summary(cells: Sequence[str]) -> str:
    """Word of a row that says it is a summary; empty if none does."""
    return next((cell.strip() for cell in cells if plain(cell.strip(" :.")) in SUMMARIES), "")


def is_mean(numbers: Floats) -> bool:
    """Whether the last of (n, k) rows of numbers is the mean or the sum of all others.

    Examples
    --------
    >>> is_mean(np.array([[1.0, 500.0, 90.0], [3.0, 601.0, 110.0], [2.0, 550.5, 100.0]]))
    True
    """
    if len(numbers) < _FEWEST or numbers.shape[1] < _FEWEST:
        return False
    known = np.isfinite(numbers[-1]) & np.isfinite(numbers[:-1]).all(axis=0)
    if known.sum() < _FEWEST or not (np.ptp(numbers[:-1, known], axis=0) > 0).any():
        return False
    above, last = numbers[:-1, known], numbers[-1, known]
    close = np.abs(above.mean(axis=0) - last) <= 1e-6 * np.abs(last) + 1e-9
    whole = np.abs(above.sum(axis=0) - last) <= 1e-6 * np.abs(last) + 1e-9
    return bool(close.all() or whole.all())
