"""A survey is a fold over its events."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from subsoil.dispatch import LocalDispatch, drive
from subsoil.errors import BatteryError, CorruptJournalError, ParameterError, RobotError
from subsoil.events import (
    BatterySwapped,
    Configured,
    Event,
    Finished,
    Fitted,
    Opened,
    Planned,
    Refused,
    Sampled,
    from_json,
    same,
    to_json,
)
from subsoil.sequel import next_event
from subsoil.simulation import Machine, SimulatedRobot, Truth
from subsoil.strategies import Plan, View
from subsoil.survey import Survey, apply, fold, opened

Configure = Callable[..., Configured]
RobotAt = Callable[[Survey, Truth], SimulatedRobot]

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


class Notes:
    """Recorder in memory."""

    def __init__(self) -> None:
        self.events: list[Event] = []

    def append(self, event: Event, survey: Survey) -> None:
        assert survey is not None
        self.events.append(event)


def surveyed(
    opening: Opened, settings: Configured, truth: Truth, robot_at: RobotAt
) -> tuple[Survey, list[Event]]:
    notes = Notes()
    dispatch = LocalDispatch(opened(opening), notes)
    dispatch.record(settings)
    drive("robot", robot_at(dispatch.survey, truth), dispatch)
    return dispatch.survey, [opening, *notes.events]


def test_folding_the_events_gives_the_state_the_survey_ended_in(
    plot_opened: Opened, configured: Configure, plot_truth: Truth, robot_at: RobotAt
) -> None:
    survey, events = surveyed(plot_opened, configured(), plot_truth, robot_at)
    again = fold(events)
    assert again.finished == "8 samples taken"
    assert again.visited == survey.visited
    assert again.metres == survey.metres
    assert np.array_equal(again.soil_map.mean, survey.soil_map.mean)
    assert np.array_equal(again.soil_map.variance, survey.soil_map.variance)


def test_every_prefix_of_the_events_implies_the_next_planned_or_fitted_event(
    plot_opened: Opened, configured: Configure, plot_truth: Truth, robot_at: RobotAt
) -> None:
    _, events = surveyed(plot_opened, configured(), plot_truth, robot_at)
    survey = opened(plot_opened)
    for event in events[1:]:
        if not isinstance(event, Configured | Sampled | Refused):
            expected = next_event(survey)
            assert expected is not None
            assert same(event, expected, tolerance=0.0)
        survey = apply(survey, event)


def test_a_survey_cut_off_anywhere_goes_on_to_the_same_end(
    plot_opened: Opened, configured: Configure, plot_truth: Truth, robot_at: RobotAt
) -> None:
    whole, events = surveyed(plot_opened, configured("adaptive-greedy"), plot_truth, robot_at)
    for cut in range(2, len(events)):
        dispatch = LocalDispatch(fold(events[:cut]), Notes())
        drive("robot", robot_at(dispatch.survey, plot_truth), dispatch)
        assert dispatch.survey.visited == whole.visited
        assert np.array_equal(dispatch.survey.soil_map.mean, whole.soil_map.mean)


def test_a_report_that_comes_twice_counts_once(
    plot_opened: Opened, configured: Configure, plot_truth: Truth, robot_at: RobotAt
) -> None:
    _, events = surveyed(plot_opened, configured(), plot_truth, robot_at)
    report = next(event for event in events if isinstance(event, Sampled))
    survey = fold(events)
    assert apply(survey, report) is survey


def test_a_report_on_a_cell_outside_the_field_is_an_error(
    plot_opened: Opened, configured: Configure
) -> None:
    dispatch = LocalDispatch(apply(opened(plot_opened), configured()), Notes())
    report = Refused(agent="a", cell=9999, at=(0, 0), reason="stone", metres=1, seconds=1, tries=1)
    with pytest.raises(CorruptJournalError, match="cell 9999"):
        dispatch.report(report)


def test_the_first_event_must_set_the_survey_up(configured: Configure) -> None:
    for events in ([], [configured()]):
        with pytest.raises(CorruptJournalError, match="never set up"):
            fold(events)


def test_more_samples_can_be_asked_of_a_finished_survey(
    plot_opened: Opened, configured: Configure, plot_truth: Truth, robot_at: RobotAt
) -> None:
    for strategy in ("area-split", "greedy", "adaptive-greedy"):
        short, _ = surveyed(plot_opened, configured(strategy, 6), plot_truth, robot_at)
        dispatch = LocalDispatch(short, Notes())
        dispatch.record(configured(strategy, 10))
        drive("robot", robot_at(dispatch.survey, plot_truth), dispatch)
        assert len(dispatch.survey.visited) == 10
        assert dispatch.survey.visited[:6] == short.visited


def test_a_strategy_that_plans_what_cannot_be_is_named(
    plot_opened: Opened, configured: Configure, plot_truth: Truth, robot_at: RobotAt
) -> None:
    for strategy, words in (
        ("beyond", "not in the field"),
        ("twice", "planned already"),
        ("again", "visited"),
    ):
        settings = configured(f"{__name__}:{strategy}")
        with pytest.raises(ParameterError, match=f"strategy .*{strategy}: it plans cell.*{words}"):
            surveyed(plot_opened, settings, plot_truth, robot_at)


def test_variograms_are_refitted_early_on_schedule_and_at_the_end(
    plot_opened: Opened, configured: Configure, plot_truth: Truth, robot_at: RobotAt
) -> None:
    settings = configured("random", 23).model_copy(update={"refit_every": 5})
    _, events = surveyed(plot_opened, settings, plot_truth, robot_at)
    fitted = [event.samples for event in events if isinstance(event, Fitted)]
    assert fitted == [*range(1, 13), 15, 20, 23]


def test_a_survey_whose_robot_runs_out_of_charge_goes_on_with_a_fresh_battery(
    plot_opened: Opened, configured: Configure, plot_truth: Truth
) -> None:
    machine = Machine(opened(plot_opened).cone, battery_s=400.0)
    dispatch = LocalDispatch(apply(opened(plot_opened), configured()), Notes())

    def robot() -> SimulatedRobot:
        survey = dispatch.survey
        left = machine.battery_s - (survey.seconds - survey.charged_at)
        return SimulatedRobot(
            plot_truth, machine, seed=3, position=survey.position, stop=survey.step, battery_s=left
        )

    with pytest.raises(BatteryError, match="battery"):
        drive("robot", robot(), dispatch)
    taken = len(dispatch.survey.visited)
    assert 0 < taken < 8
    with pytest.raises(RobotError):
        drive("robot", robot(), dispatch)
    while not dispatch.survey.finished:
        dispatch.record(BatterySwapped())
        try:
            drive("robot", robot(), dispatch)
        except BatteryError:
            continue
    assert len(dispatch.survey.visited) == 8


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
    sampled = Sampled(
        agent=words, cell=3, at=at, depth_m=tuple(depth), force_n=tuple(depth), ending="force",
        metres=metres, seconds=1.5, tries=2,
    )  # fmt: skip
    planned = Planned(step=1, cells=(1, 2), reason=words, mean_kv=kv)
    for event in (sampled, planned, Finished(reason=words)):
        again = from_json(to_json(event))
        assert again.id == event.id
        assert same(again, event, tolerance=0.0)


@given(st.integers(0, 5), st.integers(0, 5))
def test_events_that_differ_are_not_the_same(a: int, b: int) -> None:
    first = Planned(step=1, cells=(a,), reason="r", mean_kv=1.0)
    second = Planned(step=1, cells=(b,), reason="r", mean_kv=1.0)
    assert same(first, second) == (a == b)
    assert not same(first, Finished(reason="r"))
