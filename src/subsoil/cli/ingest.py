"""Take the readings of files into a survey, each at its own place and once."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

import typer

from subsoil.cli.at_work import HAND, AgentName, at_work
from subsoil.cli.found import exit_for, said
from subsoil.cli.material import ReadingOptions
from subsoil.cli.options import Allow, MethodOptions, SurveyFile
from subsoil.cli.output import AsJson, Shown, tell
from subsoil.cli.parsing import OUTPUT, grouped
from subsoil.errors import ParameterError, ReportError
from subsoil.findings import Finding, left_out
from subsoil.journal import is_foreign, read_survey
from subsoil.kriging.memory import check_memory
from subsoil.land.field import Field
from subsoil.readings import Readings
from subsoil.report.wording import in_units
from subsoil.reports import Sampled
from subsoil.survey import LocalDispatch, Memory, Survey, fold
from subsoil.survey.imported import imported
from subsoil.survey.outlook import in_words, outlook
from subsoil.units import SYSTEMS, System

Files = Annotated[
    list[Path], typer.Argument(help="Readings, in any format that map reads.", metavar="FILES...")
]


@dataclass
class Taking:
    """What came of the readings of files.

    Attributes
    ----------
    accepted, known, flagged
        How many were taken, were in already, and are odd among those taken.
    findings
        What else there is to know of the files, and what was left out.
    """

    accepted: int = 0
    known: int = 0
    flagged: int = 0
    findings: list[Finding] = field(default_factory=list)

    def take(self, dispatch: LocalDispatch, readings: Readings, agent: str) -> None:
        """Take the readings of one file into a survey."""
        survey = dispatch.survey
        self.findings += readings.findings
        doubted = {each.row for each in readings.findings if each.severity == "doubt" and each.row}
        start, pace = survey.agent(agent).position, survey.settings.pace
        for report in imported(readings, agent, start, pace):
            if report.id in dispatch.survey.known:
                self.known += 1
            else:
                self._take_one(dispatch, report, doubted)

    def _take_one(self, dispatch: LocalDispatch, report: Sampled, doubted: set[int]) -> None:
        source = report.source
        try:
            dispatch.report(report)
        except ReportError as error:
            self.findings.append(
                Finding(error.what, "left out", "left out", source.file, source.row)
            )
            return
        flags = dispatch.survey.stops[-1].readings[-1].reading.flags
        self.accepted += 1
        self.flagged += bool(flags) or source.row in doubted
        if flags:
            seen = f"it is taken, and odd: {', '.join(flags)}"
            self.findings.append(Finding(seen, "", "doubt", source.file, source.row))


@grouped
def ingest(
    survey: SurveyFile,
    files: Files,
    given: ReadingOptions,
    preview: Annotated[
        bool,
        typer.Option(
            "--preview", help="Say what would be taken; write nothing.", rich_help_panel=OUTPUT
        ),
    ] = False,
    agent: AgentName = HAND,
    allow: Allow = None,
    units: Shown = "metric",
    as_json: AsJson = False,
) -> None:
    """Take readings of files into a survey; those that are in already are not taken twice."""
    content = read_survey(survey)
    state = fold(content.events)
    readings = [_read(path, given, state.field) for path in files]
    check_memory(len(state.readings) + sum(map(len, readings)))
    taking = Taking()
    if preview:
        dispatch = LocalDispatch(state, Memory())
        dispatch.join(agent, "person")
        _take_all(taking, dispatch, readings, agent)
    else:
        with at_work(survey, agent, MethodOptions(allow=allow)) as dispatch:
            _take_all(taking, dispatch, readings, agent)
    _tell(survey, taking, dispatch.survey, preview=preview, as_json=as_json, units=units)


def _take_all(
    taking: Taking, dispatch: LocalDispatch, readings: Iterable[Readings], agent: str
) -> None:
    for each in readings:
        taking.take(dispatch, each, agent)


def _read(path: Path, given: ReadingOptions, field: Field) -> Readings:
    """Readings of a file on the field of the survey.

    Raises
    ------
    ParameterError
        If it is a survey, which holds readings that are in it already or were simulated.
    """
    if path.suffix.lower() == ".gpkg" and not is_foreign(path):
        raise ParameterError(
            "it is a survey of its own",
            where=str(path),
            remedy="give the files that its readings came from",
        )
    return given.readings_in(path, field)


def _tell(
    path: Path, taking: Taking, survey: Survey, *, preview: bool, as_json: bool, units: System
) -> None:
    """Print what was taken, and end with exit code 1 where something was left out."""
    counts: dict[str, object] = {"survey": path}
    if preview:
        counts["preview"] = "nothing is written"
    counts |= {"accepted": taking.accepted, "already in": taking.known, "flagged": taking.flagged}
    if as_json:
        counts["preview"], counts["known"] = preview, counts.pop("already in")
    else:
        counts["refused"] = len(left_out(taking.findings))
    told = said(taking.findings, as_json=as_json)
    if not as_json:
        told["left out"] = told.pop("refused")
    counts |= {**told, "samples": survey.taken, "finished": survey.finished or "no"}
    if not preview:
        words = in_words(survey, outlook(survey))
        counts["outlook"] = words if as_json else in_units(survey, outlook(survey), SYSTEMS[units])
    tell(counts, as_json)
    exit_for(taking.findings)
