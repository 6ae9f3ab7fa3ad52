"""A strategy may think for long: reports are taken meanwhile, and its plan made anew after them."""

from __future__ import annotations

import threading
from collections.abc import Callable

import pytest

from subsoil.agent import Assignment
from subsoil.errors import ReportError
from subsoil.land.field import Field
from subsoil.layers import Layers
from subsoil.penetrometer import SMALL_CONE
from subsoil.registry import Allowed
from subsoil.reports import Place, Reading, Sampled
from subsoil.strategies import Plan, View
from subsoil.survey import LocalDispatch, Memory, Settings, opened, opening
from subsoil.survey.events import Configured

FIELD = Field.from_metres([(0, 0), (60, 0), (60, 40), (0, 40)])
OPENED = opening(FIELD, Layers((0.0, 0.2, 0.4)), SMALL_CONE)


def reading(at: Place) -> Reading:
    return Reading(depth_m=(0.2, 0.4), force_n=(100 + at[0], 200 + at[1]))


class Slow:
    """A strategy that thinks until it is let go."""

    def __init__(self) -> None:
        self._began, self._may_end = threading.Semaphore(0), threading.Semaphore(0)
        self.calls = 0

    def begins(self) -> None:
        """Wait until it thinks."""
        assert self._began.acquire(timeout=10)

    def ends(self) -> None:
        """Let it come to an end."""
        self._may_end.release()

    def __call__(self, view: View) -> Plan:
        self.calls += 1
        self._began.release()
        assert self._may_end.acquire(timeout=10)
        free = [k for k in range(len(view.field.cells)) if view.free[k] or k in view.plan]
        return Plan(tuple(free[: view.remaining]), "slowly")


slow = Slow()


@pytest.fixture
def thinker(monkeypatch: pytest.MonkeyPatch) -> Slow:
    fresh = Slow()
    monkeypatch.setitem(globals(), "slow", fresh)
    return fresh


def begun() -> LocalDispatch:
    dispatch = LocalDispatch(opened(OPENED), Memory(), allowed=Allowed(frozenset([__name__])))
    wanted = Settings(start=(0.0, 0.0), strategy=f"{__name__}:slow", samples=40)
    dispatch.record(Configured(settings=wanted))
    for name in "ab":
        dispatch.join(name)
    return dispatch


def test_reports_are_acknowledged_while_a_strategy_thinks_and_its_plan_is_made_anew(
    thinker: Slow,
) -> None:
    dispatch = begun()
    answers: list[object] = []
    asking = threading.Thread(target=lambda: answers.append(dispatch.assign("a")))
    asking.start()
    thinker.begins()
    dispatch.report(beside(0))
    assert dispatch.survey.taken == 1
    assert answers == []
    thinker.ends()
    thinker.begins()
    thinker.ends()
    asking.join(10)
    (stop,) = answers
    assert isinstance(stop, Assignment)
    assert thinker.calls == 2
    assert stop.cell not in dispatch.survey.visited
    assert dispatch.survey.planned_at == dispatch.survey.step == 1


def test_a_decision_overtaken_twice_is_made_with_the_reports_waiting(thinker: Slow) -> None:
    dispatch = begun()
    answers: list[object] = []
    asking = threading.Thread(target=lambda: answers.append(dispatch.assign("a")))
    asking.start()
    for k in range(2):
        thinker.begins()
        dispatch.report(beside(k))
        thinker.ends()
    thinker.begins()
    late = threading.Thread(target=lambda: dispatch.report(beside(2)))
    late.start()
    late.join(0.3)
    assert late.is_alive()
    thinker.ends()
    asking.join(10)
    late.join(10)
    assert thinker.calls == 3
    assert dispatch.survey.taken == 3
    assert isinstance(answers[0], Assignment)


def test_an_agent_that_leaves_while_a_strategy_thinks_gets_no_stop(thinker: Slow) -> None:
    dispatch = begun()
    refused: list[ReportError] = []

    def ask() -> None:
        try:
            dispatch.assign("a")
        except ReportError as error:
            refused.append(error)

    asking = threading.Thread(target=ask)
    asking.start()
    meanwhile: list[Callable[[], None]] = [
        lambda: dispatch.report(beside(0)),
        lambda: dispatch.leave("a"),
    ]
    for happens in meanwhile:
        thinker.begins()
        happens()
        thinker.ends()
    thinker.ends()
    asking.join(10)
    assert "not at work" in str(refused[0])
    assert dispatch.survey.leases == ()


def beside(k: int) -> Sampled:
    at: Place = (2.5 + 5 * k, 2.5)
    return Sampled(agent="b", at=at, reading=reading(at))
