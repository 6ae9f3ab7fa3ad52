"""Joint plans: the search does what it says, and beats the best public planner."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import inf

import numpy as np
import pytest

from subsoil.errors import ParameterError
from subsoil.kriging.designs import Designs
from subsoil.land.field import Field
from subsoil.layers import Layers
from subsoil.mapping.soilmap import SoilMap
from subsoil.stopping import Pace
from subsoil.strategies import Plan, View, strategy_named
from subsoil.strategies.joint.exchange import Exchange
from subsoil.strategies.joint.plans import designs_for, joint, joint_adaptive
from subsoil.strategies.joint.price import Price, SweepOptions
from subsoil.variogram import Exponential, Nested, Structure
from subsoil.ways.open_land import OpenLand
from subsoil.ways.routing import length

TEST_BED = Field.from_metres([(0, 0), (180, 0), (180, 130), (0, 130)])
POND = Field.from_metres(
    [(0, 0), (90, 0), (90, 60), (0, 60)], keep_outs=[[(30, 0), (45, 0), (45, 45), (30, 45)]]
)
SHAPE = Nested(1.0, (Structure(0.8, Exponential, 45.0),))
SGP_TOOLS = {15: (0.5884, 487.0), 20: (0.5382, 572.0), 30: (0.4700, 681.0), 50: (0.3857, 897.0)}
"""Mean variance and way in m of the plans of SGP-Tools 2.0.7 (its best effort, four plans each)."""


def view(field: Field, budget: int, seed: int = 1) -> View:
    empty = SoilMap(field, Layers())
    return View(
        field,
        OpenLand(field),
        empty,
        (0.0, 0.0),
        (),
        (),
        (),
        budget,
        True,
        np.random.default_rng(seed),
    )


def search(field: Field, cells: list[int], price: Price, fixed: tuple[int, ...] = ()) -> Exchange:
    designs = Designs(field, SHAPE, np.ones(len(field.cells)))
    free = np.ones(len(field.cells), dtype=bool)
    start = (0.0, 0.0)
    return Exchange(designs, OpenLand(field), start, fixed, cells, free, price)


def agrees(found: Exchange, field: Field, fixed: tuple[int, ...] = ()) -> None:
    designs = Designs(field, SHAPE, np.ones(len(field.cells)))
    way = length(OpenLand(field), (0.0, 0.0), field.cells[list(found.route)])
    assert len(set(found.route)) == len(found.route)
    assert not set(found.route) & set(fixed)
    assert found.metres == pytest.approx(way)
    assert found.variance == pytest.approx(designs.mean_variance([*fixed, *found.route]), rel=1e-9)


@pytest.mark.parametrize("field", [TEST_BED, POND], ids=["open", "pond"])
def test_a_search_keeps_exact_account_of_variance_and_way(field: Field) -> None:
    rng = np.random.default_rng(2)
    cells = rng.choice(len(field.cells), 12, replace=False).tolist()
    fixed = tuple(cells[:4])
    found = search(field, cells[4:], Price(elasticity=0.14), fixed)
    agrees(found, field, fixed)
    found.anneal(5, inf, rng)
    agrees(found, field, fixed)
    found.insert()
    agrees(found, field, fixed)
    found.drop()
    found.drop()
    agrees(found, field, fixed)
    assert len(found.route) == 7


def test_what_the_next_best_cell_brings_is_exact() -> None:
    cells = [50, 400, 700]
    found = search(TEST_BED, cells, Price(elasticity=0.14))
    before, metres = found.variance, found.metres
    gain, detour = found.next_best()
    found.insert()
    assert before - found.variance == pytest.approx(gain, rel=1e-9)
    assert found.metres - metres == pytest.approx(detour)


def test_no_single_exchange_improves_what_descended() -> None:
    rng = np.random.default_rng(3)
    cells = rng.choice(len(POND.cells), 6, replace=False).tolist()
    found = search(POND, cells, Price(per_m=1e-4))
    found.descend(50, SweepOptions(), rng)
    designs = Designs(POND, SHAPE, np.ones(len(POND.cells)))
    travel = OpenLand(POND)

    def cost(route: list[int]) -> float:
        way = length(travel, (0.0, 0.0), POND.cells[route])
        return designs.mean_variance(route) + 1e-4 * way

    route = list(found.route)
    least = cost(route)
    for stop in route:
        others = [cell for cell in route if cell != stop]
        for cell in set(range(len(POND.cells))) - set(others):
            for gap in range(len(others) + 1):
                assert cost([*others[:gap], cell, *others[gap:]]) > least - 1e-9


def test_under_a_budget_the_variance_falls_and_the_way_keeps_to_it() -> None:
    rng = np.random.default_rng(4)
    cells = rng.choice(936, 10, replace=False).tolist()
    found = search(TEST_BED, cells, Price(elasticity=0.14))
    budget = found.metres
    for _ in range(6):
        before = found.variance
        found.descend(1, SweepOptions(budget_m=budget), rng)
        assert found.variance <= before + 1e-12
        assert found.metres <= budget + 1e-9


@pytest.mark.parametrize(
    "n",
    [15, 20, pytest.param(30, marks=pytest.mark.slow), pytest.param(50, marks=pytest.mark.slow)],
)
def test_plans_beat_those_of_the_best_public_planner_on_its_way(n: int) -> None:
    variance, metres = SGP_TOOLS[n]
    start = view(TEST_BED, n)
    plan = joint(replace(start, metres_left=metres))
    assert len(plan.cells) == n
    assert length(start.access, start.position, TEST_BED.cells[list(plan.cells)]) <= metres
    assert designs_for(start).mean_variance(plan.cells) <= variance


def minutes(plan: Plan, start: View) -> float:
    way = length(start.access, start.position, start.field.cells[list(plan.cells)])
    return start.pace.minutes(way, len(plan.cells))


@pytest.mark.parametrize("strategy", [joint, joint_adaptive])
def test_a_plan_uses_the_minutes_it_has_and_no_more(strategy: Callable[[View], Plan]) -> None:
    stops = []
    for limit in (8.0, 15.0, 25.0):
        start = replace(view(TEST_BED, 900), minutes_left=limit, pace=Pace(1.5, 40.0))
        plan = strategy(start)
        assert limit - 2.0 < minutes(plan, start) <= limit
        stops.append(len(plan.cells))
    assert stops == sorted(set(stops))


def test_with_no_time_left_there_is_no_plan() -> None:
    plan = joint(replace(view(TEST_BED, 30), minutes_left=0.5))
    assert plan == Plan((), "no time left for another stop")


@pytest.mark.parametrize(
    ("setting", "values"), [("way", (1.1, 0.9, 0.6)), ("price_per_m", (1e-5, 2e-4, 1e-3))]
)
def test_a_smaller_share_or_a_higher_price_gives_a_shorter_way_and_a_higher_variance(
    setting: str, values: tuple[float, ...]
) -> None:
    designs = designs_for(view(TEST_BED, 12))
    ways, variances = [], []
    for value in values:
        start = view(TEST_BED, 12)
        plan = strategy_named("joint", {setting: value})(start)
        ways.append(length(start.access, start.position, TEST_BED.cells[list(plan.cells)]))
        variances.append(designs.mean_variance(plan.cells))
    assert ways == sorted(ways, reverse=True)
    assert variances == sorted(variances)


def test_after_a_sample_the_way_does_not_get_longer_and_the_variance_not_higher() -> None:
    start = view(TEST_BED, 20)
    cells = area = strategy_named("area-split")(start).cells
    here = tuple(TEST_BED.cells[area[7]].tolist())
    seen = replace(
        start, plan=cells[8:], visited=cells[:8], position=here, fresh=False, metres=300.0
    )
    plan = joint_adaptive(seen)
    designs = designs_for(seen)
    assert len(plan.cells) == 12
    assert length(seen.access, here, TEST_BED.cells[list(plan.cells)]) <= length(
        seen.access, here, TEST_BED.cells[list(cells[8:])]
    )
    assert designs.mean_variance([*cells[:8], *plan.cells]) < designs.mean_variance(cells)


def test_on_a_large_field_some_cells_are_weighed_at_a_time_and_the_plan_is_as_good() -> None:
    large = Field.from_metres([(0, 0), (300, 0), (300, 200), (0, 200)])
    start = view(large, 12)
    plan = joint(start, sweeps=10)
    area = strategy_named("area-split")(view(large, 12))
    designs = designs_for(start)
    assert designs.mean_variance(plan.cells) <= 1.02 * designs.mean_variance(area.cells)


def test_the_same_view_gives_the_same_plan() -> None:
    assert joint(view(TEST_BED, 14, 7)) == joint(view(TEST_BED, 14, 7))


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"way": 0.0}, "a way of 0 is none"),
        ({"price_per_m": inf}, "cannot be inf"),
        ({"sweeps": 0}, "0 sweeps find nothing"),
    ],
)
def test_a_price_or_search_that_makes_no_sense_is_refused(
    settings: dict[str, float | str], message: str
) -> None:
    with pytest.raises(ParameterError, match=message):
        strategy_named("joint", settings)(view(TEST_BED, 5))
