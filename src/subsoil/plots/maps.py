"""Maps of all layers side by side on one colour scale, or of one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from subsoil.arrays import Floats
from subsoil.errors import ParameterError, ReadingsError
from subsoil.land.field import Field
from subsoil.mapping.soilmap import SoilMap
from subsoil.mapping.uncertainty import standard_deviation
from subsoil.plots.land import (
    draw_foot,
    draw_land,
    draw_refusals,
    draw_samples,
    draw_way,
    extent,
    foot_height,
    frame,
)
from subsoil.plots.sheet import (
    FAINT,
    SMALL,
    TEXT,
    Sheet,
    blank,
    head,
    letters,
    place,
    room_of,
    sheet,
    width_of,
)
from subsoil.plots.subject import Soil, Subject, subject

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.image import AxesImage

    from subsoil.plots.sheet import Canvas, Drawn


_LEAST = (0.8, 0.5)
"""Inches of a panel that has room for its name."""
_UNKNOWN = ("no sample measured", "this layer")


@dataclass(frozen=True)
class _Scale:
    """Colours, their limits, and what they stand for."""

    cmap: str
    low: float
    high: float
    label: str


def depth_slices(soil: Soil, *, caption: str = "", figure: Drawn | None = None) -> Drawn:
    """Kriged mean of every layer with the samples; of a survey also its way and refused stops.

    Parameters
    ----------
    soil
        Map to draw, or the survey whose map it is.
    caption
        What to say under the title. Default: how many samples, and what they cost.
    figure
        Figure or part of one to draw into, within its size. Default: a new one.

    Returns
    -------
    Figure or SubFigure
        What was drawn into.

    Raises
    ------
    ReadingsError
        If no sample has measured a layer yet.
    ParameterError
        If the figure is too small.
    MissingExtraError
        If matplotlib is not installed.
    """
    found = subject(soil)
    scale = _of_means(found.soil_map)
    title = f"Penetration resistance by depth, {found.soil_map.field.name}"
    return _maps(found, found.soil_map.mean, scale, title, caption, figure)


def std_dev(soil: Soil, *, caption: str = "", figure: Drawn | None = None) -> Drawn:
    """Kriging standard deviation of every layer, with the samples.

    Parameters
    ----------
    soil, caption, figure
        As in :func:`depth_slices`.

    Returns
    -------
    Figure or SubFigure
        What was drawn into.

    Raises
    ------
    ReadingsError
        If no sample has measured a layer yet.
    ParameterError
        If the figure is too small.
    MissingExtraError
        If matplotlib is not installed.
    """
    found = subject(soil)
    here = Subject(found.soil_map, found.way[:0], found.refused[:0], found.cost)
    values = standard_deviation(found.soil_map.variance)
    scale = _scale("magma", values, "standard deviation (kPa)", found.soil_map.field)
    title = f"Kriging standard deviation by depth, {found.soil_map.field.name}"
    return _maps(here, values, scale, title, caption, figure)


def layer_panel(soil_map: SoilMap, layer: int, *, ax: Axes) -> Axes:
    """Kriged mean of one layer with the samples, on the colours that all layers share.

    The colours are ``ax.images[0]``, for a colour bar, and the marks have names, for a legend.

    Parameters
    ----------
    soil_map
        Map to draw.
    layer
        Index of the layer.
    ax
        Axes to draw into.

    Returns
    -------
    Axes
        Those axes.

    Raises
    ------
    ReadingsError
        If no sample has measured a layer yet.
    ParameterError
        If there is no such layer.
    """
    last = len(soil_map.layers) - 1
    if not 0 <= layer <= last:
        raise ParameterError(
            f"there is no layer {layer}", where="layer_panel", remedy=f"0 to {last}"
        )
    head(ax, soil_map.layers.names[layer])
    _draw_layer(ax, soil_map, soil_map.mean[layer], layer, _of_means(soil_map))
    return ax


def _maps(
    found: Subject,
    values: Floats,
    scale: _Scale,
    title: str,
    caption: str,
    given: Drawn | None,
) -> Drawn:
    """Figure with a panel a layer of (m, N) values."""
    soil_map, room = found.soil_map, room_of(given)
    west, south, east, north = frame(soil_map.field)
    layout = sheet(
        len(values), (east - west) / (north - south),
        strip=0.24, across=0.12, left=0.2, right=1.05,
        bottom=foot_height(room, _marks(found)),
    ).within(room, _LEAST)  # fmt: skip
    figure = blank(layout.size, title, caption or found.on_land, given)
    panels = [layout.panel(figure, k) for k in range(len(values))]
    for k, (axes, name) in enumerate(zip(panels, soil_map.layers.names, strict=True)):
        head(axes, name)
        image = _draw_layer(axes, soil_map, values[k], k, scale)
        if len(found.way):
            draw_way(axes, found.way)
        if len(found.refused):
            draw_refusals(axes, found.refused)
    _colour_bar(figure, layout, image, scale.label)
    draw_foot(figure, layout, soil_map.field, panels)
    return figure


def _marks(found: Subject) -> int:
    """How many marks a legend of all panels has."""
    states = {int(state) for sample in found.soil_map.samples for state in sample.state}
    return len(states) + 2 * bool(len(found.way)) + bool(len(found.refused))


def _of_means(soil_map: SoilMap) -> _Scale:
    return _scale("viridis", soil_map.mean, "kriged mean (kPa)", soil_map.field)


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


def _draw_layer(
    axes: Axes, soil_map: SoilMap, values: Floats, layer: int, scale: _Scale
) -> AxesImage:
    """Field, (N,) values of its cells, and samples by what they know of a layer."""
    draw_land(axes, soil_map.field)
    image = _draw_cells(axes, soil_map.field, values, scale)
    states = np.array([sample.state[layer] for sample in soil_map.samples], dtype=np.int8)
    draw_samples(axes, soil_map.at, states)
    return image


def _draw_cells(axes: Axes, field: Field, values: Floats, scale: _Scale) -> AxesImage:
    if not np.isfinite(values).any():
        axes.text(
            0.5, 0.5, "\n".join(_UNKNOWN), transform=axes.transAxes, ha="center", va="center",
            size=letters(_UNKNOWN, SMALL, width_of(axes)), color=FAINT, zorder=7,
            bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.85},
        )  # fmt: skip
    limits = axes.get_xlim(), axes.get_ylim()
    image = axes.imshow(
        field.grid.image(values), cmap=scale.cmap, vmin=scale.low, vmax=scale.high,
        extent=extent(field), origin="lower", interpolation="nearest", zorder=0,
    )  # fmt: skip
    axes.set(xlim=limits[0], ylim=limits[1])
    return image


def _colour_bar(figure: Canvas, layout: Sheet, image: AxesImage, label: str) -> None:
    """Bar at the right of the panels, as high as they are but not endless."""
    room = layout.depth - layout.strip
    height = min(room, 4.5)
    left = layout.corner + layout.breadth + 0.2
    base = layout.spare + layout.bottom + (room - height) / 2
    axes = place(figure, left, base, 0.16, height)
    bar = figure.colorbar(image, cax=axes)
    bar.set_label(label, size=letters([label], TEXT, layout.depth + 0.3))
    bar.ax.tick_params(labelsize=SMALL)
    bar.outline.set_linewidth(0.5)
