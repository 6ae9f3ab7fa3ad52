"""Resistance against depth, sample by sample."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from subsoil.arrays import Bools, Floats
from subsoil.errors import ReadingsError
from subsoil.layers import LayerState
from subsoil.mapping.soilmap import SoilMap
from subsoil.plots.sheet import COLD, FAINT, INK, SMALL, TEXT, WARM, blank, place

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


_ARROW = [(0.0, 0.0), (1.0, 0.0), (0.7, 0.2), (1.0, 0.0), (0.7, -0.2), (1.0, 0.0)]
ROOT_LIMIT_KPA = 2000.0
"""Resistance at which roots hardly grow any more (Taylor & Gardner 1963; Bengough 2011)."""


def profiles(soil_map: SoilMap, *, caption: str = "") -> Figure:
    """Layer means of every sample against depth, and their mean over the samples that measured it.

    An arrow marks a layer in which the force limit ended the push: its resistance is that or
    more. Such layers are not in the mean, which then is lower than the soil's.

    Parameters
    ----------
    soil_map
        Map whose samples to draw.
    caption
        What to say under the title.

    Raises
    ------
    ReadingsError
        If no sample has measured a layer yet.
    MissingExtraError
        If matplotlib is not installed.
    """
    measured = soil_map.kpa
    if not np.isfinite(measured).any():
        raise ReadingsError(
            "there is nothing to draw: no sample has measured a layer yet",
            where="profiles",
            remedy="take samples first",
        )
    values = np.array([sample.kpa for sample in soil_map.samples]).T
    states = np.array([sample.state for sample in soil_map.samples]).T
    figure = blank((6.4, 5.6), "Resistance by depth at every sample", caption)
    axes = place(figure, 0.75, 0.6, 4.7, 4.1)
    depth = soil_map.layers.centre_m
    axes.plot(values, depth, color=COLD, alpha=0.35, linewidth=0.8)
    axes.plot([], [], color=COLD, alpha=0.6, linewidth=0.8, label="a sample")
    _draw_bounds(axes, values, states == LayerState.AT_LEAST, depth)
    _draw_mean(axes, measured, depth)
    axes.axvline(ROOT_LIMIT_KPA, color=WARM, linestyle="--", linewidth=1.2, label="2 MPa")
    _label(axes, np.array(soil_map.layers.edges_m), values)
    axes.legend(
        fontsize=SMALL, loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=4, frameon=False
    )
    return figure


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
