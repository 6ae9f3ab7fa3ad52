"""What a survey measured goes out again as it came in: readings, samples, fits and how it went."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import isnan, nan

import numpy as np
import pytest

from subsoil.agent import Assignment, Push
from subsoil.errors import ParameterError
from subsoil.findings import others
from subsoil.land.field import Field
from subsoil.layers import Layers
from subsoil.mapping.scores import rmse
from subsoil.penetrometer import SMALL_CONE
from subsoil.reports import Reading, Refused, Sampled, Source
from subsoil.simulation import Truth, draw_truth
from subsoil.strategies import Plan, View
from subsoil.survey import (
    LocalDispatch,
    Memory,
    Settings,
    Survey,
    apply,
    fits_of,
    opened,
    opening,
)
from subsoil.survey.events import Configured, Event, Fitted, Joined, Opened, Planned, Simulation
from subsoil.survey.measured import estimator_of, mappable, readings_of, sample_of
from subsoil.survey.progress import History, progress_of
from subsoil.survey.records import fit_record
from subsoil.survey.settings import checked
from subsoil.survey.simulated import SIMULATED, robot_of, simulate, simulation_of, soil_drawn
from subsoil.variogram import Spherical, empirical_layers

Configure = Callable[..., Configured]
SurveyPlot = Callable[..., tuple[Survey, list[Event]]]
Work = Callable[[LocalDispatch, Truth], str]

FIELD = Field.from_metres([(0, 0), (60, 0), (60, 40), (0, 40)], name="plot")
LAYERS = Layers((0.0, 0.2, 0.4))


def pushed(k: int, at: tuple[float, float], kpa: tuple[float, ...] = (500.0, 900.0)) -> Sampled:
    reading = Reading(depth_m=(0.2, 0.4)[: len(kpa)], kpa=kpa)
    return Sampled(id=f"reading {k}", agent="anna", at=at, reading=reading)


@pytest.fixture
def hand() -> Survey:
    """Three readings by hand, the second of a shallow push."""
    survey = apply(opened(opening(FIELD, LAYERS, SMALL_CONE)), Joined(agent="anna"))
    survey = apply(survey, pushed(0, (2.5, 2.5)))
    survey = apply(survey, pushed(1, (32.5, 12.5), (640.0,)))
    return apply(survey, pushed(2, (57.5, 37.5), (700.0, 1100.0)))


def test_readings_come_out_in_order_with_the_place_and_depths_they_were_taken_at(
    hand: Survey,
) -> None:
    readings = readings_of(hand)
    assert readings.at.tolist() == [[2.5, 2.5], [32.5, 12.5], [57.5, 37.5]]
    assert [each.kpa.tolist() for each in readings.profiles] == [
        [500.0, 900.0], [640.0], [700.0, 1100.0],
    ]  # fmt: skip
    assert np.allclose(
        readings.layer_means(LAYERS), [[500.0, 640.0, 700.0], [900.0, nan, 1100.0]], equal_nan=True
    )
    assert (readings.source, readings.extent_m, readings.simulated) == (
        "plot", FIELD.extent_m, False,
    )  # fmt: skip


def test_a_reading_that_says_nothing_true_is_kept_and_not_mapped(hand: Survey) -> None:
    """None enters today; files of earlier versions hold some."""
    lost = pushed(3, (nan, 2.5))
    bad = pushed(4, (7.5, 7.5), (nan, 1.0))
    survey = apply(apply(hand, lost), bad)
    assert [mappable(survey, each) for each in survey.readings] == [True, True, True, False, False]
    assert len(survey.soil_map.samples) == len(readings_of(survey)) == 3
    assert survey.notes[-1] == "2 readings say nothing that can be true, and are not mapped"
    assert others(readings_of(survey).findings) == survey.notes
    once = apply(hand, lost)
    assert once.notes[-1] == "1 reading says nothing that can be true, and is not mapped"


def test_a_sample_is_the_layer_means_of_its_push_at_its_own_place(hand: Survey) -> None:
    sample = sample_of(hand, pushed(7, (9.0, 9.0), (300.0, 500.0)))
    assert sample.at == (9.0, 9.0)
    assert sample.kpa.tolist() == [300.0, 500.0]


def test_fits_of_a_survey_are_those_recorded_with_the_bins_of_its_samples(
    configured: Configure, survey_plot: SurveyPlot
) -> None:
    survey, events = survey_plot(configured("area-split", samples=9))
    recorded = [event for event in events if isinstance(event, Fitted)][-1]
    fits = fits_of(survey)
    again = estimator_of(survey)(survey.soil_map.at, survey.soil_map.kpa)
    for fit, record, peer in zip(fits, recorded.fits, again, strict=True):
        assert fit.variogram == record.model.variogram == peer.variogram
        assert fit.why == record.why
        assert np.array_equal(fit.empirical.lag, peer.empirical.lag)
        assert np.array_equal(fit.empirical.semivariance, peer.empirical.semivariance)
        assert np.array_equal(fit.empirical.pairs, peer.empirical.pairs)


def test_fits_of_an_estimator_of_ones_own_have_the_usual_bins() -> None:
    def own(_: np.ndarray, z: np.ndarray) -> tuple[Spherical, ...]:
        return tuple(Spherical(100.0, 20.0, 4000.0) for _ in z)

    survey = simulate(FIELD, "area-split", samples=6, seed=1, estimator=own, layers=LAYERS)
    bins = empirical_layers(survey.soil_map.at, survey.soil_map.kpa)
    for fit, peer in zip(fits_of(survey), bins, strict=True):
        assert fit.variogram == Spherical(100.0, 20.0, 4000.0)
        assert np.array_equal(fit.empirical.semivariance, peer.semivariance)


def test_bins_of_a_layer_that_follows_the_covariate_are_of_what_that_leaves() -> None:
    """Residuals of a straight line through covariate and readings, by numpy.polyfit."""
    rng = np.random.default_rng(5)
    covariate = 10.0 + FIELD.cells[:, 0] / 6.0
    survey = opened(opening(FIELD, LAYERS, SMALL_CONE, covariate.tolist()))
    settings = Settings(start=(0.0, 0.0), estimator="spherical", samples=30)
    survey = apply(apply(survey, Configured(settings=settings)), Joined(agent="anna"))
    cells = rng.choice(len(FIELD.cells), 16, replace=False)
    for k, cell in enumerate(cells.tolist()):
        east, north = FIELD.cells[cell].tolist()
        kpa = (300.0 + 40.0 * covariate[cell] + rng.normal(0, 8), 900.0 + rng.normal(0, 50))
        survey = apply(survey, pushed(k, (east, north), kpa))
    z = survey.soil_map.kpa
    line = np.polyfit(covariate[cells], z[0], 1)
    rest = np.array([z[0] - np.polyval(line, covariate[cells]), z[1]])
    peers = estimator_of(survey)(survey.soil_map.at, rest)
    follows = replace(survey, soil_map=replace(survey.soil_map, drift=(0,)))
    told = fit_record(peers[1])
    recorded = apply(follows, Fitted(samples=16, drift=(0,), fits=(told, told)))
    for fit, peer in zip(fits_of(recorded), peers, strict=True):
        assert fit.empirical.semivariance == pytest.approx(peer.empirical.semivariance, rel=1e-9)


# How it went


def test_a_history_has_where_the_survey_stood_after_each_plan_and_events_tell_it_again(
    plot_opened: Opened, plot_truth: Truth, configured: Configure, work: Work
) -> None:
    history, memory = History(plot_truth), Memory()
    states: list[Survey] = []

    def follow(survey: Survey, event: Event) -> None:
        history(survey, event)
        if isinstance(event, Planned) and survey.taken:
            states.append(survey)

    dispatch = LocalDispatch(opened(plot_opened), memory, follow)
    dispatch.record(configured("area-split", samples=6))
    work(dispatch, plot_truth)
    assert [entry.samples for entry in history.entries] == [1, 2, 3, 4, 5]
    for entry, state in zip(history.entries, states, strict=True):
        assert entry.rmse == rmse(state.soil_map.mean, plot_truth.kpa)
        assert (entry.metres, entry.minutes) == (state.metres, state.minutes)
    told = progress_of(plot_opened, memory.events)
    assert [entry.samples for entry in told] == [2, 3, 4, 5]
    for entry, seen in zip(told, history.entries[1:], strict=True):
        assert isnan(entry.rmse)
        assert replace(entry, rmse=seen.rmse) == seen
    history.look(dispatch.survey)
    assert history.entries[-1].samples == 6


def test_a_survey_without_events_went_nowhere(plot_opened: Opened) -> None:
    assert progress_of(plot_opened, ()) == ()


# In a simulated soil


def test_a_simulation_is_known_again_by_its_first_middle_and_last_cell() -> None:
    truth = soil_drawn(FIELD, LAYERS, seed=4)
    record = simulation_of(truth, "simulated", 4)
    assert record == Simulation(
        world="simulated", seed=4,
        check_kpa=tuple(float(truth.kpa[k, cell]) for k in range(2) for cell in (0, 48, 95)),
    )  # fmt: skip
    assert np.array_equal(soil_drawn(FIELD, LAYERS, seed=4).kpa, truth.kpa)
    assert not np.array_equal(soil_drawn(FIELD, LAYERS, seed=5).kpa, truth.kpa)


def first_free(view: View) -> Plan:
    """The first free cell."""
    return Plan(tuple(np.flatnonzero(view.free)[:1].tolist()), "the first")


def test_a_soil_that_is_given_is_surveyed_in_its_own_layers_by_a_function_in_memory() -> None:
    truth = draw_truth(FIELD, np.random.default_rng(3), LAYERS)
    run = simulate(FIELD, first_free, samples=4, truth=truth, seed=2, estimator="paper-10")
    assert run.layers == LAYERS
    assert run.visited == (0, 1, 2, 3)
    assert run.settings.strategy.endswith(":first_free")
    assert (run.simulation[0].world, run.simulation[0].seed) == ("simulated", 2)
    assert run.simulated
    drawn = simulate(FIELD, first_free, samples=4, seed=2, layers=LAYERS, estimator="paper-10")
    assert not np.allclose(drawn.soil_map.kpa, run.soil_map.kpa)


def test_a_simulated_survey_keeps_to_its_metres_and_minutes() -> None:
    short = simulate(FIELD, "area-split", samples=20, seed=1, estimator="paper-10", metres=60.0)
    assert short.metres <= 60.0 < short.spent_after_next.metres
    assert "metres driven" in short.finished
    quick = simulate(FIELD, "area-split", samples=20, seed=1, estimator="paper-10", minutes=6.0)
    assert "minutes spent" in quick.finished


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        (
            {"samples": 97},
            "--samples: 97 samples are more than the field's 96 cells (remedy: take fewer, or "
            "start a survey with smaller cells)",
        ),
        ({"metres": 3.0}, "--metres: 3 m do not reach the nearest cell, 3.5 m away"),
        ({"minutes": 0.5}, "--minutes: 0.5 min are too few for one stop, which takes 0.9"),
    ],
)
def test_settings_that_leave_no_room_for_a_stop_say_by_how_much(
    changes: dict[str, float], said: str
) -> None:
    settings = Settings(start=(0.0, 0.0)).model_copy(update=changes)
    with pytest.raises(ParameterError) as caught:
        checked(settings, FIELD)
    assert str(caught.value) == said


def test_the_robot_of_a_survey_stands_where_it_was_last_sent_with_the_battery_it_has_left(
    plot_opened: Opened, plot_truth: Truth, configured: Configure
) -> None:
    dispatch = LocalDispatch(opened(plot_opened), Memory())
    dispatch.record(configured("area-split", samples=5, seed=9))
    dispatch.join(SIMULATED, "simulator", simulation=Simulation(world="simulated", seed=9))
    first = robot_of(dispatch.survey, plot_truth)
    assert first.position == (0.0, 0.0)
    assert first.battery_s == first.machine.battery_s
    assert first.seed == 9
    stop = dispatch.assign(SIMULATED)
    assert isinstance(stop, Assignment)
    arrival, push = first.go_to(stop), first.probe()
    assert isinstance(push, Push)
    dispatch.report(
        Sampled(
            agent=SIMULATED, assignment=stop.id, at=push.at, metres=arrival.metres,
            seconds=arrival.seconds + push.seconds, reading=push.reading,
            source=Source(kind="simulator"),
        )
    )  # fmt: skip
    then = robot_of(dispatch.survey, plot_truth)
    assert then.position == stop.at == first.position
    assert then.battery_s == pytest.approx(first.battery_s)


def test_a_refused_stop_takes_a_cell_out_of_the_way_and_leaves_no_sample(hand: Survey) -> None:
    stone = Refused(agent="anna", at=(22.5, 22.5), reason="a stone", metres=9.0, seconds=60.0)
    after = apply(hand, stone)
    cell = FIELD.nearest_cell((22.5, 22.5))
    assert after.refused == (cell,)
    assert after.taken == 3
    # Where a reading was had before, a stone takes nothing back.
    again = apply(after, pushed(9, (22.5, 22.5)))
    assert again.refused == ()
    assert cell in again.visited
