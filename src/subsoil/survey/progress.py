"""How a survey went on, sample by sample."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate
from math import nan

from subsoil.mapping.scores import rmse
from subsoil.simulation import Truth
from subsoil.survey import Survey, apply, opened
from subsoil.survey.events import Event, Opened, Planned


@dataclass(frozen=True)
class Progress:
    """Where a survey stood after one of its samples.

    Attributes
    ----------
    samples
        Readings taken.
    metres, minutes
        Way driven in m and time spent in min.
    mean_kv
        Field average of the kriging variance in kPa2.
    rmse
        Root mean square error of the map against the simulated truth in kPa; NaN without one.
    """

    samples: int
    metres: float
    minutes: float
    mean_kv: float
    rmse: float


class History:
    """Observer of a simulated survey that looks at it after every plan, with the truth at hand.

    Attributes
    ----------
    entries
        Where the survey stood after each sample.
    """

    def __init__(self, truth: Truth) -> None:
        self.truth, self.entries = truth, list[Progress]()

    def __call__(self, survey: Survey, event: Event) -> None:
        """Look where a plan was made."""
        if isinstance(event, Planned) and survey.taken:
            self.look(survey)

    def look(self, survey: Survey) -> None:
        """Note where a survey stands."""
        spent, error = survey.spent, rmse(survey.soil_map.mean, self.truth.kpa)
        self.entries.append(
            Progress(spent.samples, spent.metres, spent.minutes, spent.mean_kv, error)
        )


def progress_of(opening: Opened, events: Sequence[Event]) -> tuple[Progress, ...]:
    """How a survey went on, from its events after the first; no truth is known.

    One entry a plan, from the second sample on, with the kriging variance recorded then.
    """
    states = accumulate(events, apply, initial=opened(opening))
    next(states)
    return tuple(
        Progress(state.taken, state.metres, state.minutes, event.mean_kv, nan)
        for event, state in zip(events, states, strict=True)
        if isinstance(event, Planned) and state.taken > 1
    )
