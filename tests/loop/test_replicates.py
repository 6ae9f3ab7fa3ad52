"""A stop may take several pushes: readings of their own, at one place, in their own time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import inf
from pathlib import Path

import numpy as np
import pytest

from subsoil.dispatch import Assignment, LocalDispatch, drive
from subsoil.errors import BatteryError, ParameterError
from subsoil.events import Configured, Event, Opened, Planned, Refused, Sampled, from_json, to_json
from subsoil.field import Field
from subsoil.journal import create
from subsoil.layers import Layers
from subsoil.sequel import next_event
from subsoil.simulation import Machine, SimulatedRobot, Truth, simulate
from subsoil.strategies import Plan, View
from subsoil.survey import Survey, apply, fold, opened
from subsoil.verification import verify

Configure = Callable[..., Configured]
RobotAt = Callable[[Survey, Truth], SimulatedRobot]

CELLS = (5, 30, 44, 77, 90)
PUSHES = (3, 1, 2, 1, 2)


def rows(view: View) -> Plan:
    """Five stops with up to three pushes each, then as planned."""
    if view.fresh:
        return Plan(CELLS, "rows", PUSHES)
    return Plan(view.plan, "as planned", view.pushes)


def too_few(_: View) -> Plan:
    """A plan that says of one stop only how often to push."""
    return Plan((3, 4), "too few", (2,))


def never(_: View) -> Plan:
    """A plan that stops somewhere and does not push."""
    return Plan((3, 4), "never", (1, 0))


class Notes:
    """Recorder in memory."""

    def __init__(self) -> None:
        self.events: list[Event] = []

    def append(self, event: Event, survey: Survey) -> None:
        assert survey is not None
        self.events.append(event)


def _settings(configured: Configure, strategy: str = "rows", samples: int = 5) -> Configured:
    settings = configured(f"{__name__}:{strategy}", samples)
    return settings.model_copy(update={"estimator": "pmc"})


def _surveyed(
    opening: Opened, settings: Configured, truth: Truth, robot_at: RobotAt
) -> tuple[Survey, list[Event]]:
    notes = Notes()
    dispatch = LocalDispatch(opened(opening), notes)
    dispatch.record(settings)
    drive("robot", robot_at(dispatch.survey, truth), dispatch)
    return dispatch.survey, [opening, *notes.events]


def _pushes(events: list[Event]) -> list[Sampled]:
    return [event for event in events if isinstance(event, Sampled)]


def test_every_push_is_a_report_of_its_own_and_every_stop_counts_once(
    plot_opened: Opened, configured: Configure, plot_truth: Truth, robot_at: RobotAt
) -> None:
    survey, events = _surveyed(plot_opened, _settings(configured), plot_truth, robot_at)
    asked = [cell for cell, k in zip(CELLS, PUSHES, strict=True) for _ in range(k)]
    assert [push.cell for push in _pushes(events)] == asked
    assert survey.visited == CELLS
    assert survey.repeats == (5, 5, 44, 90)
    assert survey.finished == "5 samples taken"
    assert len(survey.soil_map.samples) == sum(PUSHES)


def test_further_pushes_cost_their_time_and_no_way(
    plot_opened: Opened, configured: Configure, plot_truth: Truth, robot_at: RobotAt
) -> None:
    _, events = _surveyed(plot_opened, _settings(configured), plot_truth, robot_at)
    for before, push in zip(_pushes(events), _pushes(events)[1:], strict=False):
        if push.cell == before.cell:
            assert push.metres == 0.0
            assert push.seconds == 28.0 * push.tries
        else:
            assert push.seconds == pytest.approx(push.metres + 50.0 + 28.0 * (push.tries - 1))


def test_holes_of_a_stop_lie_apart_and_its_readings_are_kriged_at_one_place(
    plot_opened: Opened, configured: Configure, plot_truth: Truth, robot_at: RobotAt
) -> None:
    survey, events = _surveyed(plot_opened, _settings(configured), plot_truth, robot_at)
    holes = [push.at for push in _pushes(events)]
    assert len(set(holes)) == len(holes)
    for hole in holes[1:3]:
        assert 0.15 < np.hypot(*np.subtract(hole, holes[0])) < 0.7
    assert len(np.unique(survey.soil_map.at, axis=0)) == len(CELLS)
    assert [s.at for s in survey.soil_map.samples[:3]] == [holes[0]] * 3


def test_pushes_of_a_stop_count_as_their_mean_with_a_share_of_the_nugget(
    plot_opened: Opened, configured: Configure, plot_truth: Truth, robot_at: RobotAt
) -> None:
    survey, _ = _surveyed(plot_opened, _settings(configured), plot_truth, robot_at)
    soil_map, place = survey.soil_map, survey.places[0]
    for stack in soil_map.stacks:
        kriging = stack.estimate.kriging
        readings = kriging.system.readings
        here = int(np.flatnonzero((readings.at == place).all(axis=1))[0])
        at_stop = [s.measured_kpa[list(stack.layers)] for s in soil_map.samples if s.at == place]
        reached = [kpa for kpa in at_stop if np.isfinite(kpa).all()]
        assert readings.z[:, here] == pytest.approx(np.mean(reached, axis=0))
        nugget = kriging.system.covariance.noise
        assert readings.noise[:, here] == pytest.approx(nugget / len(reached))


@pytest.mark.parametrize("estimator", ["pmc", "paper-10"])
def test_a_survey_cut_off_anywhere_makes_the_pushes_that_are_due_and_ends_the_same(
    plot_opened: Opened,
    configured: Configure,
    plot_truth: Truth,
    robot_at: RobotAt,
    estimator: str,
) -> None:
    settings = _settings(configured).model_copy(update={"estimator": estimator})
    whole, events = _surveyed(plot_opened, settings, plot_truth, robot_at)
    for cut in range(2, len(events)):
        dispatch = LocalDispatch(fold(events[:cut]), Notes())
        drive("robot", robot_at(dispatch.survey, plot_truth), dispatch)
        survey = dispatch.survey
        assert (survey.visited, survey.repeats) == (whole.visited, whole.repeats)
        assert (survey.metres, survey.seconds) == (whole.metres, whole.seconds)
        assert np.array_equal(survey.soil_map.mean, whole.soil_map.mean)
        assert np.array_equal(survey.soil_map.variance, whole.soil_map.variance)


def test_nothing_is_planned_or_fitted_before_a_stop_is_over(
    plot_opened: Opened, configured: Configure, plot_truth: Truth, robot_at: RobotAt
) -> None:
    _, events = _surveyed(plot_opened, _settings(configured), plot_truth, robot_at)
    first = events.index(_pushes(events)[0])
    survey = fold(events[: first + 1])
    assert (survey.due, survey.next_stop) == (2, (5, 2))
    assert next_event(survey) is None
    dispatch = LocalDispatch(survey, Notes())
    assert dispatch.assign("robot") == Assignment(5, tuple(survey.field.cells[5]), 1, 2)


def test_a_battery_that_ends_between_two_pushes_loses_none(
    plot_opened: Opened, configured: Configure, plot_truth: Truth
) -> None:
    dispatch = LocalDispatch(apply(opened(plot_opened), _settings(configured)), Notes())

    def robot(battery_s: float) -> SimulatedRobot:
        survey = dispatch.survey
        return SimulatedRobot(
            plot_truth, Machine(survey.cone), seed=3, position=survey.position, stop=survey.step,
            pushed=survey.pushed, battery_s=battery_s,
        )  # fmt: skip

    with pytest.raises(BatteryError):
        drive("robot", robot(160.0), dispatch)
    assert dispatch.survey.due > 0
    drive("robot", robot(inf), dispatch)
    assert (dispatch.survey.visited, dispatch.survey.repeats) == (CELLS, (5, 5, 44, 90))


def test_a_refusal_ends_its_stop_and_does_not_take_back_its_reading(
    plot_opened: Opened, configured: Configure, plot_truth: Truth, robot_at: RobotAt
) -> None:
    _, events = _surveyed(plot_opened, _settings(configured), plot_truth, robot_at)
    survey = fold(events[: events.index(_pushes(events)[0]) + 1])
    at = survey.position
    stone = Refused(agent="a", cell=5, at=at, reason="stone", metres=0, seconds=84, tries=3)
    after = apply(survey, stone)
    assert (after.due, after.visited, after.refused, after.step) == (0, (5,), (), 1)
    assert after.seconds == survey.seconds + 84
    refused_first = apply(fold(events[: events.index(_pushes(events)[0])]), stone)
    assert (refused_first.due, refused_first.visited, refused_first.refused) == (0, (), (5,))


def test_the_minutes_of_a_stop_hold_all_its_pushes(
    plot_opened: Opened, configured: Configure
) -> None:
    survey = apply(opened(plot_opened), _settings(configured))
    survey = apply(survey, Planned(step=0, cells=(30,), reason="", mean_kv=0.0))
    once = survey.spent_after_next.minutes
    planned = Planned(step=0, cells=(30,), reason="", mean_kv=0.0, pushes=(3,))
    assert apply(survey, planned).spent_after_next.minutes == pytest.approx(once + 2 * 28.0 / 60.0)
    assert from_json(to_json(planned)) == planned


def test_plans_whose_pushes_do_not_fit_are_named(
    plot_opened: Opened, configured: Configure, plot_truth: Truth, robot_at: RobotAt
) -> None:
    for strategy in ("too_few", "never"):
        with pytest.raises(ParameterError, match=f"{strategy}: it plans .* pushes at 2 stops"):
            _surveyed(plot_opened, _settings(configured, strategy), plot_truth, robot_at)


def test_a_survey_file_with_further_pushes_verifies(
    tmp_path: Path,
    plot_opened: Opened,
    configured: Configure,
    plot_truth: Truth,
    robot_at: RobotAt,
) -> None:
    path = tmp_path / "survey.gpkg"
    with create(path, plot_opened) as journal:
        dispatch = LocalDispatch(opened(plot_opened), journal)
        dispatch.record(_settings(configured))
        drive("robot", robot_at(dispatch.survey, plot_truth), dispatch)
    assert verify(path) == ()


def test_further_pushes_deviate_from_the_soil_as_first_ones_do_but_on_their_own() -> None:
    field = Field.from_metres([(0, 0), (180, 0), (180, 130), (0, 130)])
    truth = simulate(field, np.random.default_rng(2), Layers())
    n = len(field.cells)
    off = np.array([
        [truth.reading(cell, push) - truth.kpa[:, cell] for cell in range(n)] for push in range(3)
    ])  # fmt: skip
    assert np.allclose(off[0].T, truth.noise)
    sd = off.std(axis=1)
    # An SD of n draws of a normal has a relative error of 1 / sqrt(2 n), here 5 SDs of it.
    assert sd[1:] == pytest.approx(np.tile(sd[0], (2, 1)), rel=5 * np.sqrt(1 / n))
    for one, other in ((0, 1), (0, 2), (1, 2)):
        for layer in range(8):
            r = np.corrcoef(off[one][:, layer], off[other][:, layer])[0, 1]
            assert abs(r) < 5 / np.sqrt(n)
    kept, again = (np.corrcoef(off[push].T)[2, 3] for push in (0, 1))
    assert again == pytest.approx(kept, abs=5 / np.sqrt(n))


def test_without_noise_every_push_of_a_cell_reads_the_same(plot_truth: Truth) -> None:
    quiet = replace(plot_truth, noise=np.zeros_like(plot_truth.noise))
    assert np.array_equal(quiet.reading(7, 2), quiet.reading(7))
