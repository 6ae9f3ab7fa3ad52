"""Resistance against depth, sample by sample."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from subsoil.arrays import Bools, Floats
from subsoil.errors import ReadingsError
from subsoil.layers import LayerState
from subsoil.mapping.soilmap import SoilMap
from subsoil.plots.sheet import COLD, FAINT, INK, SMALL, TEXT, WARM, Sheet, blank, room_of
from subsoil.plots.subject import Soil, subject

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from subsoil.plots.sheet import Drawn


_ARROW = [(0.0, 0.0), (1.0, 0.0), (0.7, 0.2), (1.0, 0.0), (0.7, -0.2), (1.0, 0.0)]
ROOT_LIMIT_KPA = 2000.0
"""Resistance at which roots hardly grow any more (Taylor & Gardner 1963; Bengough 2011)."""


_SHEET = Sheet(1, 1, 4.7, 4.1, 0.25, 0.0, 0.75, 0.95, 0.65, 0.6)
_LEAST = (1.9, 1.6)
_LEGEND_WIDTH = 6.1
"""Inches of a picture whose legend is one line."""


def profiles(soil: Soil, *, caption: str = "", figure: Drawn | None = None) -> Drawn:
    """Layer means of every sample against depth, and their mean over the samples that measured it.

    An arrow marks a layer in which the force limit ended the push: its resistance is that or
    more. Such layers are not in the mean, which then is lower than the soil's.

    Parameters
    ----------
    soil
        Map or survey whose samples to draw.
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
    found, room = subject(soil), room_of(figure)
    _measured(found.soil_map)
    narrow = room is not None and room[0] < _LEGEND_WIDTH
    layout = replace(_SHEET, strip=0.45 if narrow else 0.25).filling(room, _LEAST)
    drawn = blank(layout.size, "Resistance by depth at every sample", caption or found.cost, figure)
    axes = profiles_panel(found.soil_map, ax=layout.panel(drawn, 0))
    axes.legend(
        fontsize=SMALL,
        loc="lower center",
        bbox_to_anchor=(0.5, 1.0),
        ncols=2 if narrow else 4,
        frameon=False,
    )
    return drawn


def profiles_panel(soil_map: SoilMap, *, ax: Axes) -> Axes:
    """Draw the layer means of every sample and their mean into axes, as :func:`profiles` does.

    The lines have names, for a legend.

    Parameters
    ----------
    soil_map
        Map whose samples to draw.
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
    """
    measured = _measured(soil_map)
    values = np.array([sample.kpa for sample in soil_map.samples]).T
    states = np.array([sample.state for sample in soil_map.samples]).T
    depth = soil_map.layers.centre_m
    ax.plot(values, depth, color=COLD, alpha=0.35, linewidth=0.8)
    ax.plot([], [], color=COLD, alpha=0.6, linewidth=0.8, label="a sample")
    _draw_bounds(ax, values, states == LayerState.AT_LEAST, depth)
    _draw_mean(ax, measured, depth)
    ax.axvline(ROOT_LIMIT_KPA, color=WARM, linestyle="--", linewidth=1.2, label="2 MPa")
    _label(ax, np.array(soil_map.layers.edges_m), values)
    return ax


def _measured(soil_map: SoilMap) -> Floats:
    """(m, n) layer means of the samples, some of which were measured."""
    measured = soil_map.kpa
    if not np.isfinite(measured).any():
        raise ReadingsError(
            "there is nothing to draw: no sample has measured a layer yet",
            where="profiles",
            remedy="take samples first",
        )
    return measured


def _draw_bounds(axes: Axes, values: Floats, bound: Bools, depth: Floats) -> None:
    """Arrow to the right from every lower bound among (m, n) values."""
    if not bound.any():
        return
    layer, sample = np.nonzero(bound)
    axes.plot(
        values[layer, sample], depth[layer], linestyle="none", marker=_ARROW, markersize=16,
        fillstyle="none", color=INK, markeredgewidth=0.9, label="at least (force limit)",
    )  # fmt: skip


def _draw_mean(axes: Axes, measured: Floats, depth: Floats) -> None:
    """Mean of each layer, and at the right margin from how many samples."""
    number = np.isfinite(measured).sum(axis=1)
    known = number > 0
    mean = np.nansum(measured[known], axis=1) / number[known]
    axes.plot(mean, depth[known], "o-", color=INK, linewidth=2.4, markersize=4, label="mean")
    for y, count in zip(depth, number, strict=True):
        axes.annotate(
            f"{count} of {measured.shape[1]}", (1, y), xytext=(6, 0), size=SMALL, color=FAINT,
            xycoords=axes.get_yaxis_transform(), textcoords="offset points", va="center",
        )  # fmt: skip


def _label(axes: Axes, edges: Floats, values: Floats) -> None:
    axes.set_xlim(0, 1.08 * max(float(np.nanmax(values)), ROOT_LIMIT_KPA))
    axes.set_ylim(edges[-1], edges[0])
    axes.set_yticks(edges)
    axes.set_xlabel("penetration resistance, mean of the layer (kPa)", size=TEXT)
    axes.set_ylabel("depth (m)", size=TEXT)
    axes.annotate(
        "measured", (1, 1), xytext=(6, 4), size=SMALL, color=FAINT,
        xycoords="axes fraction", textcoords="offset points",
    )  # fmt: skip
    axes.tick_params(labelsize=SMALL)
    axes.grid(color="#e5e5e5", linewidth=0.6)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
