"""Figures as files: the same figure gives the same bytes."""

from __future__ import annotations

from collections.abc import Mapping
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from subsoil.io.write.whole import whole
from subsoil.optional import FIGURES, load

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Format = Literal["png", "svg", "pdf"]
"""Formats of figures."""
DPI = 150
"""Dots per inch of a PNG file."""
_UNDATED: dict[str, dict[str, None]] = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}
_LETTERS = {"svg.fonttype": "none", "svg.hashsalt": "subsoil", "pdf.fonttype": 42}
"""Text stays text in SVG, and fonts are part of a PDF."""


def save(figure: Figure, path: Path) -> Path:
    """Write a figure to a file in the format that its name ends with; returns the path."""
    with whole(path) as unfinished, load("matplotlib", *FIGURES[1:]).rc_context(_LETTERS):
        figure.savefig(unfinished, dpi=DPI, metadata=_UNDATED.get(path.suffix[1:]))
    return path


def save_all(figures: Mapping[str, Figure], folder: Path, form: Format) -> tuple[Path, ...]:
    """Write figures to a folder, each under its name; returns their paths."""
    return tuple(save(figure, Path(folder) / f"{name}.{form}") for name, figure in figures.items())


def as_png(figure: Figure) -> bytes:
    """The PNG file of a figure."""
    target = BytesIO()
    figure.savefig(target, dpi=DPI)
    return target.getvalue()
