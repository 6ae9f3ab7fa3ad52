"""What holds for every strategy, on every field, with every robot: the loop is the real one."""

from __future__ import annotations

import sys
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field
from functools import partial
from math import hypot
from typing import Literal

import numpy as np
import pytest
from numpy.typing import NDArray

from subsoil.agent import Arrival, Assignment, Push, Refusal, drive
from subsoil.errors import NotAllowedError, ParameterError
from subsoil.land.field import Field
from subsoil.layers import Layers
from subsoil.penetrometer import LARGE_CONE
from subsoil.registry import Allowed
from subsoil.reports import Reading
from subsoil.strategies import STRATEGIES, strategy_named
from subsoil.survey import LocalDispatch, Settings, Survey, opened, opening, view
from subsoil.survey.events import Configured, Event, Planned

OWN = "nearest_cell_strategy:nearest"
EVERY = [*STRATEGIES, OWN]
PLANNED_AHEAD = ["random", "w-shape", "area-split", "joint"]
SEARCHING = ["joint", "joint-adaptive"]
"""They may find the same optimum from any seed."""
BY_CHANCE = [name for name in STRATEGIES if name not in {"w-shape", *SEARCHING}]
FIELDS = ["test bed", "L", "keep-out", "tiny", "thin"]
LAYERS = Layers((0.0, 0.2, 0.4))
START = (0.0, 0.0)

Ground = Literal["soft", "hard"]


@pytest.fixture(scope="module", autouse=True)
def own_strategy(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """A user's strategy in a file of their own."""
    folder = tmp_path_factory.mktemp("own")
    (folder / "nearest_cell_strategy.py").write_text(
        """
import numpy as np
from subsoil.strategies import Plan, View

def nearest(view: View) -> Plan:
    free = np.flatnonzero(view.free)
    if not free.size:
        return Plan((), "no cell is left")
    away = ((view.field.cells[free] - np.array(view.position)) ** 2).sum(axis=1)
    return Plan((int(free[np.argmin(away)]),), "the nearest")
"""
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(folder)
        yield


def soil(east: float, north: float) -> NDArray[np.float64]:
    """kPa of two layers: waves of 40 to 90 m, and a ripple from cell to cell."""
    wave = np.sin(east / 14.0) * np.cos(north / 9.0) + 0.6 * np.sin((east + 2 * north) / 11.0)
    ripple = 0.3 * np.sin(1.7 * east + 0.9 * north)
    return np.array([900.0 + 150.0 * (wave + ripple), 1700.0 + 250.0 * (wave - ripple)])


@dataclass
class Reader:
    """Robot that reads the soil straight and refuses in stony cells."""

    field: Field
    position: tuple[float, float] = START
    stony: Collection[int] = ()
    ground: Ground = "soft"

    def go_to(self, stop: Assignment) -> Arrival:
        metres = hypot(stop.at[0] - self.position[0], stop.at[1] - self.position[1])
        self.position = stop.at
        return Arrival(stop.at, metres, metres)

    def probe(self) -> Push | Refusal:
        if self.field.nearest_cell(self.position) in self.stony:
            return Refusal("a stone", 50.0, 4)
        if self.ground == "hard":
            shallow = Reading(depth_m=(0.01, 0.02), force_n=(300.0, 600.0), ending="force")
            return Push(self.position, shallow, 50.0)
        depth, force = LAYERS.bottom_m, soil(*self.position) * LARGE_CONE.area_mm2 / 1000.0
        reading = Reading(depth_m=tuple(depth.tolist()), force_n=tuple(force.tolist()))
        return Push(self.position, reading, 50.0)

    def stop(self) -> None:
        pass


@dataclass
class Course:
    """Recorder that keeps each event with the state before it, three to a cell at most."""

    state: Survey
    steps: list[tuple[Survey, Event]] = field(default_factory=list)

    def append(self, event: Event, survey: Survey) -> None:
        assert len(self.steps) < 20 + 3 * len(survey.field.cells), (
            "the survey goes round in circles"
        )
        self.steps.append((self.state, event))
        self.state = survey

    @property
    def plans(self) -> list[tuple[Survey, Planned]]:
        return [(before, event) for before, event in self.steps if isinstance(event, Planned)]


def laid_down(before: Survey, event: Planned) -> tuple[int, ...]:
    """Cells of a plan: those of the last one where it was kept."""
    return before.plan.cells if event.kept else event.cells


def how(
    strategy: str, samples: int, seed: int = 1, settings: dict[str, float | str] | None = None
) -> Configured:
    decided = Settings(
        strategy=strategy, strategy_settings=settings or {}, estimator="paper-10", seed=seed,
        start=START, samples=samples,
    )  # fmt: skip
    return Configured(settings=decided)


def driven(
    land: Field,
    *configured: Configured,
    stony: Collection[int] = (),
    ground: Ground = "soft",
) -> Course:
    """A whole survey; with several configurations, one after the other."""
    state = opened(opening(land, LAYERS, LARGE_CONE))
    course = Course(state)
    dispatch = LocalDispatch(state, course, allowed=Allowed.by_name(OWN))
    dispatch.join("reader")
    for event in configured:
        dispatch.record(event)
        robot = Reader(land, dispatch.survey.position, stony, ground)
        drive("reader", robot, dispatch)
    return course


def check(course: Course, stony: Collection[int] = ()) -> None:
    """What must hold of every survey that was driven to its end."""
    end, cells = course.state, len(course.state.field.cells)
    for before, event in course.plans:
        planned = laid_down(before, event)
        assert len(set(planned)) == len(planned)
        assert not {*before.visited, *before.refused} & {*planned}
        assert all(0 <= cell < cells for cell in planned)
        assert end.field.contains(end.field.cells[list(planned)]).all()
        assert event.reason
    assert len({*end.visited, *end.refused}) == len(end.visited) + len(end.refused)
    assert not set(end.visited) & set(stony)
    assert set(end.refused) <= set(stony)
    samples = end.settings.samples
    if len(end.visited) == samples:
        assert end.finished == f"{samples} samples taken"
    else:
        assert len(end.visited) + len(end.refused) == cells
        assert end.finished


@pytest.mark.parametrize("name", EVERY)
@pytest.mark.parametrize("land", FIELDS)
@pytest.mark.parametrize("samples", [1, 2, 5, 14, 24])
def test_a_survey_ends_with_its_budget_or_with_every_cell_tried(
    fields: dict[str, Field], land: str, name: str, samples: int
) -> None:
    check(driven(fields[land], how(name, samples)))


@pytest.mark.parametrize("name", EVERY)
def test_every_budget_is_met_up_to_all_the_cells_and_beyond(
    fields: dict[str, Field], name: str
) -> None:
    for samples in range(1, 9):
        course = driven(fields["tiny"], how(name, samples))
        check(course)
        assert len(course.state.visited) == min(samples, 6)


@pytest.mark.parametrize("name", EVERY)
@pytest.mark.parametrize("land", ["L", "keep-out", "thin"])
def test_a_stony_corner_is_got_around(fields: dict[str, Field], land: str, name: str) -> None:
    corner = fields[land].cells.max(axis=0)
    away = np.hypot(*(fields[land].cells - corner).T)
    stony = set(np.argsort(away)[: len(away) // 4].tolist())
    course = driven(fields[land], how(name, 10), stony=stony)
    check(course, stony)
    assert len(course.state.visited) == 10


@pytest.mark.parametrize("name", EVERY)
@pytest.mark.parametrize("stones", [2, 5, 6])
def test_a_field_full_of_stones_is_given_up_when_every_cell_was_tried(
    fields: dict[str, Field], name: str, stones: int
) -> None:
    stony = set(range(6 - stones, 6))
    course = driven(fields["tiny"], how(name, 6), stony=stony)
    check(course, stony)
    assert len(course.state.visited) == 6 - stones
    assert set(course.state.refused) == stony


@pytest.mark.parametrize("name", EVERY)
def test_a_survey_goes_on_while_no_push_tells_anything(fields: dict[str, Field], name: str) -> None:
    course = driven(fields["L"], how(name, 6), ground="hard")
    check(course)
    assert np.isnan(course.state.soil_map.kv).all()


@pytest.mark.parametrize("name", EVERY)
@pytest.mark.parametrize("land", ["L", "tiny"])
def test_a_larger_budget_goes_on_from_what_was_done(
    fields: dict[str, Field], land: str, name: str
) -> None:
    first, second = how(name, 4, seed=1), how(name, 9, seed=2)
    course = driven(fields[land], first, second)
    check(course)
    assert len(course.state.visited) == min(9, len(fields[land].cells))
    assert course.state.visited[:4] == driven(fields[land], first).state.visited


@pytest.mark.parametrize("name", EVERY)
def test_a_strategy_is_changed_half_way(fields: dict[str, Field], name: str) -> None:
    for other in ("greedy", "area-split", "adaptive-greedy"):
        check(driven(fields["keep-out"], how(other, 3), how(name, 7)))


@pytest.mark.parametrize("name", EVERY)
def test_the_same_seed_gives_the_same_survey(fields: dict[str, Field], name: str) -> None:
    one, other = (driven(fields["L"], how(name, 9, seed=5)).plans for _ in range(2))
    assert [laid_down(*each) for each in one] == [laid_down(*each) for each in other]


@pytest.mark.parametrize("name", BY_CHANCE)
def test_another_seed_gives_another_survey(fields: dict[str, Field], name: str) -> None:
    visited = {driven(fields["L"], how(name, 6, seed)).state.visited for seed in range(3)}
    assert len(visited) == 3


def test_a_w_leaves_nothing_to_chance(fields: dict[str, Field]) -> None:
    visited = {driven(fields["L"], how("w-shape", 6, seed)).state.visited for seed in range(3)}
    assert len(visited) == 1


@pytest.mark.parametrize("name", EVERY)
def test_a_strategy_is_a_function_of_what_it_sees_and_leaves_that_alone(
    fields: dict[str, Field], name: str
) -> None:
    strategy = strategy_named(name, allowed=Allowed.by_name(name))
    stony = set(range(0, len(fields["keep-out"].cells), 3))
    for before, event in driven(fields["keep-out"], how(name, 8), stony=stony).plans:
        seen, kv = view(before), before.soil_map.kv.copy()
        plan = strategy(seen)
        assert plan.cells == strategy(view(before)).cells == laid_down(before, event)
        assert plan.reason == event.reason
        now = view(before)
        assert (seen.plan, seen.visited, seen.refused) == (now.plan, now.visited, now.refused)
        assert seen.soil_map is before.soil_map
        assert np.array_equal(before.soil_map.kv, kv, equal_nan=True)


@pytest.mark.parametrize("name", PLANNED_AHEAD)
@pytest.mark.parametrize("land", FIELDS)
def test_coverage_visits_what_it_planned_in_the_order_it_planned(
    fields: dict[str, Field], land: str, name: str
) -> None:
    course = driven(fields[land], how(name, 12))
    assert course.state.visited == course.plans[0][1].cells


@pytest.mark.parametrize("name", [*PLANNED_AHEAD, "adaptive-monte-carlo"])
def test_the_number_of_stops_stays_with_stones_or_without(
    fields: dict[str, Field], name: str
) -> None:
    stony = set(range(0, len(fields["L"].cells), 4))
    for before, event in driven(fields["L"], how(name, 10), stony=stony).plans:
        assert len(laid_down(before, event)) == 10 - len(before.visited)


def test_settings_reach_the_strategy(fields: dict[str, Field]) -> None:
    course = driven(fields["L"], how("adaptive-greedy", 9, settings={"first_change": 99}))
    assert course.state.visited == driven(fields["L"], how("area-split", 9)).state.visited
    wild: dict[str, float | str] = {"initial": "random", "first_change": 99}
    course = driven(fields["L"], how("adaptive-monte-carlo", 9, settings=wild))
    assert course.state.visited == driven(fields["L"], how("random", 9)).state.visited


def test_a_whole_number_survives_being_kept_as_a_float(fields: dict[str, Field]) -> None:
    settings = how("monte-carlo", 4, settings={"candidates": 7}).settings.strategy_settings
    check(driven(fields["L"], how("monte-carlo", 4, settings=settings)))
    strategy = strategy_named("monte-carlo", {"candidates": 7.0})
    assert isinstance(strategy, partial)
    assert strategy.keywords == {"candidates": 7}


@pytest.mark.parametrize(
    ("name", "settings", "message"),
    [
        ("grredy", {}, "there is no strategy 'grredy'"),
        ("no_such_module:plan", {}, "cannot import"),
        ("subsoil.strategies:plan_nothing", {}, "cannot import"),
        ("subsoil.strategies:STRATEGIES", {}, "is not callable"),
        ("greedy", {"sigma": 1.0}, "it has none"),
        ("monte-carlo", {"candidate": 9.0}, "it has candidates"),
        ("monte-carlo", {"candidates": 9.5}, "candidates cannot be 9.5"),
        ("monte-carlo", {"candidates": float("nan")}, "candidates cannot be nan"),
        ("w-shape", {"margin": "wide"}, "margin cannot be 'wide'"),
        ("adaptive-greedy", {"initial": 3.0}, "initial cannot be 3.0"),
    ],
)
def test_a_name_or_setting_that_does_not_exist_is_refused(
    name: str, settings: dict[str, float | str], message: str
) -> None:
    with pytest.raises(ParameterError, match=message):
        strategy_named(name, settings, Allowed.by_name(name))


def test_code_of_a_module_that_nobody_allowed_is_not_run() -> None:
    for name in ("os:system", OWN, "subsoil.strategies:greedy", "antigravity:fly"):
        with pytest.raises(NotAllowedError, match=f"give --allow {name.split(':')[0]}"):
            strategy_named(name)
    for name in (":x", "..x:y", "a b:c", "greedy:"):
        with pytest.raises(ParameterError, match="there is no strategy"):
            strategy_named(name)
    assert "antigravity" not in sys.modules
