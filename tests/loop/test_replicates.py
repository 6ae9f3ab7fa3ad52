"""A stop may take several pushes: readings of their own, at one place, in their own time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import inf
from pathlib import Path

import numpy as np
import pytest

from subsoil.agent import Assignment, drive
from subsoil.errors import BatteryError, ParameterError
from subsoil.journal import create, verify
from subsoil.kriging.kriged_at import KrigedAt
from subsoil.land.field import Field
from subsoil.layers import Layers
from subsoil.registry import Allowed
from subsoil.reports import Refused, Sampled
from subsoil.simulation import Machine, SimulatedRobot, Truth, draw_truth
from subsoil.strategies import Plan, View
from subsoil.survey import LocalDispatch, Memory, Survey, apply, decision, fold, opened
from subsoil.survey.events import Configured, Event, Opened, Planned, from_json, to_json
from subsoil.survey.state import stop_of

Configure = Callable[..., Configured]
SurveyPlot = Callable[..., tuple[Survey, list[Event]]]
Work = Callable[[LocalDispatch, Truth], str]

ALLOWED = Allowed(frozenset([__name__]))
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


def _settings(configured: Configure, strategy: str = "rows", **changes: object) -> Configured:
    return configured(f"{__name__}:{strategy}", 5, **{"estimator": "pmc", **changes})


def _pushes(events: list[Event]) -> list[Sampled]:
    return [event for event in events if isinstance(event, Sampled)]


def _stop_of(event: Sampled, survey: Survey) -> int:
    """Cell of the stop that a push was made at."""
    return stop_of(survey, event).cell


def test_every_push_is_a_report_of_its_own_and_every_stop_counts_once(
    configured: Configure, survey_plot: SurveyPlot
) -> None:
    survey, events = survey_plot(_settings(configured))
    asked = [cell for cell, k in zip(CELLS, PUSHES, strict=True) for _ in range(k)]
    assert [_stop_of(push, survey) for push in _pushes(events)] == asked
    assert [len(stop.readings) for stop in survey.stops] == list(PUSHES)
    assert survey.visited == CELLS
    assert survey.repeats == (5, 5, 44, 90)
    assert survey.finished == "5 samples taken"
    assert len(survey.soil_map.samples) == sum(PUSHES)


def test_further_pushes_cost_their_time_and_no_way(
    configured: Configure, survey_plot: SurveyPlot
) -> None:
    _, events = survey_plot(_settings(configured))
    for before, push in zip(_pushes(events), _pushes(events)[1:], strict=False):
        if push.assignment == before.assignment:
            assert push.metres == 0.0
            assert push.seconds == 28.0 * push.tries
        else:
            assert push.seconds == pytest.approx(push.metres + 50.0 + 28.0 * (push.tries - 1))


def test_holes_of_a_stop_lie_apart_and_readings_are_kriged_where_they_were_taken(
    configured: Configure, survey_plot: SurveyPlot
) -> None:
    survey, events = survey_plot(_settings(configured))
    holes = [push.at for push in _pushes(events)]
    assert len(set(holes)) == len(holes)
    for hole in holes[1:3]:
        assert 0.15 < np.hypot(*np.subtract(hole, holes[0])) < 0.7
    assert [sample.at for sample in survey.soil_map.samples] == holes
    assert len(survey.stops) == len(CELLS)


def test_pushes_in_one_hole_count_as_their_mean_with_a_share_of_the_nugget(
    configured: Configure, survey_plot: SurveyPlot
) -> None:
    _, events = survey_plot(_settings(configured))
    place = _pushes(events)[0].at
    at_stop = {push.id for push in _pushes(events)[: PUSHES[0]]}
    moved = [
        event.model_copy(update={"at": place}) if event.id in at_stop else event for event in events
    ]
    soil_map = fold(moved).soil_map
    for stack in soil_map.stacks:
        assert isinstance(stack.estimate, KrigedAt)
        kriging = stack.estimate.kriging
        readings = kriging.system.readings
        here = int(np.flatnonzero((readings.at == place).all(axis=1))[0])
        layers = list(stack.layers)
        pushes = [s.measured_kpa[layers] for s in soil_map.samples if s.at == place]
        reached = [kpa for kpa in pushes if np.isfinite(kpa).all()]
        assert readings.z[:, here] == pytest.approx(np.mean(reached, axis=0))
        nugget = kriging.system.covariance.noise
        assert readings.noise[:, here] == pytest.approx(nugget / len(reached))


@pytest.mark.parametrize("estimator", ["pmc", "paper-10"])
def test_a_survey_cut_off_anywhere_makes_the_pushes_that_are_due_and_ends_the_same(
    configured: Configure,
    survey_plot: SurveyPlot,
    plot_truth: Truth,
    work: Work,
    estimator: str,
) -> None:
    whole, events = survey_plot(_settings(configured, estimator=estimator))
    for cut in range(2, len(events)):
        dispatch = LocalDispatch(fold(events[:cut]), Memory(), allowed=ALLOWED)
        work(dispatch, plot_truth)
        survey = dispatch.survey
        assert (survey.visited, survey.repeats) == (whole.visited, whole.repeats)
        assert (survey.metres, survey.minutes) == (whole.metres, whole.minutes)
        assert np.array_equal(survey.soil_map.mean, whole.soil_map.mean)
        assert np.array_equal(survey.soil_map.variance, whole.soil_map.variance)


def test_nothing_is_planned_or_fitted_before_a_stop_is_over(
    configured: Configure, survey_plot: SurveyPlot
) -> None:
    _, events = survey_plot(_settings(configured))
    first = events.index(_pushes(events)[0])
    survey = fold(events[: first + 1])
    (lease,) = survey.leases
    assert (lease.cell, lease.pushes, lease.made) == (5, 3, 1)
    assert decision(survey) is None
    dispatch = LocalDispatch(survey, Memory())
    stop = dispatch.assign("robot")
    assert isinstance(stop, Assignment)
    assert (stop.id, stop.cell, stop.pushes, stop.made) == (lease.id, 5, 3, 1)
    assert stop.at == tuple(survey.field.cells[5])


def test_a_battery_that_ends_between_two_pushes_loses_none(
    plot_opened: Opened, configured: Configure, plot_truth: Truth
) -> None:
    dispatch = LocalDispatch(opened(plot_opened), Memory(), allowed=ALLOWED)
    dispatch.record(_settings(configured))
    dispatch.join("robot")

    def robot(at: tuple[float, float], battery_s: float) -> SimulatedRobot:
        machine = Machine(dispatch.survey.cone)
        return SimulatedRobot(plot_truth, machine, seed=3, position=at, battery_s=battery_s)

    with pytest.raises(BatteryError):
        drive("robot", robot((0.0, 0.0), 160.0), dispatch)
    (lease,) = dispatch.survey.leases
    assert 0 < lease.made < lease.pushes
    drive("robot", robot(dispatch.survey.position, inf), dispatch)
    assert (dispatch.survey.visited, dispatch.survey.repeats) == (CELLS, (5, 5, 44, 90))


def test_a_refusal_ends_its_stop_and_does_not_take_back_its_reading(
    configured: Configure, survey_plot: SurveyPlot
) -> None:
    _, events = survey_plot(_settings(configured))
    first = events.index(_pushes(events)[0])
    before, survey = fold(events[:first]), fold(events[: first + 1])
    (lease,) = survey.leases
    stone = Refused(
        agent="robot", assignment=lease.id, at=survey.position, reason="stone", seconds=84, tries=3
    )
    after = apply(survey, stone)
    assert (after.leases, after.visited, after.refused, after.step) == ((), (5,), (), 1)
    assert after.agent("robot").seconds == survey.agent("robot").seconds + 84
    refused_first = apply(before, stone)
    assert (refused_first.leases, refused_first.visited) == ((), ())
    assert refused_first.refused == (5,)


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
    configured: Configure, survey_plot: SurveyPlot
) -> None:
    for strategy in ("too_few", "never"):
        with pytest.raises(ParameterError, match=f"{strategy}: it plans .* pushes at 2 stops"):
            survey_plot(_settings(configured, strategy))


def test_a_survey_file_with_further_pushes_verifies(
    tmp_path: Path, plot_opened: Opened, configured: Configure, plot_truth: Truth, work: Work
) -> None:
    path = tmp_path / "survey.gpkg"
    with create(path, plot_opened) as journal:
        dispatch = LocalDispatch(opened(plot_opened), journal, allowed=ALLOWED)
        dispatch.record(_settings(configured))
        work(dispatch, plot_truth)
    assert verify(path, ALLOWED).findings == ()
    assert verify(path).findings == ()
    assert any(f"give --allow {__name__}" in note for note in verify(path).notes)


def test_further_pushes_deviate_from_the_soil_as_first_ones_do_but_on_their_own() -> None:
    field = Field.from_metres([(0, 0), (180, 0), (180, 130), (0, 130)])
    truth = draw_truth(field, np.random.default_rng(2), Layers())
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
