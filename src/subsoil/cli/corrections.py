"""Verbs that correct what was recorded; nothing is ever taken out of a survey file."""

from __future__ import annotations

from typing import Annotated

import typer

from subsoil.cli.options import SurveyFile
from subsoil.cli.output import AsJson, tell
from subsoil.cli.parsing import FIELD
from subsoil.journal import open_journal
from subsoil.survey import LocalDispatch, fold


def withdraw(
    survey: SurveyFile,
    report: Annotated[
        str, typer.Argument(help="Id of the reading, as the layer `samples` names it.")
    ],
    reason: Annotated[
        str, typer.Option(metavar="WORDS", help="Why it does not count.", rich_help_panel=FIELD)
    ],
    as_json: AsJson = False,
) -> None:
    """Let a reading count no more; the map is as if it had never been taken."""
    with open_journal(survey) as journal:
        dispatch = LocalDispatch(fold(journal.events()), journal)
        reading = dispatch.withdraw(report, reason)
    at = {"easting_m": reading.at[0], "northing_m": reading.at[1]}
    tell({"withdrawn": report, "agent": reading.agent, **at, "reason": reason}, as_json)
