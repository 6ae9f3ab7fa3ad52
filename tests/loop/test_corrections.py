"""Reports in any order, late or twice, and corrected later, leave the map they should."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta
from math import nan, sin

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from subsoil.agent import Assignment
from subsoil.errors import ReportError
from subsoil.land.field import Field
from subsoil.layers import Layers
from subsoil.penetrometer import SMALL_CONE
from subsoil.reports import Place, Reading, Sampled
from subsoil.strategies import STRATEGIES
from subsoil.survey import LocalDispatch, Memory, Settings, Survey, fold, opened, opening, settled
from subsoil.survey.events import Configured, Fitted, Planned
from subsoil.survey.state import stop_of

FIELD = Field.from_metres([(0, 0), (60, 0), (60, 40), (0, 40)])
OPENED = opening(FIELD, Layers((0.0, 0.2, 0.4)), SMALL_CONE)
PLACES: list[Place] = [
    (float(east), float(north)) for east, north in FIELD.cells[[3, 9, 20, 31, 44, 57, 66, 75, 90]]
]


def reading(at: Place, more: float = 0.0) -> Reading:
    """A soil that hardens to the east and with depth."""
    depth, here = (0.1, 0.2, 0.3, 0.4), 90 + more + 2 * at[0] + 30 * sin(at[1] / 7)
    return Reading(depth_m=depth, force_n=tuple(here + 400 * d for d in depth))


def report(k: int, agent: str = "anna", **more: object) -> Sampled:
    """The k-th reading, of a place that nobody asked for."""
    said = {"agent": agent, "at": PLACES[k], "metres": 3.0, "reading": reading(PLACES[k]), **more}
    return Sampled.model_validate({"id": f"reading-{k}", **said})


def begun(
    samples: int = 40, recorder: Memory | None = None, strategy: str = "area-split"
) -> LocalDispatch:
    dispatch = LocalDispatch(opened(OPENED), recorder or Memory())
    wanted = Settings(start=(0.0, 0.0), strategy=strategy, samples=samples, seed=2)
    dispatch.record(Configured(settings=wanted))
    for name in ("anna", "bert"):
        dispatch.join(name)
    return dispatch


def work(dispatch: LocalDispatch) -> None:
    """Make every stop that is asked for."""
    while isinstance(stop := dispatch.assign("anna"), Assignment):
        said = Sampled(agent="anna", assignment=stop.id, at=stop.at, reading=reading(stop.at))
        dispatch.report(said)


def fitted(survey: Survey) -> Survey:
    """The survey after the fit that follows, and what follows that."""
    return settled(survey)[0]


def told(*ks: int) -> Survey:
    dispatch = begun()
    for k in ks:
        dispatch.report(report(k))
    return fitted(dispatch.survey)


def assert_same_map(one: Survey, other: Survey, tolerance: float) -> None:
    assert len(one.soil_map.samples) == len(other.soil_map.samples)
    for a, b in ((one.soil_map.mean, other.soil_map.mean), (one.soil_map.kv, other.soil_map.kv)):
        assert np.allclose(a, b, rtol=tolerance, atol=0.0)


@pytest.mark.slow
@settings(deadline=None, max_examples=15)
@given(order=st.permutations(range(9)), again=st.lists(st.integers(0, 8), max_size=6))
def test_reports_shuffled_repeated_and_late_give_the_same_map(
    order: list[int], again: list[int]
) -> None:
    dispatch = begun()
    for n, k in enumerate(order):
        dispatch.report(report(k))
        if n == 4:
            dispatch.assign("bert")
        for twice in again[:n]:
            if twice in order[: n + 1]:
                dispatch.report(report(twice))
    assert len(dispatch.survey.readings) == 9
    assert_same_map(fitted(dispatch.survey), told(*range(9)), 1e-6)


@pytest.mark.slow
@settings(deadline=None, max_examples=15)
@given(gone=st.sets(st.integers(0, 8), min_size=1, max_size=5), early=st.booleans())
def test_a_withdrawn_reading_leaves_the_map_as_if_it_had_never_been(
    gone: set[int], early: bool
) -> None:
    dispatch = begun()
    for k in range(9):
        dispatch.report(report(k))
        if early and k in gone:
            dispatch.withdraw(f"reading-{k}", "a stone")
    for k in gone:
        if not early:
            dispatch.withdraw(f"reading-{k}", "a stone")
    rest = told(*(k for k in range(9) if k not in gone))
    assert_same_map(fitted(dispatch.survey), rest, 1e-9)
    assert dispatch.survey.metres == 27.0


@pytest.mark.slow
@settings(deadline=None, max_examples=15)
@given(changed=st.integers(0, 8), more=st.floats(-50, 200), east=st.floats(1, 59))
def test_an_amended_reading_leaves_the_map_as_if_it_had_been_so_from_the_start(
    changed: int, more: float, east: float
) -> None:
    at = (east, 20.0)
    right = report(changed, at=at, reading=reading(at, more))
    dispatch, straight = begun(), begun()
    for k in range(9):
        dispatch.report(report(k))
        straight.report(right if k == changed else report(k))
    dispatch.amend(f"reading-{changed}", right.model_copy(update={"id": "new"}), "a typo")
    assert_same_map(fitted(dispatch.survey), fitted(straight.survey), 1e-9)
    assert dispatch.survey.reading(f"reading-{changed}").at == at


def test_a_correction_makes_fit_and_plan_due_at_once_and_counters_never_fall() -> None:
    memory = Memory()
    dispatch = LocalDispatch(opened(OPENED), memory)
    wanted = Settings(start=(0.0, 0.0), strategy="greedy", samples=40, refit_every=50)
    dispatch.record(Configured(settings=wanted))
    dispatch.join("anna")
    for k in range(9):
        dispatch.report(report(k))
    for k in range(5):
        at = tuple(FIELD.cells[80 + k].tolist())
        dispatch.report(Sampled(id=f"more-{k}", agent="anna", at=at, reading=reading(at)))
    dispatch.assign("anna")
    fits = sum(isinstance(event, Fitted) for event in memory.events)
    before = dispatch.survey
    dispatch.withdraw("more-2", "a stone")
    now = dispatch.survey
    assert (now.step, now.changes, now.assigned) >= (before.step, before.changes, before.assigned)
    assert now.step > before.step
    kinds = [event.kind for event in settled(now)[1]]
    assert kinds[:2] == ["fitted", "planned"]
    assert fits == sum(isinstance(event, Fitted) for event in memory.events)


@pytest.mark.parametrize("assignment", ["", "of another stop"])
def test_an_amended_reading_stays_at_its_stop_whatever_the_correction_says_of_that(
    assignment: str,
) -> None:
    dispatch = begun()
    stop = dispatch.assign("anna")
    assert isinstance(stop, Assignment)
    dispatch.report(report(0, at=stop.at, assignment=stop.id))
    by = report(0, id="new", at=stop.at, assignment=assignment)
    dispatch.amend("reading-0", by, "a typo")
    (kept,) = dispatch.survey.readings
    assert stop_of(dispatch.survey, kept).id == kept.assignment == stop.id


def test_a_push_withdrawn_while_its_stop_is_made_is_made_again() -> None:
    dispatch = begun()
    dispatch.record(Planned(step=0, cells=(31, 44), reason="", mean_kv=nan, pushes=(2, 1)))
    stop = dispatch.assign("anna")
    assert isinstance(stop, Assignment)
    dispatch.report(report(0, at=stop.at, assignment=stop.id))
    dispatch.withdraw("reading-0", "a stone")
    (lease,) = dispatch.survey.leases
    assert (lease.pushes, lease.made, dispatch.survey.stops) == (2, 0, ())
    dispatch.release("anna", stop.id, "lunch")
    assert (dispatch.survey.plan.cells, dispatch.survey.plan.pushes) == ((31, 44), (2, 1))


@pytest.mark.parametrize("strategy", STRATEGIES)
def test_a_survey_whose_every_reading_was_withdrawn_is_made_again(strategy: str) -> None:
    dispatch = begun(5, strategy=strategy)
    work(dispatch)
    assert dispatch.survey.finished == "5 samples taken"
    for each in dispatch.survey.readings:
        dispatch.withdraw(each.id, "the wrong cone")
    assert (dispatch.survey.taken, dispatch.survey.soil_map.samples) == (0, ())
    work(dispatch)
    assert dispatch.survey.finished == "5 samples taken"
    assert np.isfinite(dispatch.survey.soil_map.mean).all()


def test_what_is_not_there_cannot_be_corrected() -> None:
    dispatch = begun()
    dispatch.report(report(1))
    with pytest.raises(ReportError, match="there is no reading 'reading-2'"):
        dispatch.withdraw("reading-2", "a stone")
    dispatch.withdraw("reading-1", "a stone")
    with pytest.raises(ReportError, match="there is no reading 'reading-1'"):
        dispatch.amend("reading-1", report(1), "a typo")


def test_a_withdrawn_reading_opens_its_stop_and_a_finished_survey_again() -> None:
    dispatch = begun(samples=3)
    for k in range(3):
        dispatch.report(report(k))
    survey = fitted(dispatch.survey)
    assert survey.finished == "3 samples taken"
    dispatch.withdraw("reading-1", "a stone")
    assert dispatch.survey.finished == ""
    assert dispatch.survey.plan.cells[-1] == FIELD.nearest_cell(PLACES[1])


def test_a_reading_taken_far_from_its_stop_counts_where_it_is_and_leaves_the_stop_open() -> None:
    dispatch = begun()
    stop = dispatch.assign("anna")
    assert isinstance(stop, Assignment)
    there = (57.5, 37.5)
    dispatch.report(report(0, at=there, assignment=stop.id))
    assert dispatch.survey.visited == (FIELD.nearest_cell(there),)
    assert stop.cell not in dispatch.survey.visited
    assert dispatch.survey.leases == ()
    assert dispatch.survey.soil_map.samples[0].at == there
    assert dispatch.survey.plan.cells[-1] == stop.cell


@pytest.mark.parametrize("strategy", sorted(STRATEGIES))
def test_a_stop_that_was_missed_by_far_is_planned_again_and_none_is_made_twice(
    strategy: str,
) -> None:
    dispatch = begun(samples=6, strategy=strategy)
    stop = dispatch.assign("anna")
    assert isinstance(stop, Assignment)
    dispatch.report(report(0, at=(57.5, 37.5), assignment=stop.id))
    assert stop.cell in dispatch.survey.plan.cells
    work(dispatch)
    assert dispatch.survey.taken == 6
    assert len(set(dispatch.survey.visited)) == 6


def test_a_stop_missed_by_far_that_was_read_before_is_not_made_again() -> None:
    dispatch = begun()
    stop = dispatch.assign("anna")
    assert isinstance(stop, Assignment)
    dispatch.report(report(1, agent="bert", at=stop.at))
    dispatch.report(report(0, at=(57.5, 37.5), assignment=stop.id))
    assert stop.cell not in dispatch.survey.plan.cells


def test_a_reading_a_few_metres_from_its_stop_is_the_stops_but_keeps_its_place() -> None:
    dispatch = begun()
    stop = dispatch.assign("anna")
    assert isinstance(stop, Assignment)
    near = (stop.at[0] + 3.5, stop.at[1])
    dispatch.report(report(0, at=near, assignment=stop.id, accuracy_m=2.0))
    assert dispatch.survey.visited == (stop.cell,)
    assert dispatch.survey.soil_map.samples[0].at == near
    assert dispatch.survey.agent("anna").position == near


def test_a_reading_in_no_cell_is_kriged_where_it_was_taken() -> None:
    dispatch = begun()
    for at in ((-20.0, 20.0), (5e6, 5e6)):
        dispatch.report(Sampled(agent="anna", at=at, reading=reading((0.0, 0.0))))
    survey = dispatch.survey
    assert (survey.visited, survey.taken) == ((), 2)
    assert all("outside-the-field" in each.reading.flags for each in survey.readings)
    for k in range(9):
        dispatch.report(report(k))
    assert np.isfinite(fitted(dispatch.survey).soil_map.mean).all()
    assert dispatch.survey.soil_map.samples[0].at == (-20.0, 20.0)


def test_a_second_agents_reading_in_a_cell_is_a_stop_of_its_own_at_its_own_place() -> None:
    dispatch = begun()
    dispatch.report(report(0))
    beside = (PLACES[0][0] + 2.4, PLACES[0][1])
    dispatch.report(Sampled(agent="bert", at=beside, reading=reading(beside)))
    survey = dispatch.survey
    assert [stop.agent for stop in survey.stops] == ["anna", "bert"]
    assert [sample.at for sample in survey.soil_map.samples] == [PLACES[0], beside]
    assert (survey.taken, survey.repeats) == (2, survey.visited)


@pytest.mark.parametrize("handed_on", [False, True])
def test_a_late_report_under_a_lapsed_lease_is_kept_once_and_closes_the_stop(
    handed_on: bool,
) -> None:
    clock = [datetime(2026, 5, 1, tzinfo=UTC)]
    dispatch = LocalDispatch(
        opened(OPENED), Memory(), patience=timedelta(minutes=5), now=lambda: clock[0]
    )
    dispatch.record(Configured(settings=Settings(start=(0.0, 0.0), strategy="random", samples=9)))
    for name in ("anna", "bert"):
        dispatch.join(name)
    stop = dispatch.assign("anna")
    assert isinstance(stop, Assignment)
    clock[0] += timedelta(minutes=6)
    other = dispatch.assign("bert") if handed_on else None
    late = Sampled(agent="anna", assignment=stop.id, at=stop.at, reading=reading(stop.at))
    dispatch.report(late)
    dispatch.report(late)
    survey = dispatch.survey
    assert [(each.agent, each.cell) for each in survey.stops] == [("anna", stop.cell)]
    assert survey.readings[0].assignment == stop.id
    if isinstance(other, Assignment):
        assert other.cell == stop.cell
        assert survey.leases == ()
        following = dispatch.assign("bert")
        assert isinstance(following, Assignment)
        assert following.cell != stop.cell


def test_a_reading_under_anothers_lease_is_its_own_and_ends_the_lease() -> None:
    memory = Memory()
    dispatch = begun(recorder=memory)
    stop = dispatch.assign("anna")
    assert isinstance(stop, Assignment)
    dispatch.report(Sampled(agent="bert", assignment=stop.id, at=stop.at, reading=reading(stop.at)))
    survey = dispatch.survey
    assert (survey.stops[0].agent, survey.visited, survey.leases) == ("bert", (stop.cell,), ())
    assert fold([OPENED, *memory.events]).stops == survey.stops
