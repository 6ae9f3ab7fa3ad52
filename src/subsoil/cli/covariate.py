"""Options of what is known of a field beforehand, and whether its soil follows that."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, cast, get_args

import typer

from subsoil.errors import ParameterError
from subsoil.io.covariate import read_covariate
from subsoil.kriging.drift import NO_COVARIATE, Covariate
from subsoil.land.field import Field
from subsoil.mapping.drift_choice import DriftRule

CovariateFile = Annotated[
    Path | None,
    typer.Option(
        "--covariate", help="EC, yield or earlier map that the soil may follow: GeoTIFF or points."
    ),
]
Column = Annotated[
    str | None, typer.Option(help="Column of a covariate of points, if it has several.")
]
Drift = Annotated[
    str,
    typer.Option(
        help="Layers that follow the covariate: auto (where it predicts better), always, never."
    ),
]


def covariate_of(path: Path | None, column: str | None, field: Field, crs: str | None) -> Covariate:
    """Covariate of a field's cells; none without a file."""
    if path is None:
        return NO_COVARIATE
    return Covariate(field.cells, read_covariate(path, field, column=column, crs=crs))


def rule_named(name: str) -> DriftRule:
    """Rule of a name.

    Raises
    ------
    ParameterError
        If there is none of that name.
    """
    if name not in get_args(DriftRule):
        raise ParameterError(
            f"there is no rule {name!r}",
            where="--drift",
            remedy=f"one of {', '.join(get_args(DriftRule))}",
        )
    return cast("DriftRule", name)
