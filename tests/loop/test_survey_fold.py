"""A survey is a fold over its events."""

from __future__ import annotations

from collections.abc import Callable
from datetime import UTC, datetime

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from subsoil.agent import drive
from subsoil.errors import BatteryError, CorruptJournalError, ParameterError, RobotError
from subsoil.reports import Quantity, Reading, Refused, Sampled
from subsoil.simulation import Machine, SimulatedRobot, Truth
from subsoil.strategies import Plan, View
from subsoil.survey import LocalDispatch, Memory, Survey, apply, decision, fold, opened
from subsoil.survey.events import (
    Assigned,
    BatterySwapped,
    Configured,
    Event,
    Finished,
    Fitted,
    Opened,
    Planned,
    from_json,
    same,
    to_json,
)

Configure = Callable[..., Configured]
SurveyPlot = Callable[..., tuple[Survey, list[Event]]]
Work = Callable[[LocalDispatch, Truth], str]

numbers = st.floats(allow_nan=False, allow_infinity=False, width=64)


def beyond(view: View) -> Plan:
    """A plan outside the field."""
    return Plan((len(view.field.cells),), "beyond")


def twice(_: View) -> Plan:
    """A plan that names a cell twice."""
    return Plan((3, 3), "twice")


def again(_: View) -> Plan:
    """A plan that never moves on."""
    return Plan((3,), "again")


def test_folding_the_events_gives_the_state_the_survey_ended_in(
    configured: Configure, survey_plot: SurveyPlot
) -> None:
    survey, events = survey_plot(configured())
    again = fold(events)
    assert again.finished == "8 samples taken"
    assert again.stops == survey.stops
    assert again.agents == survey.agents
    assert again.metres == survey.metres
    assert np.array_equal(again.soil_map.mean, survey.soil_map.mean)
    assert np.array_equal(again.soil_map.variance, survey.soil_map.variance)


def test_every_prefix_of_the_events_implies_the_next_planned_or_fitted_event(
    configured: Configure, survey_plot: SurveyPlot
) -> None:
    _, events = survey_plot(configured())
    first, *later = events
    assert isinstance(first, Opened)
    survey = opened(first)
    for event in later:
        if isinstance(event, Fitted | Planned | Finished):
            expected = decision(survey)
            assert expected is not None
            assert same(event, expected, tolerance=0.0)
        survey = apply(survey, event)


def test_a_survey_cut_off_anywhere_goes_on_to_the_same_end(
    configured: Configure, survey_plot: SurveyPlot, plot_truth: Truth, work: Work
) -> None:
    whole, events = survey_plot(configured("adaptive-greedy"))
    for cut in range(2, len(events)):
        dispatch = LocalDispatch(fold(events[:cut]), Memory())
        work(dispatch, plot_truth)
        assert dispatch.survey.visited == whole.visited
        assert dispatch.survey.metres == whole.metres
        assert np.array_equal(dispatch.survey.soil_map.mean, whole.soil_map.mean)


def test_a_report_that_comes_twice_counts_once(
    configured: Configure, survey_plot: SurveyPlot
) -> None:
    _, events = survey_plot(configured())
    report = next(event for event in events if isinstance(event, Sampled))
    survey = fold(events)
    assert apply(survey, report) is survey


def test_a_cell_outside_the_field_and_an_agent_that_never_joined_are_errors(
    configured: Configure, survey_plot: SurveyPlot
) -> None:
    survey, _ = survey_plot(configured(samples=2))
    for cell in (9999, -1):
        with pytest.raises(CorruptJournalError, match=f"cell {cell}"):
            apply(survey, Assigned(agent="robot", cell=cell))
        planned = Planned(step=survey.step, cells=(3, cell), reason="", mean_kv=1.0)
        with pytest.raises(CorruptJournalError, match=f"cell {cell}"):
            apply(survey, planned)
    for event in (
        Assigned(agent="nobody", cell=3),
        Refused(agent="nobody", at=(0, 0), reason="stone"),
        Sampled(agent="nobody", at=(0, 0), reading=Reading(depth_m=(0.1,), kpa=(500.0,))),
    ):
        with pytest.raises(CorruptJournalError, match="'nobody' never joined"):
            apply(survey, event)


def test_the_first_event_must_set_the_survey_up(configured: Configure) -> None:
    for events in ([], [configured()]):
        with pytest.raises(CorruptJournalError, match="never set up"):
            fold(events)


def test_more_samples_can_be_asked_of_a_finished_survey(
    configured: Configure, survey_plot: SurveyPlot, plot_truth: Truth, work: Work
) -> None:
    for strategy in ("area-split", "greedy", "adaptive-greedy"):
        short, _ = survey_plot(configured(strategy, 6))
        dispatch = LocalDispatch(short, Memory())
        dispatch.record(configured(strategy, 10))
        work(dispatch, plot_truth)
        assert len(dispatch.survey.visited) == 10
        assert dispatch.survey.visited[:6] == short.visited


def test_a_strategy_that_plans_what_cannot_be_is_named(
    configured: Configure, survey_plot: SurveyPlot
) -> None:
    for strategy, words in (
        ("beyond", "not in the field"),
        ("twice", "planned already"),
        ("again", "visited"),
    ):
        settings = configured(f"{__name__}:{strategy}")
        with pytest.raises(ParameterError, match=f"strategy .*{strategy}: it plans cell.*{words}"):
            survey_plot(settings)


def test_variograms_are_refitted_early_on_schedule_and_at_the_end(
    configured: Configure, survey_plot: SurveyPlot
) -> None:
    settings = configured("random", 23, refit_every=5)
    _, events = survey_plot(settings)
    fitted = [event.samples for event in events if isinstance(event, Fitted)]
    assert fitted == [*range(1, 13), 15, 20, 23]


def test_a_survey_whose_robot_runs_out_of_charge_goes_on_with_a_fresh_battery(
    plot_opened: Opened, configured: Configure, plot_truth: Truth
) -> None:
    machine = Machine(opened(plot_opened).cone, battery_s=400.0)
    dispatch = LocalDispatch(opened(plot_opened), Memory())
    dispatch.record(configured())
    dispatch.join("robot")

    def robot() -> SimulatedRobot:
        agent = dispatch.survey.agent("robot")
        left = machine.battery_s - (agent.seconds - agent.charged_at)
        cells = [stop.cell for stop in dispatch.survey.stops]
        at = tuple(plot_truth.field.cells[cells[-1]].tolist()) if cells else agent.position
        return SimulatedRobot(plot_truth, machine, seed=3, position=at, battery_s=left)

    with pytest.raises(BatteryError, match="battery"):
        drive("robot", robot(), dispatch)
    taken = dispatch.survey.taken
    assert 0 < taken < 8
    with pytest.raises(RobotError):
        drive("robot", robot(), dispatch)
    while not dispatch.survey.finished:
        dispatch.swap_battery("robot")
        try:
            drive("robot", robot(), dispatch)
        except BatteryError:
            continue
    assert dispatch.survey.taken == 8


def test_a_battery_swap_reopens_nothing(configured: Configure, survey_plot: SurveyPlot) -> None:
    survey, _ = survey_plot(configured(samples=3))
    swapped = apply(survey, BatterySwapped(agent="robot"))
    assert swapped.finished == survey.finished == "3 samples taken"
    assert swapped.agent("robot").charged_at == survey.agent("robot").seconds


@given(
    at=st.tuples(numbers, numbers),
    depth=st.lists(numbers, max_size=5),
    metres=numbers,
    kv=st.floats(allow_nan=True, allow_infinity=True),
    words=st.text(),
)
def test_events_survive_json_bit_for_bit(
    at: tuple[float, float], depth: list[float], metres: float, kv: float, words: str
) -> None:
    moisture = Quantity(name=words, unit="%", depth_m=tuple(depth), values=tuple(depth))
    reading = Reading(
        depth_m=tuple(depth), force_n=tuple(depth), ending="force", flags=(words,),
        further=(moisture,),
    )  # fmt: skip
    sampled = Sampled(
        agent=words, at=at, reading=reading, metres=metres, seconds=1.5, tries=2,
        time=datetime(2026, 1, 2, 3, 4, 5, 678901, tzinfo=UTC), clock="gnss",
    )  # fmt: skip
    planned = Planned(step=1, cells=(1, 2), reason=words, mean_kv=kv)
    for event in (sampled, planned, Finished(reason=words)):
        again = from_json(to_json(event))
        assert (again.id, again.time, again.clock) == (event.id, event.time, event.clock)
        assert same(again, event, tolerance=0.0)


@given(st.integers(0, 5), st.integers(0, 5))
def test_events_that_differ_are_not_the_same(a: int, b: int) -> None:
    first = Planned(step=1, cells=(a,), reason="r", mean_kv=1.0)
    second = Planned(step=1, cells=(b,), reason="r", mean_kv=1.0)
    assert same(first, second) == (a == b)
    assert not same(first, Finished(reason="r"))
