"""A benchmark's folder holds what it says, whole, and refuses what it is not."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from math import nan
from pathlib import Path

import numpy as np
import pytest
import shapely

from subsoil.bench import Benchmark, Entrant, Result, Series, Setting, Snapshot, Task, repeatable
from subsoil.bench.compare import Compared, setting_on, waiting
from subsoil.bench.running import Failed, on_dask
from subsoil.bench.store import COLUMNS, config_of, enter, keep, kept, results_of, write_results
from subsoil.errors import ParameterError
from subsoil.land.field import Field

SETTING = Setting("signal", 1, (5, 8))
ENTRANTS = (Entrant("random", "paper-10"), Entrant("greedy", "pmc"))
BENCHMARK = Benchmark(SETTING, 2, ENTRANTS)


def done(task: Task, error: float = 60.0, decision_s: float = 0.25) -> Result:
    """A survey a budget, whose error falls by a kPa a sample."""
    series = tuple(
        Series(
            budget,
            tuple(
                Snapshot(n, error - n / 3, 10.0 * n, 2.0 * n, 400.0, 0.5)
                for n in range(2, budget + 1)
            ),
            decision_s,
        )
        for budget in task.setting.samples
    )
    return Result(task, series)


def rows(folder: Path) -> list[dict[str, str]]:
    with (folder / "results.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def test_a_folder_says_again_what_was_entered(tmp_path: Path) -> None:
    enter(tmp_path, BENCHMARK)
    assert config_of(tmp_path) == BENCHMARK
    assert config_of(tmp_path).tasks == tuple(
        Task(SETTING, k, entrant) for k in range(2) for entrant in ENTRANTS
    )


def test_more_fields_and_entrants_are_added_and_none_is_taken_away(tmp_path: Path) -> None:
    enter(tmp_path, BENCHMARK)
    enter(tmp_path, Benchmark(SETTING, 1, (Entrant("w-shape", "pmc"), ENTRANTS[0])))
    found = config_of(tmp_path)
    assert found.fields == 2
    assert found.entrants == (ENTRANTS[1], ENTRANTS[0], Entrant("w-shape", "pmc"))


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"protocol": "surrogate"}, "protocol signal, not surrogate"),
        ({"seed": 7}, "seed 1, not 7"),
        ({"samples": (5, 9)}, "samples 5,8, not 5,9"),
        ({"boundary_wkt": "POLYGON ((0 0, 9 0, 9 9, 0 0))"}, "another boundary"),
        ({"crs": "EPSG:32630"}, "crs none, not EPSG:32630"),
        ({"seed": 7, "samples": (9,)}, "seed 1, not 7; samples 5,8, not 9"),
    ],
)
def test_another_benchmark_is_refused_with_all_that_differs(
    tmp_path: Path, changes: dict[str, object], said: str
) -> None:
    enter(tmp_path, BENCHMARK)
    before = (tmp_path / "config.json").read_bytes()
    other = Benchmark(replace(SETTING, **changes), 2, ENTRANTS)  # type: ignore[arg-type]
    with pytest.raises(ParameterError) as caught:
        enter(tmp_path, other)
    assert str(caught.value) == (
        f"{tmp_path}: it holds another benchmark: {said} "
        "(remedy: give another folder, or the same settings)"
    )
    assert (tmp_path / "config.json").read_bytes() == before


def test_a_folder_of_another_version_is_not_added_to(tmp_path: Path) -> None:
    enter(tmp_path, BENCHMARK)
    config = json.loads((tmp_path / "config.json").read_text())
    (tmp_path / "config.json").write_text(json.dumps({**config, "subsoil": "0.0.9"}))
    with pytest.raises(ParameterError, match=r"another benchmark: subsoil 0\.0\.9, not "):
        enter(tmp_path, BENCHMARK)


@pytest.mark.parametrize("fields", [0, -3])
def test_a_benchmark_has_a_field(fields: int) -> None:
    with pytest.raises(ParameterError) as caught:
        Benchmark(SETTING, fields, ENTRANTS)
    assert str(caught.value) == f"--fields: there must be a field or more, not {fields}"


@pytest.mark.parametrize(
    "content", ["", "{", "7", '{"entrants": [], "setting": {}, "fields": 1}', '{"fields": 2}']
)
def test_what_is_no_benchmark_is_said_with_how_to_make_one(tmp_path: Path, content: str) -> None:
    (tmp_path / "config.json").write_text(content)
    with pytest.raises(ParameterError) as caught:
        config_of(tmp_path)
    assert str(caught.value) == (
        f"{tmp_path}: there is no config.json of a benchmark "
        "(remedy: make one with `subsoil bench run`)"
    )


def test_a_result_that_is_kept_is_there_whole_and_the_others_are_waited_for(
    tmp_path: Path,
) -> None:
    enter(tmp_path, BENCHMARK)
    first, second, *rest = BENCHMARK.tasks
    keep(tmp_path, done(first))
    keep(tmp_path, done(second, 40.0))
    keep(tmp_path, done(second, 50.0))
    assert kept(tmp_path, first)
    assert waiting(tmp_path, BENCHMARK) == tuple(rest)
    assert results_of(tmp_path) == (done(first), done(second, 50.0))
    assert sorted(path.suffix for path in (tmp_path / "tasks").iterdir()) == [".json", ".json"]


def test_results_of_tasks_that_are_no_longer_compared_are_left_alone(tmp_path: Path) -> None:
    enter(tmp_path, BENCHMARK)
    other = Task(SETTING, 0, Entrant("w-shape", "pmc"))
    keep(tmp_path, done(other))
    assert results_of(tmp_path) == ()
    assert kept(tmp_path, other)


@pytest.mark.parametrize("content", ["", "{}", "[1]", '{"task": {}, "series": []}'])
def test_a_file_that_is_no_result_is_named_with_what_to_do(tmp_path: Path, content: str) -> None:
    enter(tmp_path, BENCHMARK)
    path = tmp_path / "tasks" / f"{BENCHMARK.tasks[0].name}.json"
    path.write_text(content)
    with pytest.raises(ParameterError) as caught:
        results_of(tmp_path)
    assert str(caught.value) == (
        f"{path}: it is not a result (remedy: delete it and run the benchmark again)"
    )


def test_results_are_a_row_a_task_and_mark_sorted_and_rounded(tmp_path: Path) -> None:
    enter(tmp_path, BENCHMARK)
    for task in reversed(BENCHMARK.tasks):
        keep(tmp_path, done(task, 60.0 + task.field_number))
    assert write_results(tmp_path) == tmp_path / "results.csv"
    found = rows(tmp_path)
    assert tuple(found[0]) == COLUMNS
    assert [(row["field"], row["strategy"], row["n"]) for row in found] == [
        (k, who, n) for k in "01" for who in ("greedy", "random") for n in "58"
    ]
    first = found[0]
    assert first["rmse_kpa"] == "58.333333"
    assert (first["path_m"], first["minutes"]) == ("50.0", "10.0")
    assert (first["mean_kv"], first["predicted_rmse_kpa"]) == ("400.0", "20.0")
    assert first["decision_s"] == "0.25"


def test_what_is_repeatable_is_all_but_the_time_and_no_number_is_an_empty_cell(
    tmp_path: Path,
) -> None:
    texts = []
    for folder, decision_s in ((tmp_path / "a", 0.1), (tmp_path / "b", nan)):
        enter(folder, BENCHMARK)
        keep(folder, done(BENCHMARK.tasks[0], decision_s=decision_s))
        texts.append(repeatable(write_results(folder)))
    assert texts[0] == texts[1]
    assert {row["decision_s"] for row in rows(tmp_path / "b")} == {""}
    assert "decision_s" not in texts[0]


def test_a_comparison_counts_what_was_done_before_now_and_not_at_all() -> None:
    failed = (Failed(BENCHMARK.tasks[3], "it broke"),)
    assert Compared(BENCHMARK, 1, failed, Path("results.csv")).now == 2


def test_a_setting_on_a_boundary_holds_its_outline_to_the_last_bit_and_its_frame() -> None:
    corners = np.add([(0.1, 0.2), (60 + 1 / 3, 0), (60, 40), (0, 40)], (681_000, 5_900_000))
    field = Field.from_metres(corners, crs="EPSG:32630")
    setting = setting_on(field, "signal", 3, (5, 8))
    assert shapely.equals_exact(shapely.from_wkt(setting.boundary_wkt), field.boundary, 0.0)
    assert (setting.protocol, setting.seed, setting.crs) == ("signal", 3, "EPSG:32630")
    assert setting_on(None, "surrogate", 3, (936,)).boundary_wkt == ""


def test_more_samples_than_cells_are_refused_with_both_numbers() -> None:
    field = Field.from_metres([(0, 0), (20, 0), (20, 10), (0, 10)])
    with pytest.raises(ParameterError) as caught:
        setting_on(field, "signal", 1, (5, 9))
    assert str(caught.value) == (
        "--samples: 9 samples are more than the field's 8 cells (remedy: take fewer)"
    )


@pytest.mark.parametrize(
    ("setting", "said"),
    [
        (
            ("noise", (5,)),
            "--protocol: there is no protocol 'noise' (remedy: one of surrogate, signal, "
            "riseholme)",
        ),
        (
            ("signal", (5, 5)),
            "--samples: '5,5' is not an increasing list of 2 or more (remedy: numbers such as "
            "15,20,30,50)",
        ),
    ],
)
def test_a_setting_that_cannot_be_is_said_whole(
    setting: tuple[str, tuple[int, ...]], said: str
) -> None:
    protocol, samples = setting
    with pytest.raises(ParameterError) as caught:
        Setting(protocol, 1, samples)
    assert str(caught.value) == said


def test_an_address_that_no_scheduler_can_have_is_refused_with_what_one_looks_like() -> None:
    with pytest.raises(ParameterError) as caught:
        next(on_dask(BENCHMARK.tasks, "nowhere://at all", 1))
    assert str(caught.value) == (
        "--dask: no Dask scheduler answers at nowhere://at all "
        "(remedy: give its address, such as tcp://10.0.0.5:8786, or local)"
    )
