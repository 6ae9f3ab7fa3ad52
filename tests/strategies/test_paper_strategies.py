"""Each strategy of the paper does what the paper says of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
import shapely
from numpy.typing import NDArray
from scipy.stats import chi2

from subsoil.arrays import Floats
from subsoil.errors import ParameterError
from subsoil.land.field import Field
from subsoil.strategies import STRATEGIES, View, strategy_named
from subsoil.strategies.adaptive import adaptive_greedy, adaptive_monte_carlo
from subsoil.strategies.coverage import area_split, areas, carry_on, random, w_shape
from subsoil.strategies.next_best_view import greedy, monte_carlo
from subsoil.variogram import Spherical

Look = Callable[..., View]

SHORT = (Spherical(100.0, 9.0, 900.0), Spherical(100.0, 9.0, 900.0))
"""Variograms of so short a range that all cells away from a sample have the same KV."""


def too_uneven(counts: NDArray[np.int64], expected: Floats) -> bool:
    """Whether counts fail a chi-square test that passes all but one in a million samples."""
    statistic = float(((counts - expected) ** 2 / expected).sum())
    return statistic > float(chi2.ppf(1 - 1e-6, len(counts) - 1))


def some_cells(view_field: Field, k: int, seed: int) -> tuple[int, ...]:
    rng = np.random.default_rng(seed)
    return tuple(rng.choice(len(view_field.cells), k, replace=False).tolist())


# --- random ---------------------------------------------------------------------------------------


def test_random_draws_every_cell_equally_often(fields: dict[str, Field], look: Look) -> None:
    land = fields["tiny"]
    counts = np.zeros(6, dtype=np.int64)
    for seed in range(2000):
        (cell,) = random(look(land, budget=1, fresh=True, seed=seed)).cells
        counts[cell] += 1
    assert not too_uneven(counts, np.full(6, 2000 / 6))


# --- W shape --------------------------------------------------------------------------------------


def test_a_w_stands_upright_and_its_stops_lie_on_it_evenly(
    fields: dict[str, Field], look: Look
) -> None:
    land = fields["test bed"]
    plan = w_shape(look(land, budget=30, fresh=True), margin=0.03, amplitude=0.7)
    top, bottom = 130 * 0.85, 130 * 0.15
    east = np.linspace(0.03, 0.97, 5) * 180
    line = shapely.LineString(np.column_stack([east, (top, bottom, top, bottom, top)]))
    stops = shapely.points(land.cells[list(plan.cells)])
    assert shapely.distance(stops, line).max() <= np.hypot(2.5, 2.5)
    along = np.sort(shapely.line_locate_point(line, stops))
    assert np.diff(along) == pytest.approx(line.length / 29, abs=2 * np.hypot(2.5, 2.5))


@pytest.mark.parametrize("degrees", [0, 17, 45, 90, 130, 180, 260])
def test_a_w_turns_with_the_field_and_stays_upright(look: Look, degrees: float) -> None:
    turn = np.deg2rad(degrees)
    spin = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    corners = np.array([(-90, -65), (90, -65), (90, 65), (-90, 65)]) @ spin + 300
    land = Field.from_metres(corners)
    plan = w_shape(look(land, budget=40, fresh=True))
    level = np.deg2rad((degrees + 90 - 1e-6) % 180 - 90 + 1e-6)
    along = np.array([np.cos(level), np.sin(level)])
    up = np.array([-along[1], along[0]])
    s, t = ((land.cells[list(plan.cells)] - 300) @ np.column_stack([along, up])).T
    legs = np.linspace(-0.47, 0.47, 5) * 180
    height = np.interp(s, legs, np.array([0.35, -0.35, 0.35, -0.35, 0.35]) * 130)
    assert np.abs(t - height).max() < 9.5


@pytest.mark.parametrize("name", ["L", "keep-out", "thin"])
def test_stops_of_a_w_stay_on_the_w_where_that_lies_in_the_field(
    fields: dict[str, Field], look: Look, name: str
) -> None:
    land = fields[name]
    plan = w_shape(look(land, budget=9, fresh=True))
    west, south, east, north = land.boundary.bounds
    x = np.linspace(0.03, 0.97, 5) * (east - west)
    t = np.array([0.85, 0.15, 0.85, 0.15, 0.85]) * (north - south)
    stops = shapely.points(land.cells[list(plan.cells)])
    assert shapely.distance(stops, shapely.LineString(np.column_stack([x, t]))).max() <= 5.0


def test_a_w_that_misses_the_field_still_gives_its_stops(look: Look) -> None:
    inner = [(6, 6), (94, 6), (94, 74), (6, 74)]
    land = Field.from_metres([(0, 0), (100, 0), (100, 80), (0, 80)], keep_outs=[inner])
    plan = w_shape(look(land, budget=12, fresh=True), margin=0.2, amplitude=0.5)
    assert len(set(plan.cells)) == 12


@pytest.mark.parametrize(("margin", "amplitude"), [(0.5, 0.7), (-0.1, 0.7), (0.1, 0.0), (0.1, 1.1)])
def test_a_w_outside_the_field_is_refused(
    fields: dict[str, Field], look: Look, margin: float, amplitude: float
) -> None:
    with pytest.raises(ParameterError, match="does not lie in the field"):
        w_shape(look(fields["L"], fresh=True), margin=margin, amplitude=amplitude)


# --- area split -----------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["test bed", "L", "keep-out"])
@pytest.mark.parametrize("k", [2, 5, 15])
def test_areas_are_of_about_equal_size_around_their_centres(
    fields: dict[str, Field], name: str, k: int
) -> None:
    land = fields[name]
    fair = len(land.cells) / k
    spreads = []
    for seed in range(5):
        owner, centres = areas(land, k, 60, np.random.default_rng(seed))
        size = np.bincount(owner, minlength=k)
        assert size.sum() == len(land.cells)
        assert np.abs(size / fair - 1).max() <= 0.4
        for area in range(k):
            assert centres[area] == pytest.approx(land.cells[owner == area].mean(axis=0))
        spreads.append(size.std() / fair)
    assert np.mean(spreads) <= 0.15


def test_areas_are_compact(fields: dict[str, Field]) -> None:
    land, k = fields["test bed"], 15
    owner, centres = areas(land, k, 60, np.random.default_rng(1))
    square = 180 * 130 / k / 6
    spread = ((land.cells - centres[owner]) ** 2).sum(axis=1).mean()
    assert spread <= 1.2 * square


@pytest.mark.parametrize("name", ["L", "keep-out", "thin"])
def test_area_split_stops_at_the_centres_or_in_the_nearest_cell(
    fields: dict[str, Field], look: Look, name: str
) -> None:
    land = fields[name]
    plan = area_split(look(land, budget=9, fresh=True, seed=4))
    _, centres = areas(land, 9, 60, np.random.default_rng(4))
    away = np.hypot(*(centres[:, None] - land.cells[None]).transpose(2, 0, 1))
    assert set(plan.cells) == set(np.argmin(away, axis=1).tolist())
    assert land.contains(land.cells[list(plan.cells)]).all()


def test_the_centre_of_an_area_around_a_corner_moves_into_the_field(look: Look) -> None:
    land = Field.from_metres([(0, 0), (60, 0), (60, 10), (10, 10), (10, 60), (0, 60)])
    (cell,) = area_split(look(land, budget=1, fresh=True)).cells
    assert not land.contains(land.cells.mean(axis=0)).any()
    assert land.contains(land.cells[cell]).all()


def test_no_round_of_area_split_is_refused(fields: dict[str, Field], look: Look) -> None:
    with pytest.raises(ParameterError, match="0 rounds"):
        area_split(look(fields["L"], fresh=True), rounds=0)


# --- carrying on ----------------------------------------------------------------------------------


def test_the_nearest_free_cell_stands_in_for_a_refused_one(
    fields: dict[str, Field], look: Look
) -> None:
    land = fields["test bed"]
    plan = carry_on(look(land, (100,), (300, 500), refused=(400,), budget=4))
    (new,) = set(plan.cells) - {300, 500}
    assert np.hypot(*(land.cells[new] - land.cells[400])) == 5.0
    assert carry_on(look(land, (100,), (300, 500), refused=(400,), budget=3)).cells == (300, 500)


# --- next best view -------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(12))
def test_greedy_goes_to_the_free_cell_of_highest_kv(
    fields: dict[str, Field], look: Look, seed: int
) -> None:
    land = fields["keep-out"]
    taken = some_cells(land, 9, seed)
    seen = look(land, taken[:6], refused=taken[6:])
    (cell,) = greedy(seen).cells
    free = [k for k in range(len(land.cells)) if k not in taken]
    assert cell in free
    assert seen.soil_map.kv[cell] >= seen.soil_map.kv[free].max() * (1 - 1e-9)


def test_of_equal_kv_greedy_takes_the_nearest_and_then_the_first(
    fields: dict[str, Field], look: Look
) -> None:
    land = fields["test bed"]
    centre = land.nearest_cell((92.5, 62.5))
    seen = look(land, (centre,), variograms=SHORT)
    kv = seen.soil_map.kv
    highest = np.flatnonzero(kv >= kv.max() * (1 - 1e-9))
    away = np.hypot(*(land.cells[highest] - land.cells[centre]).T)
    assert len(highest) > 900
    nearest = highest[away <= away.min() + 1e-9]
    assert len(nearest) == 4
    assert greedy(seen).cells == (nearest.min(),)


@pytest.mark.parametrize("name", ["greedy", "monte-carlo"])
def test_the_first_stop_of_a_next_best_view_is_drawn_uniformly(
    fields: dict[str, Field], look: Look, name: str
) -> None:
    counts = np.zeros(6, dtype=np.int64)
    for seed in range(2000):
        counts[STRATEGIES[name](look(fields["tiny"], seed=seed)).cells[0]] += 1
    assert not too_uneven(counts, np.full(6, 2000 / 6))


def test_monte_carlo_draws_in_proportion_to_kv(fields: dict[str, Field], look: Look) -> None:
    land = fields["thin"]
    seen = look(land, (3, 4, 30))
    counts = np.zeros(len(land.cells), dtype=np.int64)
    for seed in range(4000):
        counts[monte_carlo(replace(seen, rng=np.random.default_rng(seed))).cells[0]] += 1
    free = seen.free
    kv = seen.soil_map.kv[free]
    assert counts[~free].sum() == 0
    assert kv.max() > 1.3 * kv.min()
    assert not too_uneven(counts[free], 4000 * kv / kv.sum())
    assert too_uneven(counts[free], np.full(free.sum(), 4000 / free.sum()))


def test_of_a_single_candidate_kv_does_not_matter(fields: dict[str, Field], look: Look) -> None:
    land = fields["thin"]
    seen = look(land, (3, 4, 30))
    counts = np.zeros(len(land.cells), dtype=np.int64)
    for seed in range(4000):
        drawn = monte_carlo(replace(seen, rng=np.random.default_rng(seed)), candidates=1)
        counts[drawn.cells[0]] += 1
    assert not too_uneven(counts[seen.free], np.full(seen.free.sum(), 4000 / seen.free.sum()))


@pytest.mark.parametrize("strategy", [monte_carlo, adaptive_monte_carlo])
def test_no_candidate_is_refused(
    fields: dict[str, Field], look: Look, strategy: Callable[..., object]
) -> None:
    with pytest.raises(ParameterError, match="0 candidates"):
        strategy(look(fields["L"], (1, 2, 3), (4, 5)), candidates=0)


# --- adaptive -------------------------------------------------------------------------------------


@pytest.mark.parametrize("sigma", [0.2, 1.0, 2.0])
@pytest.mark.parametrize("seed", range(8))
def test_adaptive_greedy_drops_below_the_mean_less_sigmas_and_adds_what_exceeds_all(
    fields: dict[str, Field], look: Look, seed: int, sigma: float
) -> None:
    land = fields["L"]
    cells = some_cells(land, 21, seed)
    seen = look(land, cells[:8], cells[8:20], refused=cells[20:])
    kv = seen.soil_map.kv
    planned = [kv[cell] for cell in cells[8:20]]
    mean = sum(planned) / 12
    deviation = (sum((value - mean) ** 2 for value in planned) / 12) ** 0.5
    kept = {cell for cell in cells[8:20] if kv[cell] >= mean - sigma * deviation}
    free = [cell for cell in range(len(land.cells)) if cell not in cells]
    best = max(free, key=lambda cell: float(kv[cell]))
    added = {best} if kv[best] > max(kv[cell] for cell in kept) else set()
    plan = adaptive_greedy(seen, drop_sigma=sigma)
    assert set(plan.cells) == kept | added
    assert len(plan.cells) == len(kept) + len(added)


def test_the_rules_of_adaptive_greedy_bite_in_these_tests(
    fields: dict[str, Field], look: Look
) -> None:
    land, reasons = fields["L"], []
    for seed in range(8):
        cells = some_cells(land, 20, seed)
        for sigma in (0.2, 1.0, 2.0):
            plan = adaptive_greedy(look(land, cells[:8], cells[8:]), drop_sigma=sigma)
            reasons.append(plan.reason)
    dropped = [int(reason.split()[0]) for reason in reasons if "dropped" in reason]
    assert 0 in dropped
    assert max(dropped) >= 3
    assert any("none added" in reason for reason in reasons)
    assert any("added" in reason and "none" not in reason for reason in reasons)


def test_a_plan_that_holds_the_highest_kv_is_kept(fields: dict[str, Field], look: Look) -> None:
    land = fields["L"]
    seen = look(land, (0, 5, 60))
    highest = greedy(seen).cells
    plan = (*highest, 100, 150)
    kept = adaptive_greedy(replace(seen, plan=plan), drop_sigma=9.0)
    assert kept.cells == plan
    assert kept.reason == "no cell exceeds the plan's KV"


def test_targets_of_equal_kv_are_all_kept(fields: dict[str, Field], look: Look) -> None:
    land = fields["test bed"]
    plan = (700, 750, 790, 800, 830, 850, 900)
    seen = look(land, (0, 1, 2), plan, variograms=SHORT)
    assert np.ptp(seen.soil_map.kv[list(plan)]) == pytest.approx(0.0)
    assert adaptive_greedy(seen, drop_sigma=0.0).cells == plan


def test_adaptive_greedy_with_an_empty_plan_goes_to_the_highest_kv(
    fields: dict[str, Field], look: Look
) -> None:
    seen = look(fields["L"], (0, 5, 60))
    assert adaptive_greedy(seen).cells == greedy(seen).cells


@pytest.mark.parametrize("seed", range(15))
def test_adaptive_monte_carlo_swaps_the_lowest_kv_for_one_drawn(
    fields: dict[str, Field], look: Look, seed: int
) -> None:
    land = fields["L"]
    cells = some_cells(land, 14, seed)
    seen = look(land, cells[:6], cells[6:], seed=seed, budget=14)
    plan, kv = adaptive_monte_carlo(seen), seen.soil_map.kv
    added, gone = set(plan.cells) - set(cells[6:]), set(cells[6:]) - set(plan.cells)
    assert len(plan.cells) == len(set(plan.cells)) == 8
    assert len(added) == len(gone) <= 1
    assert not added & set(cells[:6])
    assert all(kv[cell] == min(kv[list(cells[6:])]) for cell in gone)
    assert all(kv[new] > kv[old] for new, old in zip(added, gone, strict=True))


@pytest.mark.parametrize("name", ["adaptive-greedy", "adaptive-monte-carlo"])
@pytest.mark.parametrize("initial", ["area-split", "random"])
def test_an_adaptive_survey_starts_with_a_coverage_plan(
    fields: dict[str, Field], look: Look, name: str, initial: str
) -> None:
    adaptive = strategy_named(name, {"initial": initial})
    first = look(fields["L"], fresh=True, budget=10, seed=8)
    again = look(fields["L"], fresh=True, budget=10, seed=8)
    assert adaptive(first) == STRATEGIES[initial](again)


@pytest.mark.parametrize("name", ["adaptive-greedy", "adaptive-monte-carlo"])
def test_a_plan_is_not_changed_before_the_first_change(
    fields: dict[str, Field], look: Look, name: str
) -> None:
    land = fields["L"]
    late, soon = (strategy_named(name, {"first_change": k}) for k in (4.0, 3.0))
    seen = look(land, (0, 1, 2), (30, 3, 31), budget=6)
    assert late(seen).cells == (30, 3, 31)
    assert soon(look(land, (0, 1, 2), (30, 3, 31), budget=6)).cells != (30, 3, 31)


@pytest.mark.parametrize("name", ["adaptive-greedy", "adaptive-monte-carlo"])
def test_an_initial_plan_that_does_not_exist_is_refused(
    fields: dict[str, Field], look: Look, name: str
) -> None:
    with pytest.raises(ParameterError, match="no initial plan 'w'"):
        strategy_named(name, {"initial": "w"})(look(fields["L"], fresh=True))
