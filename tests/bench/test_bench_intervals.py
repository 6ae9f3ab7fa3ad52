"""95 % intervals hold the truth in 95 % of benchmarks, and pairs of fields make them narrower."""

from __future__ import annotations

from math import sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import binom, nct, norm, t

from subsoil.bench import Entrant, Result, Series, Setting, Snapshot, Task
from subsoil.bench.comparison import ByField, by_minutes, curves, mean_of, paired

TRIALS, LEAST_P = 3000, 1e-5
"""Simulated benchmarks, and the probability of a test failing by chance."""


def benchmarks(
    fields: int, better: float, seed: int, *, alike: float = 0.9
) -> list[tuple[ByField, ByField]]:
    """Errors of two entrants on the same normal fields, whose errors correlate."""
    rng = np.random.default_rng(seed)
    found: list[tuple[ByField, ByField]] = []
    for _ in range(TRIALS):
        field = 60.0 + 10.0 * sqrt(alike) * rng.standard_normal(fields)
        one, other = field + 10.0 * sqrt(1 - alike) * rng.standard_normal((2, fields))
        found.append((dict(enumerate((one - better).tolist())), dict(enumerate(other.tolist()))))
    return found


def within(number: int, share: float) -> bool:
    """Whether a number of trials is one that a share of them may give."""
    low, high = binom.ppf(LEAST_P / 2, TRIALS, share), binom.isf(LEAST_P / 2, TRIALS, share)
    return bool(low <= number <= high)


@pytest.mark.parametrize("fields", [2, 5, 20])
def test_the_interval_of_a_difference_holds_the_true_one_in_95_of_100_benchmarks(
    fields: int,
) -> None:
    """Differences of one field are normal, so that Student's interval is exact."""
    held = 0
    for ours, theirs in benchmarks(fields, 1.5, seed=fields):
        found = paired(ours, theirs).difference
        assert found.fields == fields
        held += abs(found.mean - (-1.5)) <= found.half
    assert within(held, 0.95)


def test_a_difference_is_seen_as_often_as_the_power_of_the_paired_test_says() -> None:
    """The statistic is noncentral t: 1.5 kPa in SDs of sqrt(2 (1 - 0.9)) 10 kPa over 20 fields."""
    shift = 1.5 / (10.0 * sqrt(2 * 0.1)) * sqrt(20)
    edge = t.ppf(0.975, 19)
    power = float(nct.sf(edge, 19, shift) + nct.cdf(-edge, 19, shift))
    assert 0.2 < power < 0.8
    seen = 0
    for ours, theirs in benchmarks(20, 1.5, seed=3):
        found = paired(ours, theirs).difference
        seen += abs(found.mean) > found.half
    assert within(seen, power)


def test_without_a_difference_half_the_fields_are_won() -> None:
    won = [paired(*pair).won for pair in benchmarks(4, 0.0, seed=4)]
    # A share of 4 fields in each trial, with the standard error of a fair coin.
    assert np.mean(won) == pytest.approx(0.5, abs=4.5 * sqrt(0.25 / (4 * TRIALS)))


def test_a_share_of_fields_won_is_the_normal_probability_of_being_better() -> None:
    better = float(norm.cdf(1.5 / (10.0 * sqrt(2 * 0.1))))
    won = [paired(*pair).won for pair in benchmarks(4, 1.5, seed=5)]
    spread = sqrt(better * (1 - better) / (4 * TRIALS))
    assert np.mean(won) == pytest.approx(better, abs=4.5 * spread)


def test_pairs_of_a_field_make_an_interval_narrower_by_what_they_have_in_common() -> None:
    """Half its width over that of unpaired fields is about sqrt(1 - correlation)."""
    ratios = []
    for ours, theirs in benchmarks(20, 0.0, seed=6)[:300]:
        apart = sqrt(mean_of([*ours.values()]).half ** 2 + mean_of([*theirs.values()]).half ** 2)
        ratios.append(paired(ours, theirs).difference.half / apart)
    assert np.sqrt(np.mean(np.square(ratios))) == pytest.approx(sqrt(0.1), rel=0.1)


values = st.floats(-1e3, 1e3, allow_subnormal=False)


@given(st.lists(values, min_size=2, max_size=12), st.floats(-50, 50), st.floats(0.1, 10))
def test_an_interval_moves_and_stretches_with_its_values(
    x: list[float], shift: float, factor: float
) -> None:
    before, after = mean_of(x), mean_of([factor * each + shift for each in x])
    assert after.mean == pytest.approx(factor * before.mean + shift, abs=1e-6)
    assert after.half == pytest.approx(factor * before.half, rel=1e-6, abs=1e-6)


@given(st.dictionaries(st.integers(0, 9), values, min_size=1), st.integers(0, 9))
def test_an_entrant_against_itself_differs_by_nothing_and_ties_everywhere(
    errors: dict[int, float], gone: int
) -> None:
    known = {k: v for k, v in errors.items() if k != gone}
    found = paired(errors, known)
    assert found.difference.fields == len(known)
    if known:
        assert (found.difference.mean, found.won) == (0.0, 0.5)
    else:
        assert np.isnan([found.difference.mean, found.percent.mean, found.won]).all()


def test_of_a_reference_that_is_nothing_there_is_no_percent() -> None:
    found = paired({0: 1.0, 1: 3.0}, {0: 0.0, 1: 0.0})
    assert found.difference.mean == 2.0
    assert np.isnan([found.percent.mean, found.percent.half]).all()


def marked(*rows: tuple[int, float, float]) -> Result:
    """Survey whose map had errors at numbers of samples, by minutes."""
    snapshots = tuple(Snapshot(n, error, 0.0, minutes, 4.0, 0.0) for n, minutes, error in rows)
    setting = Setting("signal", 1, tuple(n for n, _, _ in rows))
    return Result(Task(setting, 0, Entrant("random", "pmc")), (Series(rows[-1][0], snapshots),))


def test_error_by_a_time_is_read_at_the_marks_themselves_and_between_the_nearest() -> None:
    one = marked((5, 10.0, 90.0), (8, 20.0, 60.0), (12, 40.0, 50.0))
    assert [by_minutes(one, minutes) for minutes in (10.0, 15.0, 20.0, 30.0, 40.0, 1e6)] == [
        90.0, 75.0, 60.0, 55.0, 50.0, 50.0,
    ]  # fmt: skip
    assert np.isnan(by_minutes(one, 9.999))


def test_a_curve_has_a_row_a_field_and_a_column_a_sample() -> None:
    one, other = marked((2, 1.0, 9.0), (3, 2.0, 8.0)), marked((2, 1.0, 7.0), (3, 2.0, 6.0))
    n, errors = curves([one, other], lambda row: row.rmse_kpa)
    assert n.tolist() == [2.0, 3.0]
    assert errors.tolist() == [[9.0, 8.0], [7.0, 6.0]]
