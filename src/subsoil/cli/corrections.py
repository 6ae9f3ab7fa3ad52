"""Verbs that correct what was recorded; nothing is ever taken out of a survey file."""

from __future__ import annotations

from typing import Annotated

import typer

from subsoil.cli.at_work import correcting
from subsoil.cli.hand import at_option, tell_reading
from subsoil.cli.options import Allow, MethodOptions, SurveyFile
from subsoil.cli.output import AsJson, Shown, tell
from subsoil.cli.parsing import FIELD, grouped
from subsoil.cli.places import check_on_field, place_of
from subsoil.cli.typed import TypedOptions
from subsoil.errors import ParameterError, ReportError
from subsoil.reports import Sampled
from subsoil.survey import Survey
from subsoil.survey.by_hand import PERSON

ReportId = Annotated[
    str,
    typer.Argument(
        help="Id of the reading, as `add` and the layer `samples` name it, or its first letters."
    ),
]
_FEWEST_LETTERS = 6


@grouped
def amend(
    survey: SurveyFile,
    report: ReportId,
    typed: TypedOptions,
    reason: Annotated[
        str, typer.Option(metavar="WORDS", help="Why it was wrong.", rich_help_panel=FIELD)
    ],
    at: Annotated[str | None, at_option("where it was recorded")] = None,
    allow: Allow = None,
    units: Shown = "metric",
    as_json: AsJson = False,
) -> None:
    """Correct a reading: its values, its place, or both; what is not given stays."""
    with correcting(survey, MethodOptions(allow=allow)) as dispatch:
        old = reading_of(dispatch.survey, report)
        dispatch.amend(old.id, _amended(dispatch.survey, old, typed, at), reason)
    tell_reading(dispatch.survey, dispatch.survey.reading(old.id), units, as_json)


def _amended(survey: Survey, old: Sampled, typed: TypedOptions, at: str | None) -> Sampled:
    """The report that is to stand in the place of another.

    Raises
    ------
    ParameterError
        If nothing is to change, or the place lies outside the field.
    ReportError
        If the survey is simulated.
    """
    if survey.simulated:
        raise ReportError(
            "its readings are simulated, and what you type in is real",
            where=survey.name,
            remedy="let a simulated reading count no more: subsoil withdraw",
        )
    if at is None and not typed.given:
        raise ParameterError(
            "nothing is to change",
            where=survey.name,
            remedy="give --kpa and --depths, or --at; subsoil withdraw takes a reading back",
        )
    change: dict[str, object] = {}
    if typed.given:
        change |= {"reading": typed.reading(survey.cone), "source": PERSON}
    if at is not None:
        place = place_of(at, survey.field, "--at")
        check_on_field(place, survey.field, "--at")
        change |= {"at": place, "accuracy_m": None}
    kept = {name: value for name, value in old if name != "id"}
    return Sampled(**{**kept, **change})


def withdraw(
    survey: SurveyFile,
    report: ReportId,
    reason: Annotated[
        str, typer.Option(metavar="WORDS", help="Why it does not count.", rich_help_panel=FIELD)
    ],
    allow: Allow = None,
    as_json: AsJson = False,
) -> None:
    """Let a reading count no more; the map is as if it had never been taken."""
    with correcting(survey, MethodOptions(allow=allow)) as dispatch:
        reading = dispatch.withdraw(reading_of(dispatch.survey, report).id, reason)
    at = {"easting_m": reading.at[0], "northing_m": reading.at[1]}
    tell({"withdrawn": reading.id, "agent": reading.agent, **at, "reason": reason}, as_json)


def reading_of(survey: Survey, text: str) -> Sampled:
    """The reading that counts of an id, or of its first letters if they are of one alone.

    Raises
    ------
    ReportError
        If there is none, or the letters are of several.
    """
    found = [
        each
        for each in survey.readings
        if each.id == text or (len(text) >= _FEWEST_LETTERS and each.id.startswith(text))
    ]
    exact = [each for each in found if each.id == text]
    if len(exact or found) == 1:
        return (exact or found)[0]
    what = "several readings begin with" if found else "there is no reading"
    raise ReportError(
        f"{what} {text[:40]!r}" + ("" if found else " that counts"),
        where=survey.name,
        remedy="give the id of a row of the layer samples, or six letters of it or more",
    )
