"""Sheets of panels, measured in inches, and the look that all pictures share."""

from __future__ import annotations

import math
import textwrap
from dataclasses import dataclass
from typing import TYPE_CHECKING

from subsoil.errors import printable
from subsoil.optional import FIGURES, load

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

TITLE, TEXT, SMALL = 12.0, 8.5, 7.5
"""Sizes of letters in points."""
INK, FAINT, COLD, WARM = "#1a1a1a", "#6b6b6b", "#2a5caa", "#c2571a"
"""Colours of text, of remarks, and of the two curves that a picture sets against each other."""

_WIDE, _HIGH = 10.6, 8.6
_WIDEST_PANEL = 6.0
_NARROWEST = 6.4
_PLEASING = 2.2


@dataclass(frozen=True)
class Sheet:
    """Equal panels in rows under a title, and room around them; lengths in inches.

    Attributes
    ----------
    number, columns
        Panels in all and in a row.
    width, height
        Size of a panel.
    strip
        Room above a panel, for its title.
    across
        Room between panels side by side.
    left, right, top, bottom
        Room around the panels.
    """

    number: int
    columns: int
    width: float
    height: float
    strip: float
    across: float
    left: float
    right: float
    top: float
    bottom: float

    @property
    def rows(self) -> int:
        """Rows of panels."""
        return math.ceil(self.number / self.columns)

    @property
    def breadth(self) -> float:
        """Width of the panels with the room between them."""
        return self.columns * self.width + (self.columns - 1) * self.across

    @property
    def depth(self) -> float:
        """Height of the panels with their strips."""
        return self.rows * (self.height + self.strip)

    @property
    def size(self) -> tuple[float, float]:
        """Width and height of the whole."""
        width = self.left + self.breadth + self.right
        return max(width, _NARROWEST), self.top + self.depth + self.bottom

    @property
    def corner(self) -> float:
        """Where the panels begin, from the left; they are centred on a sheet wider than them."""
        spare = self.size[0] - (self.left + self.breadth + self.right)
        return self.left + spare / 2

    def panel(self, figure: Figure, k: int) -> Axes:
        """Add axes for the k-th panel, row by row from the top left."""
        row, column = divmod(k, self.columns)
        left = self.corner + column * (self.width + self.across)
        bottom = self.bottom + self.depth - (row + 1) * (self.height + self.strip)
        axes = place(figure, left, bottom, self.width, self.height)
        axes.tick_params(labelsize=SMALL, colors=INK)
        return axes


def sheet(
    number: int,
    aspect: float,
    *,
    strip: float,
    across: float,
    left: float,
    right: float,
    top: float = 0.65,
    bottom: float,
) -> Sheet:
    """Sheet for panels of an aspect (width over height), as many in a row as looks best."""
    columns = min(range(1, number + 1), key=lambda c: _awkwardness(number, c, aspect))
    rows = math.ceil(number / columns)
    width = min(
        (_WIDE - left - right - (columns - 1) * across) / columns,
        (_HIGH / rows - strip) * aspect,
        _WIDEST_PANEL,
    )
    return Sheet(
        number, columns, width, width / aspect, strip, across, left, right, top, bottom
    )  # fmt: skip


def _awkwardness(number: int, columns: int, aspect: float) -> float:
    """How far a layout is from a pleasing oblong without holes."""
    rows = math.ceil(number / columns)
    shape = abs(math.log(columns * aspect / rows / _PLEASING))
    return shape + (rows * columns - number) / number


def blank(size: tuple[float, float], title: str, caption: str) -> Figure:
    """Make a white figure of a size in inches, with a title and a caption at its top left.

    Raises
    ------
    MissingExtraError
        If matplotlib is not installed.
    """
    width, height = size
    figure: Figure = load("matplotlib.figure", *FIGURES[1:]).Figure(figsize=size, facecolor="white")
    for text, down, points, colour in ((title, 0.14, TITLE, INK), (caption, 0.42, TEXT, FAINT)):
        figure.text(
            0.2 / width,
            1 - down / height,
            textwrap.shorten(printable(text), int(width * 110 / points), placeholder=" ..."),
            size=points,
            color=colour,
            va="top",
            parse_math=False,
        )
    return figure


def place(figure: Figure, left: float, bottom: float, width: float, height: float) -> Axes:
    """Add axes at a place in inches from the lower left corner."""
    wide, high = figure.get_size_inches()
    return figure.add_axes((left / wide, bottom / high, width / wide, height / high))


def head(axes: Axes, name: str, *, lift: float = 0.0) -> None:
    """Write a panel's name above it, lifted by some points."""
    axes.set_title(name, size=TEXT, color=INK, loc="left", y=1.0, pad=4.0 + lift)
