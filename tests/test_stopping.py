"""A survey stops at the first limit or goal it comes to, and says which."""

from __future__ import annotations

from collections.abc import Callable
from math import inf, nan

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from subsoil.errors import ParameterError
from subsoil.land.field import Field
from subsoil.layers import Layers, Sample
from subsoil.mapping.soilmap import SoilMap
from subsoil.mapping.uncertainty import mean_square_error, predicted_rmse
from subsoil.penetrometer import SMALL_CONE
from subsoil.simulation import Machine
from subsoil.stopping import (
    DecidedShare,
    Goal,
    GoalProgress,
    LeastGain,
    Limits,
    Pace,
    Rates,
    Spent,
    SureRmse,
    TargetRmse,
    first_stop,
    forecast,
    further,
)
from subsoil.variogram import Exponential, Spherical

ON_THE_WAY = Spent(samples=15, metres=120.0, minutes=10.0, mean_kv=900.0)


def test_nothing_is_reached_on_the_way() -> None:
    assert Limits().reached(ON_THE_WAY) == ""
    assert Limits(16, 121.0, 11.0, 899.0).reached(ON_THE_WAY) == ""


@pytest.mark.parametrize(
    ("limits", "why"),
    [
        (Limits(samples=15), "15 samples taken"),
        (Limits(metres=120), "120 metres driven"),
        (Limits(minutes=10), "10 minutes spent"),
        (Limits(mean_kv=900), "mean kriging variance at 900 kPa2"),
        (Limits(samples=4, minutes=1), "4 samples taken"),
    ],
)
def test_a_limit_counts_from_the_moment_it_is_met(limits: Limits, why: str) -> None:
    assert limits.reached(ON_THE_WAY) == why


def test_before_the_first_sample_no_variance_is_good_enough() -> None:
    assert Limits(mean_kv=1e9).reached(Spent(0, 0.0, 0.0, nan)) == ""


def test_a_dozen_samples_come_before_any_variance_is_good_enough() -> None:
    limits = Limits(mean_kv=1000.0)
    assert limits.reached(Spent(11, 0.0, 0.0, 1.0)) == ""
    assert limits.reached(Spent(12, 0.0, 0.0, 1.0)) == "mean kriging variance at 1000 kPa2"


@given(st.integers(0, 60), st.floats(0, 5000), st.floats(0, 600), st.floats(1, 1e5) | st.just(nan))
def test_going_on_never_takes_a_limit_back(
    n: int, metres: float, minutes: float, kv: float
) -> None:
    limits = Limits(samples=30, metres=2000, minutes=240, mean_kv=500)
    spent = Spent(n, metres, minutes, kv)
    later = Spent(n + 1, metres + 10, minutes + 2, kv)
    assert bool(limits.reached(later)) >= bool(limits.reached(spent))


@pytest.mark.parametrize("value", [0, -1, nan])
@pytest.mark.parametrize("name", ["samples", "metres", "minutes"])
def test_a_limit_that_stops_at_once_is_refused_by_name(name: str, value: float) -> None:
    with pytest.raises(ParameterError, match=f"{name}: must be greater than zero"):
        Limits(**{name: value})  # type: ignore[arg-type]


@pytest.mark.parametrize("value", [-1.0, nan, -inf])
def test_a_target_below_zero_is_refused(value: float) -> None:
    with pytest.raises(ParameterError, match="KV target"):
        Limits(mean_kv=value)


RATES = Rates(hour=60.0, km=5.0, sample=2.0, call_out=100.0, currency="GBP")


def test_money_is_call_out_time_way_and_samples() -> None:
    assert RATES.money(samples=10, metres=2000.0, minutes=30.0) == 100 + 30 + 10 + 20
    assert RATES.more(samples=10, metres=2000.0, minutes=30.0) == 60
    limits = Limits(money=160.0, rates=RATES)
    assert limits.reached(Spent(10, 2000.0, 30.0, 900.0, money=160.0)) == "160 GBP spent"
    assert limits.reached(Spent(10, 2000.0, 29.0, 900.0, money=159.0)) == ""


@pytest.mark.parametrize(
    ("limits", "why"),
    [
        (Limits(metres=130), "120.0 metres driven, the next stop would take it beyond 130"),
        (Limits(minutes=10.5), "10.0 minutes spent, the next stop would take it beyond 10.5"),
        (Limits(money=115, rates=RATES), "114.0 GBP spent, the next stop would take it beyond 115"),
        (Limits(metres=131, minutes=11, money=116, rates=RATES), ""),
    ],
)
def test_a_stop_that_would_pass_a_limit_is_not_begun(limits: Limits, why: str) -> None:
    now, after = Spent(15, 120.0, 10.0, 9.0, 114.0), Spent(16, 131.0, 11.0, 9.0, 116.0)
    assert limits.passed(now, after) == why


def test_money_for_nothing_charged_or_too_little_for_a_sample_is_refused() -> None:
    with pytest.raises(ParameterError, match="nothing is charged"):
        Limits(money=100.0)
    with pytest.raises(ParameterError, match="101 GBP do not pay for one sample, which is 102"):
        Limits(money=101.0, rates=RATES)


@pytest.mark.parametrize("rate", [-1.0, nan, inf])
@pytest.mark.parametrize("name", ["hour", "km", "sample", "call_out"])
def test_a_rate_is_a_finite_price(name: str, rate: float) -> None:
    with pytest.raises(ParameterError, match=f"rate {name.replace('_', '-')}"):
        Rates(**{name: rate})  # type: ignore[arg-type]


@pytest.mark.parametrize("code", ["", "eur", "EURO", "E1R", "ÄÖÜ"])
def test_a_currency_is_a_code_of_three_letters(code: str) -> None:
    with pytest.raises(ParameterError, match="is no currency"):
        Rates(currency=code)


def test_the_pace_is_that_of_the_simulated_machine() -> None:
    machine = Machine(SMALL_CONE)
    assert Pace() == Pace(machine.speed_mps, machine.stop_s)
    for speed, stop in ((0.0, 50.0), (nan, 50.0), (1.0, -1.0)):
        with pytest.raises(ParameterError):
            Pace(speed, stop)


@pytest.mark.parametrize(
    ("make", "where"),
    [
        (lambda: TargetRmse(0.0), "target RMSE"),
        (lambda: TargetRmse(inf), "target RMSE"),
        (lambda: SureRmse(nan, 0.8), "target RMSE"),
        (lambda: SureRmse(40.0, 1.0), "probability"),
        (lambda: SureRmse(40.0, nan), "probability"),
        (lambda: DecidedShare(-5.0), "threshold"),
        (lambda: DecidedShare(2000.0, share=1.1), "decided"),
        (lambda: DecidedShare(2000.0, confidence=0.5), "confidence"),
        (lambda: LeastGain(0.0), "least gain"),
    ],
)
def test_a_goal_that_cannot_be_is_refused_by_name(make: Callable[[], Goal], where: str) -> None:
    with pytest.raises(ParameterError, match=where):
        make()


predictions = st.lists(st.sampled_from([38.0, 40.0, 41.0, nan]), max_size=30)


@given(predictions, st.integers(1, 14))
def test_a_target_stops_at_the_first_of_three_good_updates_running_from_the_twelfth_sample(
    predicted: list[float], first: int
) -> None:
    samples = [first + k for k in range(len(predicted))]
    good = [
        k
        for k in range(2, len(predicted))
        if samples[k] >= 12 and all(p <= 40.0 for p in predicted[k - 2 : k + 1])
    ]
    assert first_stop(predicted, samples, 40.0) == (good[0] if good else len(predicted))


def test_plans_for_the_same_samples_are_one_update() -> None:
    goals, progress = (TargetRmse(40.0),), GoalProgress()
    for samples in (12, 12, 12, 13, 13):
        progress = progress.updated(goals, samples, (30.0,))
    assert progress.running == (2,)
    assert progress.reached(goals) == ""
    assert progress.updated(goals, 14, (30.0,)).reached(goals)


def test_of_goals_met_together_the_first_says_why_and_one_update_off_starts_anew() -> None:
    goals, progress = (TargetRmse(40.0), SureRmse(40.0, 0.8)), GoalProgress()
    for samples, measures in ((12, (39.0, 0.9)), (13, (39.0, 0.7)), (14, (39.0, 0.9))):
        progress = progress.updated(goals, samples, measures)
    assert progress.running == (3, 1)
    assert progress.reached(goals) == "predicted RMSE 39.0 kPa, 40 kPa asked for, 3 updates running"


def some_map(samples: int, seed: int = 2, nugget: float = 200.0) -> SoilMap:
    """Map of a field of 100 x 80 m in two layers, the second heavier than the first."""
    field = Field.from_metres([(0, 0), (100, 0), (100, 80), (0, 80)])
    layers = Layers((0.0, 0.1, 0.3), (1.0, 3.0))
    models = (Spherical(nugget, 45.0, 3000.0), Exponential(nugget, 20.0, 5000.0))
    rng = np.random.default_rng(seed)
    cells = rng.choice(len(field.cells), samples, replace=False)
    readings = tuple(
        Sample(
            (float(e), float(n)),
            np.array([1000.0, 2000.0]) + 300 * rng.standard_normal(2),
            np.zeros(2, dtype=np.int8),
        )
        for e, n in field.cells[cells]
    )
    return SoilMap(field, layers, models, readings)


def test_a_forecast_is_what_the_map_predicts_once_those_cells_are_probed() -> None:
    soil_map = some_map(14)
    cells = [5, 200, 77, 5]
    said = forecast(soil_map, cells)
    for cell, rmse in zip(cells, said, strict=True):
        at = (float(soil_map.cells[cell, 0]), float(soil_map.cells[cell, 1]))
        soil_map = soil_map.append(Sample(at, np.array([700.0, 3100.0]), np.zeros(2, np.int8)))
        fresh = SoilMap(soil_map.field, soil_map.layers, soil_map.variograms, soil_map.samples)
        assert predicted_rmse(fresh) == pytest.approx(rmse, rel=1e-9)
    assert (np.diff(said) < 0).all()


def test_cells_to_probe_further_are_new_ones_that_tell_most() -> None:
    soil_map = some_map(14)
    taken, planned = (3, 4, 5), (100, 120)
    cells = further(soil_map, taken, planned, 6)
    assert len(set(cells) - {*taken, *planned}) == 6
    best = forecast(soil_map, (*planned, *cells))[-1]
    for seed in range(10):
        others = np.random.default_rng(seed).choice(len(soil_map.cells), 6, replace=False)
        assert best < forecast(soil_map, (*planned, *others.tolist()))[-1]


def test_where_no_cell_is_left_there_is_none_to_probe_further() -> None:
    soil_map = some_map(5)
    taken = range(len(soil_map.cells) - 2)
    assert len(further(soil_map, tuple(taken), (), 6)) <= 2


def test_goals_measure_what_they_say() -> None:
    soil_map, plan = some_map(14), (150, 20)
    rmse = predicted_rmse(soil_map)
    assert TargetRmse(40.0).measure(soil_map, plan) == rmse
    sure = SureRmse(rmse, 0.8).measure(soil_map, plan)
    assert sure == mean_square_error(soil_map).probability(rmse)
    assert 0.4 < sure < 0.5  # the error is a little over its prediction more often than not
    gain = LeastGain(1.0).measure(soil_map, plan)
    assert gain == pytest.approx(rmse - forecast(soil_map, plan)[0], rel=1e-6)
    assert np.isnan(LeastGain(1.0).measure(soil_map, ()))


def test_a_share_is_decided_by_the_strongest_layer_that_counts() -> None:
    soil_map = some_map(14)
    assert DecidedShare(10.0).measure(soil_map, ()) == 1.0
    assert DecidedShare(1e5).measure(soil_map, ()) == 1.0
    assert DecidedShare(2000.0, confidence=0.99).measure(soil_map, ()) < 0.5
    second_only = Layers((0.0, 0.1, 0.3), (0.0, 1.0))
    first_high = SoilMap(soil_map.field, second_only, soil_map.variograms, soil_map.samples)
    goal = DecidedShare(1500.0)
    below, above = soil_map.mean[1] - 1500.0, np.sqrt(soil_map.variance[1])
    share = float((np.abs(below / above) >= 0.8416212335729143).mean())
    assert goal.measure(first_high, ()) == pytest.approx(share, abs=1e-12)
