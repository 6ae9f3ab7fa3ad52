"""What a strategy sees, what plans it may give, and how far cells are from the stops of each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.distance import cdist
from scipy.stats import chi2

from subsoil.arrays import Bools, Floats
from subsoil.errors import ParameterError, ReadingsError
from subsoil.land.field import Field
from subsoil.layers import Layers, Sample
from subsoil.mapping.soilmap import SoilMap
from subsoil.strategies import Plan, View, plan, planned, strategy_named
from subsoil.strategies.coverage import carry_on, nearest_free
from subsoil.strategies.next_best_view import draw
from subsoil.variogram import Spherical
from subsoil.ways.open_land import OpenLand

Look = Callable[..., View]

PLOT = Field.from_metres([(0, 0), (60, 0), (60, 40), (0, 40)])
N = len(PLOT.cells)
some = st.lists(st.integers(0, N - 1), max_size=5)


def view_of(**changes: object) -> View:
    seen = View(
        PLOT, OpenLand(PLOT), SoilMap(PLOT, Layers((0.0, 0.4))), (2.5, 2.5), (), (), (), 10, True,
        np.random.default_rng(1),
    )  # fmt: skip
    return replace(seen, **changes)  # type: ignore[arg-type]


# --- views ----------------------------------------------------------------------------------------


@given(some, some, some, some, st.integers(0, 120), st.integers(0, 12))
def test_free_cells_are_nobodys_and_what_remains_is_no_more_than_there_are(
    plan_: list[int], visited: list[int], refused: list[int], leased: list[int], budget: int,
    taken: int,
) -> None:  # fmt: skip
    seen = view_of(
        plan=tuple(dict.fromkeys(plan_)), visited=tuple(visited), refused=tuple(refused),
        leased=tuple(leased), budget=budget, taken=taken,
    )  # fmt: skip
    gone = {*plan_, *visited, *refused, *leased}
    assert np.flatnonzero(seen.free).tolist() == [k for k in range(N) if k not in gone]
    wanted = budget - max(taken, len(visited)) - len(leased)
    assert seen.remaining == min(max(wanted, 0), N - len(gone) + len(seen.plan))


def test_readings_are_those_of_all_pushes_and_a_map_informs_from_the_first_sample_on() -> None:
    seen = view_of(visited=(3, 8), repeats=(3, 3))
    assert sorted(seen.readings) == [3, 3, 3, 8]
    assert not seen.informed
    sample = Sample((2.5, 2.5), np.array([900.0]), np.zeros(1, dtype=np.int8))
    informed = SoilMap(PLOT, Layers((0.0, 0.4)), (Spherical(1.0, 9.0, 9.0),), (sample,))
    assert replace(seen, soil_map=informed).informed


def test_a_cell_that_no_way_leads_to_is_not_free() -> None:
    class Island(OpenLand):
        """Land whose last cell cannot be got to."""

        def between(self, a: object, b: object) -> Floats:
            metres = super().between(a, b)  # type: ignore[arg-type]
            metres[:, -1] = np.inf
            return metres

    free = view_of(access=Island(PLOT)).free
    assert np.flatnonzero(~free).tolist() == [N - 1]


# --- plans ----------------------------------------------------------------------------------------


def refusal(answer: object, **changes: object) -> ParameterError:
    with pytest.raises(ParameterError) as raised:
        planned(lambda _: answer, view_of(**changes), "strategy mine")  # type: ignore[arg-type]
    assert raised.value.where == "strategy mine"
    assert "\n" not in str(raised.value)
    return raised.value


@pytest.mark.parametrize(
    ("answer", "what", "remedy"),
    [
        ((1, 2), "it answered (1, 2), which is no plan", "return a Plan"),
        ("y" * 300, f"it answered '{'y' * 39}..., which is no plan", "return a Plan"),
        (Plan((1, 2), "", (1,)), "it plans (1,) pushes at 2 stops", "one or more at each"),
        (Plan((1, 2), "", (1, 0)), "it plans (1, 0) pushes at 2 stops", "or none for one each"),
        (Plan((), "", (1,)), "it plans (1,) pushes at 0 stops", "one or more at each"),
        (Plan((True,), ""), "it plans True, which is no number of a cell", "whole numbers"),
        (Plan((np.int64(3),), ""), "which is no number of a cell", "tuple(cells.tolist())"),  # type: ignore[arg-type]
        (Plan((-1,), ""), "it plans cell -1, which is not in the field", "0 to 95"),
        (Plan((N,), ""), "it plans cell 96, which is not in the field", "0 to 95"),
        (Plan((4, 7, 4), ""), "it plans cell 4, which is visited, refused, assigned", "each once"),
        (Plan((10,), ""), "it plans cell 10, which is visited", "each once"),
        (Plan((11,), ""), "it plans cell 11, which is visited", "each once"),
        (Plan((12,), ""), "it plans cell 12, which is visited", "each once"),
    ],
)
def test_a_plan_that_cannot_be_made_is_refused_with_what_could(
    answer: object, what: str, remedy: str
) -> None:
    error = refusal(answer, visited=(10,), refused=(11,), leased=(12,))
    assert what in error.what
    assert remedy in error.remedy


def test_a_stop_where_one_cannot_stop_is_refused() -> None:
    class Barred(OpenLand):
        """Land on which one may stop in even cells only."""

        @property
        def stops(self) -> Bools:
            return np.asarray(np.arange(N) % 2 == 0)

    assert "cell 3, at which one cannot stop" in refusal(Plan((2, 3), ""), access=Barred(PLOT)).what


def test_what_fails_in_a_strategy_is_said_in_one_line_and_what_it_says_itself_comes_through() -> (
    None
):
    def failing(view: View) -> Plan:
        raise KeyError("z" * 900 if view.fresh else "")

    def refusing(view: View) -> Plan:  # noqa: ARG001
        raise ReadingsError("too few readings")

    with pytest.raises(ParameterError) as raised:
        planned(failing, view_of(), "strategy mine")
    assert raised.value.what.startswith("it failed: KeyError: 'zzz")
    assert len(str(raised.value)) < 320
    assert isinstance(raised.value.__cause__, KeyError)
    with pytest.raises(ReadingsError, match="too few readings"):
        planned(refusing, view_of(), "strategy mine")


def test_a_plan_goes_on_from_a_map_with_its_samples_taken_and_starts_where_it_is_told() -> None:
    seen: list[View] = []

    def look(view: View) -> Plan:
        seen.append(view)
        return Plan((), "only looked")

    at = [(2.5, 2.5), (3.0, 3.0), (57.5, 37.5), (999.0, 0.0)]
    samples = tuple(Sample(a, np.array([900.0]), np.zeros(1, dtype=np.int8)) for a in at)
    soil_map = SoilMap(PLOT, Layers((0.0, 0.4)), (Spherical(9.0, 9.0, 9.0),), samples)
    plan(soil_map, look, samples=7, start=(1.0, 2.0), seed=5)
    plan(PLOT, look)
    of_map, of_field = seen
    assert of_map.visited == (0, N - 1), "once a cell, and none for a place outside"
    assert (of_map.taken, of_map.budget, of_map.remaining) == (4, 11, 7)
    assert of_map.position == (1.0, 2.0)
    assert of_map.rng.integers(10**9) == np.random.default_rng(5).integers(10**9)
    assert (of_field.taken, of_field.budget, of_field.position) == (0, 30, PLOT.entrance)


# --- standing in ----------------------------------------------------------------------------------


@given(st.integers(0, 2**31), st.integers(1, 12))
@settings(max_examples=30, deadline=None)
def test_each_point_takes_the_nearest_cell_that_no_point_before_it_took(seed: int, k: int) -> None:
    rng = np.random.default_rng(seed)
    points: Floats = rng.integers(0, 12, (k, 2)).astype(float) * 5.0
    seen = view_of(visited=tuple(rng.choice(N, 20, replace=False).tolist()))
    left = np.flatnonzero(seen.free).tolist()
    for point, cell in zip(points, nearest_free(seen, points).tolist(), strict=True):
        away = {c: float(((PLOT.cells[c] - point) ** 2).sum()) for c in left}
        assert cell == min(left, key=lambda c: (away[c], c))
        left.remove(cell)


def test_a_stand_in_is_pushed_once_and_the_others_as_often_as_before() -> None:
    seen = view_of(plan=(30, 60), pushes=(3, 2), visited=(5,), refused=(44,), fresh=False, budget=4)
    found = carry_on(seen)
    (new,) = set(found.cells) - {30, 60}
    asked = dict(zip(found.cells, found.pushes, strict=True))
    assert asked == {30: 3, 60: 2, new: 1}
    assert found.reason == f"cell {new} stands in for refused cell 44"
    assert carry_on(replace(seen, pushes=())).pushes == ()


def test_carrying_on_says_when_nothing_is_left() -> None:
    everywhere = tuple(range(N))
    assert carry_on(view_of(visited=everywhere, fresh=False)).reason == "every cell was tried"
    made = carry_on(view_of(visited=(1, 2), budget=2, fresh=False))
    assert (made.cells, made.reason) == ((), "every planned stop is made")


# --- how far cells are from stops -----------------------------------------------------------------


@pytest.mark.parametrize("stops", [6, 15, 30])
@pytest.mark.parametrize("land", ["test bed", "L", "keep-out"])
def test_no_cell_is_far_from_the_stops_of_an_area_split(
    fields: dict[str, Field], look: Look, land: str, stops: int
) -> None:
    """Areas are compact: none reaches farther than a strip one by three of its size, and the cell
    of its centre is half a cell's diagonal off."""
    field = fields[land]
    found = strategy_named("area-split")(look(field, budget=stops, fresh=True, seed=stops))
    area = len(field.cells) * field.cell_size**2 / stops
    strip = np.hypot(np.sqrt(3 * area), np.sqrt(area / 3)) / 2
    reach = strip + field.cell_size * np.sqrt(0.5)
    assert cdist(field.cells, field.cells[list(found.cells)]).min(axis=1).max() <= reach


@pytest.mark.parametrize("stops", [10, 25])
def test_no_cell_is_farther_from_the_stops_of_a_w_than_from_the_w_and_half_a_step_along_it(
    fields: dict[str, Field], look: Look, stops: int
) -> None:
    field = fields["test bed"]
    found = strategy_named("w-shape")(look(field, budget=stops, fresh=True))
    east = np.linspace(0.03, 0.97, 5) * 180
    w = shapely.LineString(np.column_stack([east, 130 * np.array([0.85, 0.15, 0.85, 0.15, 0.85])]))
    step = w.length / (stops - 1)
    off_w = shapely.distance(w, shapely.points(field.cells))
    off = cdist(field.cells, field.cells[list(found.cells)]).min(axis=1)
    # A stop is in the cell nearest to its point, or in one beside it where that was taken.
    assert (off <= off_w + step / 2 + 1.5 * field.cell_size).all()


# --- draws ----------------------------------------------------------------------------------------


def odds(kv: Floats, candidates: int) -> Floats:
    """Chance of each of some cells to be drawn by KV from a set of candidates drawn uniformly."""
    sets = list(combinations(range(len(kv)), candidates))
    chance = np.zeros(len(kv))
    for each in sets:
        chance[list(each)] += kv[list(each)] / kv[list(each)].sum() / len(sets)
    return chance


@pytest.mark.parametrize("candidates", [1, 2, 3, 5])
def test_a_draw_has_the_odds_of_the_paper_whatever_the_number_of_candidates(
    fields: dict[str, Field], look: Look, candidates: int
) -> None:
    seen = look(fields["tiny"], (0,), refused=())
    free = np.flatnonzero(seen.free)
    kv = seen.soil_map.kv[free]
    rng = np.random.default_rng(candidates)
    drawn = [draw(replace(seen, rng=rng), candidates) for _ in range(3000)]
    counts = np.array([drawn.count(cell) for cell in free.tolist()])
    expected = 3000 * odds(kv, candidates)
    # Passed by chance once in a million times.
    assert ((counts - expected) ** 2 / expected).sum() < chi2.ppf(1 - 1e-6, len(free) - 1)


def test_a_survey_that_adapts_by_chance_swaps_in_each_cell_as_often_as_the_odds_say(
    fields: dict[str, Field], look: Look
) -> None:
    land = fields["tiny"]
    kv = look(land, (0,)).soil_map.kv
    middle = int(np.argsort(kv)[3])
    seen = look(land, (0,), (middle,), budget=2)
    free = np.flatnonzero(seen.free)
    rng, times = np.random.default_rng(3), 1500
    of_three = strategy_named("adaptive-monte-carlo", {"candidates": 3, "first_change": 1})
    plans = [of_three(replace(seen, rng=rng)).cells for _ in range(times)]
    assert {len(cells) for cells in plans} == {1}
    for cell, p in zip(free.tolist(), odds(kv[free], 3).tolist(), strict=True):
        often = sum(each == (cell,) for each in plans)
        # Only a cell of higher KV than the plan's takes its place; five deviations of a count.
        assert abs(often - times * p * (kv[cell] > kv[middle])) <= 5 * np.sqrt(times * p)
    assert kv[free].min() < kv[middle] < kv[free].max()
