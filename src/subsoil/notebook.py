"""What notebooks show of values: small tables."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape


def table(head: Sequence[str], rows: Iterable[Sequence[str]], caption: str = "") -> str:
    """HTML table of texts.

    Examples
    --------
    >>> table(["<b>"], [["5"]])
    '<table><tr><th>&lt;b&gt;</th></tr><tr><td>5</td></tr></table>'
    """
    lines = [_row("th", head), *(_row("td", row) for row in rows)]
    title = f"<caption>{escape(caption)}</caption>" if caption else ""
    return f"<table>{title}{''.join(lines)}</table>"


def _row(tag: str, cells: Sequence[str]) -> str:
    return f"<tr>{''.join(f'<{tag}>{escape(cell)}</{tag}>' for cell in cells)}</tr>"
