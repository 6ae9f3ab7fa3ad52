"""Leases run by the host's clock from the last word heard; no clock of an agent moves anything."""

from __future__ import annotations

from collections.abc import Callable
from datetime import UTC, datetime, timedelta, timezone
from typing import Any

import pytest

from subsoil.agent import Assignment, Wait
from subsoil.errors import CorruptJournalError, ReportError
from subsoil.land.field import Field
from subsoil.layers import Layers
from subsoil.penetrometer import SMALL_CONE
from subsoil.reports import Place, Reading, Refused, Sampled
from subsoil.simulation import Machine
from subsoil.stopping import Rates
from subsoil.survey import LocalDispatch, Memory, Settings, Survey, apply, fold, opened, opening
from subsoil.survey.admission import CLOCK_OFF
from subsoil.survey.events import (
    Amended,
    Assigned,
    BatterySwapped,
    Configured,
    Finished,
    Planned,
    Released,
    Withdrawn,
)

FIELD = Field.from_metres([(0, 0), (60, 0), (60, 40), (0, 40)], name="plot")
OPENED = opening(FIELD, Layers((0.0, 0.2, 0.4)), SMALL_CONE)
PATIENCE = timedelta(minutes=10)
TICK = timedelta(microseconds=1)
START = datetime(2026, 5, 1, 12, tzinfo=UTC)


class Host:
    """A dispatch whose clock is turned by hand."""

    def __init__(
        self,
        names: str = "ab",
        *,
        survey: Survey | None = None,
        memory: Memory | None = None,
        patience: timedelta | None = PATIENCE,
        **settings: Any,
    ) -> None:
        self.clock, self.memory = START, memory or Memory()
        self.dispatch = LocalDispatch(
            survey or opened(OPENED), self.memory, patience=patience, now=lambda: self.clock
        )
        if survey is None:
            how = {"strategy": "area-split", "samples": 6, "seed": 1, **settings}
            self.dispatch.record(Configured(settings=Settings(start=(0.0, 0.0), **how)))
        for name in names:
            self.dispatch.join(name)

    @property
    def survey(self) -> Survey:
        return self.dispatch.survey

    def stop(self, name: str, ahead: int = 1) -> Assignment:
        answer = self.dispatch.assign(name, ahead)
        assert isinstance(answer, Assignment)
        return answer

    @property
    def released(self) -> list[Released]:
        return [event for event in self.memory.events if isinstance(event, Released)]


def reading(at: Place) -> Reading:
    return Reading(depth_m=(0.2, 0.4), force_n=(100 + at[0], 200 + at[1]))


def sampled(agent: str, stop: Assignment, **more: Any) -> Sampled:
    return Sampled(agent=agent, assignment=stop.id, at=stop.at, reading=reading(stop.at), **more)


def test_a_lease_holds_to_the_last_moment_of_the_hosts_patience_and_no_longer() -> None:
    host = Host()
    stop = host.stop("a")
    host.clock += PATIENCE
    assert host.stop("b").id != stop.id
    assert host.released == []
    host.clock += TICK
    host.dispatch.assign("b")
    (event,) = host.released
    assert (event.agent, event.assignment, event.cause) == ("a", stop.id, "lapsed")
    assert event.reason == "nothing was heard of it for 600 s"
    assert (event.time, event.clock) == (START + PATIENCE + TICK, "host")


def test_asking_again_is_no_news_of_a_stop_but_a_push_is() -> None:
    host = Host("a")
    survey = host.survey
    lease = Assigned(id="two pushes", agent="a", cell=30, pushes=2)
    host.dispatch.record(lease)
    stop = host.stop("a")
    assert (stop.id, stop.pushes) == ("two pushes", 2)
    host.clock += PATIENCE
    host.dispatch.report(sampled("a", stop))
    host.clock += PATIENCE
    assert host.stop("a").id == stop.id
    host.clock += TICK
    assert host.stop("a").id != stop.id
    assert [event.assignment for event in host.released] == [stop.id]
    # A stop with a reading is over: it is neither refused nor made again.
    assert host.survey.visited == (30,)
    assert host.survey.refused == survey.refused == ()


def test_a_clock_that_is_set_back_takes_no_stop_away() -> None:
    host = Host()
    stop = host.stop("a")
    host.clock -= timedelta(days=400)
    host.dispatch.assign("b")
    assert host.released == []
    host.clock = START + PATIENCE
    assert host.stop("a").id == stop.id


def test_without_patience_a_stop_is_its_agents_for_ever() -> None:
    host = Host(patience=None)
    stop = host.stop("a")
    host.clock += timedelta(days=3650)
    assert host.stop("b").cell != stop.cell
    assert host.released == []


def test_after_a_restart_of_the_host_a_lease_has_its_whole_time_again() -> None:
    host = Host()
    stop = host.stop("a")
    again = Host("", survey=fold([OPENED, *host.memory.events]), memory=host.memory)
    again.clock = START + timedelta(days=1)
    other = again.stop("b")
    assert other.cell != stop.cell
    again.clock += PATIENCE
    again.dispatch.assign("b")
    assert again.released == []
    again.clock += TICK
    again.dispatch.assign("b")
    assert [event.assignment for event in again.released] == [stop.id, other.id]


def test_each_of_several_stops_ahead_has_a_time_of_its_own() -> None:
    host = Host()
    stop = host.stop("a", ahead=3)
    host.clock += PATIENCE / 2
    host.dispatch.report(sampled("a", stop))
    later = host.stop("a", ahead=3)
    newest = later.ahead[-1]
    host.clock += PATIENCE / 2 + TICK
    host.dispatch.assign("b")
    gone = {event.assignment for event in host.released}
    assert gone == {each.id for each in stop.ahead}
    assert [lease.id for lease in host.survey.agent("a").leases] == [newest.id]


@pytest.mark.parametrize(
    ("off", "flagged"),
    [
        (timedelta(hours=1), False),
        (timedelta(hours=1) + TICK, True),
        (-timedelta(days=3650), False),
        (-timedelta(days=3650) - TICK, True),
        (timedelta(0), False),
    ],
)
def test_a_time_is_odd_beyond_an_hour_ahead_and_ten_years_back(
    off: timedelta, flagged: bool
) -> None:
    host = Host()
    stop = host.stop("a")
    host.dispatch.report(sampled("a", stop, time=START + off, clock="gnss"))
    (kept,) = host.survey.readings
    assert (CLOCK_OFF in kept.reading.flags) == flagged
    assert (kept.time, kept.clock) == (START + off, "gnss")


def test_a_report_without_a_time_has_the_hosts_and_one_with_a_time_keeps_it_and_its_zone() -> None:
    host = Host()
    host.dispatch.report(sampled("a", host.stop("a")))
    local = START.astimezone(timezone(timedelta(hours=2)))
    host.clock += timedelta(minutes=1)
    host.dispatch.report(sampled("b", host.stop("b"), time=local, clock="agent"))
    first, second = host.survey.readings
    assert (first.time, first.clock) == (START, "host")
    assert (second.time, second.clock) == (START, "agent")
    assert second.time is not None
    assert second.time.utcoffset() == timedelta(hours=2)


def test_events_stand_in_the_order_they_came_whatever_their_clocks_say() -> None:
    host, reports = Host(), []
    for k, off in enumerate((0, -900, 1800, -5)):
        stop = host.stop("a")
        report = sampled("a", stop, id=f"{k}", time=START + timedelta(seconds=off), clock="agent")
        reports.append(report.id)
        host.dispatch.report(report)
    assert [each.id for each in host.survey.readings] == reports


def test_an_event_is_stamped_once() -> None:
    event = Finished(reason="enough")
    first = event.stamped(START)
    assert (first.time, first.clock) == (START, "host")
    assert first.stamped(START + TICK, "gnss") is first
    assert event.time is None


def test_side_by_side_agents_take_the_time_of_the_slowest_and_the_money_of_all() -> None:
    host = Host("abc", rates=Rates(hour=60.0, km=1000.0, sample=5.0, call_out=7.0))
    for name, metres, seconds in (("a", 10.0, 60.0), ("b", 20.0, 600.0), ("a", 5.0, 120.0)):
        host.dispatch.report(sampled(name, host.stop(name), metres=metres, seconds=seconds))
    stop = host.stop("c")
    host.dispatch.report(
        Refused(
            agent="c", assignment=stop.id, at=stop.at, reason="a stone", metres=4.0, seconds=30.0
        )
    )
    spent = host.survey.spent
    assert (spent.samples, spent.metres) == (3, 39.0)
    assert spent.minutes == 10.0
    assert spent.money == pytest.approx(7.0 + 60.0 * 13.5 / 60 + 1000.0 * 0.039 + 5.0 * 3)
    # The next stop is money for its own minutes only, beside those of all agents so far.
    after = host.survey.spent_after_next
    more = after.minutes - spent.minutes
    metres = after.metres - spent.metres
    assert more == pytest.approx((metres / 1.0 + 50.0) / 60.0)
    assert after.money - spent.money == pytest.approx(more + metres + 5.0)


def test_a_fresh_battery_is_its_agents_alone_and_counts_from_then() -> None:
    host = Host()
    for name in "ab":
        host.dispatch.report(sampled(name, host.stop(name), seconds=400.0))
    host.dispatch.record(BatterySwapped(agent="a"))
    host.dispatch.report(sampled("a", host.stop("a"), seconds=100.0))
    full = Machine(SMALL_CONE).battery_s
    left = {each.name: full - (each.seconds - each.charged_at) for each in host.survey.agents}
    assert left == {"a": full - 100.0, "b": full - 400.0}


def test_who_waits_is_told_for_how_long_and_why() -> None:
    host = Host(samples=1)
    host.stop("a")
    answer = host.dispatch.assign("b")
    assert answer == Wait("other agents are on their way to the last stops of the plan", 1.0)


# What cannot be asked, said whole

Ask = Callable[[LocalDispatch], object]


@pytest.mark.parametrize(
    ("ask", "said"),
    [
        (
            lambda d: d.assign("nobody"),
            "plot: agent 'nobody' is not at work on the survey (remedy: join first; there are a)",
        ),
        (
            lambda d: d.release("a", "none", "why not"),
            "plot: 'a' does not hold the assignment 'none' (remedy: only the agent that holds a "
            "stop gives it back or leaves it out)",
        ),
        (
            lambda d: d.withdraw("none", "a stone"),
            "plot: there is no reading 'none' that counts (remedy: give the id of a row of the "
            "layer samples)",
        ),
        (lambda d: d.join("a", "person"), "plot: 'a' is another kind of agent"),
        (
            lambda d: d.join("x", "simulator"),
            "plot: simulated and real agents do not work on one survey (remedy: start a survey of "
            "its own for the simulation)",
        ),
    ],
)
def test_what_cannot_be_done_is_said_with_its_remedy_and_changes_nothing(
    ask: Ask, said: str
) -> None:
    host = Host("a")
    before = host.survey
    with pytest.raises(ReportError) as caught:
        ask(host.dispatch)
    assert str(caught.value) == said
    assert host.survey is before


def test_with_nobody_at_work_that_is_said_and_with_no_decision_that() -> None:
    dispatch = LocalDispatch(opened(OPENED), Memory())
    with pytest.raises(ReportError, match="join first; there are no agents"):
        dispatch.assign("a")
    dispatch.join("a")
    with pytest.raises(ReportError) as caught:
        dispatch.assign("a")
    assert str(caught.value) == (
        "plot: nobody decided how to survey: with which strategy, and how far "
        "(remedy: record a Configured first, as subsoil run does)"
    )


@pytest.mark.parametrize(
    ("event", "said"),
    [
        (
            Withdrawn(report="none", reason="a stone"),
            "plot: there is no reading 'none' to correct (remedy: go back to a copy of the file)",
        ),
        (
            Amended(
                report="gone", reason="a typo",
                by=Sampled(agent="a", at=(1.0, 1.0), reading=reading((1.0, 1.0))),
            ),
            "plot: there is no reading 'gone' to correct (remedy: go back to a copy of the file)",
        ),
        (
            Assigned(agent="ghost", cell=3),
            "plot: agent 'ghost' never joined (remedy: go back to a copy of the file)",
        ),
        (
            Assigned(agent="a", cell=96),
            "plot: cell 96 is assigned, which does not exist "
            "(remedy: go back to a copy of the file)",
        ),
        (
            Planned(step=0, cells=(3, -1), reason="x", mean_kv=1.0),
            "plot: a plan names cell -1, which does not exist "
            "(remedy: go back to a copy of the file)",
        ),
        (OPENED.model_copy(update={"id": "again"}), "plot: the survey is set up twice"),
    ],
)  # fmt: skip
def test_an_event_that_cannot_follow_is_a_corrupt_file_and_says_what(event: Any, said: str) -> None:
    survey = Host("a").survey
    with pytest.raises(CorruptJournalError) as caught:
        apply(survey, event)
    assert str(caught.value) == said


@pytest.mark.parametrize(
    ("wkt", "said"),
    [
        ("POINT (1 2)", "an outline is a Point, not a polygon"),
        ("POLYGON ((0 0, 1", "an outline cannot be read: "),
    ],
)
def test_an_outline_in_a_file_that_is_none_is_said_to_be_so(wkt: str, said: str) -> None:
    with pytest.raises(CorruptJournalError, match=f"^{said}"):
        opened(OPENED.model_copy(update={"boundary_wkt": wkt}))
