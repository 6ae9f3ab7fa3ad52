"""Joint planning: the stops and the way through them chosen together.

A design that maps best strings its stops far apart; the shortest way through many stops passes
where it learns little. Both strategies minimise the mean kriging variance of the map to come plus
a price on every metre (:mod:`subsoil.strategies.joint.exchange`). ``joint`` does so before leaving;
``joint_adaptive`` goes on doing so after every sample, under what the samples say of the soil by
then.

Variance is in sills and judged under the pooled correlogram (:mod:`subsoil.variogram.pooled`),
which before the first samples is the prior.
"""

from __future__ import annotations

from math import inf

import numpy as np
from threadpoolctl import threadpool_limits

from subsoil.errors import ParameterError
from subsoil.kriging.designs import Designs
from subsoil.strategies.coverage import areas, carry_on, nearest_free
from subsoil.strategies.joint.exchange import Exchange
from subsoil.strategies.joint.price import Price, SweepOptions
from subsoil.strategies.joint.replicates import replicated
from subsoil.strategies.view import Plan, View
from subsoil.variogram.nested import Nested
from subsoil.variogram.pooled import Pooled
from subsoil.ways.routing import length, reroute

_ELASTICITY = 0.14
"""Percent of the mean variance that a percent of the way is worth, where its length is given: about
what makes it 0.87 of an area split's. A search for a given length starts from this price."""
_ROUNDS = 20
"""Rounds of splitting the field for a start."""
_STOPS_ANNEALED = 60
"""Stops to anneal in all: those of few stops are annealed from several starts, the best counts."""
_WARM_SWEEPS = 2
"""Most sweeps after a sample."""


def joint(
    view: View,
    *,
    way: float = 0.87,
    price_per_m: float = 0.0,
    sweeps: int = 40,
    most_pushes: int = 1,
) -> Plan:
    """Stops and way chosen together before leaving.

    The way is given, as a share of the tour through as many areas of equal size, and the stops are
    those that make the best map along it; or a metre has a price. Where there is a limit in metres
    or minutes, the plan keeps to it: in minutes, with as many stops as there is time for.

    Parameters
    ----------
    view
        The survey so far.
    way
        Length of the way as a share of an area split's.
    price_per_m
        Mean variance, in sills, that a metre of way is worth; in place of the share, unless it
        is zero.
    sweeps
        Sweeps of annealing over the stops.
    most_pushes
        Most pushes at a stop (:mod:`subsoil.strategies.joint.replicates`).

    Raises
    ------
    ParameterError
        If the share is not positive, the price is negative, or there is no sweep or no push.
    """
    price = _price(way, price_per_m, sweeps)
    if not (view.fresh and view.remaining > 0):
        return carry_on(view)
    time_left, designs = TimeLeft(view), designs_for(view)
    stops = _stops_in_time(view, time_left, way)
    if not stops:
        return Plan((), "no time left for another stop")
    starts = [
        _exchange(view, designs, _split(view, stops), price)
        for _ in range(max(1, _STOPS_ANNEALED // stops))
    ]
    budget = time_left.metres_for(stops)
    if not (price_per_m or time_left.counts_minutes):
        budget = min(budget, way * min(start.metres for start in starts))
    with threadpool_limits(1, user_api="blas"):
        for search in starts:
            search.anneal(sweeps, budget, view.rng)
    best = min(starts, key=lambda s: (time_left.late(s), s.variance if budget < inf else s.cost))
    if time_left.counts_minutes:
        _suit_to_time(best, time_left, view.remaining)
        best.descend(sweeps, SweepOptions(budget_m=time_left.metres_for(len(best.route))), view.rng)
    return replicated(Plan(best.route, _reason(best, "planned")), view, best, most_pushes)


def joint_adaptive(
    view: View,
    *,
    way: float = 0.87,
    price_per_m: float = 0.0,
    sweeps: int = 40,
    first_change: int = 6,
    reach_m: float = 25.0,
    most_pushes: int = 1,
) -> Plan:
    """Stops and way chosen together, and again after every sample.

    From the sixth sample on the stops still to make move to where they are worth most under the
    correlogram of the samples, the way never getting longer by it. Under a limit in minutes or
    metres a stop is dropped where time has become short, and put in where there is enough.

    Parameters
    ----------
    view
        The survey so far.
    way, price_per_m, sweeps
        As in :func:`joint`.
    first_change
        Samples before the plan is changed for the first time: the first ones are a start design,
        without close pairs and without a transect.
    reach_m
        Distance in m by which a stop may move at a time.
    most_pushes
        As in :func:`joint`.

    Raises
    ------
    ParameterError
        As :func:`joint`.
    """
    if view.fresh or not (view.plan or view.visited):
        return joint(
            view,
            way=way,
            price_per_m=price_per_m,
            sweeps=sweeps,
            most_pushes=most_pushes,
        )
    price, time_left = _price(way, price_per_m, sweeps), TimeLeft(view)
    if len(view.visited) < first_change and not time_left.is_ticking:
        return carry_on(view)
    search = _exchange(view, designs_for(view), view.plan, price)
    _suit_to_time(search, time_left, view.remaining)
    if not search.route:
        return Plan((), "the limits leave no room for another stop")
    budget = time_left.metres_for(len(search.route)) if time_left.is_ticking else search.metres
    with threadpool_limits(1, user_api="blas"):
        search.descend(_WARM_SWEEPS, SweepOptions(reach_m=reach_m, budget_m=budget), view.rng)
    plan = Plan(search.route, _reason(search, "moved to where they are worth most"))
    return replicated(plan, view, search, most_pushes)


class TimeLeft:
    """What a survey's limits leave for driving.

    Parameters
    ----------
    view
        The survey so far.
    """

    def __init__(self, view: View) -> None:
        self._metres, self._seconds = view.metres_left, 60.0 * view.minutes_left
        self._speed, self._stop = view.pace.speed_mps, view.pace.stop_s

    @property
    def is_ticking(self) -> bool:
        """Whether there is any limit in metres or minutes."""
        return min(self._metres, self._seconds) < inf

    @property
    def counts_minutes(self) -> bool:
        """Whether there is a limit in minutes."""
        return self._seconds < inf

    def metres_for(self, stops: int) -> float:
        """Longest way in m that leaves time for some stops."""
        return min(self._metres, (self._seconds - stops * self._stop) * self._speed)

    def late(self, search: Exchange) -> bool:
        """Whether a plan takes longer than there is time."""
        return search.metres > self.metres_for(len(search.route))

    def most_stops(self, wanted: int) -> int:
        """Stops, up to some wanted, there is time for without driving a metre."""
        return int(min(self._seconds / self._stop, wanted))


def designs_for(view: View) -> Designs:
    """Judge of designs on a view's field, under what is known of its correlogram."""
    return Designs(view.field, _correlogram(view), np.ones(len(view.field.cells)))


def _correlogram(view: View) -> Nested:
    """The map's correlogram if it is pooled, else that of the samples, or the prior."""
    models = view.soil_map.variograms
    if view.visited and models and isinstance(models[0], Nested):
        return models[0]
    pooled = Pooled().scaled_to(view.field.extent_m)
    return Nested(1.0, pooled.posterior(view.soil_map.at, view.soil_map.kpa).structures)


def _exchange(view: View, designs: Designs, route: tuple[int, ...], price: Price) -> Exchange:
    free = view.free
    free[list(view.plan)] = True
    return Exchange(
        designs,
        view.access,
        view.position,
        view.readings,
        route,
        free,
        price,
        view.metres,
    )


def _stops_in_time(view: View, time_left: TimeLeft, way: float) -> int:
    """Most stops there is time for, with a way of some share of an area split's."""

    def fits(stops: int) -> bool:
        split = view.access.at[list(_split(view, stops))]
        return way * length(view.access, view.position, split) <= time_left.metres_for(stops)

    fewest, most = 0, time_left.most_stops(view.remaining)
    if not time_left.counts_minutes or not most or fits(most):
        return most
    while most - fewest > 1:
        middle = (fewest + most) // 2
        fewest, most = (middle, most) if fits(middle) else (fewest, middle)
    return fewest


def _split(view: View, stops: int) -> tuple[int, ...]:
    """Route through the centres of some areas of equal size.

    It is put together stop by stop: unlike a tour that is searched for some time, the same always.
    """
    _, centres = areas(view.field, stops, _ROUNDS, view.rng)
    cells = nearest_free(view, centres).tolist()
    return reroute(view.access, view.access.at, view.position, (), cells)


def _suit_to_time(search: Exchange, time_left: TimeLeft, most: int) -> None:
    """Drop stops there is no time for; put stops in as long as there is."""
    while time_left.late(search) and len(search.route) > 1:
        search.drop()
    while len(search.route) < most:
        search.insert()
        if time_left.late(search):
            search.drop()
            break


def _price(way: float, price_per_m: float, sweeps: int) -> Price:
    if not 0 < way < inf:
        raise ParameterError(f"a way of {way:g} is none", where="strategy joint, way")
    if not 0 <= price_per_m < inf:
        raise ParameterError(f"cannot be {price_per_m:g}", where="strategy joint, price_per_m")
    if sweeps < 1:
        raise ParameterError(f"{sweeps} sweeps find nothing", where="strategy joint, sweeps")
    return Price(per_m=price_per_m) if price_per_m else Price(elasticity=_ELASTICITY)


def _reason(search: Exchange, what: str) -> str:
    return (
        f"{len(search.route)} stops {what}: {search.metres:.0f} m to go, "
        f"mean variance {search.variance:.3f} sills after them"
    )
