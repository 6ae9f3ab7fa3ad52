"""Several agents on one survey: each its own stops, none lost, whoever dies."""

from __future__ import annotations

import random
from datetime import UTC, datetime, timedelta
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from subsoil.agent import Assignment, Done, Wait
from subsoil.errors import ReportError
from subsoil.land.field import Field
from subsoil.layers import Layers
from subsoil.penetrometer import SMALL_CONE
from subsoil.reports import Place, Reading, Refused, Sampled
from subsoil.survey import LocalDispatch, Memory, Settings, Survey, fold, opened, opening
from subsoil.survey.events import Assigned, Configured, Event, Planned, Released
from subsoil.survey.recompute import recomputed

FIELD = Field.from_metres([(0, 0), (60, 0), (60, 40), (0, 40)])
OPENED = opening(FIELD, Layers((0.0, 0.2, 0.4)), SMALL_CONE)
PATIENCE = timedelta(minutes=10)
START = datetime(2026, 5, 1, tzinfo=UTC)


def reading(at: Place) -> Reading:
    return Reading(depth_m=(0.2, 0.4), force_n=(100 + at[0], 200 + at[1]))


def sampled(agent: str, stop: Assignment, at: Place | None = None) -> Sampled:
    place = at or stop.at
    return Sampled(
        agent=agent, assignment=stop.id, at=place, metres=3.0, seconds=60.0, reading=reading(place)
    )


class Crew:
    """Agents at work on a survey, with a clock of their own, and what must hold of them."""

    def __init__(self, strategy: str, samples: int, names: str, **more: Any) -> None:
        self.clock = START
        self.memory = Memory()
        self.dispatch = LocalDispatch(
            opened(OPENED), self.memory, patience=PATIENCE, now=lambda: self.clock
        )
        wanted = Settings(start=(0.0, 0.0), strategy=strategy, samples=samples, seed=1, **more)
        self.dispatch.record(Configured(settings=wanted))
        for name in names:
            self.dispatch.join(name)

    @property
    def survey(self) -> Survey:
        return self.dispatch.survey

    def stop(self, name: str, ahead: int = 1) -> Assignment:
        answer = self.dispatch.assign(name, ahead)
        assert isinstance(answer, Assignment)
        return answer

    def check(self) -> None:
        """No stop is handed to two while a lease on it holds, and the fold is the state."""
        cells = [lease.cell for lease in self.survey.leases]
        assert len(set(cells)) == len(cells)
        assert not set(cells) & set(self.survey.plan.cells)
        again = fold([OPENED, *self.memory.events])
        assert (again.stops, again.agents, again.plan) == (
            self.survey.stops, self.survey.agents, self.survey.plan,
        )  # fmt: skip


def leases_of(events: list[Event]) -> list[tuple[str, int]]:
    return [(event.agent, event.cell) for event in events if isinstance(event, Assigned)]


def test_two_agents_that_ask_get_two_stops() -> None:
    crew = Crew("area-split", 8, "ab")
    one, other = crew.stop("a"), crew.stop("b")
    assert one.cell != other.cell
    assert crew.stop("a").id == one.id
    assert (one.number, other.number) == (0, 1)
    crew.check()


def test_an_agent_that_goes_out_of_reach_takes_stops_along() -> None:
    crew = Crew("area-split", 8, "ab")
    stop = crew.stop("a", ahead=4)
    taken = [stop.cell, *(each.cell for each in stop.ahead)]
    assert len(set(taken)) == 4
    assert crew.stop("b").cell not in taken
    for each in (stop, *stop.ahead):
        crew.dispatch.report(sampled("a", each))
    assert crew.survey.visited == tuple(taken)
    crew.check()


def test_strategies_see_the_stops_of_others_as_taken() -> None:
    crew = Crew("greedy", 9, "abc")
    first = crew.stop("a")
    crew.dispatch.report(sampled("a", first))
    cells = {crew.stop(name).cell for name in "abc"} | {first.cell}
    assert len(cells) == 4
    crew.check()


def test_who_finds_no_stop_left_waits_for_those_on_their_way() -> None:
    crew = Crew("area-split", 2, "abc")
    one, other = crew.stop("a"), crew.stop("b")
    answer = crew.dispatch.assign("c")
    assert isinstance(answer, Wait)
    assert "on their way" in answer.reason
    crew.dispatch.report(Refused(agent="a", assignment=one.id, at=one.at, reason="a stone"))
    third = crew.stop("c")
    assert third.cell not in (one.cell, other.cell)
    crew.dispatch.report(sampled("b", other))
    crew.dispatch.report(sampled("c", third))
    assert crew.dispatch.assign("a") == Done("2 samples taken")


def test_a_stop_of_which_nothing_is_heard_is_handed_out_again() -> None:
    crew = Crew("area-split", 3, "ab")
    stop = crew.stop("a")
    crew.clock += PATIENCE / 2
    assert crew.stop("b").cell != stop.cell
    other = crew.stop("b")
    crew.dispatch.report(sampled("b", other))
    crew.clock += PATIENCE
    assert crew.stop("b").cell == stop.cell
    released = [event for event in crew.memory.events if isinstance(event, Released)]
    assert [(event.assignment, event.cause) for event in released] == [(stop.id, "lapsed")]
    crew.check()


def test_a_stop_whose_lease_ran_out_twice_counts_as_refused() -> None:
    crew = Crew("area-split", 3, "ab")
    cell = crew.stop("a").cell
    for name in "ba":
        crew.clock += 2 * PATIENCE
        answer = crew.dispatch.assign(name)
        assert isinstance(answer, Assignment)
    assert cell in crew.survey.refused
    (refusal,) = [stop.refusal for stop in crew.survey.stops if stop.refusal]
    assert (refusal.cause, refusal.reason) == ("lapsed", "its lease ran out twice")
    crew.check()


def test_an_agent_that_leaves_leaves_its_stops_behind() -> None:
    crew = Crew("area-split", 4, "ab")
    stop = crew.stop("a", ahead=2)
    crew.dispatch.leave("a", "lunch")
    assert crew.survey.plan.cells[:2] == (stop.cell, stop.ahead[0].cell)
    assert crew.stop("b").cell == stop.cell
    crew.dispatch.join("a")
    assert crew.stop("a").cell == stop.ahead[0].cell
    crew.check()


def work(crew: Crew, names: str, chance: random.Random) -> None:
    """Agents ask, report, refuse, report late or twice, die, leave and come back, at random."""
    holding: dict[str, Assignment] = {}
    late: list[tuple[str, Assignment]] = []
    alive = dict.fromkeys(names, True)
    counters = (0, 0, 0)
    for _ in range(1000):
        if crew.survey.finished:
            return
        crew.clock += timedelta(minutes=chance.uniform(0, 3))
        name, luck = chance.choice(names), chance.random()
        if luck < 0.08:
            alive[name] = not alive[name]
            if alive[name]:
                crew.dispatch.join(name)
            elif name in holding:
                late.append((name, holding.pop(name)))
        elif alive[name] and name not in holding:
            answer = crew.dispatch.assign(name, chance.choice([1, 1, 2]))
            if isinstance(answer, Assignment):
                holding[name] = answer
        elif alive[name]:
            stop = holding.pop(name)
            if luck < 0.2:
                crew.dispatch.report(
                    Refused(agent=name, assignment=stop.id, at=stop.at, reason="a stone")
                )
            else:
                report = sampled(name, stop)
                for _ in range(chance.choice([1, 1, 2])):
                    crew.dispatch.report(report)
        if late and luck > 0.9:
            crew.dispatch.report(sampled(*late.pop()))
        crew.check()
        survey = crew.survey
        now = (survey.step, survey.changes, survey.assigned)
        assert all(b >= a for a, b in zip(counters, now, strict=True))
        counters = now
    raise AssertionError("the survey never ends")


@settings(deadline=None, max_examples=12)
@given(
    seed=st.integers(0, 10**6),
    agents=st.integers(2, 4),
    strategy=st.sampled_from(["area-split", "greedy", "adaptive-greedy", "joint-adaptive"]),
)
def test_whoever_dies_no_stop_is_handed_to_two_and_none_is_lost(
    seed: int, agents: int, strategy: str
) -> None:
    crew, names = Crew(strategy, 7, "abcd"[:agents]), "abcd"[:agents]
    work(crew, names, random.Random(seed))
    survey = crew.survey
    assert survey.finished == "7 samples taken"
    handed_out = {cell for _, cell in leases_of(crew.memory.events)}
    settled = {*survey.visited, *survey.refused, *survey.plan.cells}
    assert handed_out <= settled | {lease.cell for lease in survey.leases} | changed(crew)
    assert recomputed(enumerate([OPENED, *crew.memory.events], 1)).findings == ()


def changed(crew: Crew) -> set[int]:
    """Cells that a strategy took out of its plan again after they had been given back."""
    planned = [e.cells for e in crew.memory.events if isinstance(e, Planned) and not e.kept]
    return {cell for cells in planned for cell in cells}


@pytest.mark.parametrize("ahead", [0, -1])
def test_less_than_one_stop_is_not_handed_out(ahead: int) -> None:
    crew = Crew("area-split", 3, "a")
    with pytest.raises(ReportError, match=f"{ahead} stops cannot be handed out"):
        crew.dispatch.assign("a", ahead)
    assert crew.survey.leases == ()


def test_a_stop_whose_assignment_is_recorded_twice_is_handed_out_once() -> None:
    crew = Crew("area-split", 8, "a")
    crew.stop("a")
    (event,) = (each for each in crew.memory.events if isinstance(each, Assigned))
    crew.dispatch.record(event)
    assert [lease.id for lease in crew.survey.leases] == [event.id]
    crew.dispatch.release("a", event.id, "a puddle")
    crew.dispatch.record(event)
    assert crew.survey.leases == ()
    crew.check()


def test_no_stop_is_handed_out_before_anyone_decided_how_to_survey() -> None:
    dispatch = LocalDispatch(opened(OPENED), Memory())
    dispatch.join("a")
    with pytest.raises(ReportError, match="nobody decided how to survey"):
        dispatch.assign("a")
    assert dispatch.survey.leases == ()
