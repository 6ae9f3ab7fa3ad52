"""How a map got better with every sample, and what that cost."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from subsoil.arrays import Floats
from subsoil.errors import ReadingsError
from subsoil.plots.sheet import (
    COLD,
    FAINT,
    SMALL,
    TEXT,
    WARM,
    Sheet,
    blank,
    head,
    letters,
    room_of,
    width_of,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from subsoil.plots.sheet import Drawn
    from subsoil.survey.outlook import Outlook
    from subsoil.survey.progress import Progress


_MOST_TICKS = 7
_THOUSAND = 1000.0
_OUTLOOK = Sheet(1, 1, 6.0, 3.2, 0.3, 1.0, 0.85, 0.25, 0.65, 0.65)
_LEAST = (2.5, 1.2)
_TICKS = 0.5
"""Inches of the ticks of a panel above the next one."""


def learning_curves(
    history: Sequence[Progress], *, caption: str = "", figure: Drawn | None = None
) -> Drawn:
    """Error and kriging variance against samples, with metres and minutes under the samples.

    The error is drawn where there is a truth, beside the root of the mean kriging variance: the
    error that the map itself expects. One sample alone has no variance but an assumed one, which
    is not drawn. Of several entries for one number of samples the last counts.

    Parameters
    ----------
    history
        Where the survey stood after its samples.
    caption
        What to say under the title.
    figure
        Figure or part of one to draw into, within its size. Default: a new one.

    Returns
    -------
    Figure or SubFigure
        What was drawn into.

    Raises
    ------
    ReadingsError
        If the history is empty.
    ParameterError
        If the figure is too small.
    MissingExtraError
        If matplotlib is not installed.
    """
    if not history:
        raise ReadingsError(
            "there is nothing to draw: the history has no sample", where="learning curves"
        )
    last = {now.samples: now for now in history}
    entries = [last[samples] for samples in sorted(last)]
    rmse = np.array([now.rmse for now in entries])
    kv = np.array([now.mean_kv if now.samples > 1 else np.nan for now in entries])
    known = bool(np.isfinite(rmse).any())
    layout = Sheet(
        1 + known, 1 + known, 4.4, 2.7, _TICKS + 0.3, 1.0, 0.85, 0.25, 0.65 - _TICKS, 0.75
    )
    layout = layout.filling(room_of(figure), _LEAST)
    drawn = blank(layout.size, "What every sample brought", caption, figure)
    samples = np.array([now.samples for now in entries], dtype=float)
    if known:
        axes = layout.panel(drawn, 0)
        _head(axes, "Error of the map, all layers")
        _curve(axes, samples, rmse, WARM, "against the simulated truth (RMSE)", "o-")
        _curve(axes, samples, np.sqrt(kv), COLD, "as the map expects it (root mean KV)", "s--")
        axes.legend(fontsize=SMALL, frameon=False, loc="best")
        _label(axes, entries, "error (kPa)")
    axes = layout.panel(drawn, int(known))
    _head(axes, "Kriging variance, mean over cells and layers")
    _curve(axes, samples, kv / _THOUSAND, COLD, "mean KV", "s-")
    _label(axes, entries, "mean KV (10³ kPa²)")
    if not np.isfinite(kv).any():
        _say_unknown(axes)
    return drawn


def outlook_curve(
    history: Sequence[Progress],
    outlook: Outlook,
    *,
    caption: str = "",
    figure: Drawn | None = None,
) -> Drawn:
    """Error as the map expects it against samples: so far, and what more samples would buy.

    Parameters
    ----------
    history
        Where the survey stood after its samples.
    outlook
        What more would buy.
    caption
        What to say under the title.
    figure
        Figure or part of one to draw into, within its size. Default: a new one.

    Returns
    -------
    Figure or SubFigure
        What was drawn into.

    Raises
    ------
    ReadingsError
        If there is nothing ahead: there are too few samples, or no cell is left.
    ParameterError
        If the figure is too small.
    MissingExtraError
        If matplotlib is not installed.
    """
    _check(outlook)
    layout = _OUTLOOK.filling(room_of(figure), _LEAST)
    drawn = blank(layout.size, "What more samples would buy", caption, figure)
    outlook_panel(history, outlook, ax=layout.panel(drawn, 0))
    return drawn


def outlook_panel(history: Sequence[Progress], outlook: Outlook, *, ax: Axes) -> Axes:
    """Draw the error so far and with more samples into axes, as :func:`outlook_curve` does.

    Parameters
    ----------
    history, outlook
        As in :func:`outlook_curve`.
    ax
        Axes to draw into.

    Returns
    -------
    Axes
        Those axes.

    Raises
    ------
    ReadingsError
        If there is nothing ahead: there are too few samples, or no cell is left.
    """
    _check(outlook)
    _head(ax, "Error of the map as it expects it (root mean KV)")
    now = outlook.samples
    past = np.array([(entry.samples, np.sqrt(entry.mean_kv)) for entry in history])
    ahead = np.array([(now, outlook.rmse), *((now + e.more, e.rmse) for e in outlook.ahead)])
    planned = ahead[: outlook.planned + 1]
    _curve(ax, past[:, 0], past[:, 1], COLD, "so far, as then foreseen", "s-")
    _curve(ax, ahead[:, 0], ahead[:, 1], FAINT, "with more samples, where they tell most", "--")
    if len(planned) > 1:
        _curve(ax, planned[:, 0], planned[:, 1], WARM, "with the planned stops", "o-")
    ax.legend(fontsize=SMALL, frameon=False, loc="best")
    ax.set_ylim(bottom=0)
    ax.set_xlabel("samples", size=TEXT)
    ax.set_ylabel("predicted RMSE (kPa)", size=TEXT)
    ax.grid(color="#e5e5e5", linewidth=0.6)
    ax.set_axisbelow(True)
    ax.spines[["top", "right"]].set_visible(False)
    return ax


def _head(axes: Axes, name: str) -> None:
    """Name above a panel, in letters with which it does not reach the next one."""
    head(axes, name, size=letters([name], TEXT, width_of(axes) + 0.2))


def _check(outlook: Outlook) -> None:
    if not outlook.ahead:
        raise ReadingsError("there is nothing to foresee from so few samples", where="outlook")


def _say_unknown(axes: Axes) -> None:
    axes.set_yticks([])
    axes.text(
        0.5, 0.5, "one sample alone\ntells no variance", transform=axes.transAxes, size=SMALL,
        color=FAINT, ha="center", va="center",
    )  # fmt: skip


def _curve(axes: Axes, x: Floats, y: Floats, colour: str, name: str, look: str) -> None:
    if not np.isfinite(y).any():
        return
    axes.plot(x, y, look, color=colour, label=name, linewidth=1.4, markersize=3)


def _label(axes: Axes, entries: Sequence[Progress], unit: str) -> None:
    """Axes from zero, and samples, metres and minutes under the lower one."""
    picks = np.unique(np.linspace(0, len(entries) - 1, _MOST_TICKS).round().astype(int))
    ticks = [entries[k] for k in picks]
    axes.set_xticks(
        [now.samples for now in ticks],
        [f"{now.samples}\n{now.metres:.0f}\n{now.minutes:.0f}" for now in ticks],
    )
    axes.annotate(
        "samples\nm driven\nmin", (0, 0), xytext=(-14, -7), xycoords="axes fraction",
        textcoords="offset points", size=SMALL, color=FAINT, ha="right", va="top",
    )  # fmt: skip
    first, last = entries[0].samples, entries[-1].samples
    axes.set_xlim(first - 0.5, last + 0.5)
    axes.set_ylim(bottom=0)
    axes.set_ylabel(unit, size=TEXT)
    axes.grid(color="#e5e5e5", linewidth=0.6)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
