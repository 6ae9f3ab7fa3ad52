"""Benchmarks on the command line: resumed, added to, refused, reported on, and robust."""

from __future__ import annotations

import csv
import json
import multiprocessing
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from subsoil.bench import (
    Benchmark,
    Entrant,
    Failed,
    Result,
    Retried,
    Setting,
    Task,
    on_dask,
    on_pool,
    repeatable,
    scored,
)
from subsoil.bench.compare import compare
from subsoil.bench.running import Outcome
from subsoil.cli import run

Bench = Callable[..., Any]


def mtimes(out: Path) -> dict[str, int]:
    return {path.name: path.stat().st_mtime_ns for path in (out / "tasks").iterdir()}


def lines(out: Path) -> list[dict[str, str]]:
    with (out / "results.csv").open() as file:
        return list(csv.DictReader(file))


@pytest.mark.slow
def test_a_run_is_resumed_added_to_and_never_mixed(tmp_path: Path, bench: Bench) -> None:
    out = tmp_path / "out"
    assert bench(out).code == 0
    before, results = mtimes(out), repeatable(out / "results.csv")
    assert len(before) == 4
    rows = lines(out)
    assert list(rows[0]) == [
        "field", "protocol", "strategy", "estimator", "n", "rmse_kpa", "path_m", "minutes",
        "mean_kv", "predicted_rmse_kpa", "decision_s",
    ]  # fmt: skip
    assert [(r["field"], r["strategy"], r["n"]) for r in rows] == [
        (k, s, n) for k in "01" for s in ("area-split", "greedy") for n in "58"
    ]

    gone = sorted(before)[1]
    (out / "tasks" / gone).unlink()
    again = bench(out, "--json")
    assert json.loads(again.out)["done now"] == 1
    after = mtimes(out)
    assert {name for name in before if after[name] != before[name]} == {gone}
    assert repeatable(out / "results.csv") == results
    assert all(float(row["decision_s"]) > 0 for row in lines(out))

    assert bench(out, strategies="random", fields=3).code == 0
    assert {r["strategy"] for r in lines(out)} == {"area-split", "greedy", "random"}
    config = json.loads((out / "config.json").read_text())
    assert config["fields"] == 3
    assert len(config["entrants"]) == 3

    refused = bench(out, seed=2, samples="5,9")
    assert refused.code == 2
    assert refused.err.count("\n") == 1
    assert "seed 1, not 2; samples 5,8, not 5,9" in refused.err
    assert run(["bench", "report", str(out)]) == 0
    text = (out / "report.md").read_text()
    assert "**2 tasks have no result.**" in text


@pytest.mark.slow
def test_a_benchmark_runs_from_python_and_goes_on(tmp_path: Path, setting: Setting) -> None:
    entrants = (Entrant("random", "paper-10"), Entrant("area-split", "paper-10"))
    told: list[Outcome] = []
    first = compare(Benchmark(setting, 1, entrants[:1]), tmp_path, workers=1, told=told.append)
    assert (first.before, first.now, len(told)) == (0, 1, 1)
    both = compare(Benchmark(setting, 1, entrants), tmp_path, workers=1, told=told.append)
    assert (both.before, both.now, both.failed, len(told)) == (1, 1, (), 2)
    assert {row["strategy"] for row in lines(tmp_path)} == {"random", "area-split"}
    assert both.results == tmp_path / "results.csv"


@pytest.mark.slow
def test_a_report_has_every_table_and_figure(tmp_path: Path, bench: Bench) -> None:
    out = tmp_path / "out"
    bench(out, "--estimator", "paper-10,spherical", strategies="area-split,random")
    assert run(["bench", "report", str(out), "--figures", "svg"]) == 0
    text = (out / "report.md").read_text()
    figures = {path.stem for path in (out / "figures").iterdir()}
    assert figures == {
        "learning", "time_quality", "variance_and_error", "calibration", "layers", "differences",
        "example_depth_slices", "example_std_dev", "example_variograms",
    }  # fmt: skip
    for name in figures:
        assert f"(figures/{name}.svg)" in text
    names = {path.stem for path in (out / "tables").glob("*.csv")}
    assert names == {path.stem for path in (out / "tables").glob("*.tex")}
    assert names == {
        "table1_layers", "table2_correlation", "table3_rmse", "table4_path", "time_quality",
        "calibration", "decision_time", "paired_rmse", "paired_path",
    }  # fmt: skip
    assert "area-split, spherical" in text
    assert "arXiv:1803.08069" in text


@pytest.mark.slow
def test_a_report_of_a_single_field_and_entrant_is_made(tmp_path: Path, bench: Bench) -> None:
    out = tmp_path / "out"
    bench(out, strategies="greedy", samples="5", fields=1)
    assert run(["bench", "report", str(out)]) == 0
    assert "There is nothing to compare." in (out / "report.md").read_text()


@pytest.mark.slow
@pytest.mark.usefixtures("bad_strategies")
def test_tasks_that_fail_are_named_and_the_others_are_kept(tmp_path: Path, bench: Bench) -> None:
    out = tmp_path / "out"
    said = bench(out, "--json", strategies="area-split,bad_strategies:broken", fields=1)
    assert said.code == 3
    (failed,) = json.loads(said.out)["failed"]
    assert "bad_strategies-broken" in failed
    assert "ValueError: broken on purpose" in failed
    assert {r["strategy"] for r in lines(out)} == {"area-split"}


@pytest.mark.parametrize(
    ("option", "value", "words"),
    [
        ("--protocol", "x", "'x' is not one of 'surrogate'"),
        ("--fields", "0", "--fields"),
        ("--strategies", "nope", "no strategy 'nope'"),
        ("--strategies", "random,random", "comes twice"),
        ("--estimator", "nope", "no estimator 'nope'"),
        ("--samples", "20,15", "increasing"),
        ("--samples", "5,x", "whole numbers"),
        ("--samples", "5,1000", "936 cells"),
        ("--boundary", "none.geojson", "none.geojson"),
    ],
)
def test_what_cannot_be_run_is_refused_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], option: str, value: str, words: str
) -> None:
    out = tmp_path / "out"
    assert run(["bench", "run", "--out", str(out), option, value]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert words in error
    assert not out.exists()


@pytest.mark.parametrize("content", ["", "{}", "[]", '{"entrants": [], "setting": 1}'])
def test_a_folder_that_is_no_benchmark_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], content: str
) -> None:
    (tmp_path / "config.json").write_text(content)
    assert run(["bench", "report", str(tmp_path)]) == 2
    assert "config.json" in capsys.readouterr().err


def with_one_deadly(setting: Setting) -> list[Task]:
    """Tasks of which the second kills its worker the first time it is tried."""
    entrants = [Entrant(name, "paper-10") for name in ("area-split", "greedy", "random")]
    entrants.insert(1, Entrant("bad_strategies:deadly_once", "paper-10"))
    return [Task(setting, 0, entrant) for entrant in entrants]


def results(outcomes: Iterator[Outcome]) -> dict[Task, Result]:
    return {outcome.task: outcome for outcome in outcomes if isinstance(outcome, Result)}


@pytest.mark.slow
@pytest.mark.usefixtures("bad_strategies")
def test_a_killed_worker_of_the_pool_loses_nothing(setting: Setting) -> None:
    tasks = with_one_deadly(setting)
    outcomes = list(on_pool(tasks, 2))
    assert not [o for o in outcomes if isinstance(o, Failed)]
    assert [o for o in outcomes if isinstance(o, Retried)] == [Retried(tasks[1], 1)]
    assert results(iter(outcomes)) == {task: scored(task) for task in tasks}


@pytest.mark.slow
def test_a_worker_killed_while_it_has_nothing_to_do_is_replaced(area_split: Task) -> None:
    tasks = [replace(area_split, field_number=k) for k in range(2)]
    before = set(multiprocessing.active_children())
    outcomes = on_pool(tasks, 1)
    first = next(outcomes)
    for worker in set(multiprocessing.active_children()) - before:
        worker.kill()
        worker.join()
    assert results(iter([first, *outcomes])) == {task: scored(task) for task in tasks}


@pytest.mark.slow
@pytest.mark.usefixtures("bad_strategies")
def test_a_task_that_kills_its_workers_fails_alone(area_split: Task) -> None:
    deadly = replace(area_split, entrant=Entrant("bad_strategies:deadly", "paper-10"))
    outcomes = list(on_pool([deadly, area_split], 2))
    assert Failed(deadly, "its worker died 3 times") in outcomes
    assert [o.deaths for o in outcomes if isinstance(o, Retried)] == [1, 2]
    assert results(iter(outcomes)) == {area_split: scored(area_split)}


@pytest.mark.slow
@pytest.mark.usefixtures("bad_strategies")
def test_a_killed_worker_of_dask_loses_nothing(setting: Setting) -> None:
    tasks = with_one_deadly(setting)
    assert results(on_dask(tasks, "local", 2)) == {task: scored(task) for task in tasks}


@pytest.mark.slow
def test_results_are_the_same_from_dask_and_the_pool_but_for_their_time(
    tmp_path: Path, bench: Bench
) -> None:
    for out, more in ((tmp_path / "pool", ()), (tmp_path / "dask", ("--dask", "local"))):
        assert bench(out, *more, strategies="random,adaptive-greedy").code == 0
    pool, dask = (tmp_path / name / "results.csv" for name in ("pool", "dask"))
    assert repeatable(pool) == repeatable(dask)
    assert len(repeatable(pool).splitlines()[0].split(",")) == 10


@pytest.mark.slow
def test_a_folder_of_before_decisions_were_timed_is_read_and_gone_on_with(
    tmp_path: Path, bench: Bench
) -> None:
    out = tmp_path / "out"
    bench(out, strategies="random", fields=1)
    (path,) = (out / "tasks").iterdir()
    before = repeatable(out / "results.csv")
    result = json.loads(path.read_text())
    for series in result["series"]:
        del series["decision_s"]
    path.write_text(json.dumps(result))
    assert json.loads(bench(out, "--json", strategies="random", fields=1).out)["done before"] == 1
    assert {row["decision_s"] for row in lines(out)} == {""}
    assert repeatable(out / "results.csv") == before
    assert run(["bench", "report", str(out)]) == 0
    assert "| random | – | – |" in (out / "report.md").read_text()
