"""Does a survey file say what its events imply? Recompute everything, and compare."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from subsoil import layout
from subsoil.errors import SubsoilError
from subsoil.events import Event, Fitted, Opened, Planned, Sampled, same
from subsoil.journal import read_events, reading
from subsoil.sequel import next_event
from subsoil.survey import Survey, apply, opened


def verify(path: Path) -> tuple[str, ...]:
    """Differences between a survey file and what its events imply; empty if there is none.

    Every fit and every plan is computed again from the events before it, and every row of the
    samples layer from its push.

    Raises
    ------
    JournalError
        If the file is missing, not a survey, or its events were changed.
    """
    events = read_events(path)
    return (*_check_events(events), *_check_samples(path, events))


def _check_events(events: tuple[Event, ...]) -> Iterator[str]:
    first = events[0]
    assert isinstance(first, Opened)
    survey = opened(first)
    for seq, event in enumerate(events[1:], start=2):
        if isinstance(event, Fitted | Planned):
            yield from _check_follows(survey, seq, event)
        survey = apply(survey, event)


def _check_follows(survey: Survey, seq: int, event: Fitted | Planned) -> Iterator[str]:
    try:
        expected = next_event(survey)
    except SubsoilError as error:
        yield f"event {seq}: {event.kind} cannot be computed again: {error}"
        return
    if expected is None or not same(event, expected):
        yield f"event {seq}: {event.kind} differs from what the events before it imply"


def _check_samples(path: Path, events: tuple[Event, ...]) -> Iterator[str]:
    first = events[0]
    assert isinstance(first, Opened)
    survey = opened(first)
    with reading(path) as database:
        rows = layout.sample_rows(database, survey.layers)
    pushes = {event.id: event for event in events if isinstance(event, Sampled)}
    for missing in pushes.keys() - rows.keys():
        yield f"samples layer: {missing} is missing"
    for extra in rows.keys() - pushes.keys():
        yield f"samples layer: {extra} was never reported"
    for id_ in pushes.keys() & rows.keys():
        if rows[id_] != layout.sample_values(pushes[id_], survey):
            yield f"samples layer: values of {id_} differ from its push"
