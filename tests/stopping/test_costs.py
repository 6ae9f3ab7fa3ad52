"""What a survey costs adds up, and limits are judged by nothing but what was and will be spent."""

from __future__ import annotations

from collections.abc import Callable
from math import inf, nan

import pytest
from hypothesis import given
from hypothesis import strategies as st

from subsoil.errors import ParameterError
from subsoil.stopping import FEWEST, Limits, Pace, Rates, Spent

amounts = st.floats(0, 1e5)
numbers = st.integers(0, 500)


def test_a_way_takes_its_metres_and_a_stop_its_first_push_and_the_further_ones() -> None:
    pace = Pace(speed_mps=2.0, stop_s=30.0, push_s=10.0)
    assert pace.minutes(metres=600.0, stops=4, further=3) == (300 + 120 + 30) / 60
    assert pace.minutes(metres=0.0, stops=0) == 0.0


@given(amounts, amounts, numbers, numbers, numbers, numbers)
def test_two_parts_of_a_survey_take_as_long_as_the_whole(
    a: float, b: float, stops: int, more: int, pushes: int, others: int
) -> None:
    pace = Pace(1.3, 47.0, 21.0)
    whole = pace.minutes(a + b, stops + more, pushes + others)
    assert whole == pytest.approx(pace.minutes(a, stops, pushes) + pace.minutes(b, more, others))


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: Pace(speed_mps=0.0), "speed: must be greater than zero, not 0"),
        (lambda: Pace(speed_mps=nan), "speed: must be greater than zero, not nan"),
        (lambda: Pace(stop_s=-0.5), "stop: must be zero or more, not -0.5"),
        (lambda: Pace(push_s=-1.0), "push: must be zero or more, not -1"),
        (lambda: Pace(push_s=nan), "push: must be zero or more, not nan"),
        (
            lambda: Rates(currency="eur"),
            "currency: 'eur' is no currency (remedy: three letters, such as EUR)",
        ),
        (
            lambda: Limits(money=9.0),
            "money: nothing is charged, so it is never spent (remedy: give a rate)",
        ),
    ],
)
def test_what_cannot_be_paid_or_made_is_said_whole(make: Callable[[], object], said: str) -> None:
    with pytest.raises(ParameterError) as caught:
        make()
    assert str(caught.value) == said


def test_stops_that_take_no_time_are_allowed() -> None:
    assert Pace(stop_s=0.0, push_s=0.0).minutes(120.0, 9, 9) == 2.0


@given(numbers, amounts, amounts, st.tuples(*[st.floats(0, 1e3)] * 4))
def test_the_call_out_is_paid_once_however_a_survey_is_cut(
    samples: int, metres: float, minutes: float, prices: tuple[float, float, float, float]
) -> None:
    rates = Rates(*prices)
    first = rates.money(samples, metres, minutes)
    again = first + rates.more(samples, metres, minutes)
    assert again == pytest.approx(rates.money(2 * samples, 2 * metres, 2 * minutes))
    assert rates.money(0, 0.0, 0.0) == rates.call_out


@pytest.mark.parametrize("name", ["hour", "km", "sample", "call_out"])
def test_one_price_is_enough_to_charge(name: str) -> None:
    assert Rates().free
    charged = Rates(**{name: 0.01})  # type: ignore[arg-type]
    assert not charged.free
    assert charged.money(1, 1000.0, 60.0) == 0.01


few = st.integers(0, 4).map(float)
"""Small whole numbers, so that what is spent and its limit often are the same."""
limit = st.integers(1, 6).map(float) | st.just(inf)
spent = st.builds(
    Spent,
    samples=st.integers(10, 14),
    metres=few,
    minutes=few,
    mean_kv=few | st.just(nan),
    money=few,
)
limits = st.builds(
    Limits,
    samples=st.integers(11, 16),
    metres=limit,
    minutes=limit,
    mean_kv=few,
    money=limit,
    rates=st.just(Rates(hour=30.0, currency="CHF")),
)


@given(limits, spent)
def test_the_first_limit_that_is_met_is_the_one_named(limits: Limits, now: Spent) -> None:
    """In the order: samples, metres, minutes, money, and at last the variance."""
    met = {
        "samples taken": now.samples >= limits.samples,
        "metres driven": now.metres >= limits.metres,
        "minutes spent": now.minutes >= limits.minutes,
        "CHF spent": now.money >= limits.money,
        "mean kriging variance": now.samples >= FEWEST and now.mean_kv <= limits.mean_kv,
    }
    said = limits.reached(now)
    first = next((words for words, is_met in met.items() if is_met), "")
    assert bool(said) == bool(first)
    assert first in said


@given(limits, spent, spent)
def test_a_stop_is_begun_exactly_where_nothing_is_beyond_its_limit_after_it(
    limits: Limits, now: Spent, more: Spent
) -> None:
    after = Spent(
        now.samples + 1,
        now.metres + more.metres,
        now.minutes + more.minutes,
        now.mean_kv,
        now.money + more.money,
    )
    within = (
        after.metres <= limits.metres
        and after.minutes <= limits.minutes
        and after.money <= limits.money
    )
    said = limits.passed(now, after)
    assert (said == "") == within
    if said:
        assert "the next stop would take it beyond" in said
        assert "inf" not in said


def test_a_price_of_exactly_one_sample_is_money_enough() -> None:
    rates = Rates(sample=2.0, call_out=50.0)
    assert Limits(money=52.0, rates=rates).reached(Spent(0, 0.0, 0.0, nan, 50.0)) == ""
    with pytest.raises(ParameterError, match=r"51\.9 EUR do not pay for one sample, which is 52"):
        Limits(money=51.9, rates=rates)
