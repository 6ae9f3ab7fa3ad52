"""Readings corrected after they were taken: the map is as if they had been so from the start."""

from __future__ import annotations

from dataclasses import replace

from subsoil.errors import CorruptJournalError, brief
from subsoil.survey.agents import Stop
from subsoil.survey.events import Amended, Withdrawn
from subsoil.survey.measured import mappable, sample_of
from subsoil.survey.state import NOWHERE, Survey, cell_of
from subsoil.survey.stops import changed, far, reopened, with_lease


def after(survey: Survey, event: Amended | Withdrawn) -> Survey:
    """State after a correction.

    Raises
    ------
    CorruptJournalError
        If there is no such reading.
    """
    match event:
        case Amended():
            return amended(survey, event)
        case Withdrawn():
            return withdrawn(survey, event)


def amended(survey: Survey, event: Amended) -> Survey:
    """A reading is another from now on, as if it had been so from the start."""
    stop = _stop_of(survey, event.report)
    (old,) = (each for each in stop.readings if each.id == event.report)
    by = event.by.model_copy(update={"id": old.id, "assignment": old.assignment})
    readings = tuple(by if each.id == event.report else each for each in stop.readings)
    cell = stop.cell
    if len(readings) == 1 and (cell == NOWHERE or far(survey, by.at, by.accuracy_m, cell)):
        cell = cell_of(survey, by.at)
    survey = changed(survey, stop.id, lambda s: replace(s, readings=readings, cell=cell))
    return _corrected(survey, event.id)


def withdrawn(survey: Survey, event: Withdrawn) -> Survey:
    """A reading does not count any more, as if it had never been taken: its stop is open again."""
    stop = _stop_of(survey, event.report)
    readings = tuple(each for each in stop.readings if each.id != event.report)
    if readings or stop.refusal:
        survey = changed(survey, stop.id, lambda s: replace(s, readings=readings))
    else:
        rest = tuple(each for each in survey.stops if each.id != stop.id)
        survey = reopened(replace(survey, stops=rest), stop.cell)
    for lease in survey.lease(stop.id):
        survey = with_lease(survey, lease, (replace(lease, made=max(0, lease.made - 1)),))
    return _corrected(survey, event.id)


def _stop_of(survey: Survey, report: str) -> Stop:
    for stop in survey.stops:
        if any(reading.id == report for reading in stop.readings):
            return stop
    raise CorruptJournalError(
        f"there is no reading {brief(report)!r} to correct",
        where=survey.name,
        remedy="go back to a copy of the file",
    )


def _corrected(survey: Survey, event: str) -> Survey:
    """Map of the readings as they are now; fit and plan are due at once."""
    samples = tuple(sample_of(survey, r) for r in survey.readings if mappable(survey, r))
    return replace(
        survey,
        soil_map=replace(survey.soil_map, samples=samples),
        step=survey.step + 1,
        changes=survey.changes + 1,
        corrected=True,
        finished="",
        known=survey.known | {event},
    )
