"""Tasks are pure functions of themselves, with names that tell them apart."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from time import process_time

import numpy as np
import pytest

from subsoil.agent import Assignment, Push
from subsoil.bench import (
    Entrant,
    Result,
    Series,
    Setting,
    Snapshot,
    Task,
    scored,
    truth_of,
)
from subsoil.bench.records import result_from_json, result_to_json
from subsoil.bench.scoring import Scorer, kv_error_correlation, surveyed
from subsoil.bench.task import PAPER_STRATEGIES, entrants_of, survey_seed
from subsoil.bench.truths import TruthReader
from subsoil.errors import ParameterError, SubsoilError
from subsoil.mapping.scores import rmse
from subsoil.penetrometer import LARGE_CONE, profile_of
from subsoil.simulation import draw_field
from subsoil.survey import Survey
from subsoil.survey.events import Event
from subsoil.ways.open_land import OpenLand


def test_whatever_differs_between_two_tasks_their_names_differ(area_split: Task) -> None:
    setting = area_split.setting
    others = [
        replace(area_split, field_number=1),
        replace(area_split, entrant=Entrant("area-split", "spherical")),
        *(
            replace(area_split, setting=other)
            for other in (
                replace(setting, protocol="surrogate"),
                replace(setting, seed=2),
                replace(setting, samples=(5, 9)),
                replace(setting, boundary_wkt=""),
                replace(setting, crs="EPSG:32630"),
            )
        ),
    ]
    assert len({task.name for task in [area_split, *others]}) == 1 + len(others)
    assert replace(area_split).name == area_split.name


def test_a_task_keeps_the_name_that_folders_know_it_by() -> None:
    task = Task(Setting("signal", 1, (5, 8)), 3, Entrant("mine:own", "paper-10"))
    assert task.name == "0003-mine-own-paper-10-cea9adfeb212"


def test_a_result_of_before_decisions_were_timed_is_read_and_has_no_time() -> None:
    row = (
        '{"kv_error_correlation": 0.5, "mean_kv": 4.0, "minutes": 3.0, "n": N, "path_m": 2.0, '
        '"rmse_kpa": 1.0}'
    )
    rows = f"[{row.replace('N', '5')}, {row.replace('N', '8')}]"
    task = (
        '{"entrant": {"estimator": "paper-10", "strategy": "greedy"}, "field": 3, "setting": '
        '{"boundary_wkt": "", "crs": "", "protocol": "signal", "samples": [5, 8], "seed": 1}}'
    )
    text = f'{{"series": [{{"budget": 8, "rows": {rows}}}], "task": {task}}}'
    found = result_from_json(text)
    assert found.task == Task(Setting("signal", 1, (5, 8)), 3, Entrant("greedy", "paper-10"))
    assert [each.n for each in found.marks] == [5, 8]
    assert np.isnan(found.decision_s).all()


class SlowScorer(Scorer):
    """Works for 0.2 s after each event, on its own watch."""

    def append(self, event: Event, survey: Survey) -> None:
        super().append(event, survey)
        with self.watch.running():
            begun = process_time()
            while process_time() < begun + 0.2:
                pass


def test_a_decision_takes_the_processor_and_scoring_does_not_count(area_split: Task) -> None:
    truth = truth_of(area_split.setting, 0)
    quick, slow = Scorer(truth), SlowScorer(truth)
    _, decision_s = surveyed(area_split, 5, truth, quick)
    assert 0.0 < decision_s < 1.0
    assert quick.watch.seconds > 0.0
    _, slowly_scored = surveyed(area_split, 5, truth, slow)
    assert slow.watch.seconds > 2.0
    assert slowly_scored < 0.1 + 2 * decision_s


def test_equal_surveys_are_equal_whatever_time_they_took(area_split: Task) -> None:
    rows = (Snapshot(5, 1.0, 2.0, 3.0, 4.0, 0.5),)
    assert Series(5, rows, 0.1) == Series(5, rows, 0.2)
    written = result_to_json(Result(area_split, (Series(5, rows, 0.1),)))
    assert result_from_json(written).series[0].decision_s == 0.1


def test_a_result_survives_json_bit_for_bit(area_split: Task) -> None:
    row = Snapshot(5, 0.1 + 0.2, 1 / 3, 2.0, 1e-300, -0.1)
    result = Result(area_split, (Series(5, (row,)),))
    assert result_from_json(result_to_json(result)) == result


def test_a_mark_is_read_from_the_survey_of_that_budget_or_else_from_the_longest(
    area_split: Task,
) -> None:
    def rows(rmse_kpa: float) -> tuple[Snapshot, ...]:
        return tuple(Snapshot(n, rmse_kpa + n, 0, 0, 1, 0) for n in range(2, 9))

    own = Result(area_split, (Series(5, rows(100)[:4]), Series(8, rows(200))))
    assert [row.rmse_kpa for row in own.marks] == [105, 208]
    one = Result(area_split, (Series(8, rows(200)),))
    assert [row.rmse_kpa for row in one.marks] == [205, 208]


def test_the_papers_strategies_work_with_its_estimator_and_others_with_pmc() -> None:
    found = entrants_of((*PAPER_STRATEGIES, "subsoil.strategies:random"), ())
    assert {e.estimator for e in found[:7]} == {"paper-10"}
    assert found[7].estimator == "pmc"
    crossed = entrants_of(("random", "greedy"), ("paper-10", "spherical"))
    assert crossed == tuple(
        Entrant(*pair) for pair in product(("random", "greedy"), ("paper-10", "spherical"))
    )


@pytest.mark.parametrize("samples", [(), (1, 5), (8, 5), (5, 5), (0,)])
def test_samples_increase_from_two_on(samples: tuple[int, ...]) -> None:
    with pytest.raises(ParameterError, match="--samples"):
        Setting("signal", 1, samples)


def test_fields_and_seeds_differ_and_depend_on_nothing_but_seed_and_number(
    setting: Setting,
) -> None:
    first, second = truth_of(setting, 0), truth_of(setting, 1)
    assert not np.array_equal(first.kpa, second.kpa)
    assert np.array_equal(truth_of(replace(setting, samples=(20,)), 0).kpa, first.kpa)
    seeds = [survey_seed(seed, field) for seed in range(20) for field in range(20)]
    assert len(set(seeds)) == len(seeds)


def test_soils_are_those_of_the_test_bed() -> None:
    rng = np.random.default_rng(np.random.SeedSequence(7, spawn_key=(3, 0)))
    assert np.array_equal(truth_of(Setting("surrogate", 7, (15,)), 3).kpa, draw_field(rng).kpa)


def test_a_row_says_what_the_survey_was_when_it_had_that_many_samples(area_split: Task) -> None:
    truth = truth_of(area_split.setting, 0)
    scorer = Scorer(truth)
    survey, _ = surveyed(area_split, 8, truth, scorer)
    last = scorer.snapshots[-1]
    assert [row.n for row in scorer.snapshots] == list(range(2, 9))
    assert last.rmse_kpa == rmse(survey.soil_map.mean, truth.kpa)
    assert (
        last.mean_kv
        == survey.soil_map.variance.mean(axis=0).mean()
        == pytest.approx(last.predicted_rmse_kpa**2)
    )
    error = ((survey.soil_map.mean - truth.kpa) ** 2).mean(axis=0)
    expected = np.corrcoef(survey.soil_map.kv, error)[0, 1]
    assert last.kv_error_correlation == pytest.approx(expected)
    assert kv_error_correlation(survey.soil_map, replace(truth, kpa=survey.soil_map.mean)) != 1.0


def test_minutes_are_metres_at_1_metre_a_second_and_50_seconds_a_sample(area_split: Task) -> None:
    for row in scored(area_split).longest.snapshots:
        assert row.minutes == pytest.approx((row.path_m + 50 * row.n) / 60)


def test_a_reading_is_the_truth_of_the_cell(area_split: Task) -> None:
    truth = truth_of(area_split.setting, 0)
    robot = TruthReader(truth, OpenLand(truth.field), (0.0, 0.0))
    cell = 50
    east, north = truth.field.cells[cell].tolist()
    stop = Assignment("a", 0, cell, (east, north))
    assert robot.go_to(stop).metres == pytest.approx(np.hypot(east, north))
    push = robot.probe()
    assert isinstance(push, Push)
    sample = truth.layers.sample(profile_of(push.reading, LARGE_CONE), push.at)
    assert sample.kpa == pytest.approx(truth.reading(cell))


def test_a_strategy_that_does_not_know_the_budget_surveys_once(setting: Setting) -> None:
    greedy = Task(setting, 0, Entrant("greedy", "paper-10"))
    short = replace(greedy, setting=replace(setting, samples=(5,)))
    assert [series.budget for series in scored(greedy).series] == [8]
    assert scored(greedy).marks[0] == scored(short).marks[0]


@pytest.mark.usefixtures("bad_strategies")
def test_a_survey_that_ends_early_is_an_error_and_not_a_result(setting: Setting) -> None:
    with pytest.raises(SubsoilError, match=r"3 of 5 samples"):
        scored(Task(setting, 0, Entrant("bad_strategies:short", "paper-10")))
