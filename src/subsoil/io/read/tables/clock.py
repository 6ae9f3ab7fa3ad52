"""Dates and times in tables, told by the whole column."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime, timedelta

_ORDERS = (
    "%d.%m.%Y",
    "%d/%m/%Y",
    "%m/%d/%Y",
    "%d-%m-%Y",
    "%Y/%m/%d",
    "%d.%m.%y",
    "%d/%m/%y",
    "%m/%d/%y",
)
_CLOCKS = ("", " %H:%M", " %H:%M:%S", " %H:%M:%S.%f", " %I:%M %p", " %I:%M:%S %p")
_EXCEL_DAYS = (20_000.0, 80_000.0)
_UNIX_S = (3e8, 4e9)
_EPOCH = datetime(1899, 12, 30)

Times = list[datetime | None]


def times_of(texts: Sequence[str]) -> Times | None:
    """Times of a column; ``None`` if its words are none, or leave open which is day and month.

    Times with a zone are given in UTC.

    Examples
    --------
    >>> times_of(["13.5.2024 08:15", ""])
    [datetime.datetime(2024, 5, 13, 8, 15), None]
    >>> times_of(["03/04/2024"]) is None
    True
    """
    words = {text.strip() for text in texts if text.strip()}
    meant: dict[str, datetime] | None = _iso(words)
    if meant is None:
        meant = _numbers(words)
    if meant is None:
        found = [times for order in _ORDERS if (times := _ordered(words, order)) is not None]
        meant = found[0] if found and all(times == found[0] for times in found) else None
    return None if meant is None else [meant.get(text.strip()) for text in texts]


def _iso(words: set[str]) -> dict[str, datetime] | None:
    if any(map(_is_number, words)):
        return None
    try:
        return {word: _utc(datetime.fromisoformat(word)) for word in words}
    except ValueError:
        return None


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def _utc(time: datetime) -> datetime:
    return time.astimezone(UTC).replace(tzinfo=None) if time.tzinfo else time


def _numbers(words: set[str]) -> dict[str, datetime] | None:
    """Times of a spreadsheet's days, or of seconds since 1970."""
    try:
        values = {word: float(word) for word in words}
    except ValueError:
        return None
    if all(_EXCEL_DAYS[0] < value < _EXCEL_DAYS[1] for value in values.values()):
        return {word: _EPOCH + timedelta(seconds=round(86400 * v)) for word, v in values.items()}
    if all(_UNIX_S[0] < value < _UNIX_S[1] for value in values.values()):
        return {
            word: datetime.fromtimestamp(v, UTC).replace(tzinfo=None) for word, v in values.items()
        }
    return None


def _ordered(words: set[str], order: str) -> dict[str, datetime] | None:
    for clock in _CLOCKS:
        try:
            return {word: datetime.strptime(word, order + clock) for word in words}
        except ValueError:
            continue
    return None
