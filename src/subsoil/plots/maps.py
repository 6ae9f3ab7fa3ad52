"""Maps of all layers side by side on one colour scale."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from subsoil.arrays import Floats
from subsoil.errors import ReadingsError
from subsoil.land.field import Field
from subsoil.mapping.soilmap import SoilMap
from subsoil.mapping.uncertainty import standard_deviation
from subsoil.plots.land import (
    SCALE_WIDTH,
    draw_land,
    draw_refusals,
    draw_samples,
    draw_scale,
    draw_way,
    extent,
    frame,
)
from subsoil.plots.sheet import FAINT, SMALL, TEXT, Sheet, blank, head, place, sheet

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.image import AxesImage


_MARK_WIDTH = 1.3
"""Room in inches for a mark and its name in a legend."""


@dataclass(frozen=True)
class _Scale:
    """Colours, their limits, and what they stand for."""

    cmap: str
    low: float
    high: float
    label: str


def depth_slices(
    soil_map: SoilMap,
    *,
    way: ArrayLike = (),
    refused: ArrayLike = (),
    caption: str = "",
) -> Figure:
    """Kriged mean of every layer, with samples, the way between them and refused stops.

    Parameters
    ----------
    soil_map
        Map to draw.
    way
        (k, 2) places in m, in order, from the start on.
    refused
        (k, 2) places in m where no push gave a reading.
    caption
        What to say under the title.

    Raises
    ------
    ReadingsError
        If no sample has measured a layer yet.
    MissingExtraError
        If matplotlib is not installed.
    """
    scale = _scale("viridis", soil_map.mean, "kriged mean (kPa)", soil_map.field)
    title = f"Penetration resistance by depth, {soil_map.field.name}"
    figure, panels = _maps(soil_map, soil_map.mean, scale, title, caption)
    line, crosses = _places(way), _places(refused)
    for axes in panels:
        if len(line):
            draw_way(axes, line)
        if len(crosses):
            draw_refusals(axes, crosses)
    _legend(figure, panels)
    return figure


def std_dev(soil_map: SoilMap, *, caption: str = "") -> Figure:
    """Kriging standard deviation of every layer, with the samples.

    Parameters
    ----------
    soil_map
        Map to draw.
    caption
        What to say under the title.

    Raises
    ------
    ReadingsError
        If no sample has measured a layer yet.
    MissingExtraError
        If matplotlib is not installed.
    """
    values = standard_deviation(soil_map.variance)
    scale = _scale("magma", values, "standard deviation (kPa)", soil_map.field)
    title = f"Kriging standard deviation by depth, {soil_map.field.name}"
    figure, panels = _maps(soil_map, values, scale, title, caption)
    _legend(figure, panels)
    return figure


def _maps(
    soil_map: SoilMap, values: Floats, scale: _Scale, title: str, caption: str
) -> tuple[Figure, list[Axes]]:
    """Figure with a panel a layer of (m, N) values, and its panels."""
    field = soil_map.field
    west, south, east, north = frame(field)
    layout = sheet(
        len(values), (east - west) / (north - south),
        strip=0.24, across=0.12, left=0.2, right=1.05, bottom=0.75,
    )  # fmt: skip
    figure = blank(layout.size, title, caption)
    states = np.array([sample.state for sample in soil_map.samples], dtype=np.int8).T
    panels = [layout.panel(figure, k) for k in range(len(values))]
    for axes, name, layer, state in zip(panels, soil_map.layers.names, values, states, strict=True):
        head(axes, name)
        draw_land(axes, field)
        image = _draw_cells(axes, field, layer, scale)
        draw_samples(axes, soil_map.at, state)
    _colour_bar(figure, layout, image, scale.label)
    draw_scale(figure, layout, field)
    return figure, panels


def _scale(cmap: str, values: Floats, label: str, field: Field) -> _Scale:
    """Scale from the least value to the greatest, or half a kPa around it if they are the same."""
    known = values[np.isfinite(values)]
    if not known.size:
        raise ReadingsError(
            "there is nothing to draw: no sample has measured a layer yet",
            where=field.name,
            remedy="take samples first",
        )
    low, high = float(known.min()), float(known.max())
    if low == high:
        low, high = low - 0.5, high + 0.5
    return _Scale(cmap, low, high, label)


def _draw_cells(axes: Axes, field: Field, values: Floats, scale: _Scale) -> AxesImage:
    if not np.isfinite(values).any():
        axes.text(
            0.5, 0.5, "no sample measured\nthis layer", transform=axes.transAxes,
            ha="center", va="center", size=SMALL, color=FAINT, zorder=7,
            bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.85},
        )  # fmt: skip
    limits = axes.get_xlim(), axes.get_ylim()
    image = axes.imshow(
        field.grid.image(values), cmap=scale.cmap, vmin=scale.low, vmax=scale.high,
        extent=extent(field), origin="lower", interpolation="nearest", zorder=0,
    )  # fmt: skip
    axes.set(xlim=limits[0], ylim=limits[1])
    return image


def _colour_bar(figure: Figure, layout: Sheet, image: AxesImage, label: str) -> None:
    """Bar at the right of the panels, as high as they are but not endless."""
    room = layout.depth - layout.strip
    height = min(room, 4.5)
    left = layout.corner + layout.breadth + 0.2
    axes = place(figure, left, layout.bottom + (room - height) / 2, 0.16, height)
    bar = figure.colorbar(image, cax=axes)
    bar.set_label(label, size=TEXT)
    bar.ax.tick_params(labelsize=SMALL)
    bar.outline.set_linewidth(0.5)


def _legend(figure: Figure, panels: list[Axes]) -> None:
    """One legend at the foot for the marks of all panels."""
    marks: dict[str, Artist] = {}
    for axes in panels:
        handles, names = axes.get_legend_handles_labels()
        marks.update(zip(names, handles, strict=True))
    width, height = figure.get_size_inches()
    columns = int((width - SCALE_WIDTH) / _MARK_WIDTH)
    figure.legend(
        list(marks.values()), list(marks), loc="center right", ncols=min(columns, len(marks)),
        bbox_to_anchor=(1 - 0.15 / width, 0.34 / height), fontsize=SMALL, frameon=False,
        handletextpad=0.5, columnspacing=1.4, handlelength=1.6,
    )  # fmt: skip


def _places(at: ArrayLike) -> Floats:
    return np.asarray(at, dtype=float).reshape(-1, 2)
