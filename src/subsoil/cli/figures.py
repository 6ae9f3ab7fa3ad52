"""The option that says in which format figures are written."""

from __future__ import annotations

from typing import Annotated

import typer

from subsoil.cli.parsing import OUTPUT
from subsoil.plots.saving import Format

FigureFormat = Annotated[
    Format,
    typer.Option(
        "--figures",
        help="Format of the figures: pixels, or lines and letters for print.",
        rich_help_panel=OUTPUT,
    ),
]
