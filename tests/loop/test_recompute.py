"""A decision that does not follow from what was known is found; one not tried again is noted."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from subsoil.agent import Assignment
from subsoil.errors import CorruptJournalError
from subsoil.land.field import Field
from subsoil.layers import Layers
from subsoil.penetrometer import SMALL_CONE
from subsoil.registry import NOBODY, Allowed, handed_over
from subsoil.reports import Reading, Sampled
from subsoil.strategies import Plan, View
from subsoil.survey import LocalDispatch, Memory, Settings, Survey, opened, opening
from subsoil.survey.events import (
    Assigned,
    Configured,
    Event,
    Finished,
    Fitted,
    Planned,
)
from subsoil.survey.recompute import Verdict, recomputed

Configure = Callable[..., Configured]
SurveyPlot = Callable[..., tuple[Survey, list[Event]]]


@pytest.fixture
def events(configured: Configure, survey_plot: SurveyPlot) -> list[Event]:
    """Events of a survey of five samples."""
    return survey_plot(configured("area-split", samples=5))[1]


def verdict(events: list[Event], allowed: Allowed = NOBODY) -> Verdict:
    return recomputed(enumerate(events, 1), allowed)


def nth(events: list[Event], kind: type, n: int = 0) -> int:
    return [k for k, event in enumerate(events) if isinstance(event, kind)][n]


def changed(events: list[Event], k: int, **update: object) -> list[Event]:
    return [*events[:k], events[k].model_copy(update=update), *events[k + 1 :]]


def test_a_survey_as_it_was_made_has_no_finding_and_each_event_is_told(
    events: list[Event],
) -> None:
    told: list[int] = []
    assert recomputed(enumerate(events, 1), progress=told.append) == Verdict()
    assert told == list(range(2, len(events) + 1))


@pytest.mark.parametrize(
    ("kind", "update"),
    [
        (Planned, {"mean_kv": 1.0}),
        (Planned, {"step": 7}),
        (Finished, {"reason": "tired"}),
    ],
)
def test_a_changed_number_or_word_of_a_decision_is_found_by_its_event(
    events: list[Event], kind: type, update: dict[str, object]
) -> None:
    k = nth(events, kind, -1)
    first, *_ = verdict(changed(events, k, **update)).findings
    name = events[k].kind
    assert first == f"event {k + 1}: {name} differs from what the events before it imply"


def test_a_variogram_is_found_by_its_numbers_and_not_by_its_words(events: list[Event]) -> None:
    k = nth(events, Fitted, 2)
    fitted = events[k]
    assert isinstance(fitted, Fitted)
    reworded = tuple(fit.model_copy(update={"why": "for a reason"}) for fit in fitted.fits)
    assert verdict(changed(events, k, fits=reworded)) == Verdict()
    model = fitted.fits[3].model
    for factor, found in ((1 + 1e-9, False), (1.01, True)):
        harder = model.model_copy(update={"range": factor * model.range})  # type: ignore[union-attr]
        fits = list(fitted.fits)
        fits[3] = fits[3].model_copy(update={"model": harder})
        said = verdict(changed(events, k, fits=tuple(fits))).findings
        assert bool(said) == found
        if found:
            assert said[0] == f"event {k + 1}: fitted differs from what the events before it imply"


def test_a_stop_that_was_not_the_next_of_the_plan_is_found(events: list[Event]) -> None:
    k = nth(events, Assigned)
    assigned, planned = events[k], events[nth(events, Planned)]
    assert isinstance(assigned, Assigned)
    assert isinstance(planned, Planned)
    other = planned.cells[1]
    said = verdict(changed(events, k, cell=other)).findings
    assert f"event {k + 1}: assigned differs from what the events before it imply" in said


def test_decisions_of_another_version_are_counted_and_not_computed(events: list[Event]) -> None:
    k = nth(events, Configured)
    decisions = sum(isinstance(e, Fitted | Planned | Finished | Assigned) for e in events)
    found = verdict(changed(events, k, method="0.1"))
    assert found.findings == ()
    assert found.notes == (f"{decisions} decisions not recomputed: made by 0.1",)


def test_a_strategy_that_is_not_allowed_is_noted_and_one_that_fails_is_a_finding(
    events: list[Event],
) -> None:
    k = nth(events, Configured)
    configured = events[k]
    assert isinstance(configured, Configured)

    def by(strategy: str) -> list[Event]:
        settings = configured.settings.model_copy(update={"strategy": strategy})
        return changed(events, k, settings=settings)

    noted = verdict(by("mine.own:plan"))
    plans = sum(isinstance(event, Planned) for event in events)
    assert len(noted.findings) == 0
    (note,) = noted.notes
    assert note.startswith(f"{plans} decisions not recomputed: strategy: 'mine.own:plan' is code")
    name, allowed = handed_over(_broken)
    first, *_ = verdict(by(name), allowed).findings
    first_plan = nth(events, Planned)
    assert first.startswith(f"event {first_plan + 1}: planned cannot be computed again: ")


def _broken(view: View) -> Plan:
    raise ValueError(f"broken with {view.taken} samples")


def test_what_cannot_follow_at_all_ends_the_check(events: list[Event]) -> None:
    k = nth(events, Assigned)
    with pytest.raises(CorruptJournalError, match="agent 'ghost' never joined"):
        verdict(changed(events, k, agent="ghost"))


def test_two_verdicts_make_one() -> None:
    both = Verdict(("a",), ("x",)) + Verdict(("b",), ()) + Verdict((), ("y",))
    assert both == Verdict(("a", "b"), ("x", "y"))


# A plan that is another one and worth the same

SQUARE = Field.from_metres([(0, 0), (50, 0), (50, 50), (0, 50)], name="square")
"""Ten cells a side: what lies across its diagonal is as far from the start and tells as much."""


def across(cell: int) -> int:
    east, north = SQUARE.cells[cell].tolist()
    return SQUARE.nearest_cell((north, east))


def one_side(view: View) -> Plan:
    """Cells of the diagonal, then two on one side of it."""
    wanted = [SQUARE.nearest_cell(at) for at in ((22.5, 22.5), (32.5, 12.5), (47.5, 7.5))]
    left = tuple(cell for cell in wanted if view.free[cell] or cell in view.plan)
    return Plan(left[: view.remaining], "one side")


def surveyed_square() -> list[Event]:
    name, allowed = handed_over(one_side)
    begun = opening(SQUARE, Layers((0.0, 0.4)), SMALL_CONE)
    memory = Memory()
    dispatch = LocalDispatch(opened(begun), memory, allowed=allowed)
    settings = Settings(start=(0.0, 0.0), strategy=name, estimator="paper-10", samples=3)
    dispatch.record(Configured(settings=settings))
    dispatch.join("anna")
    stop = dispatch.assign("anna")
    assert isinstance(stop, Assignment)
    reading = Reading(depth_m=(0.2, 0.4), force_n=(150.0, 170.0))
    dispatch.report(Sampled(agent="anna", assignment=stop.id, at=stop.at, reading=reading))
    dispatch.assign("anna")
    return [begun, *memory.events]


def test_a_plan_on_the_other_side_of_the_diagonal_is_as_good_and_no_finding() -> None:
    events, (_, allowed) = surveyed_square(), handed_over(one_side)
    k = nth(events, Planned, 1)
    cells = tuple(SQUARE.nearest_cell(at) for at in ((32.5, 12.5), (47.5, 7.5)))
    mirrored = tuple(map(across, cells))
    assert not set(mirrored) & set(cells)
    alone = events[: k + 1]
    for plan in (cells, mirrored):
        given = changed(alone, k, cells=plan, kept=False)
        assert verdict(given, allowed) == Verdict(), plan


@pytest.mark.parametrize(
    "places",
    [
        ((47.5, 7.5), (32.5, 12.5)),
        ((32.5, 12.5), (47.5, 12.5)),
        ((32.5, 12.5),),
        ((22.5, 22.5), (47.5, 7.5)),
    ],
)
def test_a_plan_that_is_longer_shorter_or_to_where_one_was_is_a_finding(
    places: tuple[tuple[float, float], ...],
) -> None:
    events, (_, allowed) = surveyed_square(), handed_over(one_side)
    k = nth(events, Planned, 1)
    cells = tuple(SQUARE.nearest_cell(at) for at in places)
    found = verdict(changed(events[: k + 1], k, cells=cells, kept=False), allowed).findings
    assert found == (f"event {k + 1}: planned differs from what the events before it imply",)


def test_cells_across_the_diagonal_are_mirror_images() -> None:
    east, north = SQUARE.cells.T
    image = np.array([across(cell) for cell in range(len(SQUARE.cells))])
    assert np.array_equal(SQUARE.cells[image], np.column_stack([north, east]))
