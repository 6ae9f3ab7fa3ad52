"""A survey stops at the first limit it comes to, and says which."""

from __future__ import annotations

from math import inf, nan

import pytest
from hypothesis import given
from hypothesis import strategies as st

from subsoil.errors import ParameterError
from subsoil.stopping import Limits, Spent

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
