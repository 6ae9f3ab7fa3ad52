"""Where a survey went: the field with its stops, its way, and what is still planned."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from subsoil.arrays import Floats
from subsoil.errors import ReadingsError
from subsoil.plots.land import draw_foot, draw_land, draw_refusals, foot_height, frame
from subsoil.plots.sheet import COLD, INK, WARM, blank, room_of, sheet
from subsoil.plots.subject import subject
from subsoil.survey import Survey
from subsoil.ways import routing

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from subsoil.plots.sheet import Drawn


_LEAST = (1.9, 0.6)
_MARKS = 6


def route(survey: Survey, *, caption: str = "", figure: Drawn | None = None) -> Drawn:
    """Field with the samples of a survey, the way between them, refusals, and planned stops.

    Parameters
    ----------
    survey
        Survey to draw, finished or not.
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
        If there is neither a stop nor a plan.
    ParameterError
        If the figure is too small.
    MissingExtraError
        If matplotlib is not installed.
    """
    _ahead(survey)
    west, south, east, north = frame(survey.field)
    room = room_of(figure)
    layout = sheet(
        1, (east - west) / (north - south), strip=0.1, across=0.0, left=0.2, right=0.2,
        bottom=foot_height(room, _MARKS),
    ).within(room, _LEAST)  # fmt: skip
    title = f"Route of the survey, {survey.field.name}"
    drawn = blank(layout.size, title, caption or subject(survey).on_land, figure)
    axes = route_panel(survey, ax=layout.panel(drawn, 0))
    draw_foot(drawn, layout, survey.field, [axes])
    return drawn


def route_panel(survey: Survey, *, ax: Axes) -> Axes:
    """Draw the field, samples, way, refusals and planned stops of a survey into axes.

    The marks have names, for a legend.

    Parameters
    ----------
    survey
        Survey to draw, finished or not.
    ax
        Axes to draw into.

    Returns
    -------
    Axes
        Those axes.

    Raises
    ------
    ReadingsError
        If there is neither a stop nor a plan.
    """
    ahead = _ahead(survey)
    found = subject(survey)
    draw_land(ax, survey.field)
    if len(found.way):
        ax.plot(*found.way.T, color=COLD, linewidth=1.2, label="way between samples")
        ax.plot(*found.way[:1].T, "s", color="white", markeredgecolor=INK, label="start")
    if len(ahead):
        on = routing.way(survey.access, survey.position, ahead)
        ax.plot(*on.T, "--", color=WARM, linewidth=1.0)
        ax.plot(*ahead.T, "D", color="white", markeredgecolor=WARM, markersize=4, label="planned")
    if len(at := survey.soil_map.at):
        ax.plot(*np.asarray(at).T, "o", color=COLD, markersize=4, label="sample")
    if len(found.refused):
        draw_refusals(ax, found.refused)
    return ax


def _ahead(survey: Survey) -> Floats:
    """(k, 2) places in m of the stops handed out and planned, of a survey with any stop."""
    cells = [*(lease.cell for lease in survey.leases), *survey.plan.cells]
    if not survey.stops and not cells:
        raise ReadingsError(
            "there is nothing to draw: no stop was made or planned",
            where=survey.name,
            remedy="take samples or make a plan first",
        )
    return survey.access.at[cells]
