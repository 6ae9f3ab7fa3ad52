"""What a GIS sees of a survey file: its layers, drawn from events."""

from __future__ import annotations

import sqlite3
from itertools import pairwise

import numpy as np
from shapely.geometry import LineString, MultiPolygon, Point
from shapely.geometry.polygon import Polygon

from subsoil.events import Event, Planned, Refused, Sampled
from subsoil.geopackage import add_layer, insert
from subsoil.layers import Layers, LayerState
from subsoil.routing import way
from subsoil.survey import Survey, sample_of
from subsoil.travel import travel_of

_STATES = {
    LayerState.MEASURED: "measured",
    LayerState.AT_LEAST: "at least",
    LayerState.UNREACHED: "unreached",
}


def kpa_columns(layers: Layers) -> tuple[str, ...]:
    """Column of each layer's value in the samples layer, such as ``kpa_15_20cm``."""
    edges = [f"{100 * edge:g}".replace(".", "p") for edge in layers.edges_m]
    return tuple(f"kpa_{a}_{b}cm" for a, b in pairwise(edges))


def create(database: sqlite3.Connection, srs: int, survey: Survey) -> None:
    """Make the layers, empty but for the boundary."""
    values = kpa_columns(survey.layers)
    kinds: dict[str, tuple[str, dict[str, str], str]] = {
        "boundary": (
            "MULTIPOLYGON",
            {"name": "TEXT", "role": "TEXT", "area_ha": "REAL"},
            "Outline of the field and its keep-outs",
        ),
        "samples": (
            "POINT",
            {
                "id": "TEXT UNIQUE", "cell": "INTEGER", "depth_m": "REAL", "tries": "INTEGER",
                **dict.fromkeys(values, "REAL"), "states": "TEXT",
            },
            "Places probed, with mean kPa by layer",
        ),
        "refusals": (
            "POINT",
            {"id": "TEXT UNIQUE", "cell": "INTEGER", "reason": "TEXT", "tries": "INTEGER"},
            "Places where no push gave a reading",
        ),
        "targets": ("POINT", {"cell": "INTEGER", "rank": "INTEGER"}, "Stops still to make"),
        "route": ("LINESTRING", {"metres": "REAL"}, "Way through the stops still to make"),
    }  # fmt: skip
    for table, (geometry, columns, description) in kinds.items():
        add_layer(
            database, table, geometry, columns,
            srs=srs, bounds=survey.field.boundary.bounds, description=description,
        )  # fmt: skip
    field = survey.field
    outlines = [("field", field.boundary), *(("keep-out", area) for area in field.keep_outs)]
    for role, area in outlines:
        parts = MultiPolygon([area]) if isinstance(area, Polygon) else area
        values_of = {"name": field.name, "role": role, "area_ha": area.area / 10_000}
        insert(database, "boundary", parts, srs, values_of)


def draw(database: sqlite3.Connection, srs: int, event: Event, survey: Survey) -> None:
    """Show an event in the layers, given the state after it."""
    match event:
        case Sampled():
            insert(database, "samples", Point(event.at), srs, _sample_row(event, survey))
            _draw_plan(database, srs, survey)
        case Refused():
            row = {
                "id": event.id, "cell": event.cell, "reason": event.reason, "tries": event.tries
            }  # fmt: skip
            insert(database, "refusals", Point(event.at), srs, row)
            _draw_plan(database, srs, survey)
        case Planned():
            _draw_plan(database, srs, survey)


def sample_rows(database: sqlite3.Connection, layers: Layers) -> dict[str, tuple[object, ...]]:
    """Values of the samples layer by report id, in the order of :func:`kpa_columns`."""
    columns = ", ".join(kpa_columns(layers))
    rows = database.execute(f"SELECT id, {columns} FROM samples")
    return {row[0]: tuple(row[1:]) for row in rows}


def sample_values(event: Sampled, survey: Survey) -> tuple[object, ...]:
    """What the samples layer says of a push: kPa by layer, ``None`` where unreached."""
    kpa = sample_of(survey, event).kpa
    return tuple(None if np.isnan(value) else float(value) for value in kpa)


def srs_of(database: sqlite3.Connection) -> int:
    """Id of the reference system the layers are in."""
    query = "SELECT srs_id FROM gpkg_geometry_columns WHERE table_name = 'samples'"
    return int(database.execute(query).fetchone()[0])


def _sample_row(event: Sampled, survey: Survey) -> dict[str, object]:
    states = sample_of(survey, event).state
    return {
        "id": event.id,
        "cell": event.cell,
        "depth_m": event.depth_m[-1] if event.depth_m else 0.0,
        "tries": event.tries,
        **dict(zip(kpa_columns(survey.layers), sample_values(event, survey), strict=True)),
        "states": ", ".join(_STATES[LayerState(state)] for state in states),
    }


def _draw_plan(database: sqlite3.Connection, srs: int, survey: Survey) -> None:
    database.execute("DELETE FROM targets")
    database.execute("DELETE FROM route")
    stops = survey.field.cells[list(survey.plan)]
    for rank, (cell, stop) in enumerate(zip(survey.plan, stops, strict=True)):
        insert(database, "targets", Point(stop), srs, {"cell": cell, "rank": rank + 1})
    if survey.plan:
        line = LineString(way(travel_of(survey.field), survey.position, stops))
        insert(database, "route", line, srs, {"metres": line.length})
