"""Variograms of all layers: bins with their pairs, and the curves laid through them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from subsoil.arrays import Floats, Integers
from subsoil.errors import ParameterError
from subsoil.plots.sheet import (
    COLD,
    FAINT,
    INK,
    SMALL,
    TEXT,
    WARM,
    blank,
    head,
    least_length,
    letters,
    room_of,
    sheet,
    width_of,
)
from subsoil.plots.subject import Soil, subject
from subsoil.variogram import Bounded, Fit, Nested, Variogram, name_of, semivariance

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from subsoil.plots.sheet import Drawn


_THOUSAND = 1000.0
_GAMMA = "semivariance (10³ kPa²)"
_LEAST = (0.9, 0.5)
_BEYOND = 0.15
"""Inches by which words above a panel may be longer than it."""
_PAIRS, _LETTER_WIDTH, _APART = 6, 0.01, 0.06
"""Size of the numbers of pairs in points, inches a digit and point, and inches between them."""


def variograms(
    fits: Sequence[Fit], soil: Soil, *, caption: str = "", figure: Drawn | None = None
) -> Drawn:
    """Empirical variogram of every layer with the number of pairs in each bin, and its curve.

    A dashed second curve shows what a layer was kriged with, where that is another model.

    Parameters
    ----------
    fits
        How the variograms were come by, one a layer.
    soil
        Map kriged with them, or the survey whose map it is.
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
    ParameterError
        If there is not one fit a layer, or the figure is too small.
    MissingExtraError
        If matplotlib is not installed.
    """
    found = subject(soil)
    names, models = found.soil_map.layers.names, found.soil_map.kriged_with
    if len(fits) != len(names):
        raise ParameterError(
            f"{len(fits)} fits for {len(names)} layers",
            where="variograms",
            remedy="give one a layer",
        )
    natural = sheet(len(fits), 1.3, strip=0.8, across=0.52, left=0.65, right=0.2, bottom=0.5)
    words = [line for fit, used in zip(fits, models, strict=True) for line in remarks(fit, used)]
    least = max(_LEAST[0], least_length(words) - _BEYOND)
    layout = natural.filling(room_of(figure), (least, _LEAST[1]))
    legend = "small numbers: pairs of samples in each bin"
    drawn = blank(layout.size, "Variograms", f"{caption or found.cost}; {legend}", figure)
    size = letters(words, SMALL, layout.width + _BEYOND)
    for k, (name, fit, used) in enumerate(zip(names, fits, models, strict=True)):
        axes = layout.panel(drawn, k)
        head(axes, f"{name}, {name_of(fit.variogram)}", lift=24, size=size * TEXT / SMALL)
        _write(axes, parameters(fit.variogram), COLD, size, up=15)
        _write(axes, remark(fit, used), WARM, size, up=4)
        _draw(axes, fit, used, _reach(fits))
        if k % layout.columns == 0:
            axes.set_ylabel(_GAMMA, size=letters([_GAMMA], TEXT, layout.height + 0.7))
        if k + layout.columns >= len(fits):
            axes.set_xlabel("distance (m)", size=TEXT)
    return drawn


def variogram_panel(fit: Fit, *, ax: Axes) -> Axes:
    """Draw one empirical variogram, the pairs in its bins, and the curve fitted to it into axes.

    Parameters
    ----------
    fit
        How the variogram was come by.
    ax
        Axes to draw into.

    Returns
    -------
    Axes
        Those axes.
    """
    _draw(ax, fit, fit.variogram, _reach([fit]))
    ax.set_ylabel(_GAMMA, size=TEXT)
    ax.set_xlabel("distance (m)", size=TEXT)
    ax.tick_params(labelsize=SMALL)
    return ax


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


def remarks(fit: Fit, used: Variogram) -> tuple[str, str]:
    """Lines above a panel."""
    return parameters(fit.variogram), remark(fit, used)


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


def _write(axes: Axes, words: str, colour: str, size: float, *, up: float) -> None:
    """Write words above a panel, some points up."""
    axes.annotate(
        words, (0, 1), xytext=(0, up), xycoords="axes fraction", textcoords="offset points",
        size=size, color=colour,
    )  # fmt: skip


def _count_pairs(axes: Axes, lag: Floats, pairs: Integers) -> None:
    """Write the pairs of each bin above it, a line lower where the last one is close.

    A number that has room in neither line is left out.
    """
    metre = width_of(axes) / axes.get_xlim()[1]
    ends = {0.995: -np.inf, 0.935: -np.inf}
    for x, number in zip(lag * metre, pairs, strict=True):
        half = 0.5 * _PAIRS * _LETTER_WIDTH * len(str(number))
        free = [y for y, end in ends.items() if x - half > end]
        if not free:
            continue
        ends[free[0]] = x + half + _APART
        axes.text(
            x / metre, free[0], str(number), size=_PAIRS, color=FAINT, ha="center",
            va="top", transform=axes.get_xaxis_transform(), gid="pairs",
        )  # fmt: skip
