"""An outlook counts ways, minutes and money by hand, and says only what follows from them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import accumulate, pairwise
from math import hypot, inf, isnan, nan

import pytest

from subsoil.mapping.uncertainty import MeanSquare, mean_square_error, predicted_rmse
from subsoil.stopping import DecidedShare, Pace, Rates, SureRmse, TargetRmse
from subsoil.survey import Survey, apply, opened
from subsoil.survey.events import Configured, Event
from subsoil.survey.outlook import (
    Outlook,
    Prospect,
    in_words,
    out_of_reach,
    outlook,
    too_sure,
)

Configure = Callable[..., Configured]
SurveyPlot = Callable[..., tuple[Survey, list[Event]]]

ERROR = MeanSquare(10_000.0, 60.0, 40.0)


def foreseen(ahead: int, planned: int) -> Outlook:
    """Each further stop takes two minutes and three euros, and tells a kPa."""
    entries = (Prospect(k, 2.0 * k, 3.0 * k, 100.0 - k) for k in range(1, ahead + 1))
    return Outlook(14, 100.0, ERROR, tuple(entries), planned)


@pytest.mark.parametrize(
    ("ahead", "planned", "said"),
    [
        (0, 0, []),
        (3, 0, [3]),
        (6, 0, [6]),
        (20, 0, [6, 20]),
        (20, 4, [4, 20]),
        (20, 20, [6, 20]),
        (40, 30, [6, 30]),
        (40, 12, [12, 20]),
        (5, 5, [5]),
    ],
)
def test_it_speaks_of_the_planned_stops_and_of_twenty_or_of_six(
    ahead: int, planned: int, said: list[int]
) -> None:
    assert [entry.more for entry in foreseen(ahead, planned).milestones] == said


@pytest.fixture(scope="module")
def half_way() -> dict[str, Survey]:
    """Surveys of the plot that a test made, by their settings."""
    return {}


@pytest.fixture
def under_way(
    half_way: dict[str, Survey], configured: Configure, survey_plot: SurveyPlot
) -> Callable[..., Survey]:
    """A survey of 24 samples cut off at its fifteenth, with settings changed."""

    def cut(**changes: object) -> Survey:
        if not half_way:
            _, events = survey_plot(configured("area-split", samples=24))
            begun = opened(events[0])  # type: ignore[arg-type]
            states = accumulate(events[1:], apply, initial=begun)
            half_way["plain"] = next(
                state for state in states if state.taken == 15 and state.planned_at == state.step
            )
        survey = half_way["plain"]
        return replace(survey, settings=survey.settings.model_copy(update=changes))

    return cut


def test_minutes_and_money_ahead_are_those_of_the_way_through_the_planned_stops(
    under_way: Callable[..., Survey],
) -> None:
    """Straight legs of a field without corners inside, from where the robot stands."""
    rates = Rates(hour=60.0, km=100.0, sample=3.0, call_out=1e6)
    survey = under_way(pace=Pace(0.5, 40.0), rates=rates)
    seen = outlook(survey)
    assert seen.planned == len(survey.plan.cells) == 9
    here, metres = survey.position, 0.0
    for entry, cell in zip(seen.ahead, survey.plan.cells, strict=False):
        there = survey.field.cells[cell]
        metres += hypot(there[0] - here[0], there[1] - here[1])
        here = (float(there[0]), float(there[1]))
        minutes = (metres / 0.5 + 40.0 * entry.more) / 60.0
        assert entry.minutes == pytest.approx(minutes)
        # What was paid for coming is not paid again.
        assert entry.money == pytest.approx(minutes + 0.1 * metres + 3.0 * entry.more)


def test_stops_beyond_the_plan_are_new_cells_and_each_takes_its_time(
    under_way: Callable[..., Survey],
) -> None:
    survey = under_way()
    seen = outlook(survey)
    assert len(seen.ahead) == 20
    ways = [60.0 * e.minutes - 50.0 * e.more for e in seen.ahead]
    # A way through more stops is no shorter where none of them is left out.
    for before, after in pairwise(ways[8:]):
        assert after >= before - 1e-6


def test_what_is_left_to_take_is_looked_at_up_to_forty(under_way: Callable[..., Survey]) -> None:
    assert len(outlook(under_way(samples=50)).ahead) == 35
    assert len(outlook(under_way(samples=90)).ahead) == 40


def test_a_sentence_gives_samples_time_error_and_what_more_costs(
    under_way: Callable[..., Survey],
) -> None:
    survey = under_way(rates=Rates(sample=3.0, currency="CHF"))
    words = in_words(survey, foreseen(20, 4))
    assert words == (
        f"15 samples in {survey.minutes:.0f} min: typical error 100 kPa "
        f"(80 % sure: below {ERROR.rmse(0.8):.0f}). 4 more (8 min, 12 CHF) would bring it to "
        "about 96 kPa, 20 more (40 min, 60 CHF) to about 80."
    )
    assert "CHF" not in in_words(under_way(), foreseen(20, 4))
    assert in_words(survey, foreseen(0, 0)).endswith(f"below {ERROR.rmse(0.8):.0f}).")


def test_one_sample_is_one_and_says_nothing_of_the_error(
    configured: Configure, survey_plot: SurveyPlot
) -> None:
    survey, _ = survey_plot(configured("area-split", samples=1))
    words = in_words(survey, outlook(survey))
    assert words.startswith("1 sample in ")
    assert outlook(survey).ahead == ()
    assert list(too_sure(survey)) == []


def ahead_of(survey: Survey, *rmses: float) -> Outlook:
    entries = tuple(Prospect(k, 2.0 * k, 3.0 * k, rmse) for k, rmse in enumerate(rmses, start=1))
    error = mean_square_error(survey.soil_map)
    return Outlook(survey.taken, predicted_rmse(survey.soil_map), error, entries, 0)


@pytest.mark.parametrize(
    ("changes", "best"),
    [
        ({"minutes": 5.0}, 60.0),
        ({"samples": 17}, 60.0),
        ({"money": 7.0, "rates": Rates(sample=1.0)}, 60.0),
        ({"minutes": 1.0}, nan),
    ],
)
def test_a_target_beyond_what_the_limits_allow_is_said_to_be_out_of_reach(
    under_way: Callable[..., Survey], changes: dict[str, object], best: float
) -> None:
    """Of four further stops the limits leave two, or none and the map stays as it is."""
    survey = under_way()
    spent = survey.spent
    if "minutes" in changes:
        changes = {"minutes": spent.minutes + float(str(changes["minutes"]))}
    if "money" in changes:
        money = survey.taken * 1.0 + float(str(changes["money"]))
        changes = {**changes, "money": money}
    survey = under_way(**changes, goals=(TargetRmse(20.0), DecidedShare(2000.0)))
    seen = ahead_of(survey, 70.0, 60.0, 10.0, 5.0)
    reached = seen.rmse if isnan(best) else best
    assert list(out_of_reach(survey, seen)) == [
        "the target RMSE of 20 kPa is out of reach: it takes a predicted RMSE of 20 kPa, and "
        f"within its limits the survey comes to about {reached:.0f}"
    ]


def test_a_sure_target_needs_a_smaller_expected_error_by_as_much_as_the_map_is_unsure(
    under_way: Callable[..., Survey],
) -> None:
    survey = under_way(samples=17, goals=(SureRmse(80.0, 0.9),))
    seen = ahead_of(survey, 70.0, 60.0, 10.0)
    needed = 80.0 * seen.rmse / seen.error.rmse(0.9)
    assert needed < 80.0
    within = ahead_of(survey, 70.0, needed - 0.01, 10.0)
    assert list(out_of_reach(survey, within)) == []
    beyond = ahead_of(survey, 70.0, needed + 0.01, 10.0)
    (line,) = out_of_reach(survey, beyond)
    assert f"a predicted RMSE of {needed:.0f} kPa" in line


def test_where_the_limits_are_beyond_what_is_foreseen_no_target_is_given_up(
    under_way: Callable[..., Survey],
) -> None:
    survey = under_way(samples=90, minutes=inf, goals=(TargetRmse(1.0),))
    seen = ahead_of(survey, 70.0, 60.0)
    assert list(out_of_reach(survey, seen)) == []
    assert list(out_of_reach(replace(survey, finished="enough"), seen)) == []
    assert list(out_of_reach(survey, foreseen(0, 0))) == []
    # With two samples left to take, two are all there is.
    survey = under_way(samples=17, goals=(TargetRmse(1.0),))
    assert len(list(out_of_reach(survey, seen))) == 1


def test_only_least_squares_are_too_sure_of_themselves(under_way: Callable[..., Survey]) -> None:
    for estimator, sure in (("paper-10", 1), ("spherical", 1), ("pmc", 0), ("reml", 0)):
        survey = under_way(estimator=estimator)
        assert len(list(too_sure(survey))) == sure, estimator
    assert list(too_sure(under_way(estimator="mine:own"))) == []
