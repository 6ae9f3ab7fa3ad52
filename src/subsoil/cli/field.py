"""Options of a field, and of readings taken on it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from subsoil.cli.parsing import FIELD, STRATEGY, one_of
from subsoil.io.read.readings import READERS
from subsoil.io.read.recording import UNITS

Boundary = Annotated[
    Path,
    typer.Option(
        metavar="FILE",
        help="Outline of the field: GeoJSON, .coords, CSV, GeoPackage, shapefile, KML, KMZ, GPX.",
        rich_help_panel=FIELD,
    ),
]
OptionalBoundary = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE",
        help="Outline of the field; readings beyond its fence are left out.",
        show_default="the survey's own",
        rich_help_panel=FIELD,
    ),
]
FieldName = Annotated[
    str,
    typer.Option(
        "--name",
        metavar="NAME",
        help="Which outline is the field, where the file holds several.",
        show_default="the only one, or all if they adjoin",
        rich_help_panel=FIELD,
    ),
]
Fence = Annotated[
    float,
    typer.Option(
        metavar="M",
        help="How far outside the field a reading still belongs to it.",
        min=0.0,
        rich_help_panel=FIELD,
    ),
]
KeepOuts = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE", help="Areas not to probe, in the same formats.", rich_help_panel=FIELD
    ),
]
Crs = Annotated[
    str | None,
    typer.Option(
        metavar="EPSG:N",
        help="Frame of files in metres that do not name one.",
        rich_help_panel=FIELD,
    ),
]
CellSize = Annotated[
    float, typer.Option(metavar="M", help="Side of a cell.", rich_help_panel=FIELD)
]
OptionalCellSize = Annotated[
    float | None,
    typer.Option(
        "--cell",
        metavar="M",
        help="Side of a cell.",
        show_default="the survey's, else 5",
        rich_help_panel=FIELD,
    ),
]
Edges = Annotated[
    str,
    typer.Option(
        metavar="M,M,...",
        help="Edges of the depth layers, comma-separated.",
        rich_help_panel=FIELD,
    ),
]
ConeArea = Annotated[
    float,
    typer.Option(
        metavar="MM2",
        help="Base area of the cone: 130 or 323 as a rule.",
        rich_help_panel=FIELD,
    ),
]
ConeAngle = Annotated[
    float,
    typer.Option(metavar="DEG", help="Apex angle of the cone.", rich_help_panel=FIELD),
]
OptionalConeArea = Annotated[
    float | None,
    typer.Option(
        metavar="MM2",
        help="Base area of the cone, where readings are forces.",
        rich_help_panel=FIELD,
    ),
]
ReadingsFile = Annotated[
    Path,
    typer.Argument(
        help="Readings (table, workbook, points, an instrument's file) or a survey file.",
        metavar="READINGS",
    ),
]
ReadingUnit = Annotated[
    str | None,
    typer.Option(
        metavar="UNIT",
        help=f"Unit of the readings where the file does not say: {', '.join(UNITS)}.",
        autocompletion=one_of(UNITS),
        rich_help_panel=FIELD,
    ),
]
Mapped = Annotated[
    list[str] | None,
    typer.Option(
        metavar="HEADING=MEANING",
        help="What a heading of a table means: latitude, easting, number, depth cm, "
        "kpa at 10 cm, kpa 10-20 cm, ignore; may be repeated.",
        rich_help_panel=FIELD,
    ),
]
ReaderName = Annotated[
    str,
    typer.Option(
        metavar="NAME",
        help="What wrote the readings, where the file does not tell, or a reader of your own, "
        "`module:function`. `subsoil doctor` lists them.",
        autocompletion=one_of(READERS),
        show_default=False,
        rich_help_panel=FIELD,
    ),
]
PositionsFile = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE",
        help="Where pushes were, by number or time, if the instrument does not say: "
        "CSV, GPX, GeoJSON, GeoPackage.",
        rich_help_panel=FIELD,
    ),
]
Block = Annotated[
    float,
    typer.Option(
        metavar="M", help="Side of the blocks left out together.", rich_help_panel=STRATEGY
    ),
]
