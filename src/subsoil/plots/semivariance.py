"""Variograms of all layers: bins with their pairs, and the curves laid through them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from subsoil.arrays import Floats, Integers
from subsoil.errors import ParameterError
from subsoil.mapping.soilmap import SoilMap
from subsoil.plots.sheet import COLD, FAINT, INK, SMALL, TEXT, WARM, blank, head, sheet
from subsoil.variogram import Bounded, Fit, Nested, Variogram, name_of, semivariance

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


_THOUSAND = 1000.0
_CLOSE = 0.1
"""Share of a panel's width in which two numbers do not fit side by side."""


def variograms(fits: Sequence[Fit], soil_map: SoilMap, *, caption: str = "") -> Figure:
    """Empirical variogram of every layer with the number of pairs in each bin, and its curve.

    A dashed second curve shows what a layer was kriged with, where that is another model.

    Parameters
    ----------
    fits
        How the variograms were come by, one a layer.
    soil_map
        Map kriged with them.
    caption
        What to say under the title.

    Raises
    ------
    ParameterError
        If there is not one fit a layer.
    MissingExtraError
        If matplotlib is not installed.
    """
    names = soil_map.layers.names
    if len(fits) != len(names):
        raise ParameterError(
            f"{len(fits)} fits for {len(names)} layers",
            where="variograms",
            remedy="give one a layer",
        )
    layout = sheet(len(fits), 1.3, strip=0.8, across=0.52, left=0.65, right=0.2, bottom=0.5)
    legend = "small numbers: pairs of samples in each bin"
    figure = blank(layout.size, "Variograms", "; ".join(filter(None, (caption, legend))))
    reach = _reach(fits)
    for k, (name, fit, used) in enumerate(zip(names, fits, soil_map.kriged_with, strict=True)):
        axes = layout.panel(figure, k)
        head(axes, f"{name}, {name_of(fit.variogram)}", lift=24)
        _write(axes, parameters(fit.variogram), COLD, up=15)
        _write(axes, remark(fit, used), WARM, up=4)
        _draw(axes, fit, used, reach)
        if k % layout.columns == 0:
            axes.set_ylabel("semivariance (10³ kPa²)", size=TEXT)
        if k + layout.columns >= len(fits):
            axes.set_xlabel("distance (m)", size=TEXT)
    return figure


def parameters(model: Bounded | Nested) -> str:
    """Nugget and sill in 1000 kPa2 and the range, in a few words."""
    nugget, sill = model.nugget / _THOUSAND, model.sill / _THOUSAND
    return f"nugget {nugget:.3g}, sill {sill:.3g}, range {model.range:.0f} m"


def remark(fit: Fit, used: Variogram) -> str:
    """What to know of a fit, in a few words: a prior, a bound, another model; else empty."""
    words = []
    if fit.is_prior:
        words.append("prior, not a fit")
    elif fit.at_bound:
        words.append(f"{' and '.join(fit.at_bound)} at bound")
    if type(used) is not type(fit.variogram) and isinstance(used, Bounded):
        words.append(f"kriged as {name_of(used)}")
    return "; ".join(words)


def _reach(fits: Sequence[Fit]) -> float:
    """Distance in m up to which to draw: the bins', or beyond the range where there are none."""
    last = max((fit.empirical.lag[-1] for fit in fits if fit.empirical.lag.size), default=0.0)
    return 1.08 * float(last) if last else 1.3 * max(fit.variogram.range for fit in fits)


def _draw(axes: Axes, fit: Fit, used: Variogram, reach: float) -> None:
    bins, model = fit.empirical, fit.variogram
    lag = np.linspace(0.0, reach, 300)[1:]
    axes.plot(lag, semivariance(model, lag) / _THOUSAND, color=COLD, label="fitted")
    if type(used) is not type(model) and isinstance(used, Bounded):
        axes.plot(lag, semivariance(used, lag) / _THOUSAND, "--", color=WARM, label="kriged")
    if bins.lag.size:
        size = 8.0 + 50.0 * bins.pairs / bins.pairs.max()
        axes.scatter(
            bins.lag, bins.semivariance / _THOUSAND, s=size, color=INK, alpha=0.7, clip_on=False
        )
    top = max(model.sill, bins.semivariance.max(initial=0.0)) / _THOUSAND
    axes.set(xlim=(0, reach), ylim=(0, 1.25 * top))
    _count_pairs(axes, bins.lag, bins.pairs)
    axes.locator_params(axis="y", nbins=5)
    axes.yaxis.set_major_formatter("{x:g}")
    axes.spines[["top", "right"]].set_visible(False)


def _write(axes: Axes, words: str, colour: str, *, up: float) -> None:
    """Write words above a panel, some points up."""
    axes.annotate(
        words, (0, 1), xytext=(0, up), xycoords="axes fraction", textcoords="offset points",
        size=SMALL, color=colour,
    )  # fmt: skip


def _count_pairs(axes: Axes, lag: Floats, pairs: Integers) -> None:
    """Write the pairs of each bin above it, a line lower where the last one is close."""
    lower, last = False, -np.inf
    for x, number in zip(lag, pairs, strict=True):
        lower = not lower and x - last < _CLOSE * axes.get_xlim()[1]
        last = x
        axes.text(
            x, 0.935 if lower else 0.995, str(number), size=6, color=FAINT, ha="center",
            va="top", transform=axes.get_xaxis_transform(), gid="pairs",
        )  # fmt: skip
