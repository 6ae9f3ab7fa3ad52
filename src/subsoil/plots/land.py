"""The field on a map: outline, keep-outs, samples, the way, and the foot that explains them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import shapely
from numpy.typing import NDArray

from subsoil.arrays import Floats
from subsoil.land.field import Field
from subsoil.layers import LayerState
from subsoil.plots.sheet import INK, SMALL, Room, Sheet, place

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

    from subsoil.plots.sheet import Canvas


_MARGIN = 0.04
_CROWDED = 60
_SCALE = (2.2, 0.75)
"""Room in inches for scale bar and north arrow."""
_NAME, _LONG_NAME, _LINE = 1.3, 1.7, 0.18
"""Room in inches for a mark and its name in a legend, for a long name, and their height."""

_LOOKS = {
    LayerState.MEASURED: ("sample", "o", "white"),
    LayerState.AT_LEAST: ("at least (force limit)", "^", "white"),
    LayerState.UNREACHED: ("layer not reached", "o", "#8c8c8c"),
}


def frame(field: Field) -> tuple[float, float, float, float]:
    """West, south, east and north of a map of a field in m, with a margin."""
    west, south, east, north = field.boundary.bounds
    edge = _MARGIN * max(east - west, north - south) + field.cell_size / 2
    return west - edge, south - edge, east + edge, north + edge


def extent(field: Field) -> tuple[float, float, float, float]:
    """West, east, south and north of the grid's outer edges in m."""
    half, grid = field.cell_size / 2, field.grid
    return (
        float(grid.easting[0] - half),
        float(grid.easting[-1] + half),
        float(grid.northing[0] - half),
        float(grid.northing[-1] + half),
    )


def draw_land(axes: Axes, field: Field) -> None:
    """Outline and hatched keep-outs, framed, with metres of equal length and no axes."""
    west, south, east, north = frame(field)
    axes.set_xlim(west, east)
    axes.set_ylim(south, north)
    axes.set_aspect("equal")
    axes.set_axis_off()
    for area in field.keep_outs:
        for part in shapely.get_parts(area):
            x, y = shapely.get_coordinates(part.exterior).T
            axes.fill(x, y, facecolor="#d9d9d9", edgecolor="#555555", hatch="////", linewidth=0.6)
    for part in shapely.get_parts(field.boundary):
        for ring in (part.exterior, *part.interiors):
            axes.plot(*shapely.get_coordinates(ring).T, color=INK, linewidth=1.0)


def draw_samples(axes: Axes, at: Floats, states: NDArray[np.int8]) -> None:
    """Samples at (n, 2) places in m, by what they know of the layer: (n,) states."""
    size = 15.0 if len(at) <= _CROWDED else 6.0
    for state, (name, marker, face) in _LOOKS.items():
        chosen = at[states == state]
        if len(chosen):
            axes.scatter(
                chosen[:, 0], chosen[:, 1], s=size, marker=marker, facecolor=face,
                edgecolor="black", linewidth=0.6, label=name, zorder=5,
            )  # fmt: skip


def draw_way(axes: Axes, way: Floats) -> None:
    """White line along (k, 2) places in m, edged to be seen on every colour, from a square."""
    axes.plot(*way.T, color="#555555", linewidth=2.0, label="way between samples", zorder=3)
    axes.plot(*way.T, color="white", linewidth=1.1, zorder=4)
    axes.plot(
        *way[:1].T, "s", color="white", markeredgecolor="black", markersize=4.5,
        markeredgewidth=0.6, label="start", zorder=6,
    )  # fmt: skip


def draw_refusals(axes: Axes, at: Floats) -> None:
    """Crosses at (k, 2) places in m."""
    axes.plot(*at.T, "x", color="black", markersize=4.5, markeredgewidth=1.2, zorder=5)
    axes.plot(
        *at.T, "x", color="#ff6f61", markersize=4.0, markeredgewidth=0.8, label="refused", zorder=6
    )


def foot_height(room: Room | None, marks: int) -> float:
    """Inches under maps for scale bar and legend, which is below it in a narrow room."""
    if room is None or room[0] - _SCALE[0] > 2 * _LONG_NAME:
        return _SCALE[1]
    return _SCALE[1] + math.ceil(marks / _columns_below(room[0])) * _LINE + 0.05


def draw_foot(figure: Canvas, sheet: Sheet, field: Field, panels: Sequence[Axes]) -> None:
    """Scale bar, north arrow, and one legend for the marks of all axes."""
    west, _, east, _ = frame(field)
    width, height = sheet.size
    legend = sheet.bottom - _SCALE[1]
    base = sheet.spare + legend
    marks: dict[str, Artist] = {}
    for axes in panels:
        handles, names = axes.get_legend_handles_labels()
        marks.update(zip(names, handles, strict=True))
    columns = _columns_below(width) if legend else max(2, int((width - _SCALE[0]) / _NAME))
    across, up = (0.1, base + 0.05) if legend else (width - 0.15, base + 0.34)
    figure.legend(
        list(marks.values()), list(marks), loc="upper left" if legend else "center right",
        ncols=min(columns, len(marks)), bbox_to_anchor=(across / width, up / height),
        fontsize=SMALL, frameon=False,
        handletextpad=0.5, columnspacing=1.4, handlelength=1.6,
    )  # fmt: skip
    room = (min(_SCALE[0], width - sheet.left), _SCALE[1])
    _draw_scale(place(figure, sheet.left, base, *room), room, (east - west) / sheet.width)


def _columns_below(width: float) -> int:
    return max(1, int((width - 0.2) / _LONG_NAME))


def _draw_scale(axes: Axes, room: Room, inch: float) -> None:
    """Scale bar and north arrow in a room, for maps with so many metres in an inch."""
    metres = round_length(1.3 * inch)
    axes.set_xlim(0, room[0])
    axes.set_ylim(0, room[1])
    axes.set_axis_off()
    long, middle = metres / inch, room[1] / 2
    axes.plot([0.05, 0.05 + long], [middle - 0.08] * 2, color=INK, linewidth=2.5, gid="scale bar")
    axes.text(0.05 + long / 2, middle, f"{metres:g} m", size=SMALL, ha="center", va="bottom")
    axes.annotate(
        "", (long + 0.35, middle + 0.14), (long + 0.35, middle - 0.2),
        arrowprops={"arrowstyle": "-|>", "color": INK},
    )  # fmt: skip
    axes.text(long + 0.35, middle + 0.14, "N", size=SMALL, ha="center", va="bottom")


def round_length(metres: float) -> float:
    """Longest of 1, 2 and 5 times a power of ten that is no longer than a length in m.

    Examples
    --------
    >>> round_length(74.0), round_length(20.0), round_length(0.3)
    (50.0, 20.0, 0.2)
    """
    power = 10.0 ** math.floor(math.log10(metres))
    return max(step * power for step in (1.0, 2.0, 5.0) if step * power <= metres * (1 + 1e-9))
