"""Options of who walks or drives: where from, and how fast."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated

import typer

from subsoil.cli.limits import only_given
from subsoil.cli.parsing import WAY
from subsoil.cli.places import place_of
from subsoil.land.field import Field
from subsoil.stopping import Pace


@dataclass(frozen=True)
class PaceOptions:
    """Where a way begins and how fast stops are made; ``None`` where nobody says.

    Attributes
    ----------
    start
        Where it begins, as :func:`subsoil.cli.places.place_of` reads it.
    speed
        Between stops, in m/s.
    stop_seconds
        At a stop with one push.
    """

    start: Annotated[
        str | None,
        typer.Option(
            metavar="LAT,LON",
            help="Where you begin; easting,northing in a local frame.",
            show_default="as before, else the south-west corner",
            rich_help_panel=WAY,
        ),
    ] = None
    speed: Annotated[
        float | None,
        typer.Option(
            metavar="M/S",
            help="Speed between stops; 1.2 on foot.",
            show_default="as before, else 1",
            rich_help_panel=WAY,
        ),
    ] = None
    stop_seconds: Annotated[
        float | None,
        typer.Option(
            metavar="S",
            help="Time at a stop; a push by hand takes 60 to 120.",
            show_default="as before, else 50",
            rich_help_panel=WAY,
        ),
    ] = None

    def given(self, before: Pace, field: Field) -> dict[str, object]:
        """Fields of the settings that are given.

        Raises
        ------
        ParameterError
            If the start is no place near the field, or the pace is none.
        """
        pace = only_given(speed_mps=self.speed, stop_s=self.stop_seconds)
        return only_given(
            start=place_of(self.start, field, "--start") if self.start else None,
            pace=replace(before, **pace) if pace else None,  # type: ignore[arg-type]
        )
