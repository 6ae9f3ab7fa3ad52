"""Goals are met at the number asked for, never by what is unknown, and say both numbers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import FrozenInstanceError
from math import nan

import pytest
from hypothesis import given
from hypothesis import strategies as st

from subsoil.errors import ParameterError
from subsoil.stopping import (
    FEWEST,
    DecidedShare,
    Goal,
    GoalProgress,
    LeastGain,
    SureRmse,
    TargetRmse,
    first_stop,
)

GOALS: tuple[Goal, ...] = (
    TargetRmse(40.0),
    SureRmse(40.0, 0.8),
    DecidedShare(2000.0, 0.9, 0.75),
    LeastGain(0.5),
)


@pytest.mark.parametrize(
    ("goal", "just", "not_yet"),
    [
        (GOALS[0], 40.0, 40.000001),
        (GOALS[1], 0.8, 0.799999),
        (GOALS[2], 0.9, 0.899999),
        (GOALS[3], 0.499999, 0.5),
    ],
)
def test_a_goal_is_met_at_its_number_and_a_gain_only_below_it(
    goal: Goal, just: float, not_yet: float
) -> None:
    assert goal.met(just)
    assert not goal.met(not_yet)


@pytest.mark.parametrize("goal", GOALS)
def test_what_is_unknown_meets_no_goal(goal: Goal) -> None:
    assert not goal.met(nan)


@pytest.mark.parametrize(
    ("goal", "measure", "words"),
    [
        (GOALS[0], 38.26, "predicted RMSE 38.3 kPa, 40 kPa asked for"),
        (GOALS[1], 0.834, "83 % sure of an RMSE at or below 40 kPa, 80 % asked for"),
        (
            GOALS[2],
            0.957,
            "96 % of the area decided at 2000 kPa with 75 % confidence, 90 % asked for",
        ),
        (
            GOALS[3],
            0.1234,
            "the next sample would lower the predicted RMSE by 0.12 kPa, "
            "less than 0.5 kPa is not worth it",
        ),
    ],
)
def test_a_goal_says_what_it_measured_beside_what_was_asked_for(
    goal: Goal, measure: float, words: str
) -> None:
    assert goal.words(measure) == words


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: TargetRmse(-1.0), "target RMSE: must be greater than zero, not -1"),
        (lambda: SureRmse(40.0, 0.0), "probability: must be between 0 and 1, not 0"),
        (lambda: DecidedShare(0.0), "threshold: must be greater than zero, not 0"),
        (lambda: DecidedShare(2000.0, share=0.0), "decided: must be between 0 and 1, not 0"),
        (
            lambda: DecidedShare(2000.0, confidence=1.0),
            "confidence: must be between 0 and 1, not 1",
        ),
        (
            lambda: DecidedShare(2000.0, confidence=0.4),
            "confidence: a coin decides with 0.4 (remedy: more than 0.5)",
        ),
        (lambda: LeastGain(nan), "least gain: must be greater than zero, not nan"),
    ],
)
def test_a_goal_that_cannot_be_says_which_number_and_what_it_may_be(
    make: Callable[[], Goal], said: str
) -> None:
    with pytest.raises(ParameterError) as caught:
        make()
    assert str(caught.value) == said


def test_the_whole_field_may_be_asked_for_and_goals_are_values() -> None:
    assert DecidedShare(2000.0, share=1.0).met(1.0)
    assert SureRmse(40.0, 0.8) == SureRmse(40.0, 0.8)
    with pytest.raises(FrozenInstanceError):
        GOALS[0].kpa = 1.0  # type: ignore[misc, union-attr]


rmse = st.sampled_from([30.0, 40.0, 50.0, nan])
sure = st.sampled_from([0.5, 0.8, 0.95, nan])


@given(st.lists(st.tuples(rmse, sure), max_size=12), st.integers(1, FEWEST + 2))
def test_each_goal_counts_its_own_good_updates_and_the_first_to_have_three_ends_the_survey(
    measures: list[tuple[float, float]], first: int
) -> None:
    goals = GOALS[:2]
    progress, runs = GoalProgress(), [0, 0]
    for samples, measured in enumerate(measures, start=first):
        progress = progress.updated(goals, samples, measured)
        for k, (goal, measure) in enumerate(zip(goals, measured, strict=True)):
            runs[k] = runs[k] + 1 if goal.met(measure) else 0
        assert progress.running == tuple(runs)
        ended = [k for k, run in enumerate(runs) if run >= 3 and samples >= FEWEST]
        words = [f"{goals[k].words(measured[k])}, 3 updates running" for k in ended]
        assert progress.reached(goals) == (words or [""])[0]


def test_measures_of_other_goals_than_those_asked_for_change_nothing() -> None:
    """A plan of before the goals were changed names as many measures as there were."""
    before = GoalProgress(12, (39.0,), (2,))
    assert before.updated(GOALS[:2], 13, (39.0,)) is before
    assert before.updated(GOALS[:1], 12, (39.0,)) is before


def test_without_goals_nothing_is_ever_enough() -> None:
    assert GoalProgress(40, (), ()).reached(()) == ""


def test_a_target_that_is_never_met_is_reached_after_the_last_update() -> None:
    assert first_stop([50.0] * 9, range(12, 21), 40.0) == 9
    assert first_stop([], [], 40.0) == 0
