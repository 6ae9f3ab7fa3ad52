"""Fields of a benchmark are drawn as its protocol says; a reader reads them; hands roam a grid."""

from __future__ import annotations

from dataclasses import replace
from math import hypot

import numpy as np
import pytest
import shapely

from subsoil.agent import Arrival, Assignment, Push, Refusal, Unreachable
from subsoil.bench import Entrant, Setting, Task, truth_of
from subsoil.bench.conformance import check
from subsoil.bench.hand_survey import hand_surveys, loose_grid
from subsoil.bench.scoring import kv_error_correlation
from subsoil.bench.task import hand_rng, soil_rng, survey_seed
from subsoil.bench.truths import TruthReader, land_of
from subsoil.errors import ParameterError
from subsoil.land.field import Field
from subsoil.layers import Layers, Sample
from subsoil.mapping.soilmap import SoilMap
from subsoil.penetrometer import LARGE_CONE, profile_of
from subsoil.reports import STOPPED
from subsoil.simulation import Conditioned, Truth, draw_field, surrogate
from subsoil.simulation.fields import TEST_BED
from subsoil.variogram import Spherical
from subsoil.ways.open_land import OpenLand

BOX = shapely.box(0, 0, 60, 40).wkt
SIGNAL = Setting("signal", 1, (5, 8), BOX)


def reader() -> TruthReader:
    truth = truth_of(SIGNAL, 0)
    return TruthReader(truth, OpenLand(truth.field), (0.0, 0.0))


def stop_at(truth: Truth, cell: int, made: int = 0) -> Assignment:
    east, north = truth.field.cells[cell].tolist()
    return Assignment(f"stop {cell}", 0, cell, (east, north), made=made)


def test_a_reader_drives_the_shortest_way_at_its_machines_speed_from_where_it_stands() -> None:
    robot = reader()
    first, second = stop_at(robot.truth, 3), stop_at(robot.truth, 77)
    robot.go_to(first)
    there = robot.go_to(second)
    assert isinstance(there, Arrival)
    metres = hypot(second.at[0] - first.at[0], second.at[1] - first.at[1])
    assert there.at == second.at
    assert there.metres == pytest.approx(metres)
    assert there.seconds == pytest.approx(metres / 1.0)


def test_further_pushes_are_faster_and_carry_deviations_of_their_own() -> None:
    robot = reader()
    truth, cell = robot.truth, 30
    robot.go_to(stop_at(truth, cell))
    pushes = [robot.probe() for _ in range(3)]
    assert [each.seconds for each in pushes] == [50.0, 28.0, 28.0]
    for number, push in enumerate(pushes):
        assert isinstance(push, Push)
        sample = truth.layers.sample(profile_of(push.reading, LARGE_CONE), push.at)
        assert sample.kpa == pytest.approx(truth.reading(cell, number))
    # A reader that takes over a stop goes on with its pushes.
    other = reader()
    other.go_to(stop_at(truth, cell, made=2))
    assert other.probe() == pushes[2]


def test_a_reader_that_was_stopped_stays() -> None:
    robot = reader()
    robot.go_to(stop_at(robot.truth, 3))
    here = robot.position
    robot.stop()
    assert robot.go_to(stop_at(robot.truth, 9)) == Unreachable(STOPPED, here)
    assert robot.probe() == Refusal(STOPPED, 0.0, 0)


def test_soils_surveys_and_hands_have_streams_of_their_own() -> None:
    words = {
        (stream.__name__, seed, field): int(stream(seed, field).integers(2**62))
        for stream in (soil_rng, hand_rng)
        for seed in range(3)
        for field in range(5)
    }
    words |= {("survey", s, f): survey_seed(s, f) for s in range(3) for f in range(5)}
    assert len(set(words.values())) == len(words)
    assert soil_rng(2, 4).random() == soil_rng(2, 4).random()


@pytest.mark.parametrize("protocol", ["surrogate", "signal"])
def test_a_field_within_a_boundary_is_the_test_bed_laid_on_it(protocol: str) -> None:
    truth = truth_of(replace(SIGNAL, protocol=protocol), 4)
    land = Field.from_metres([(0, 0), (60, 0), (60, 40), (0, 40)])
    peer = draw_field(soil_rng(1, 4), protocol, field=land)  # type: ignore[arg-type]
    assert np.array_equal(truth.kpa, peer.kpa)
    assert np.array_equal(truth.noise, peer.noise)
    assert truth.noise.any() == (protocol == "signal")


def test_without_a_boundary_the_land_is_the_protocols_own() -> None:
    assert land_of(replace(SIGNAL, boundary_wkt="")) is TEST_BED
    own = land_of(Setting("riseholme", 1, (5,)))
    assert (len(own.cells), own.crs) == (935, "EPSG:32630")


@pytest.mark.parametrize(
    ("setting", "said"),
    [
        (
            replace(SIGNAL, boundary_wkt="LINESTRING (0 0, 1 1)"),
            "--boundary: it is a LineString, not a polygon",
        ),
        (
            Setting("riseholme", 1, (5,), BOX, "EPSG:32631"),
            "--boundary: the boundary is in EPSG:32631, the readings in EPSG:32630 "
            "(remedy: give it in EPSG:32630)",
        ),
        (
            Setting("riseholme", 1, (5,), BOX),
            "--boundary: the boundary is in a local frame, the readings in EPSG:32630 "
            "(remedy: give it in EPSG:32630)",
        ),
    ],
)
def test_land_that_cannot_be_is_said_with_the_frame_to_give_it_in(
    setting: Setting, said: str
) -> None:
    with pytest.raises(ParameterError) as caught:
        land_of(setting)
    assert str(caught.value) == said


@pytest.mark.usefixtures("real_data")
def test_riseholme_is_drawn_anew_for_each_field_from_its_readings() -> None:
    half = land_of(Setting("riseholme", 1, (5,)))
    middle = np.tile(half.cells.mean(axis=0), 2)
    box = shapely.box(*(middle + np.array([-20, -15, 20, 15])))
    setting = Setting("riseholme", 1, (5,), box.wkt, "EPSG:32630")
    one, other = truth_of(setting, 0), truth_of(setting, 1)
    assert isinstance(one.origin, Conditioned)
    assert one.origin.readings[0] == 177
    assert one.kpa.shape == (8, len(one.field.cells))
    assert not np.allclose(one.kpa, other.kpa)


# By hand


def test_a_loose_grid_has_about_49_nodes_each_up_to_a_quarter_off() -> None:
    """Of a square of 140 m the nodes are 20 m apart; cells add half of 5 m."""
    field = Field.from_metres([(0, 0), (140, 0), (140, 140), (0, 140)])
    nodes = np.array([(10 + 20 * i, 10 + 20 * j) for j in range(7) for i in range(7)])
    for seed in range(20):
        cells = loose_grid(field, np.random.default_rng(seed))
        assert len(cells) == len(set(cells.tolist())) == 49
        off = np.abs(field.cells[cells][:, None] - nodes).max(axis=2)
        nearest = off.argmin(axis=1)
        assert sorted(nearest.tolist()) == list(range(49))
        assert off.min(axis=1).max() <= 5.0 + 2.5


def test_a_survey_by_hand_is_kriged_from_what_the_field_reads_at_its_cells() -> None:
    setting = replace(SIGNAL, boundary_wkt=shapely.box(0, 0, 90, 70).wkt)
    found = hand_surveys(setting, 2)
    assert found.layers == Layers().names
    for field in range(2):
        truth = truth_of(setting, field)
        cells = loose_grid(truth.field, hand_rng(1, field))
        assert found.readings[field] == len(cells)
        kpa = (truth.kpa + truth.noise)[:, cells]
        peer = surrogate(truth.field, truth.field.cells[cells], kpa, truth.layers)
        error = np.sqrt(np.mean((peer.kpa - truth.kpa) ** 2, axis=1))
        assert found.rmse_kpa[field] == pytest.approx(error)
        assert found.mean_kpa[field] == pytest.approx(truth.kpa.mean(axis=1))


def test_variance_and_error_that_do_not_vary_have_no_correlation() -> None:
    truth = truth_of(SIGNAL, 0)
    sample = Sample((2.5, 2.5), np.full(8, 900.0), np.zeros(8, np.int8))
    flat = SoilMap(truth.field, truth.layers, (Spherical(1.0, 20.0, 9.0),) * 8, (sample,))
    # One sample is the mean everywhere; with the truth the same, no cell is better than another.
    same = replace(truth, kpa=np.full_like(truth.kpa, 700.0), noise=np.zeros_like(truth.noise))
    assert np.isnan(kv_error_correlation(flat, same))


# What is checked by rules


def three(one: object, two: object, more: object) -> None:
    """Neither a strategy nor an estimator."""


def anything(*what: object) -> None:
    """It does not say what it takes."""


@pytest.mark.parametrize(
    ("thing", "said"),
    [
        ("no-such", "check: there is no strategy or estimator 'no-such' (remedy: one of "),
        (three, "it takes 3 arguments, where a strategy takes one (view) and an estimator two"),
        (anything, "it does not say what it takes, where a strategy takes one (view)"),
    ],
)
def test_what_is_neither_is_told_how_it_would_be_called(thing: object, said: str) -> None:
    with pytest.raises(ParameterError) as caught:
        check(thing)  # type: ignore[arg-type]
    assert said in str(caught.value)


def test_a_class_is_told_that_what_it_makes_would_do() -> None:
    with pytest.raises(ParameterError) as caught:
        check("subsoil.variogram:Spherical")
    assert str(caught.value) == (
        "subsoil.variogram:Spherical: it is a class, and what it makes is a strategy or an "
        "estimator (remedy: make one in the module, and name that)"
    )


def test_a_task_is_named_after_its_field_and_entrant_with_no_sign_that_a_folder_minds() -> None:
    task = Task(SIGNAL, 12, Entrant("mine/../../own:plan *", "pmc"))
    assert task.name.startswith("0012-mine-..-..-own-plan--pmc-")
    assert "/" not in task.name
