"""Goals and limits end surveys, when they should and not before, and survive being cut short."""

from __future__ import annotations

from collections.abc import Callable
from math import inf, isnan

import numpy as np
import pytest

from subsoil.errors import ParameterError
from subsoil.mapping.uncertainty import predicted_rmse
from subsoil.simulation import Truth
from subsoil.stopping import (
    DecidedShare,
    Goal,
    LeastGain,
    Rates,
    SureRmse,
    TargetRmse,
    first_stop,
    forecast,
)
from subsoil.survey import LocalDispatch, Memory, Settings, Survey, apply, decision, fold
from subsoil.survey.events import Configured, Event, Planned, from_json, same, to_json
from subsoil.survey.outlook import in_words, out_of_reach, outlook

Configure = Callable[..., Configured]
SurveyPlot = Callable[..., tuple[Survey, list[Event]]]
Work = Callable[[LocalDispatch, Truth], str]
Run = Callable[..., tuple[Survey, list[Event]]]

CAP = 40


@pytest.fixture
def run(configured: Configure, survey_plot: SurveyPlot) -> Run:
    """Survey the plot with some settings changed."""

    def survey(
        start: Survey | None = None, strategy: str = "area-split", **changes: object
    ) -> tuple[Survey, list[Event]]:
        return survey_plot(configured(strategy, **{"samples": CAP, **changes}), start)

    return survey


def plans(events: list[Event]) -> list[Planned]:
    return [event for event in events if isinstance(event, Planned)]


def after_samples(events: list[Event]) -> list[tuple[int, Planned]]:
    """Plans with the samples they were made after."""
    samples, result = 0, []
    for event in events:
        samples += event.kind == "sampled"
        if isinstance(event, Planned):
            result.append((samples, event))
    return result


def reachable(run: Run) -> float:
    """Predicted RMSE in kPa that the plot has after some twenty samples."""
    survey, _ = run(samples=20)
    return predicted_rmse(survey.soil_map)


def test_a_target_ends_a_survey_where_its_predicted_errors_say(run: Run) -> None:
    target = reachable(run)
    survey, events = run(goals=(TargetRmse(target),))
    made = after_samples(events)
    predicted = [np.sqrt(plan.mean_kv) for _, plan in made]
    stop = first_stop(predicted, [samples for samples, _ in made], target)
    assert stop == len(made) - 1
    assert len(survey.visited) == made[stop][0] < CAP
    assert survey.finished == (
        f"predicted RMSE {predicted[stop]:.1f} kPa, {target:g} kPa asked for, 3 updates running"
    )


def test_asking_for_more_certainty_takes_more_samples(run: Run) -> None:
    target = reachable(run)
    taken = [
        len(run(goals=(SureRmse(target, probability),))[0].visited)
        for probability in (0.2, 0.8, 0.99)
    ]
    assert taken == sorted(taken)
    assert taken[0] < taken[-1]


@pytest.mark.parametrize(
    ("goal", "words"),
    [
        (SureRmse(1e4, 0.8), "100 % sure of an RMSE at or below 10000 kPa, 80 % asked for"),
        (
            DecidedShare(1e5, 0.9, 0.8),
            "100 % of the area decided at 100000 kPa with 80 % confidence, 90 % asked for",
        ),
        (LeastGain(1e4), "kPa, less than 10000 kPa is not worth it"),
        (TargetRmse(1e4), "kPa, 10000 kPa asked for"),
    ],
)
def test_what_is_met_from_the_start_ends_a_survey_at_the_twelfth_sample(
    run: Run, goal: Goal, words: str
) -> None:
    survey, _ = run(goals=(goal,))
    assert len(survey.visited) == 12
    assert words in survey.finished
    assert survey.finished.endswith(", 3 updates running")


def test_a_goal_never_met_leaves_the_survey_to_its_cap(run: Run) -> None:
    survey, _ = run(samples=14, goals=(TargetRmse(1e-3), LeastGain(1e-6)))
    assert survey.finished == "14 samples taken"


def test_before_a_second_sample_goals_measure_nothing(run: Run) -> None:
    _, events = run(samples=4, goals=(TargetRmse(50.0), DecidedShare(2000.0)))
    for samples, plan in after_samples(events):
        assert all(map(isnan, plan.measures)) == (samples < 2)
        assert len(plan.measures) == 2


def test_a_survey_with_goals_cut_off_anywhere_goes_on_to_the_same_end(
    run: Run, plot_truth: Truth, work: Work
) -> None:
    goals = (TargetRmse(reachable(run)), LeastGain(0.01))
    whole, events = run(goals=goals)
    for cut in range(2, len(events), 7):
        dispatch = LocalDispatch(fold(events[:cut]), Memory())
        work(dispatch, plot_truth)
        assert dispatch.survey.visited == whole.visited
        assert dispatch.survey.finished == whole.finished
        assert dispatch.survey.goal_progress == whole.goal_progress


def test_every_plan_and_ending_follows_from_the_events_before_it(run: Run) -> None:
    _, events = run(goals=(SureRmse(reachable(run), 0.5), LeastGain(0.01)), minutes=30.0)
    survey = fold(events[:2])
    for event in events[2:]:
        if event.kind in {"planned", "fitted", "finished"}:
            expected = decision(survey)
            assert expected is not None
            assert same(event, expected, tolerance=0.0)
        survey = apply(survey, event)


def test_settings_with_goals_survive_json(configured: Configure) -> None:
    goals = (TargetRmse(40.0), SureRmse(40.0, 0.8), DecidedShare(2000.0), LeastGain(0.1))
    settings = configured(goals=goals, money=90.0, rates=Rates(hour=50.0, currency="USD"))
    again = from_json(to_json(settings))
    assert again == settings
    assert isinstance(again, Configured)
    assert again.settings.goals == goals
    assert again.settings.limits.rates.currency == "USD"


def test_settings_of_before_there_were_goals_have_none(configured: Configure) -> None:
    fields = configured().settings.model_dump(mode="json")
    for new in ("goals", "money", "rates", "pace"):
        fields.pop(new)
    old = Settings.model_validate(fields)
    assert old.goals == ()
    assert old.money == inf


def test_impossible_goals_in_a_journal_are_an_error(configured: Configure) -> None:
    line = to_json(configured(goals=(TargetRmse(40.0),)))
    with pytest.raises(ParameterError, match="target RMSE"):
        from_json(line.replace('"kpa":40.0', '"kpa":-40.0'))


@pytest.mark.parametrize("minutes", [4.0, 9.0, 15.0])
def test_the_minutes_are_used_and_only_retries_pass_them(run: Run, minutes: float) -> None:
    survey, events = run(minutes=minutes)
    last = next(event for event in reversed(events) if event.kind in {"sampled", "refused"})
    retries = (last.tries - 1) * 28.0 / 60.0
    assert survey.minutes <= minutes + retries + 1e-9
    assert survey.spent_after_next.minutes > minutes or survey.minutes >= minutes
    assert "minutes spent" in survey.finished


def test_money_ends_a_survey_before_it_is_overdrawn(run: Run) -> None:
    rates = Rates(hour=60.0, sample=3.0, call_out=50.0)
    survey, _ = run(money=90.0, rates=rates)
    spent = rates.money(len(survey.visited), survey.metres, survey.minutes)
    assert survey.spent.money == pytest.approx(spent)
    assert spent <= 90.0 < survey.spent_after_next.money
    assert "EUR spent, the next stop would take it beyond 90" in survey.finished


def test_new_settings_count_their_updates_anew(run: Run) -> None:
    survey, _ = run(samples=14)
    again, _ = run(survey, goals=(TargetRmse(1e4),))
    assert len(again.visited) == 16
    assert again.finished.endswith("3 updates running")


def test_the_outlook_is_the_forecast_of_the_planned_stops_and_more(run: Run) -> None:
    _, events = run(samples=24)
    cut = next(k for k in range(len(events)) if fold(events[: k + 1]).step == 18)
    survey = fold(events[: cut + 3])
    seen = outlook(survey)
    assert 0 < seen.planned == len(survey.plan.cells) < len(seen.ahead)
    first = [entry.rmse for entry in seen.ahead[: seen.planned]]
    assert first == pytest.approx(forecast(survey.soil_map, survey.plan.cells).tolist())
    rmse, minutes = ([getattr(e, name) for e in seen.ahead] for name in ("rmse", "minutes"))
    assert (np.diff([seen.rmse, *rmse]) <= 0).all()
    assert [entry.more for entry in seen.ahead] == list(range(1, len(seen.ahead) + 1))
    assert minutes[seen.planned - 1] >= seen.planned * 50 / 60
    words = in_words(survey, seen)
    near, far = seen.milestones
    assert near.more == seen.planned
    assert words.startswith(f"{len(survey.visited)} samples in {survey.minutes:.0f} min: typical")
    assert f"{near.more} more ({near.minutes:.0f} min) would bring it to about" in words
    assert words.endswith(f"{far.more} more ({far.minutes:.0f} min) to about {far.rmse:.0f}.")


def test_an_outlook_on_too_few_samples_says_so(run: Run) -> None:
    survey, _ = run(samples=1)
    assert in_words(survey, outlook(survey)).endswith("too few to say how good the map is.")
    survey, _ = run(samples=5)
    assert "fewer than 12 samples say little" in in_words(survey, outlook(survey))


def test_a_target_out_of_reach_is_said_while_the_survey_goes_on(run: Run) -> None:
    _, events = run(samples=20, goals=(TargetRmse(1.0), SureRmse(1e4, 0.9)))
    survey = fold(events[:30])
    assert not survey.finished
    (said,) = out_of_reach(survey, outlook(survey))
    assert said.startswith("the target RMSE of 1 kPa is out of reach")
    done = fold(events)
    assert not list(out_of_reach(done, outlook(done)))
