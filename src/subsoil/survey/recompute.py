"""Does what was decided in a survey follow from what was known? Decide everything again."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from subsoil.errors import NotAllowedError, SubsoilError
from subsoil.registry import NOBODY, Allowed
from subsoil.strategies import designs_for
from subsoil.survey.decide import decision, view
from subsoil.survey.events import (
    METHOD,
    Assigned,
    Event,
    Finished,
    Fitted,
    Opened,
    Planned,
    same,
)
from subsoil.survey.fold import apply, opened
from subsoil.survey.state import Survey
from subsoil.ways.routing import length

_EQUAL = 1e-6
"""Relative difference up to which two plans are as good as each other."""


@dataclass(frozen=True)
class Verdict:
    """What a check found.

    Attributes
    ----------
    findings
        What is not as it should be.
    notes
        What could not be checked, and what is odd but allowed.
    """

    findings: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()

    def __add__(self, other: Verdict) -> Verdict:
        return Verdict(self.findings + other.findings, self.notes + other.notes)


Progress = Callable[[int], None]
"""Told how many events are done."""


def recomputed(
    events: Iterable[tuple[int, Event]],
    allowed: Allowed = NOBODY,
    progress: Progress = lambda _: None,
) -> Verdict:
    """Decide everything again that was decided in a survey, and compare.

    Fits, plans and endings are computed again where they were made by the methods of today.

    Parameters
    ----------
    events
        Number in the file and event, in order; the first sets the survey up.
    allowed
        Modules whose strategies may be run, beside the registered ones.
    progress
        Told how far this is.

    Raises
    ------
    CorruptJournalError
        If an event cannot follow those before it.
    """
    stream = iter(events)
    _, first = next(stream)
    assert isinstance(first, Opened)
    survey = opened(first)
    verdict = Verdict()
    left_out: dict[str, int] = {}
    for seq, event in stream:
        if isinstance(event, Fitted | Planned | Finished | Assigned):
            if survey.method != METHOD:
                _count(left_out, f"made by {survey.method or 'nobody'}")
            else:
                verdict += _check(survey, seq, event, allowed, left_out)
        survey = apply(survey, event)
        progress(seq)
    notes = tuple(f"{n} decisions not recomputed: {why}" for why, n in left_out.items())
    return verdict + Verdict(notes=notes)


def _check(
    survey: Survey,
    seq: int,
    event: Fitted | Planned | Finished | Assigned,
    allowed: Allowed,
    left_out: dict[str, int],
) -> Verdict:
    """Whether a decision follows from the state before it."""
    if isinstance(event, Assigned):
        follows = event.cell == (survey.plan.cells or (None,))[0]
    else:
        try:
            expected = decision(survey, allowed)
        except NotAllowedError as error:
            _count(left_out, str(error))
            return Verdict()
        except SubsoilError as error:
            return Verdict((f"event {seq}: {event.kind} cannot be computed again: {error}",))
        follows = expected is not None and (
            same(_numbers(event), _numbers(expected), _EQUAL) or _as_good(survey, event, expected)
        )
    if follows:
        return Verdict()
    return Verdict((f"event {seq}: {event.kind} differs from what the events before it imply",))


def _numbers(event: Event) -> Event:
    """Event without the words of its fits: they name numbers to fewer digits."""
    if not isinstance(event, Fitted):
        return event
    fits = tuple(fit.model_copy(update={"why": ""}) for fit in event.fits)
    return event.model_copy(update={"fits": fits})


def _as_good(survey: Survey, event: Event, expected: Event) -> bool:
    """Whether two plans differ, and are worth the same: another machine may find the other."""
    if not (isinstance(event, Planned) and isinstance(expected, Planned)):
        return False
    own = {"cells": (), "pushes": (), "reason": "", "kept": False, "measures": ()}
    if not same(event.model_copy(update=own), expected.model_copy(update=own), _EQUAL):
        return False
    plans = [survey.plan.cells if each.kept else each.cells for each in (event, expected)]
    free = set(range(len(survey.field.cells))) - {*survey.visited, *survey.refused}
    if len(plans[0]) != len(plans[1]) or not free.issuperset(plans[0]):
        return False
    one, other = (_worth(survey, cells) for cells in plans)
    return bool(np.allclose(one, other, rtol=_EQUAL, atol=0.0))


def _worth(survey: Survey, cells: tuple[int, ...]) -> tuple[float, float]:
    """Way of a plan in m, and the mean variance after it in sills."""
    seen = view(survey)
    stops = survey.access.at[list(cells)]
    metres = length(survey.access, survey.position, stops)
    return metres, designs_for(seen).mean_variance([*seen.readings, *cells])


def _count(numbers: dict[str, int], key: str) -> None:
    numbers[key] = numbers.get(key, 0) + 1
