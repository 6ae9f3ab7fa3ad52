"""Further pushes at a stop: where the soil between two holes varies so much that they pay.

A push beside the last one costs no drive, and halves, or thirds, the noise of its stop. It tells
nothing of the soil further away, as another stop would. What either brings is the fall of the mean
kriging variance (:mod:`subsoil.kriging.designs`), exact before it is made: a repeat is one more
reading in the same cell.

Off by default, since it rarely pays. With the correlogram known, two pushes at every stop in place
of more stops in 20-45 minutes change the RMSE of the test bed by +2 to +10 % at a nugget of 10 % of
the sill, by -1 to +2 % at 40 %, by 0 to -2 % at 70 % and by -2 to -3 % at 85 %. In surveys of 35
minutes with the pooled correlogram, trading by the rule below chose no push on 14 ``signal`` fields
of 10-40 % nugget, none on 3 ``surrogate`` ones, and few at 70 %: few samples seldom tell that a
nugget is large. Two pushes everywhere, whatever the samples say, made 16 fields of 70 % better
(-7.6 +- 3.2 %) and 16 of 10-40 % worse (+3.7 +- 2.2 %).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from math import inf

import numpy as np

from subsoil.arrays import Floats
from subsoil.errors import ParameterError
from subsoil.kriging.designs import Designs
from subsoil.strategies.joint.exchange import Exchange
from subsoil.strategies.view import Plan, View

Stops = tuple[int, ...]

_LEAST_GAIN = 0.005
"""Share of the mean variance that stops given up for pushes must save."""
_PATIENCE = 3
"""Stops given up in vain before no more are."""


def push_gains(designs: Designs, readings: Sequence[int], stops: Sequence[int]) -> Floats:
    """Fall of the mean variance by one more push at each stop.

    Parameters
    ----------
    designs
        What judges designs.
    readings
        Cells of all readings taken or planned, as often as they are pushed.
    stops
        (k,) cells to push once more.

    Returns
    -------
    ndarray
        (k,) in sills.

    Examples
    --------
    >>> from subsoil.land.field import Field
    >>> from subsoil.variogram import Exponential, Nested, Structure
    >>> field = Field.from_metres([(0, 0), (60, 0), (60, 40), (0, 40)])
    >>> for share in (0.99, 0.3):
    ...     shape = Nested(1.0, (Structure(share, Exponential, 45.0),))
    ...     designs = Designs(field, shape, np.ones(len(field.cells)))
    ...     push_gains(designs, [20, 30, 65, 75], [20]).round(4)
    array([0.0006])
    array([0.0328])
    """
    inverse, gram = _solved(designs, readings)
    c, g = designs.covariances(stops)
    c = np.concatenate([c[:, list(readings)], np.ones((len(c), 1))], axis=1).T
    g = np.concatenate([g[:, list(readings)], designs.average[list(stops), None]], axis=1).T
    weights = inverse @ c
    own = 1.0 - np.einsum("nk,nk->k", weights, c)
    joint = np.einsum("nk,nk->k", weights, gram @ weights - 2.0 * g)
    return np.asarray((designs.squares[list(stops)] + joint) / own)


def replicates(
    designs: Designs,
    readings: Sequence[int],
    stops: Stops,
    most_pushes: int,
    push_s: float,
    *,
    worth: float = 0.0,
    seconds: float = inf,
) -> Stops:
    """Pushes to make at each stop: one, and further ones where they are worth their time.

    The push that brings most is added first, and again until there is no time for another or none
    brings enough.

    Parameters
    ----------
    designs
        What judges designs.
    readings
        Cells of the readings taken so far.
    stops
        Cells still to probe.
    most_pushes
        Most pushes at a stop.
    push_s
        Time of a further push in s.
    worth
        Mean variance, in sills, that a second is worth: what a new stop brings by its time.
    seconds
        Time there is for further pushes in s.
    """
    pushes = np.ones(len(stops), dtype=np.int64)
    everything = [*readings, *stops]
    while push_s <= seconds and (pushes < most_pushes).any():
        gains = np.where(pushes < most_pushes, push_gains(designs, everything, stops), -inf)
        best = int(np.argmax(gains))
        if not gains[best] > worth * push_s:
            break
        pushes[best] += 1
        everything.append(stops[best])
        seconds -= push_s
    return tuple(pushes.tolist())


def replicated(plan: Plan, view: View, search: Exchange, most_pushes: int) -> Plan:
    """Add further pushes to a plan of one push a stop, where they make a better map.

    Without a limit in minutes all stops are kept, and pushes added that bring more in their time
    than the next stop would. With one, stops that bring least by their time are given up for
    pushes as long as that lowers the mean variance; the plan stays as it is unless that saves half
    a percent.

    Parameters
    ----------
    plan
        The plan.
    view
        The survey so far.
    search
        What found the plan.
    most_pushes
        Most pushes at a stop.

    Raises
    ------
    ParameterError
        If there is not at least one push a stop.
    """
    if most_pushes < 1:
        raise ParameterError(f"{most_pushes} pushes read nothing", where="strategy, most_pushes")
    if most_pushes == 1 or not plan.cells:
        return plan
    if view.minutes_left < inf:
        stops, pushes = _traded(view, search.designs, plan.cells, most_pushes)
    else:
        gain, detour = search.next_best()
        worth = gain / (60.0 * view.pace.minutes(detour, 1))
        readings, push_s = view.readings, view.pace.push_s
        stops, pushes = (
            plan.cells,
            replicates(search.designs, readings, plan.cells, most_pushes, push_s, worth=worth),
        )
    if sum(pushes) <= len(stops):
        return plan
    return Plan(stops, f"{plan.reason}; {sum(pushes)} pushes at {len(stops)} stops", pushes)


def _traded(view: View, designs: Designs, route: Stops, most_pushes: int) -> tuple[Stops, Stops]:
    """Give stops up for pushes within the time left."""
    plain = designs.mean_variance([*view.readings, *route])
    best, lowest, in_vain = (route, (1,) * len(route)), plain, 0
    stops = route
    while in_vain < _PATIENCE and len(stops) > 1:
        saved = _savings(view, stops)
        spare = 60.0 * view.minutes_left - _seconds(view, stops)
        pushes = replicates(
            designs, view.readings, stops, most_pushes, view.pace.push_s, seconds=spare
        )
        left = designs.mean_variance([*view.readings, *_spread(stops, pushes)])
        in_vain = 0 if left < lowest else in_vain + 1
        best, lowest = ((stops, pushes), left) if left < lowest else (best, lowest)
        if min(pushes) == most_pushes:
            break
        losses = _losses(designs, [*view.readings, *_spread(stops, pushes)], stops)
        least = int(np.argmin(losses / saved))
        stops = (*stops[:least], *stops[least + 1 :])
    return best if lowest < (1.0 - _LEAST_GAIN) * plain else (route, ())


def _solved(designs: Designs, readings: Sequence[int]) -> tuple[Floats, Floats]:
    """(n + 1, n + 1) inverse of the system of readings, and its G."""
    c, g = designs.covariances(readings)
    return designs.inverse(c[:, list(readings)]), designs.gram(readings, g)


def _losses(designs: Designs, readings: Sequence[int], stops: Stops) -> Floats:
    """(k,) growth of the mean variance without the readings of a stop, were they apart.

    Exact for a stop pushed once: its row and column leave the inverse by a downdate.
    """
    inverse, gram = _solved(designs, readings)
    each = np.einsum("in,nm,mi->i", inverse, gram, inverse, optimize=True) / np.diag(inverse)
    cells = np.array(readings)
    return np.array([each[:-1][cells == cell].sum() for cell in stops])


def _seconds(view: View, stops: Stops) -> float:
    """Time of a way and one push at each of its stops, in s."""
    away = _away(view, stops)
    return 60.0 * view.pace.minutes(float(np.trace(away, offset=1)), len(stops))


def _savings(view: View, stops: Stops) -> Floats:
    """(k,) time in s saved by leaving a stop out."""
    away, k = _away(view, stops), np.arange(1, len(stops) + 1)
    metres = away[k - 1, k].copy()
    metres[:-1] += away[k[:-1], k[1:]] - away[k[:-1] - 1, k[1:]]
    return np.asarray(metres / view.pace.speed_mps + view.pace.stop_s)


def _away(view: View, stops: Stops) -> Floats:
    """(k + 1, k + 1) metres between the agent's place and k stops."""
    places = np.concatenate([np.array([view.position]), view.access.at[list(stops)]])
    return np.asarray(view.access.between(places, places))


def _spread(stops: Stops, pushes: Stops) -> list[int]:
    """Cells of all pushes."""
    return list(Counter(dict(zip(stops, pushes, strict=True))).elements())
