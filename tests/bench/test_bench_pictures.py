"""Tables and figures of a benchmark hold the numbers of its results, read back from both."""

from __future__ import annotations

import csv
from math import isnan, nan
from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.container import ErrorbarContainer
from scipy import stats

from subsoil.bench import Entrant, Result, Series, Setting, Snapshot, Task
from subsoil.bench import figures as pictures
from subsoil.bench.comparison import Mean, ResultTable, mean_of, paired, result_table
from subsoil.bench.hand_survey import HandSurveys
from subsoil.bench.paper import CORRELATION, NORMALISED_RMSE, PATH_M, RMSE_KPA
from subsoil.bench.tables import (
    Table,
    calibration_table,
    correlation_table,
    decision_table,
    latex,
    layer_table,
    markdown,
    path_table,
    time_table,
    write_csv,
)

SAMPLES = (15, 30)
NAMES = ("random", "adaptive-greedy", "area-split", "mine.own:plan")
FIELDS = 4


def result(who: int, field: int) -> Result:
    """A survey of 30 samples whose every number says whose and where it is."""
    base = 60.0 + 4.0 * who + 3.0 * np.sin(5 * field + who)
    rows = tuple(
        Snapshot(
            n,
            base - 0.5 * n + np.cos(n * (1 + field)),
            (20.0 + who) * n + field,
            (2.0 + 0.1 * who) * n,
            (base - 0.4 * n) ** 2,
            0.5 + 0.05 * field,
        )
        for n in range(2, 31)
    )
    setting = Setting("signal", 1, SAMPLES)
    series = Series(30, rows, 0.01 * (1 + who) + 0.001 * field)
    return Result(Task(setting, field, Entrant(NAMES[who], "pmc")), (series,))


@pytest.fixture(scope="module")
def results() -> ResultTable:
    return result_table(result(who, field) for who in range(4) for field in range(FIELDS))


def numbers(name: str, n: int, value: str) -> list[float]:
    """Of each field, straight from the results."""
    who = NAMES.index(name)
    return [getattr(result(who, k).longest.at(n), value) for k in range(FIELDS)]


def cell(table: Table, row: str, column: str) -> object:
    (line,) = [line for line in table.rows if line[0] == row]
    return line[table.columns.index(column)]


def test_entrants_stand_in_the_papers_order_and_then_by_name(results: ResultTable) -> None:
    assert [entrant.strategy for entrant in results.entrants] == [
        "random", "area-split", "adaptive-greedy", "mine.own:plan",
    ]  # fmt: skip
    assert [results.label(entrant) for entrant in results.entrants][-1] == "plan"
    assert [entrant.strategy for entrant in results.references] == [
        "adaptive-greedy", "area-split",
    ]  # fmt: skip


def test_ways_are_means_over_fields_beside_the_papers(results: ResultTable) -> None:
    table = path_table(results)
    found = cell(table, "area-split", "n = 30")
    assert found == mean_of(numbers("area-split", 30, "path_m"))
    assert cell(table, "area-split", "paper 30") == f"{PATH_M['area-split'][2]:g}"
    assert cell(table, "plan", "paper 15") == "–"
    assert cell(table, "random", "fields") == FIELDS


def test_correlations_are_those_of_scipy_over_samples_and_the_means_over_cells(
    results: ResultTable,
) -> None:
    table = correlation_table(results)
    found = cell(table, "random", "over samples")
    peers = [
        stats.pearsonr(
            [row.mean_kv for row in one.longest.snapshots],
            [row.rmse_kpa**2 for row in one.longest.snapshots],
        ).statistic
        for one in (result(0, k) for k in range(FIELDS))
    ]
    assert isinstance(found, Mean)
    assert found.mean == pytest.approx(np.mean(peers))
    assert cell(table, "random", "over cells, n = 30") == mean_of([0.5, 0.55, 0.6, 0.65])
    assert cell(table, "random", "paper") == CORRELATION["random"]
    unknown = cell(table, "plan", "paper")
    assert isinstance(unknown, float)
    assert isnan(unknown)


def test_calibration_is_expected_over_made_field_by_field(results: ResultTable) -> None:
    found = cell(calibration_table(results), "area-split", "n = 15")
    kv = np.array(numbers("area-split", 15, "mean_kv"))
    error = np.array(numbers("area-split", 15, "rmse_kpa"))
    assert found == mean_of(np.sqrt(kv) / error)


def test_decisions_take_the_time_of_the_survey_of_their_mark(results: ResultTable) -> None:
    table = decision_table(results)
    assert cell(table, "random", "n = 15") == mean_of([0.01 + 0.001 * k for k in range(FIELDS)])
    assert cell(table, "plan", "n = 30") == mean_of([0.04 + 0.001 * k for k in range(FIELDS)])


def test_time_and_quality_are_compared_at_an_hour(results: ResultTable) -> None:
    """Random takes 60 min for 30 samples, the others longer: linear between their marks."""
    table = time_table(results)
    assert cell(table, "random", "RMSE at 60 min") == mean_of(numbers("random", 30, "rmse_kpa"))
    assert cell(table, "random", "over by then %") == 0.0
    early, late = (numbers("area-split", n, "rmse_kpa") for n in SAMPLES)
    begun, over = 2.2 * 15, 2.2 * 30
    share = (60.0 - begun) / (over - begun)
    by_hour = [(1 - share) * a + share * b for a, b in zip(early, late, strict=True)]
    found = cell(table, "area-split", "RMSE at 60 min")
    assert isinstance(found, Mean)
    assert found.mean == pytest.approx(np.mean(by_hour))
    assert cell(table, "area-split", "minus area-split") == "–"
    against = cell(table, "random", "minus area-split")
    assert isinstance(against, Mean)
    ours = numbers("random", 30, "rmse_kpa")
    assert against.mean == pytest.approx(np.mean(np.subtract(ours, by_hour)))


def test_a_survey_that_is_over_before_an_hour_is_counted_as_such() -> None:
    rows = (Snapshot(15, 9.0, 1.0, 20.0, 1.0, 0.0), Snapshot(30, 8.0, 1.0, 40.0, 1.0, 0.0))
    setting = Setting("signal", 1, SAMPLES)
    tasks = [Task(setting, k, Entrant("random", "pmc")) for k in range(2)]
    slow = tuple(Snapshot(r.n, r.rmse_kpa, 1.0, 2 * r.minutes, 1.0, 0.0) for r in rows)
    found = result_table(
        [Result(tasks[0], (Series(30, rows),)), Result(tasks[1], (Series(30, slow),))]
    )
    table = time_table(found)
    assert cell(table, "random", "over by then %") == 50.0
    assert cell(table, "random", "RMSE at 60 min") == mean_of([8.0, 8.5])


HAND = HandSurveys(
    tuple(f"layer {k}" for k in range(8)),
    np.outer([1.0, 1.2], 100.0 * np.arange(1, 9)),
    np.outer([1.0, 1.5], np.full(8, 30.0)),
    (49, 48),
)


def test_layers_by_hand_have_mean_error_and_ratio_beside_the_papers() -> None:
    table = layer_table(HAND)
    name, mean, rmse, ratio, paper = table.rows[1]
    assert (name, mean, rmse) == ("layer 1", mean_of([200.0, 240.0]), mean_of([30.0, 45.0]))
    assert ratio == mean_of([30 / 200, 45 / 240])
    assert paper == f"{NORMALISED_RMSE[1]:g}"
    # The paper prints no number for 25 to 30 cm.
    assert table.rows[5][-1] == "–"


def test_tables_show_a_dash_for_no_number_and_hold_an_empty_cell(tmp_path: Path) -> None:
    table = Table(
        "t", "T", ("who", "mean", "one", "n"),
        (("a", Mean(1.25, nan, 1), nan, 3), ("b", Mean(nan, nan, 0), 2.0, 4), ("–", "–", "–", 5)),
        (0, 1, 2, 0),
    )  # fmt: skip
    assert markdown(table).splitlines()[2:] == [
        "| a | 1.2 | – | 3 |", "| b | – | 2.00 | 4 |", "| – | – | – | 5 |",
    ]  # fmt: skip
    write_csv(table, tmp_path / "t.csv")
    with (tmp_path / "t.csv").open(newline="") as file:
        assert list(csv.reader(file)) == [
            ["who", "mean", "mean ±", "one", "n"],
            ["a", "1.25", "", "", "3"],
            ["b", "", "", "2.0", "4"],
            ["", "", "", "", "5"],
        ]
    assert r"-- & -- & -- & 5 \\" in latex(table)


def test_signs_that_latex_obeys_are_written_so_that_it_does_not() -> None:
    table = Table("t", "T", ("a",), (("5 % of_x & #1 \\ kPa² ±",),), (0,))
    assert r"5 \% of\_x \& \#1 \textbackslash{} kPa$^2$ $\pm$ \\" in latex(table)


# Figures


def bars(axes: Axes, name: str) -> ErrorbarContainer:
    (found,) = [
        each
        for each in axes.containers
        if isinstance(each, ErrorbarContainer) and each.get_label() == name
    ]
    return found


def drawn(bar: ErrorbarContainer, axis: int) -> tuple[list[float], list[float]]:
    """Middle of each point along an axis and half of its bar."""
    middle = np.asarray(bar.lines[0].get_xydata())[:, axis]
    (segments,) = bar.lines[2]
    assert isinstance(segments, LineCollection)
    ends = np.array(segments.get_segments())[:, :, axis]
    return middle.tolist(), (np.ptp(ends, axis=1) / 2).tolist()


def test_learning_draws_means_with_intervals_and_the_papers_numbers(results: ResultTable) -> None:
    left, right = pictures.learning(results, "c").axes[:2]
    for axes, value, paper in ((left, "rmse_kpa", RMSE_KPA), (right, "path_m", PATH_M)):
        for name, label in zip(NAMES, (*NAMES[:3], "plan"), strict=True):
            means = [mean_of(numbers(name, n, value)) for n in SAMPLES]
            middle, half = drawn(bars(axes, label), 1)
            assert middle == pytest.approx([m.mean for m in means])
            assert half == pytest.approx([m.half for m in means])
        open_marks = [
            np.asarray(line.get_xydata())[:, 1].tolist()
            for line in axes.lines
            if line.get_markerfacecolor() == "none"
        ]
        expected = [[paper[name][0], paper[name][2]] for name in ("random", "area-split")]
        assert all(each in open_marks for each in expected)
        assert len(open_marks) == 3
    assert right.get_yscale() == "log"


def test_points_of_a_number_of_samples_stand_beside_each_other_around_it(
    results: ResultTable,
) -> None:
    axes = pictures.learning(results, "c").axes[0]
    x = np.array([drawn(bars(axes, label), 0)[0] for label in (*NAMES[:3], "plan")])
    assert np.allclose(x.mean(axis=0), SAMPLES)
    assert len(np.unique(x[:, 0])) == 4
    assert np.ptp(x[:, 0]) < SAMPLES[1] - SAMPLES[0]


def test_error_by_time_joins_the_mean_minutes_and_errors_of_each_mark(
    results: ResultTable,
) -> None:
    (axes,) = pictures.time_quality(results, "c").axes
    lines = {line.get_label(): np.asarray(line.get_xydata()) for line in axes.lines}
    for name in NAMES[:3]:
        expected = [
            [np.mean(numbers(name, n, "minutes")), np.mean(numbers(name, n, "rmse_kpa"))]
            for n in SAMPLES
        ]
        assert np.allclose(lines[name], expected)
    assert any(set(line.get_xdata()) == {60.0} for line in axes.lines)  # type: ignore[arg-type]


def test_variance_and_error_are_drawn_in_thousands_from_the_fifth_sample_with_their_bands(
    results: ResultTable,
) -> None:
    figure = pictures.variance_and_error(results, "c")
    panels = figure.axes[:4]
    assert [axes.get_title(loc="left") for axes in panels] == [
        "random", "area-split", "adaptive-greedy", "plan",
    ]  # fmt: skip
    axes = panels[1]
    lines = {line.get_label(): np.asarray(line.get_xydata()) for line in axes.lines}
    n = np.arange(5, 31)
    for label, of in (
        ("mean KV", lambda n: numbers("area-split", n, "mean_kv")),
        ("mean squared error", lambda n: np.square(numbers("area-split", n, "rmse_kpa"))),
    ):
        means = [mean_of(np.divide(of(k), 1000.0)) for k in n]
        assert np.allclose(lines[label], np.column_stack([n, [m.mean for m in means]]))
    bands = [each for each in axes.collections if isinstance(each, PolyCollection)]
    edge = np.asarray(bands[0].get_paths()[0].vertices)
    first = mean_of(np.divide(numbers("area-split", 5, "mean_kv"), 1000.0))
    at_first = edge[edge[:, 0] == 5.0, 1]
    assert at_first.min() == pytest.approx(first.mean - first.half)
    assert at_first.max() == pytest.approx(first.mean + first.half)
    assert len({axes.get_ylim() for axes in panels}) == 1
    top = max(line.get_ydata().max() for axes in panels for line in axes.lines)  # type: ignore[union-attr]
    assert panels[0].get_ylim() == pytest.approx((0.0, 1.05 * top))


def test_differences_are_paired_by_field_and_none_is_drawn_against_itself(
    results: ResultTable,
) -> None:
    figure = pictures.differences(results, "c")
    rows = ["random", "area-split", "adaptive-greedy", "mine.own:plan"]
    for axes, reference in zip(figure.axes, ("adaptive-greedy", "area-split"), strict=True):
        assert axes.get_title(loc="left") == f"minus {reference}"
        for n in SAMPLES:
            theirs = dict(enumerate(numbers(reference, n, "rmse_kpa")))
            expected = {
                k: paired(dict(enumerate(numbers(name, n, "rmse_kpa"))), theirs).difference
                for k, name in enumerate(rows)
                if name != reference
            }
            found = bars(axes, f"n = {n}")
            middle, half = drawn(found, 0)
            assert middle == pytest.approx([each.mean for each in expected.values()])
            assert half == pytest.approx([each.half for each in expected.values()])
            at = np.asarray(found.lines[0].get_xydata())[:, 1]
            assert at.round().tolist() == list(expected)


def test_calibrations_stand_beside_the_line_of_one(results: ResultTable) -> None:
    (axes,) = pictures.calibrations(results, "c").axes
    middle, _ = drawn(bars(axes, "area-split"), 1)
    kv, error = (np.array(numbers("area-split", 30, name)) for name in ("mean_kv", "rmse_kpa"))
    assert middle[1] == pytest.approx(np.mean(np.sqrt(kv) / error))
    assert any(set(line.get_ydata()) == {1.0} for line in axes.lines)  # type: ignore[arg-type]


def test_layers_by_hand_are_drawn_from_the_top_with_their_means_errors_and_ratios() -> None:
    left, right = pictures.by_layer(HAND, "c").axes[:2]
    widths = [patch.get_width() for patch in left.patches]  # type: ignore[attr-defined]
    assert widths == pytest.approx((110.0 * np.arange(1, 9)).tolist())
    middle, half = drawn(bars(right, "here, with 95 % interval"), 0)
    ratio = [mean_of(HAND.rmse_kpa[:, k] / HAND.mean_kpa[:, k]) for k in range(8)]
    assert middle == pytest.approx([m.mean for m in ratio])
    assert half == pytest.approx([m.half for m in ratio])
    (paper,) = [line for line in right.lines if line.get_label() == "paper, one field"]
    assert np.asarray(paper.get_xydata()).tolist() == [
        [x, k] for k, x in enumerate(NORMALISED_RMSE) if x is not None
    ]
    assert [text.get_text() for text in left.get_yticklabels()] == list(HAND.layers)
    bottom, top = left.get_ylim()
    assert bottom > top


def test_a_single_field_has_points_and_no_bars() -> None:
    axes = pictures.learning(result_table(result(who, 0) for who in range(2)), "c").axes[0]
    bar = bars(axes, "random")
    assert np.asarray(bar.lines[0].get_xydata())[:, 1].tolist() == pytest.approx(
        [numbers("random", n, "rmse_kpa")[0] for n in SAMPLES]
    )
    (segments,) = bar.lines[2]
    assert isinstance(segments, LineCollection)
    assert not any(len(each) and np.isfinite(each).all() for each in segments.get_segments())
