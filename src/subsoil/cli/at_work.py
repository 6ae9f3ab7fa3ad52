"""A survey that somebody works on by hand: opened, joined, settled and given back."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

from subsoil.cli.limits import LimitOptions
from subsoil.cli.options import MethodOptions, decided_anew, settings_of
from subsoil.cli.output import working
from subsoil.cli.pace import PaceOptions
from subsoil.cli.parsing import FIELD
from subsoil.errors import ReportError
from subsoil.journal import open_journal
from subsoil.survey import LocalDispatch, Survey, fold
from subsoil.survey.agents import Lease
from subsoil.survey.by_hand import settle
from subsoil.survey.events import Configured

AgentName = Annotated[
    str,
    typer.Option("--agent", metavar="NAME", help="Who is at work.", rich_help_panel=FIELD),
]
HAND = "hand"
"""Name of who works by hand where nobody says."""


@contextmanager
def at_work(
    path: Path,
    agent: str,
    method: MethodOptions,
    limits: LimitOptions | None = None,
    pace: PaceOptions | None = None,
    *,
    decide: bool = True,
) -> Iterator[LocalDispatch]:
    """Dispatch of a survey that a person has joined; what is due is decided at the end, if asked.

    Nothing is written if the survey is simulated, or its settings cannot be gone by.
    """
    with open_journal(path) as journal:
        survey = fold(journal.events())
        given = limits or LimitOptions()
        settings = settings_of(survey.settings, survey.field, method, given, pace)
        dispatch = LocalDispatch(survey, journal, allowed=method.allowed)
        with journal.together():
            dispatch.join(agent, "person")
            if decided_anew(survey, settings):
                dispatch.record(Configured(settings=settings))
            yield dispatch
        if decide:
            with working("planning"):
                settle(dispatch, method.allowed)


@contextmanager
def correcting(path: Path, method: MethodOptions) -> Iterator[LocalDispatch]:
    """Dispatch of a survey to correct; what is due is decided at the end where people work on it.

    A robot's program decides that itself when it goes on.
    """
    with open_journal(path) as journal:
        survey = fold(journal.events())
        dispatch = LocalDispatch(survey, journal, allowed=method.allowed)
        people = bool(survey.method) and any(agent.kind == "person" for agent in survey.agents)
        if people:
            settings_of(survey.settings, survey.field, method, LimitOptions())
        yield dispatch
        if people:
            with working("planning"):
                settle(dispatch, method.allowed)


def lease_of(survey: Survey, agent: str) -> Lease:
    """The stop that somebody was sent to.

    Raises
    ------
    ReportError
        If there is none.
    """
    leases = survey.agent(agent).leases
    if not leases:
        raise ReportError(
            f"no stop is handed out to {agent!r}",
            where=survey.name,
            remedy="ask for it with `subsoil next`, or give a place --at LAT,LON",
        )
    return leases[0]
