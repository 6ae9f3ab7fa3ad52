"""What a GIS sees of files of format 0, by the rules of that format; nothing writes them."""

from __future__ import annotations

import numpy as np
from shapely.geometry import LineString, Point

from subsoil.journal.gis import STATES, Row, boundary_rows, kpa_columns
from subsoil.layers import Layers, LayerState
from subsoil.penetrometer import Profile, profile_of
from subsoil.reports import Sampled
from subsoil.survey import Survey
from subsoil.survey.agents import Stop
from subsoil.survey.measured import mappable
from subsoil.survey.state import NOWHERE
from subsoil.ways.routing import way


def rows(survey: Survey) -> dict[str, list[Row]]:
    """Rows of every layer, given the state at the file's end."""
    refusals = [stop for stop in survey.stops if stop.refusal is not None]
    return {
        "boundary": list(boundary_rows(survey.field)),
        "samples": [
            _sample(survey, stop, report) for stop in survey.stops for report in stop.readings
        ],
        "refusals": [
            Row(
                Point(stop.refusal.at),
                {
                    "id": stop.refusal.id, "cell": stop.cell, "reason": stop.refusal.reason,
                    "tries": stop.refusal.tries,
                },
            )
            for stop in refusals
            if stop.refusal is not None
        ],
        "targets": [
            Row(Point(survey.access.at[cell]), {"cell": cell, "rank": rank})
            for rank, cell in enumerate(_planned(survey), start=1)
        ],
        "route": _route(survey),
    }  # fmt: skip


def _sample(survey: Survey, stop: Stop, report: Sampled) -> Row:
    columns = kpa_columns(survey.layers)
    values = {
        "id": report.id,
        "cell": stop.cell,
        "depth_m": report.reading.depth_m[-1] if report.reading.depth_m else 0.0,
        "tries": report.tries,
    }
    if mappable(survey, report):
        profile = profile_of(report.reading, survey.cone)
        kpa, state = unweighted_means(survey.layers, profile)
        values |= dict(zip(columns, (None if np.isnan(v) else float(v) for v in kpa), strict=True))
        values["states"] = ", ".join(STATES[LayerState(s)] for s in state)
    return Row(Point(report.at), values)


def _planned(survey: Survey) -> tuple[int, ...]:
    """Cells still to visit: a stop with pushes still due was none."""
    begun = (lease.cell for lease in survey.leases if not lease.made)
    return (*begun, *survey.plan.cells)


def _route(survey: Survey) -> list[Row]:
    """The way through all stops, from the centre of the cell that was left last."""
    cells = _planned(survey)
    if not cells:
        return []
    made = [stop.cell for stop in survey.stops if stop.cell != NOWHERE]
    start = survey.access.at[made[-1]] if made else survey.settings.start
    places = way(survey.access, start, survey.access.at[list(cells)])
    line = LineString(places)
    return [Row(line, {"metres": line.length})]


def unweighted_means(layers: Layers, profile: Profile) -> tuple[np.ndarray, np.ndarray]:
    """(m,) kPa and states of a profile by the rule of format 0.

    Layer (a, b] takes the mean of the readings with a < d <= b, each alike, and a layer between
    two readings takes the lower one.
    """
    depth, kpa = profile.depth_m, profile.kpa
    values = np.full(len(layers), np.nan)
    state = np.full(len(layers), LayerState.UNREACHED, dtype=np.int8)
    spacing = float(np.median(np.diff(depth))) if depth.size > 1 else 0.0
    end = depth[-1] if depth.size else 0.0
    for k, (top, bottom) in enumerate(zip(layers.top_m, layers.bottom_m, strict=True)):
        inside = (depth > top + 1e-9) & (depth <= bottom + 1e-9)
        if not inside.any():
            inside = depth == depth[depth > bottom].min(initial=np.inf)
        if not inside.any():
            continue
        mean = kpa[inside].mean()
        if end >= bottom - spacing / 2 - 1e-9:
            values[k], state[k] = mean, LayerState.MEASURED
        elif profile.ending == "force":
            gone = (end - top) / (bottom - top)
            values[k] = gone * mean + (1 - gone) * kpa[-1]
            state[k] = LayerState.AT_LEAST
    return values, state
