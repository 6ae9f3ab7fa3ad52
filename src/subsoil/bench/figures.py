"""Pictures of a benchmark: how errors, ways and variances compare between entrants."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import cycle
from typing import TYPE_CHECKING

import numpy as np

from subsoil.bench.comparison import Mean, ResultTable, curves, mean_of, paired
from subsoil.bench.hand_survey import HandSurveys
from subsoil.bench.paper import MARKS, NORMALISED_RMSE, PATH_M, RMSE_KPA
from subsoil.bench.tables import MINUTES, calibration
from subsoil.bench.task import Entrant, Result, Snapshot
from subsoil.plots.sheet import COLD, FAINT, INK, SMALL, TEXT, WARM, Sheet, blank, head, sheet

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


_COLOURS = (
    "#999999", "#56b4e9", "#8c6d31", "#d55e00", "#cc79a7", "#0072b2", "#009e73", "#1a1a1a",
    "#e69f00", "#7b3294",
)  # fmt: skip
_MARKERS = "osD^v<>phd"
_THOUSAND = 1000.0
_SETTLED = 5
"""Samples from which variances are drawn: fewer tell too little of the variogram."""


def learning(results: ResultTable, caption: str) -> Figure:
    """Error and way by number of samples, with the paper's numbers as faint open marks."""
    layout = Sheet(2, 2, 3.8, 3.2, 0.3, 0.75, 0.65, 0.25, 0.65, 1.25)
    figure = blank(layout.size, "Error and way by number of samples", caption)
    left, right = layout.panel(figure, 0), layout.panel(figure, 1)
    _by_samples(left, results, lambda row: row.rmse_kpa, RMSE_KPA)
    _by_samples(right, results, lambda row: row.path_m, PATH_M)
    _finish(left, "Error of the map", "samples", "RMSE (kPa)")
    _finish(right, "Way driven, log scale", "samples", "way (m)")
    right.set_yscale("log")
    ticks = [500, 1000, 2000, 5000]
    right.set_yticks(ticks, [str(tick) for tick in ticks])
    right.minorticks_off()
    for axes in (left, right):
        axes.set_xticks(results.samples)
    _legend(figure, left)
    return figure


def time_quality(results: ResultTable, caption: str) -> Figure:
    """Error against time for driving and probing, at each number of samples."""
    layout = Sheet(1, 1, 6.2, 3.8, 0.3, 0.0, 0.65, 0.25, 0.65, 1.25)
    figure = blank(layout.size, "Error of the map by time spent", caption)
    axes = layout.panel(figure, 0)
    for entrant, colour, marker in _looks(results):
        minutes, error = (
            [
                mean_of(list(results.at(entrant, n, value).values())).mean
                for n in results.samples
            ]
            for value in (lambda row: row.minutes, lambda row: row.rmse_kpa)
        )  # fmt: skip
        axes.plot(
            minutes, error, color=colour, marker=marker, markersize=4.5, linewidth=1.3,
            label=results.label(entrant),
        )  # fmt: skip
    axes.axvline(MINUTES, color=FAINT, linestyle=":", linewidth=1.0)
    _finish(
        axes,
        "One mark for each number of samples",
        "time for driving and probing (min)",
        "RMSE (kPa)",
    )
    _legend(figure, axes)
    return figure


def variance_and_error(results: ResultTable, caption: str) -> Figure:
    """Mean kriging variance and squared error over the samples of the longest surveys."""
    entrants = results.entrants
    layout = sheet(len(entrants), 1.25, strip=0.5, across=0.45, left=0.6, right=0.2, bottom=0.8)
    figure = blank(layout.size, "Kriging variance and squared error, sample by sample", caption)
    panels = [layout.panel(figure, k) for k in range(len(entrants))]
    top = 0.0
    for k, (axes, entrant) in enumerate(zip(panels, entrants, strict=True)):
        surveys = list(results.by_entrant[entrant].values())
        top = max(
            top,
            _band(axes, surveys, lambda row: row.mean_kv, COLD, "mean KV"),
            _band(axes, surveys, lambda row: row.rmse_kpa**2, WARM, "mean squared error"),
        )
        head(axes, results.label(entrant))
        if k % layout.columns == 0:
            axes.set_ylabel("10³ kPa²", size=TEXT)
        if k + layout.columns >= len(entrants):
            axes.set_xlabel("samples", size=TEXT)
        _tidy(axes)
    for axes in panels:
        axes.set_ylim(0, 1.05 * top)
    _legend(figure, panels[0])
    return figure


def calibrations(results: ResultTable, caption: str) -> Figure:
    """Error that maps expected over the error they had, by number of samples."""
    layout = Sheet(1, 1, 6.2, 3.4, 0.3, 0.0, 0.65, 0.25, 0.65, 1.25)
    figure = blank(layout.size, "Error expected over error made", caption)
    axes = layout.panel(figure, 0)
    _by_samples(axes, results, calibration, {})
    axes.axhline(1.0, color=INK, linewidth=0.8)
    axes.set_xticks(results.samples)
    _finish(axes, "Root mean KV / RMSE; 1 is right, below it overconfident", "samples", "ratio")
    _legend(figure, axes)
    return figure


def differences(results: ResultTable, caption: str) -> Figure:
    """Differences in error to each reference strategy, paired by field, with 95 % intervals."""
    references = results.references
    rows = len(results.entrants)
    height = max(1.6, 0.34 * rows)
    layout = Sheet(len(references), len(references), 2.5, height, 0.3, 0.25, 1.75, 0.2, 0.65, 0.85)
    figure = blank(layout.size, "Difference in error on the same fields", caption)
    for k, reference in enumerate(references):
        axes = layout.panel(figure, k)
        _forest(axes, results, reference)
        head(axes, f"minus {results.label(reference)}")
        axes.set_xlabel("RMSE difference (kPa)", size=TEXT)
        names = [results.label(entrant) for entrant in results.entrants] if k == 0 else []
        axes.set_yticks(range(rows), names or [""] * rows)
        _tidy(axes)
        if k == 0:
            _legend(figure, axes)
    return figure


def by_layer(hand: HandSurveys, caption: str) -> Figure:
    """Mean of each layer with the error of a survey by hand, and its ratio beside the paper's."""
    layout = Sheet(2, 2, 3.5, 3.2, 0.3, 1.15, 1.1, 0.25, 0.65, 0.85)
    figure = blank(layout.size, "A survey by hand against the dense one, layer by layer", caption)
    left, right = layout.panel(figure, 0), layout.panel(figure, 1)
    mean, rmse = hand.mean_kpa.mean(axis=0), hand.rmse_kpa.mean(axis=0)
    place = np.arange(len(hand.layers))
    left.barh(place, mean, xerr=rmse, color="#9db7dd", ecolor=INK, capsize=3, height=0.7)
    _finish(left, "Mean; bars: RMSE of the survey by hand", "resistance (kPa)", "layer")
    ratio = [mean_of(layer) for layer in (hand.rmse_kpa / hand.mean_kpa).T]
    right.errorbar(
        [m.mean for m in ratio], place, xerr=[m.half for m in ratio], fmt="o", color=COLD,
        markersize=4, capsize=3, label="here, with 95 % interval",
    )  # fmt: skip
    printed = [(x, k) for k, x in enumerate(NORMALISED_RMSE[: len(place)]) if x is not None]
    right.plot(*zip(*printed, strict=True), "D", color=WARM, markersize=4, label="paper, one field")
    right.set_xscale("log")
    right.set_xlim(0.5 * min(m.mean for m in ratio), 6)
    right.xaxis.set_major_formatter("{x:g}")
    right.minorticks_off()
    _finish(right, "RMSE / mean, log scale", "ratio", "layer")
    for axes in (left, right):
        axes.set_yticks(place, hand.layers)
        axes.invert_yaxis()
    _legend(figure, right)
    return figure


def _looks(results: ResultTable) -> list[tuple[Entrant, str, str]]:
    """Colour and marker of every entrant."""
    looks = zip(cycle(_COLOURS), cycle(_MARKERS))
    return [
        (entrant, colour, marker)
        for entrant, (colour, marker) in zip(results.entrants, looks, strict=False)
    ]


def _by_samples(
    axes: Axes,
    results: ResultTable,
    value: Callable[[Snapshot], float],
    printed: Mapping[str, Sequence[float]],
) -> None:
    """Means with intervals at each number of samples, side by side, and the paper's numbers."""
    looks = _looks(results)
    gap = float(np.diff(results.samples).min()) if len(results.samples) > 1 else 1.0
    aside = gap * 0.09 * (np.arange(len(looks)) - (len(looks) - 1) / 2)
    for (entrant, colour, marker), shift in zip(looks, aside, strict=True):
        means = [mean_of(list(results.at(entrant, n, value).values())) for n in results.samples]
        x = np.array(results.samples) + shift
        axes.errorbar(
            x, [m.mean for m in means], yerr=[m.half for m in means], color=colour, marker=marker,
            markersize=4.5, linewidth=1.3, elinewidth=0.8, label=results.label(entrant),
        )  # fmt: skip
        paper = dict(zip(MARKS, printed.get(entrant.strategy, ()), strict=False))
        known = [(a, paper[n]) for a, n in zip(x, results.samples, strict=True) if n in paper]
        if known:
            axes.plot(
                *zip(*known, strict=True), linestyle="none", marker=marker, markersize=4,
                markerfacecolor="none", markeredgecolor=colour, alpha=0.6,
            )  # fmt: skip


def _band(
    axes: Axes,
    results: Sequence[Result],
    value: Callable[[Snapshot], float],
    colour: str,
    name: str,
) -> float:
    """Mean curve over fields with its 95 % band in 1000 kPa2; returns its highest point."""
    n, values = curves(results, value)
    settled = n >= min(_SETTLED, n[-1])
    n, values = n[settled], values[:, settled] / _THOUSAND
    means: list[Mean] = [mean_of(column) for column in values.T]
    middle, half = (np.array([getattr(m, part) for m in means]) for part in ("mean", "half"))
    axes.plot(n, middle, color=colour, linewidth=1.4, label=name)
    if np.isfinite(half).all():
        axes.fill_between(n, middle - half, middle + half, color=colour, alpha=0.2, linewidth=0)
    return float(middle.max())


def _forest(axes: Axes, results: ResultTable, reference: Entrant) -> None:
    """One point with its interval for each entrant and number of samples."""
    shades = np.linspace(0.35, 1.0, len(results.samples))
    offsets = np.linspace(-0.27, 0.27, len(results.samples))
    for n, shade, offset in zip(results.samples, shades, offsets, strict=True):
        theirs = results.at(reference, n, lambda row: row.rmse_kpa)
        found = [
            paired(results.at(entrant, n, lambda row: row.rmse_kpa), theirs).difference
            for entrant in results.entrants
        ]
        others = [k for k, entrant in enumerate(results.entrants) if entrant != reference]
        axes.errorbar(
            [found[k].mean for k in others], np.array(others) + offset,
            xerr=[found[k].half for k in others], fmt="o", color=COLD, alpha=shade,
            markersize=3.2, elinewidth=1.0, label=f"n = {n}",
        )  # fmt: skip
    axes.axvline(0.0, color=INK, linewidth=0.8)
    axes.set_ylim(len(results.entrants) - 0.5, -0.5)


def _finish(axes: Axes, name: str, x: str, y: str) -> None:
    head(axes, name)
    axes.set_xlabel(x, size=TEXT)
    axes.set_ylabel(y, size=TEXT)
    _tidy(axes)


def _tidy(axes: Axes) -> None:
    axes.tick_params(labelsize=SMALL)
    axes.grid(color="#e5e5e5", linewidth=0.6)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)


def _legend(figure: Figure, axes: Axes) -> None:
    """One legend at the foot, in as many columns as fit."""
    handles, names = axes.get_legend_handles_labels()
    width, height = figure.get_size_inches()
    fit = int((width - 0.4) / (0.45 + 0.055 * max(map(len, names))))
    figure.legend(
        handles, names, loc="lower center", ncols=min(fit, len(names)), fontsize=SMALL,
        bbox_to_anchor=(0.5, 0.06 / height), frameon=False,
    )  # fmt: skip
