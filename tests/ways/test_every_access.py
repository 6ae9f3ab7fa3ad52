"""What holds of every access, and of searches on it.

An access is added by a line in ``ACCESSES``.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import permutations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import ArrayLike, NDArray

from subsoil.agent import drive
from subsoil.arrays import Floats
from subsoil.errors import ParameterError
from subsoil.kriging.designs import Designs
from subsoil.land.field import Field
from subsoil.layers import Layers
from subsoil.mapping.soilmap import SoilMap
from subsoil.penetrometer import SMALL_CONE
from subsoil.reports import Source
from subsoil.simulation import draw_truth
from subsoil.simulation.probe import Machine
from subsoil.simulation.robot import SimulatedRobot
from subsoil.strategies import STRATEGIES, View
from subsoil.strategies.joint.exchange import Exchange
from subsoil.strategies.joint.price import Price, SweepOptions
from subsoil.survey import LocalDispatch, Memory, Settings, opened, opening
from subsoil.survey.events import Configured
from subsoil.variogram import Exponential
from subsoil.variogram.nested import Nested, Structure
from subsoil.ways.access import FARTHEST_M, Access
from subsoil.ways.moves import quantised, shorten
from subsoil.ways.open_land import OpenLand
from subsoil.ways.routing import length, reroute, tour, way
from subsoil.ways.tours import short_tour

PLOT = Field.from_metres([(0, 0), (60, 0), (60, 40), (0, 40)])
YARD = Field.from_metres(
    [(0, 0), (60, 0), (60, 40), (0, 40)], keep_outs=[[(20, 10), (30, 10), (30, 40), (20, 40)]]
)


@dataclass(frozen=True)
class OneWay:
    """A toy access: rows are driven eastwards only; one comes back by a detour to the north.

    One stops a metre east of the centres, and nowhere in the northernmost row. No way leads into
    the westernmost column, except for who stands in it.

    Attributes
    ----------
    field
        The land.
    """

    field: Field

    @property
    def stops(self) -> NDArray[np.bool_]:
        north = self.field.cells[:, 1]
        return np.asarray(north < north.max())

    @property
    def at(self) -> Floats:
        return np.asarray(self.field.cells + np.array([1.0, 0.0]))

    @property
    def is_symmetric(self) -> bool:
        return False

    def between(self, a: ArrayLike, b: ArrayLike) -> Floats:
        a, b = (np.asarray(places, dtype=float).reshape(-1, 2) for places in (a, b))
        east, north = np.moveaxis(b[None] - a[:, None], -1, 0)
        metres = np.abs(north) + np.where(east >= 0, east, 2 * self._detour - east)
        west = self.field.cells[:, 0].min() + 2.0
        barred = (b[:, 0] < west)[None] & (a[:, 0] >= west)[:, None]
        return np.where(barred, np.inf, metres)

    def way(self, a: ArrayLike, b: ArrayLike) -> Floats:
        here, there = np.asarray(a, dtype=float), np.asarray(b, dtype=float)
        if np.isinf(self.between(here, there)[0, 0]):
            raise ParameterError("no way leads there", where="one-way street")
        if there[0] >= here[0]:
            return np.array([here, [there[0], here[1]], there])
        out = [[here[0], here[1] + self._detour], [there[0], here[1] + self._detour]]
        return np.array([here, *out, [there[0], here[1]], there])

    @property
    def _detour(self) -> float:
        return self.field.cell_size


ACCESSES: dict[str, Access] = {
    "open": OpenLand(PLOT), "around a shed": OpenLand(YARD), "one way": OneWay(PLOT),
}  # fmt: skip
every_access = pytest.mark.parametrize("access", ACCESSES.values(), ids=ACCESSES)
START = (6.0, 2.0)


@every_access
def test_it_says_of_every_cell_whether_and_where_one_stops(access: Access) -> None:
    cells = len(access.at)
    assert access.at.shape == (cells, 2)
    assert access.stops.shape == (cells,)
    assert access.stops.dtype == bool
    assert access.stops.any()


@every_access
def test_no_way_is_shorter_than_the_straight_line_nor_leads_away_from_where_one_is(
    access: Access,
) -> None:
    at = access.at[::7]
    metres = access.between(at, at)
    straight = np.hypot(*(at[:, None] - at).transpose(2, 0, 1))
    assert not np.isnan(metres).any()
    assert (metres >= straight - 1e-9).all()
    assert (np.diagonal(metres) == 0).all()


@every_access
def test_it_says_whether_ways_are_as_long_back_as_forth(access: Access) -> None:
    at = access.at[::5]
    metres = access.between(at, at)
    assert np.allclose(metres, metres.T, rtol=1e-12) == access.is_symmetric


@every_access
def test_a_detour_over_a_third_place_is_never_shorter(access: Access) -> None:
    at = access.at[::11]
    metres = access.between(at, at)
    assert (metres[:, None, :] <= metres[:, :, None] + metres[None] + 1e-9).all()


@every_access
def test_a_way_is_as_long_as_it_says(access: Access) -> None:
    rng = np.random.default_rng(1)
    for a, b in access.at[rng.integers(len(access.at), size=(40, 2))]:
        metres = access.between(a, b)[0, 0]
        if np.isinf(metres):
            with pytest.raises(ParameterError):
                access.way(a, b)
        else:
            steps = np.diff(access.way(a, b), axis=0)
            assert np.hypot(*steps.T).sum() == pytest.approx(metres, abs=1e-6)


def view(access: Access, field: Field, budget: int = 8) -> View:
    empty = SoilMap(field, Layers())
    rng = np.random.default_rng(1)
    return View(field, access, empty, START, (), (), (), budget, fresh=True, rng=rng)


@every_access
@pytest.mark.parametrize("strategy", STRATEGIES.values(), ids=STRATEGIES)
def test_every_strategy_plans_only_where_one_may_stop_and_can_get_to(
    access: Access, strategy: object
) -> None:
    field = YARD if access == ACCESSES["around a shed"] else PLOT
    plan = strategy(view(access, field))  # type: ignore[operator]
    assert plan.cells
    assert access.stops[list(plan.cells)].all()
    assert np.isfinite(length(access, START, access.at[list(plan.cells)]))


@every_access
@pytest.mark.parametrize("strategy", sorted(STRATEGIES))
def test_a_survey_is_made_along_its_ways(access: Access, strategy: str) -> None:
    field = YARD if access == ACCESSES["around a shed"] else PLOT
    truth = draw_truth(field, np.random.default_rng(1))
    start = replace(opened(opening(field, truth.layers, SMALL_CONE)), access=access)
    dispatch = LocalDispatch(start, Memory())
    wanted = Settings(start=START, strategy=strategy, estimator="paper-10", samples=5, seed=1)
    dispatch.record(Configured(settings=wanted))
    dispatch.join("sim", "simulator")
    quiet = Machine(SMALL_CONE, stone_probability=0.0)
    robot = SimulatedRobot(truth, quiet, seed=1, position=START, access=access)
    assert drive("sim", robot, dispatch, source=Source(kind="simulator")) == "5 samples taken"
    survey = dispatch.survey
    assert survey.refused == ()
    assert access.stops[list(survey.visited)].all()
    driven = length(access, START, access.at[list(survey.visited)])
    assert survey.metres == pytest.approx(driven, rel=1e-6)


def one_way_metres(rng: np.random.Generator, n: int) -> Floats:
    metres: Floats = rng.uniform(1.0, 100.0, (n, n))
    np.fill_diagonal(metres, 0.0)
    return metres


def metres_of(distance: Floats, order: tuple[int, ...]) -> float:
    path = [0, *order]
    return float(distance[path[:-1], path[1:]].sum())


def test_where_ways_differ_back_a_tour_of_few_stops_is_the_shortest_of_all() -> None:
    rng = np.random.default_rng(4)
    for n in (2, 3, 4, 5, 6, 7):
        for _ in range(6):
            distance = one_way_metres(rng, n)
            shortest = min(metres_of(distance, p) for p in permutations(range(1, n)))
            assert metres_of(distance, short_tour(distance)) == pytest.approx(shortest, abs=0.01)


@given(seed=st.integers(0, 10_000), n=st.integers(2, 30))
@settings(max_examples=40, deadline=None)
def test_shortening_never_lengthens_a_one_way_path_and_keeps_its_stops(seed: int, n: int) -> None:
    distance = one_way_metres(np.random.default_rng(seed), n)
    after = shorten(distance)
    assert sorted(after) == list(range(1, n))
    units = quantised(distance)
    assert metres_of(units, after) <= metres_of(units, tuple(range(1, n)))


@given(seed=st.integers(0, 10_000), n=st.integers(3, 25))
@settings(max_examples=40, deadline=None)
def test_where_some_ways_do_not_exist_a_tour_takes_those_that_do(seed: int, n: int) -> None:
    rng = np.random.default_rng(seed)
    distance = one_way_metres(rng, n)
    order = rng.permutation(np.arange(1, n))
    chain = [0, *order.tolist()]
    barred = rng.random((n, n)) < 0.3
    barred[chain[:-1], chain[1:]] = False
    distance[barred & (distance > 0)] = np.inf
    found = short_tour(distance)
    assert sorted(found) == list(range(1, n))
    assert short_tour(distance) == found


def test_a_stop_that_no_way_leads_to_comes_last_and_the_route_says_so() -> None:
    access = OneWay(PLOT)
    west = np.flatnonzero(access.at[:, 0] < 5)[:1]
    stops = np.concatenate([west, np.flatnonzero(access.at[:, 0] > 20)[:3]])
    order = tour(access, (30.0, 2.0), access.at[stops])
    assert order[-1] == 0
    assert length(access, (30.0, 2.0), access.at[stops[list(order)]]) == np.inf
    route = reroute(access, access.at, (30.0, 2.0), tuple(stops[1:].tolist()), [int(west[0])])
    assert route[-1] == west[0]
    with pytest.raises(ParameterError, match="no way"):
        way(access, (30.0, 2.0), access.at[stops])


def test_an_exchange_keeps_exact_account_of_one_way_ways() -> None:
    access = OneWay(PLOT)
    shape = Nested(1.0, (Structure(0.8, Exponential, 45.0),))
    designs = Designs(PLOT, shape, np.ones(len(PLOT.cells)))
    cells = np.flatnonzero(access.at[:, 0] > 10)[[3, 20, 33, 50, 61, 70]].tolist()
    reachable = view(access, PLOT).free
    search = Exchange(designs, access, START, (), cells, reachable, Price(per_m=1e-4))
    rng = np.random.default_rng(2)
    search.anneal(3, np.inf, rng)
    search.insert()
    search.drop()
    search.descend(20, SweepOptions(), rng)
    assert search.metres == pytest.approx(length(access, START, access.at[list(search.route)]))
    assert search.metres < FARTHEST_M
    assert search.variance == pytest.approx(designs.mean_variance(list(search.route)), rel=1e-9)
    assert len(set(search.route)) == len(cells)
