"""Joint planning: the stops and the way through them chosen together.

A design that maps best strings its stops far apart; the shortest way through many stops passes
where it learns little. Both strategies minimise the mean kriging variance of the map to come plus
a price on every metre (:mod:`subsoil.strategies.exchange`). ``joint`` does so before leaving;
``joint_adaptive`` goes on doing so after every sample, under what the samples say of the soil by
then.

Variance is in sills and judged under the pooled correlogram (:mod:`subsoil.variogram.pooled`),
which before the first samples is the prior.
"""

from __future__ import annotations

from dataclasses import replace
from math import inf

import numpy as np

from subsoil.errors import ParameterError
from subsoil.kriging.designs import Designs
from subsoil.strategies.coverage import area_split, carry_on
from subsoil.strategies.exchange import Exchange, Price
from subsoil.strategies.replicates import replicated
from subsoil.strategies.value import local_sills
from subsoil.strategies.view import Plan, View
from subsoil.variogram.nested import Nested
from subsoil.variogram.pooled import Pooled

_SKETCH_SWEEPS = 6
"""Sweeps of a plan that only tells how long it will take."""
_STARTS = 2
"""Annealings from different starts, of which the best counts."""
_WARM_SWEEPS = 2
"""Most sweeps after a sample."""


def joint(
    view: View,
    *,
    elasticity: float = 0.14,
    price_per_m: float = 0.0,
    sweeps: int = 40,
    most_pushes: int = 1,
) -> Plan:
    """Stops and way chosen together before leaving.

    Where there is a limit in metres or minutes, the plan keeps to it: as many stops, and as long a
    way, as make the best map in the time.

    Parameters
    ----------
    view
        The survey so far.
    elasticity
        Percent by which the mean variance may rise for a way that is one percent shorter.
    price_per_m
        Mean variance, in sills, that a metre of way is worth; in place of the elasticity unless
        it is zero.
    sweeps
        Sweeps of annealing over the stops.
    most_pushes
        Most pushes at a stop (:mod:`subsoil.strategies.replicates`).

    Raises
    ------
    ParameterError
        If a price is negative, there is no sweep or no push, or the time left is too short for a
        single stop.
    """
    price = _price(elasticity, price_per_m, sweeps)
    if not (view.fresh and view.remaining > 0):
        return carry_on(view)
    clock = Clock(view)
    sketch = _sketched(view, designs_for(view), clock, price)
    budget = clock.metres_for(len(sketch.route))
    tries = []
    for _ in range(_STARTS):
        search = _exchange(view, sketch.designs, _split(view, len(sketch.route)), sketch.price)
        search.anneal(sweeps, budget, view.rng)
        tries.append(search)
    best = min(tries, key=lambda s: (clock.late(s), s.variance if budget < inf else s.cost))
    while clock.late(best) and len(best.route) > 1:
        best.drop()
        best.descend(sweeps, inf, inf, view.rng)
    return replicated(Plan(best.route, _reason(best, "planned")), view, best, most_pushes)


def joint_adaptive(
    view: View,
    *,
    elasticity: float = 0.14,
    price_per_m: float = 0.0,
    sweeps: int = 40,
    first_change: int = 6,
    reach_m: float = 25.0,
    most_pushes: int = 1,
    weights: str = "equal",
) -> Plan:
    """Stops and way chosen together, and again after every sample.

    From the sixth sample on the stops still to make move to where they are worth most under the
    correlogram of the samples, the way never getting longer by it. Under a limit in minutes or
    metres a stop is dropped where time has become short, and put in where there is enough.

    Parameters
    ----------
    view
        The survey so far.
    elasticity, price_per_m, sweeps
        As in :func:`joint`.
    first_change
        Samples before the plan is changed for the first time: the first ones are a start design,
        without close pairs and without a transect.
    reach_m
        Distance in m by which a stop may move at a time.
    most_pushes
        As in :func:`joint`.
    weights
        How much the variance of a cell counts: ``"equal"`` for all the same, ``"value"`` by the
        local sill (:mod:`subsoil.strategies.value`).

    Raises
    ------
    ParameterError
        As :func:`joint`, and if there are no such weights.
    """
    _check_weights(weights)
    if view.fresh or not view.plan:
        return joint(
            view,
            elasticity=elasticity,
            price_per_m=price_per_m,
            sweeps=sweeps,
            most_pushes=most_pushes,
        )
    price, clock = _price(elasticity, price_per_m, sweeps), Clock(view)
    if len(view.visited) < first_change and not clock.is_ticking:
        return carry_on(view)
    search = _exchange(view, designs_for(view, weights), view.plan, price)
    _suit_to_time(search, clock, view.remaining)
    before, metres = search.route, search.metres
    search.descend(_WARM_SWEEPS, reach_m, metres, view.rng)
    plan = Plan(search.route, _reason(search, "moved to where they are worth most"))
    if search.metres > metres:
        plan = Plan(before, "as planned: no better without a longer way")
    return replicated(plan, view, search, most_pushes)


class Clock:
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

    def price(self, search: Exchange) -> Price:
        """What a metre is worth: what its time would bring as part of one more stop."""
        gain, detour = search.next_best()
        return Price(per_m=gain / (self._stop + detour / self._speed) / self._speed)


def designs_for(view: View, weights: str = "equal") -> Designs:
    """Judge of designs on a view's field, under what is known of its correlogram."""
    counts = local_sills(view) if weights == "value" else np.ones(len(view.field.cells))
    return Designs(view.field, _correlogram(view), counts)


def _correlogram(view: View) -> Nested:
    """The map's correlogram if it is pooled, else that of the samples, or the prior."""
    models = view.soil_map.variograms
    if view.visited and models and isinstance(models[0], Nested):
        return models[0]
    west, south, east, north = view.field.boundary.bounds
    pooled = Pooled().scaled_to(float(np.hypot(east - west, north - south)))
    return Nested(1.0, pooled.posterior(view.soil_map.at, view.soil_map.kpa).structures)


def _exchange(view: View, designs: Designs, route: tuple[int, ...], price: Price) -> Exchange:
    free = view.free
    free[list(view.plan)] = True
    return Exchange(
        designs,
        view.travel,
        view.field.cells,
        view.position,
        view.readings,
        route,
        free,
        price,
        view.metres,
    )


def _sketched(view: View, designs: Designs, clock: Clock, price: Price) -> Exchange:
    """Start of a plan: as many stops as there is time for, by halving."""

    def sketch(stops: int) -> Exchange:
        search = _exchange(view, designs, _split(view, stops), price)
        if clock.counts_minutes:
            search.anneal(_SKETCH_SWEEPS, inf, view.rng)
            if not price.per_m:
                search.price = clock.price(search)
                search.descend(_SKETCH_SWEEPS, inf, inf, view.rng)
        return search

    fewest, most = 1, clock.most_stops(view.remaining)
    if most < 1:
        raise ParameterError(
            "the time left is too short for a single stop",
            where="strategy joint",
            remedy="allow more minutes",
        )
    search = sketch(most)
    if not clock.counts_minutes or not clock.late(search):
        return search
    while most - fewest > 1:
        middle = (fewest + most) // 2
        tried = sketch(middle)
        if clock.late(tried):
            most = middle
        else:
            fewest, search = middle, tried
    return search if len(search.route) == fewest else sketch(fewest)


def _split(view: View, stops: int) -> tuple[int, ...]:
    """Route through the centres of some areas of equal size."""
    return area_split(replace(view, budget=len(view.visited) + stops)).cells


def _suit_to_time(search: Exchange, clock: Clock, most: int) -> None:
    """Drop stops there is no time for; put stops in as long as there is."""
    while clock.late(search) and len(search.route) > 1:
        search.drop()
    while len(search.route) < most:
        search.insert()
        if clock.late(search):
            search.drop()
            break


def _price(elasticity: float, price_per_m: float, sweeps: int) -> Price:
    for name, value in (("elasticity", elasticity), ("price_per_m", price_per_m)):
        if not 0 <= value < inf:
            raise ParameterError(f"cannot be {value:g}", where=f"strategy joint, {name}")
    if sweeps < 1:
        raise ParameterError(f"{sweeps} sweeps find nothing", where="strategy joint, sweeps")
    return Price(per_m=price_per_m) if price_per_m else Price(elasticity=elasticity)


def _check_weights(weights: str) -> None:
    if weights not in ("equal", "value"):
        raise ParameterError(
            f"there are no weights {weights!r}",
            where="strategy joint-adaptive",
            remedy="use equal or value",
        )


def _reason(search: Exchange, what: str) -> str:
    return (
        f"{len(search.route)} stops {what}: {search.metres:.0f} m to go, "
        f"mean variance {search.variance:.3f} sills after them"
    )
