"""Stops still to make: as rows, and as files for whatever shows the way."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from subsoil.cli.parsing import OUTPUT
from subsoil.io.write.stops import write_stops
from subsoil.land.field import Field
from subsoil.reports import Place
from subsoil.survey import Survey

Write = Annotated[
    Path | None,
    typer.Option(
        "--write",
        metavar="FILE",
        help="Write the stops to a file: .gpx, .kml, .geojson or .csv.",
        rich_help_panel=OUTPUT,
    ),
]


def ahead_of(survey: Survey, agent: str | None = None) -> tuple[int, ...]:
    """Cells still to visit, those on the way first: of one agent, or of all."""
    on_way = [
        lease.cell
        for each in survey.agents
        if agent in (None, each.name)
        for lease in each.leases
    ]  # fmt: skip
    return (*on_way, *survey.plan.cells)


def row_of(field: Field, cell: int | None, at: Place) -> dict[str, float]:
    """A place by its cell, in metres and, where the frame has a name, in degrees."""
    stop: dict[str, float] = {} if cell is None else {"cell": cell}
    stop |= {"easting_m": at[0], "northing_m": at[1]}
    if field.crs:
        longitude, latitude = field.to_lonlat(at)[0].tolist()
        stop |= {"longitude": round(longitude, 7), "latitude": round(latitude, 7)}
    return stop


def stop_of(survey: Survey, cell: int) -> dict[str, float]:
    """A cell as a stop."""
    east, north = survey.access.at[cell].tolist()
    return row_of(survey.field, cell, (east, north))


def written(path: Path, survey: Survey, cells: Sequence[int]) -> Path:
    """File of stops, written."""
    return write_stops(path, survey.field, survey.access.at[list(cells)])
