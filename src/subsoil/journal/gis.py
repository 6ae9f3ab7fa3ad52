"""What a GIS sees of a survey file: its layers, as rows that follow from a survey's state."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from shapely.geometry import LineString, MultiPolygon, Point
from shapely.geometry.base import BaseGeometry
from shapely.geometry.polygon import Polygon

from subsoil.journal.ahead import Ahead, Target, ahead_of
from subsoil.journal.geopackage import add_layer, insert
from subsoil.land.field import Field
from subsoil.layers import Layers, LayerState
from subsoil.reports import Refused, Sampled
from subsoil.survey import Survey, sample_of
from subsoil.survey.agents import Stop
from subsoil.survey.events import Amended, Event, Opened, Withdrawn
from subsoil.survey.measured import mappable
from subsoil.survey.state import stop_of
from subsoil.ways.routing import way

STATES = {
    LayerState.MEASURED: "measured",
    LayerState.AT_LEAST: "at least",
    LayerState.UNREACHED: "unreached",
}
LAYERS = ("boundary", "samples", "refusals", "targets", "route")


@dataclass(frozen=True)
class Row:
    """A feature of a layer."""

    geometry: BaseGeometry
    values: Mapping[str, object]


def kpa_columns(layers: Layers) -> tuple[str, ...]:
    """Column of each layer's value in the samples layer, such as ``kpa_15_20cm``."""
    edges = [f"{100 * edge:g}".replace(".", "p") for edge in layers.edges_m]
    return tuple(f"kpa_{a}_{b}cm" for a, b in pairwise(edges))


def tables_of(layers: Layers) -> dict[str, tuple[str, dict[str, str], str]]:
    """Geometry, columns and description of each layer."""
    report = {"id": "TEXT UNIQUE", "agent": "TEXT", "source": "TEXT", "time": "TEXT"}
    return {
        "boundary": (
            "MULTIPOLYGON",
            {"name": "TEXT", "role": "TEXT", "area_ha": "REAL"},
            "Outline of the field and its keep-outs",
        ),
        "samples": (
            "POINT",
            {
                **report, "cell": "INTEGER", "depth_m": "REAL", "tries": "INTEGER",
                **dict.fromkeys(kpa_columns(layers), "REAL"), "states": "TEXT", "flags": "TEXT",
                "accuracy_m": "REAL",
            },
            "Places probed, with mean kPa by layer",
        ),
        "refusals": (
            "POINT",
            {
                **report, "cell": "INTEGER", "reason": "TEXT", "cause": "TEXT",
                "tries": "INTEGER",
            },
            "Places where no push gave a reading",
        ),
        "targets": (
            "POINT",
            {"cell": "INTEGER", "stop": "INTEGER", "agent": "TEXT"},
            "Stops still to make",
        ),
        "route": (
            "LINESTRING",
            {"stop": "INTEGER", "metres": "REAL"},
            "Ways to the stops still to make",
        ),
    }  # fmt: skip


def create(database: sqlite3.Connection, srs: int, survey: Survey) -> None:
    """Make the layers, empty but for the boundary."""
    for table, (geometry, columns, description) in tables_of(survey.layers).items():
        add_layer(
            database, table, geometry, columns,
            srs=srs, bounds=survey.field.boundary.bounds, description=description,
        )  # fmt: skip
    for row in boundary_rows(survey.field):
        insert(database, "boundary", row.geometry, srs, row.values)


def draw(database: sqlite3.Connection, srs: int, event: Event, survey: Survey) -> None:
    """Show what an event says of samples and refusals, given the state after it."""
    match event:
        case Sampled():
            row = sample_row(survey, stop_of(survey, event), event)
            insert(database, "samples", row.geometry, srs, row.values)
        case Amended() | Withdrawn():
            database.execute("DELETE FROM samples WHERE id = ?", (event.report,))
            for stop in survey.stops:
                for report in stop.readings:
                    if report.id == event.report:
                        row = sample_row(survey, stop, report)
                        insert(database, "samples", row.geometry, srs, row.values)
        case Refused() if any(stop.refusal is event for stop in survey.stops):
            row = refusal_row(stop_of(survey, event), event)
            insert(database, "refusals", row.geometry, srs, row.values)
        case Opened():
            redraw(database, srs, survey)
    _draw_lapsed(database, srs, event, survey)


def _draw_lapsed(database: sqlite3.Connection, srs: int, event: Event, survey: Survey) -> None:
    """Show a stop that counts as refused since its lease ran out twice."""
    for stop in survey.stops[-1:]:
        if stop.refusal and stop.refusal.cause == "lapsed" and stop.refusal.id == event.id:
            row = refusal_row(stop, stop.refusal)
            insert(database, "refusals", row.geometry, srs, row.values)


def redraw(database: sqlite3.Connection, srs: int, survey: Survey) -> None:
    """Show a whole survey anew, but for its targets."""
    rows = {
        "boundary": boundary_rows(survey.field),
        "samples": sample_rows(survey),
        "refusals": refusal_rows(survey),
    }
    for table, entries in rows.items():
        database.execute(f"DELETE FROM {table}")
        for row in entries:
            insert(database, table, row.geometry, srs, row.values)


def clear_targets(database: sqlite3.Connection) -> None:
    """Show no stops still to make."""
    database.execute("DELETE FROM targets")
    database.execute("DELETE FROM route")


def draw_targets(database: sqlite3.Connection, srs: int, survey: Survey, drawn: Ahead) -> Ahead:
    """Show the stops still to make: only those change that are not as they were drawn."""
    ahead = ahead_of(survey)
    carried_on = drawn.cells[max(ahead.first - drawn.first, 0) :] == ahead.cells
    last = ahead.first if carried_on and ahead.first >= drawn.first else None
    before, after = drawn.targets(survey.access, last), ahead.targets(survey.access, last)
    for target in sorted(before - after):
        database.execute("DELETE FROM targets WHERE stop = ?", (target.stop,))
        database.execute("DELETE FROM route WHERE stop = ?", (target.stop,))
    for target in sorted(after - before):
        for table, row in target_rows(survey, target).items():
            insert(database, table, row.geometry, srs, row.values)
    return ahead


def target_rows(survey: Survey, target: Target) -> dict[str, Row]:
    """What targets and route show of a stop still to make."""
    at = survey.access.at[target.cell]
    rows = {
        "targets": Row(Point(at), {"cell": target.cell, "stop": target.stop, "agent": target.agent})
    }
    leg = LineString(way(survey.access, target.start, at[None]))
    return {**rows, "route": Row(leg, {"stop": target.stop, "metres": leg.length})}


def boundary_rows(field: Field) -> Iterator[Row]:
    """Outlines of a field and its keep-outs."""
    outlines = [("field", field.boundary), *(("keep-out", area) for area in field.keep_outs)]
    for role, area in outlines:
        parts = MultiPolygon([area]) if isinstance(area, Polygon) else area
        yield Row(parts, {"name": field.name, "role": role, "area_ha": area.area / 10_000})


def sample_rows(survey: Survey) -> Iterator[Row]:
    """Readings that count."""
    for stop in survey.stops:
        for report in stop.readings:
            yield sample_row(survey, stop, report)


def sample_row(survey: Survey, stop: Stop, report: Sampled) -> Row:
    """A reading: ``None`` for the kPa of layers it did not reach."""
    columns = kpa_columns(survey.layers)
    kpa: tuple[float | None, ...] = (None,) * len(columns)
    states = "not mapped"
    if mappable(survey, report):
        sample = sample_of(survey, report)
        kpa = tuple(None if np.isnan(value) else float(value) for value in sample.kpa)
        states = ", ".join(STATES[LayerState(state)] for state in sample.state)
    values = {
        **_about(report),
        "cell": stop.cell,
        "depth_m": max(report.reading.depth_m, default=0.0),
        "tries": report.tries,
        **dict(zip(columns, kpa, strict=True)),
        "states": states,
        "flags": ", ".join(report.reading.flags),
        "accuracy_m": report.accuracy_m,
    }
    return Row(Point(report.at), values)


def refusal_rows(survey: Survey) -> Iterator[Row]:
    """Stops that ended without a reading, or without a further one."""
    for stop in survey.stops:
        if stop.refusal is not None:
            yield refusal_row(stop, stop.refusal)


def refusal_row(stop: Stop, report: Refused) -> Row:
    """A stop without a reading."""
    values = {
        **_about(report),
        "cell": stop.cell,
        "reason": report.reason,
        "cause": report.cause,
        "tries": report.tries,
    }
    return Row(Point(report.at), values)


def srs_of(database: sqlite3.Connection) -> int:
    """Id of the reference system the layers are in."""
    query = "SELECT srs_id FROM gpkg_geometry_columns WHERE table_name = 'samples'"
    return int(database.execute(query).fetchone()[0])


def _about(report: Sampled | Refused) -> dict[str, object]:
    time = report.time.isoformat(timespec="milliseconds") if report.time else None
    source = report.source
    where = f" {source.file}:{source.row}" if source.file else ""
    return {
        "id": report.id,
        "agent": report.agent,
        "source": f"{source.kind}{where}",
        "time": time,
    }
