"""Options of a field, and of readings taken on it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from subsoil.cli.parsing import FIELD, STRATEGY, one_of

Boundary = Annotated[
    Path,
    typer.Option(
        metavar="FILE",
        help="Outline of the field: GeoJSON, .coords, CSV, GeoPackage, shapefile, KML.",
        rich_help_panel=FIELD,
    ),
]
OptionalBoundary = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE",
        help="Outline of the field; readings outside are left out.",
        show_default="the survey's own",
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
OptionalConeArea = Annotated[
    float | None,
    typer.Option(
        metavar="MM2",
        help="Base area of the cone, where readings are forces.",
        rich_help_panel=FIELD,
    ),
]
ReadingsFile = Annotated[
    Path, typer.Argument(help="Readings (robot YAML or CSV) or a survey file.", metavar="READINGS")
]
ReadingUnit = Annotated[
    str | None,
    typer.Option(
        metavar="UNIT",
        help="Unit of the readings where the file does not say: kpa, mpa, psi or n.",
        autocompletion=one_of(("kpa", "mpa", "psi", "n")),
        rich_help_panel=FIELD,
    ),
]
Block = Annotated[
    float,
    typer.Option(
        metavar="M", help="Side of the blocks left out together.", rich_help_panel=STRATEGY
    ),
]
