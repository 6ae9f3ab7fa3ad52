"""Options of what is known of a field beforehand, and whether its soil follows that."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from subsoil.cli.parsing import FIELD, STRATEGY
from subsoil.findings import Finding
from subsoil.io.read.covariate import read_covariate
from subsoil.kriging.drift import NO_COVARIATE, Covariate
from subsoil.land.field import Field
from subsoil.mapping.drift_choice import DriftRule

CovariateFile = Annotated[
    Path | None,
    typer.Option(
        "--covariate",
        metavar="FILE",
        help="EC, yield or earlier map that the soil may follow: GeoTIFF or points.",
        rich_help_panel=FIELD,
    ),
]
Column = Annotated[
    str | None,
    typer.Option(
        metavar="NAME",
        help="Column of a covariate of points, if it has several.",
        rich_help_panel=FIELD,
    ),
]


def drift_option(default: str | bool = True) -> Any:
    """Option of which layers follow the covariate."""
    return typer.Option(
        help="Which layers follow the covariate; auto: where it predicts better.",
        show_default=default,
        rich_help_panel=STRATEGY,
    )


Drift = Annotated[DriftRule, drift_option()]


def covariate_of(
    path: Path | None, column: str | None, field: Field, crs: str | None
) -> tuple[Covariate, tuple[Finding, ...]]:
    """Covariate of a field's cells, and findings about its file; none without a file."""
    if path is None:
        return NO_COVARIATE, ()
    known = read_covariate(path, field, column=column, crs=crs)
    return Covariate(field.cells, known.values), known.findings
