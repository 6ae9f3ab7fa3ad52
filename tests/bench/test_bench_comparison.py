"""Intervals and paired differences, against SciPy and by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from subsoil.bench import Entrant, Result, Series, Setting, Snapshot, Task
from subsoil.bench.comparison import (
    Mean,
    by_minutes,
    correlation_over_samples,
    curves,
    ended_before,
    mean_of,
    paired,
    result_table,
)
from subsoil.bench.tables import Table, latex, markdown, paired_table, rmse_table, write_csv

SETTING = Setting("surrogate", 1, (15, 30))
RNG = np.random.default_rng(5)


def result(strategy: str, field: int, rmse: tuple[float, float], minutes: float = 10.0) -> Result:
    rows = (
        Snapshot(15, rmse[0], 100.0, minutes, 400.0, 0.5),
        Snapshot(30, rmse[1], 200.0, 2 * minutes, 300.0, 0.5),
    )
    return Result(Task(SETTING, field, Entrant(strategy, "paper-10")), (Series(30, rows),))


def test_a_mean_has_students_interval() -> None:
    x = RNG.normal(50.0, 5.0, 12)
    low, high = stats.t.interval(0.95, 11, x.mean(), stats.sem(x))
    found = mean_of(x)
    assert (found.mean - found.half, found.mean + found.half) == pytest.approx((low, high))
    assert mean_of([*x, np.nan]) == found


def test_one_field_has_a_mean_and_no_interval_and_none_has_neither() -> None:
    assert mean_of([3.0]).mean == 3.0
    assert np.isnan(mean_of([3.0]).half)
    assert np.isnan(mean_of([]).mean)


def test_a_paired_difference_is_that_of_the_paired_t_test_over_common_fields() -> None:
    a, b = RNG.normal(50, 8, 10), RNG.normal(48, 8, 10)
    ours = {**dict(enumerate(a)), 77: 1e9}
    theirs = {**dict(enumerate(b)), 88: -1e9, 77: np.nan}
    found = paired(ours, theirs)
    low, high = stats.ttest_rel(a, b).confidence_interval(0.95)
    assert found.difference.mean - found.difference.half == pytest.approx(low)
    assert found.difference.mean + found.difference.half == pytest.approx(high)
    assert found.percent.mean == pytest.approx(100 * (a - b).mean() / b.mean())
    assert found.won == (a < b).mean()


def test_a_tie_is_half_won() -> None:
    assert paired({0: 1.0, 1: 2.0, 2: 5.0}, {0: 1.0, 1: 3.0, 2: 4.0}).won == 0.5


def test_error_by_a_time_is_linear_between_marks_and_holds_after_the_last() -> None:
    one = result("random", 0, (60.0, 40.0), minutes=20.0)
    assert by_minutes(one, 30.0) == 50.0
    assert by_minutes(one, 90.0) == 40.0
    assert np.isnan(by_minutes(one, 19.0))
    assert ended_before(one, 41.0)
    assert not ended_before(one, 40.0)


def test_correlation_over_samples_is_of_variance_and_squared_error() -> None:
    kv, error = RNG.uniform(1, 2, 9), RNG.uniform(1, 2, 9)
    rows = tuple(
        Snapshot(n + 2, e, 0, 0, v, 0) for n, (v, e) in enumerate(zip(kv, error, strict=True))
    )
    one = replace(result("random", 0, (1, 1)), series=(Series(10, rows),))
    assert correlation_over_samples(one) == pytest.approx(stats.pearsonr(kv, error**2).statistic)
    n, values = curves([one, one], lambda row: row.mean_kv)
    assert n.tolist() == list(range(2, 11))
    assert values.tolist() == [kv.tolist()] * 2


def test_the_table_of_differences_compares_fields_with_themselves() -> None:
    easy, hard = (10.0, 8.0), (100.0, 80.0)
    found = result_table(
        [
            result("area-split", 0, easy), result("area-split", 1, hard),
            result("random", 0, (11.0, 9.0)), result("random", 1, (101.0, 81.0)),
        ]
    )  # fmt: skip
    table = paired_table("paired", "RMSE", found, lambda row: row.rmse_kpa, 1)
    against, who, n, difference, percent, won, fields = table.rows[0]
    assert (against, who, n, won, fields) == ("area-split", "random", 15, 0.0, 2)
    assert difference == Mean(1.0, 0.0, 2)
    assert isinstance(percent, Mean)
    assert percent.mean == pytest.approx(100 * 1 / 55)


def test_the_papers_numbers_stand_beside_ours_where_it_has_some() -> None:
    table = rmse_table(result_table([result("random", 0, (60.0, 40.0))]))
    assert table.columns == ("strategy", "fields", "n = 15", "paper 15", "n = 30", "paper 30")
    assert markdown(table).splitlines()[-1] == "| random | 1 | 60.0 | 63.04 | 40.0 | 48.52 |"


def test_labels_name_the_estimator_only_where_a_strategy_has_several() -> None:
    one = result("random", 0, (1.0, 1.0))
    other = replace(one, task=replace(one.task, entrant=Entrant("random", "spherical")))
    both = result_table([one, other, result("greedy", 0, (1.0, 1.0))])
    assert [both.label(e) for e in both.entrants] == [
        "random, paper-10", "random, spherical", "greedy",
    ]  # fmt: skip


def test_tables_are_written_for_latex_and_as_numbers(tmp_path: object) -> None:
    from pathlib import Path

    path = Path(str(tmp_path)) / "t.csv"
    table = Table("t", "T", ("a_b", "x %"), (("r&d", Mean(1.0, 0.5, 3)), ("s", 2.0)), (0, 1))
    text = latex(table)
    assert r"a\_b & x \% \\" in text
    assert r"r\&d & 1.0 $\pm$ 0.5 \\" in text
    assert text.count("&") - text.count(r"\&") == 3
    write_csv(table, path)
    assert path.read_text() == "a_b,x %,x % ±\nr&d,1.0,0.5\ns,2.0,\n"
