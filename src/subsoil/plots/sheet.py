"""Sheets of panels, measured in inches, and the look that all pictures share."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from subsoil.errors import ParameterError, printable
from subsoil.optional import FIGURES, load

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, SubFigure
    from typing_extensions import TypeVar

    Canvas = Figure | SubFigure
    """What can be drawn on."""
    Drawn = TypeVar("Drawn", bound=Canvas, default=Figure)
    """The figure that was given to draw into, or else a new one."""

TITLE, TEXT, SMALL = 12.0, 8.5, 7.5
"""Sizes of letters in points."""
INK, FAINT, COLD, WARM = "#1a1a1a", "#6b6b6b", "#2a5caa", "#c2571a"
"""Colours of text, of remarks, and of the two curves that a picture sets against each other."""

_WIDE, _HIGH = 10.6, 8.6
_WIDEST_PANEL = 6.0
_NARROWEST = 6.4
_PLEASING = 2.2
_LETTERS, _SMALLEST = 110, 0.65
"""Letters of a point in an inch of a title, and the part of its size to which it may shrink."""
_LEAST_LETTERS = 5.0
_NOTHING = 1e-9
_LETTER = 0.58
"""Mean width of a letter over its size."""

Room = tuple[float, float]
"""Width and height in inches."""


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
    room
        Size of the whole, where that was given.
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
    room: Room | None = None

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
    def size(self) -> Room:
        """Width and height of the whole."""
        if self.room:
            return self.room
        return max(self._needed, _NARROWEST), self.top + self.depth + self.bottom

    @property
    def spare(self) -> float:
        """Height that is left below."""
        return self.size[1] - (self.top + self.depth + self.bottom)

    @property
    def corner(self) -> float:
        """Where the panels begin, from the left; they are centred on a sheet wider than them."""
        return self.left + (self.size[0] - self._needed) / 2

    def within(self, room: Room | None, least: Room) -> Sheet:
        """Sheet in a room of a size, with panels of the same aspect, as large as they can be.

        Parameters
        ----------
        room
            Size of the whole; None for the size as it is.
        least
            Width and height that a panel needs to be read.

        Raises
        ------
        ParameterError
            If the room is too small.
        """
        aspect = self.width / self.height
        width = max(least[0], least[1] * aspect)

        def alike(free: Room) -> Room:
            most = min(free[0], free[1] * aspect)
            return most, most / aspect

        return self._refitted(room, (width, width / aspect), alike)

    def filling(self, room: Room | None, least: Room) -> Sheet:
        """Sheet in a room of a size, as :meth:`within`, with panels that take all the room."""
        return self._refitted(room, least, lambda free: free)

    def _refitted(self, room: Room | None, least: Room, taken: Callable[[Room], Room]) -> Sheet:
        if room is None:
            return self
        aspect = self.width / self.height
        options = [replace(self, columns=c, room=room) for c in range(1, self.number + 1)]
        sized = [
            replace(each, width=width, height=height)
            for each in options
            for width, height in [taken(each._free)]
            if width > least[0] - _NOTHING and height > least[1] - _NOTHING
        ]
        if not sized:
            smallest = [replace(s, width=least[0], height=least[1], room=None) for s in options]
            raise too_small(room, [(s._needed, s.top + s.depth + s.bottom) for s in smallest])
        return max(sized, key=lambda s: min(s.width, aspect * s.height))

    @property
    def _free(self) -> Room:
        """Width and height that the room leaves for each panel."""
        width = self.size[0] - self.left - self.right - (self.columns - 1) * self.across
        height = self.size[1] - self.top - self.bottom
        return width / self.columns, height / self.rows - self.strip

    @property
    def _needed(self) -> float:
        return self.left + self.breadth + self.right

    def panel(self, figure: Canvas, k: int) -> Axes:
        """Add axes for the k-th panel, row by row from the top left."""
        row, column = divmod(k, self.columns)
        left = self.corner + column * (self.width + self.across)
        bottom = self.size[1] - self.top - (row + 1) * (self.height + self.strip)
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


def blank(size: Room, title: str, caption: str, figure: Drawn | None = None) -> Drawn:
    """Write a title and a caption at the top left of a figure: a new one, unless one is given.

    Parameters
    ----------
    size
        Its width and height in inches.
    title, caption
        What to write.
    figure
        What to write on. Default: a new white figure of that size.

    Raises
    ------
    MissingExtraError
        If matplotlib is not installed.
    """
    width, height = size
    drawn: Drawn = figure or _new(size)
    for text, down, most, colour in ((title, 0.14, TITLE, INK), (caption, 0.42, TEXT, FAINT)):
        said = printable(text)
        points = max(_SMALLEST * most, min(most, width * _LETTERS / max(1, len(said))))
        drawn.text(
            0.2 / width,
            1 - down / height,
            textwrap.shorten(said, int(width * _LETTERS / points), placeholder=" ..."),
            size=points,
            color=colour,
            va="top",
            parse_math=False,
        )
    return drawn


def _new(size: Room) -> Any:
    load("matplotlib.figure", *FIGURES[1:])
    from subsoil.plots.picture import Picture  # matplotlib is loaded by the first picture

    return Picture(figsize=size, facecolor="white")


def size_of(figure: Canvas) -> Room:
    """Width and height in inches of a figure or a part of one."""
    return figure.bbox.width / figure.dpi, figure.bbox.height / figure.dpi


def room_of(figure: Canvas | None) -> Room | None:
    """Size in inches of a figure that is given to draw into; None if none is."""
    return None if figure is None else size_of(figure)


def place(figure: Canvas, left: float, bottom: float, width: float, height: float) -> Axes:
    """Add axes at a place in inches from the lower left corner."""
    wide, high = size_of(figure)
    axes: Axes = figure.add_axes((left / wide, bottom / high, width / wide, height / high))
    return axes


def head(axes: Axes, name: str, *, lift: float = 0.0, size: float = TEXT) -> None:
    """Write a panel's name above it, lifted by some points."""
    axes.set_title(name, size=size, color=INK, loc="left", y=1.0, pad=4.0 + lift)


def width_of(axes: Axes) -> float:
    """Width of axes in inches."""
    return float(axes.bbox.width / axes.figure.dpi)


def letters(words: Iterable[str], size: float, inches: float) -> float:
    """Size of letters in points in which each of some lines fits a length, a given one at most.

    Examples
    --------
    >>> letters(["short", "a line"], 8.5, 2.0)
    8.5
    """
    longest = max(map(len, words), default=0)
    return min(size, 72 * inches / (_LETTER * longest)) if longest else size


def least_length(words: Iterable[str]) -> float:
    """Inches in which each of some lines can still be read."""
    return max(map(len, words), default=0) * _LETTER * _LEAST_LETTERS / 72


def too_small(room: Room, needed: Iterable[Room]) -> ParameterError:
    """Error that says which of some sizes in inches a picture needs: the next one to its room."""
    wide, high = min(needed, key=lambda size: max(size[0] / room[0], size[1] / room[1]))
    wide, high = (math.ceil(10 * inches) / 10 for inches in (wide, high))
    return ParameterError(
        f"the picture needs {wide:.1f} by {high:.1f} inches, and has {room[0]:.1f} by "
        f"{room[1]:.1f}",
        where="figure",
        remedy="draw into a larger figure, or fewer pictures side by side",
    )
