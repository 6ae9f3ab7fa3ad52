"""Exchange search for a design and the way through it together.

Stops are taken out of the route one by one; every free cell, put in where it lengthens the way
least, is weighed against the others by what it would leave of the mean kriging variance plus a
price on its metres; and one is drawn. At a temperature the draw is a Gibbs sampler's (heat bath;
Geman & Geman 1984, IEEE PAMI 6, 721), and cooling it anneals; at zero the best is taken, as in
Fedorov's exchange algorithm (*Theory of Optimal Experiments*, 1972; for maps, Royle 2002, Comput.
Geosci. 28, 479). Unlike proposals that are tried at random, no draw is lost.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import exp, inf

import numpy as np

from subsoil.arrays import Bools, Floats, Integers
from subsoil.kriging.designs import Designs
from subsoil.strategies.joint.detours import Detours
from subsoil.strategies.joint.options import Options, drawn
from subsoil.strategies.joint.price import Price, SweepOptions
from subsoil.ways.access import Access

_HOT, _COLD = 3e-4, 1e-5
"""First and last temperature of annealing, in units of the sill."""
_MULTIPLIER_STEP = 0.3
"""Growth of the logarithm of the price per excess of the way over its budget."""
_FEWEST = 2
"""Readings that a map needs: without any there is no variance to compare."""
_MOST_WEIGHED = 1200
"""Cells weighed for a stop at a time, at most: what keeps large fields from taking minutes."""
_PRICE_RISE, _PRICE_RISES = 1.1, 30
"""Factor on the price while the optimum exceeds the budget, and how often it is applied."""


class Exchange:
    """A design that is being improved, with the way through its stops.

    Parameters
    ----------
    designs
        What judges designs.
    access
        Ways between the N cells of the field.
    start
        Where the way begins.
    fixed
        Cells probed already: they are in the design and not in the way.
    route
        Cells still to probe, in order.
    free
        (N,) cells that may be probed; those of the design are left out by themselves.
    price
        What a metre is worth.
    driven
        Metres driven before, which count as part of the way.
    """

    def __init__(
        self,
        designs: Designs,
        access: Access,
        start: tuple[float, float],
        fixed: Sequence[int],
        route: Sequence[int],
        free: Bools,
        price: Price,
        driven: float = 0.0,
    ) -> None:
        self.designs = designs
        self._cell_count = len(access.at)
        self._cells = [*fixed, *route]
        self._order = list(range(len(fixed), len(self._cells)))
        self._open = free.copy()
        self._open[self._cells] = False
        c, g = (
            designs.covariances(self._cells)
            if self._cells
            else (np.empty((0, self._cell_count)),) * 2
        )
        self._c = np.concatenate([c, np.ones((1, self._cell_count))])
        self._g = np.concatenate([g, designs.average[None]])
        self._detours = Detours(access, self._cells, start)
        self.price, self._dearer, self._driven = price, 1.0, driven
        self.refresh()

    @property
    def route(self) -> tuple[int, ...]:
        """Cells to visit, in order."""
        return tuple(self._cells[slot] for slot in self._order)

    @property
    def metres(self) -> float:
        """Length of the way."""
        return float(sum(self._legs(self._order)))

    @property
    def variance(self) -> float:
        """Mean kriging variance of the whole design, in sills."""
        return self.designs.variance_left(self._inverse, self._gram)

    @property
    def cost(self) -> float:
        """What the search minimises, at the price as given."""
        return self.price.cost(self.variance, self._driven + self.metres)

    def refresh(self) -> None:
        """Solve the design's system anew: exchanges update it, and rounding adds up."""
        self._inverse = self.designs.inverse(self._c[:-1, self._cells])
        self._gram = self.designs.gram(self._cells, self._g[:-1])

    def anneal(self, sweeps: int, budget_m: float, rng: np.random.Generator) -> None:
        """Exchange every stop once a sweep while the temperature falls, then to the optimum.

        Parameters
        ----------
        sweeps
            Number of sweeps before those to the optimum.
        budget_m
            Length in m that the way is to keep to, by a higher or lower price; infinite to hold
            the price. A budget too short for the stops is overrun.
        rng
            Source of the draws.
        """
        for temperature in np.geomspace(_HOT, _COLD, sweeps).tolist():
            self._sweep(SweepOptions(temperature), rng)
            if budget_m < inf:
                self._dearer *= exp(_MULTIPLIER_STEP * (self.metres / budget_m - 1.0))
        self.descend(sweeps, SweepOptions(), rng)
        for _ in range(_PRICE_RISES):
            if self.metres <= budget_m:
                break
            self._dearer *= _PRICE_RISE
            self.descend(sweeps, SweepOptions(), rng)
        self.descend(sweeps, SweepOptions(budget_m=budget_m), rng)

    def descend(self, most: int, sweep: SweepOptions, rng: np.random.Generator) -> None:
        """Sweep until nothing changes, at most so often; the draws order the stops."""
        for _ in range(most):
            if not self._sweep(sweep, rng):
                break

    def next_best(self) -> tuple[float, float]:
        """What the cell worth most would bring: fall of the mean variance, and metres of detour."""
        options, best = self._best()
        return float(options.gain[best]), float(options.detour[best])

    def insert(self) -> None:
        """Put in the cell that is worth most."""
        options, best = self._best()
        slot, cell = len(self._cells), int(options.cells[best])
        c, g = self.designs.covariances([cell])
        self._c = np.insert(self._c, slot, c, axis=0)
        self._g = np.insert(self._g, slot, g, axis=0)
        self._detours.insert(slot, cell)
        self._cells.append(cell)
        self._open[cell] = False
        self._order.insert(int(options.gap[best]), slot)
        self.refresh()

    def drop(self) -> None:
        """Take out the stop that is worth least."""
        kept = [self._loss(slot) for slot in self._order]
        slot = self._order[int(np.argmin(kept))]
        self._open[self._cells.pop(slot)] = True
        self._order = [other - (other > slot) for other in self._order if other != slot]
        self._c, self._g = (np.delete(rows, slot, axis=0) for rows in (self._c, self._g))
        self._detours.delete(slot)
        self.refresh()

    def _best(self) -> tuple[Options, int]:
        options = self._options(self._inverse, self._order, slice(None))
        objective = self._a_metre() * options.detour - options.gain
        objective[~self._open] = inf
        return options, int(np.argmin(objective))

    def _loss(self, slot: int) -> float:
        """By how much the objective grows without a stop."""
        order = [other for other in self._order if other != slot]
        left = self.designs.variance_left(self._without(slot), self._gram)
        shorter = self.metres - sum(self._legs(order))
        return left - self.variance - self._a_metre() * shorter

    def _sweep(self, sweep: SweepOptions, rng: np.random.Generator) -> bool:
        """Exchange every stop once and shorten the way; whether anything changed."""
        if len(self._cells) < _FEWEST or not self._order:
            return False
        self.refresh()
        a_metre = self._a_metre() if sweep.budget_m == inf else 0.0
        before = self.route
        for slot in rng.permutation(np.sort(self._order)).tolist():
            self._exchange(slot, sweep, a_metre, rng)
        self._shorten()
        return self.route != before

    def _exchange(
        self, slot: int, sweep: SweepOptions, a_metre: float, rng: np.random.Generator
    ) -> None:
        """Take a stop out and put one in, the same or another, at its best place in the way."""
        self._open[self._cells[slot]] = True
        order = [other for other in self._order if other != slot]
        without = self._without(slot)
        options = self._options(without, order, self._weighed(slot, sweep.reach_m, rng))
        objective = a_metre * options.detour - options.gain
        objective[~self._open[options.cells]] = inf
        if sweep.budget_m < inf:
            now = options.detour[options.cells == self._cells[slot]][0]
            objective[options.detour > max(sweep.budget_m - sum(self._legs(order)), now)] = inf
        chosen = drawn(objective, sweep.temperature, rng)
        self._order = order
        self._order.insert(int(options.gap[chosen]), slot)
        self._put(slot, int(options.cells[chosen]))
        weight, own = options.weights[:, chosen], options.own[chosen]
        self._inverse = without + np.outer(weight, weight / own)
        self._inverse[slot] = self._inverse[:, slot] = -weight / own
        self._inverse[slot, slot] = 1.0 / own

    def _weighed(self, slot: int, reach_m: float, rng: np.random.Generator) -> Integers | slice:
        """Cells to weigh for a stop: those within reach, of many some that are drawn, and its own.

        All cells come as a slice, which copies nothing.
        """
        if reach_m == inf and self._cell_count <= _MOST_WEIGHED:
            return slice(None)
        near = self._detours.near(slot, reach_m)
        if len(near) <= _MOST_WEIGHED:
            return near
        drawn = rng.choice(near, _MOST_WEIGHED, replace=False)
        return np.union1d(drawn, [self._cells[slot]])

    def _put(self, slot: int, cell: int) -> None:
        self._open[cell] = False
        if cell == self._cells[slot]:
            return
        self._cells[slot] = cell
        (self._c[slot],), (self._g[slot],) = self.designs.covariances([cell])
        self._detours.put(slot, cell)
        self._gram[:, slot] = self._g[:, cell]
        self._gram[slot] = self._gram[:, slot]

    def _without(self, slot: int) -> Floats:
        """Inverse of the system without a reading, as large as with it: zero where it was."""
        column = self._inverse[:, slot]
        inverse = self._inverse - np.outer(column, column / column[slot])
        inverse[slot] = inverse[:, slot] = 0.0
        return inverse

    def _options(self, inverse: Floats, order: Sequence[int], columns: Integers | slice) -> Options:
        """What each of some cells would bring to a design."""
        c, designs = self._c[:, columns], self.designs
        weights = inverse @ c
        own = 1.0 - np.einsum("nq,nq->q", weights, c)
        joint = self._gram @ weights
        joint -= 2.0 * self._g[:, columns]
        gain = (designs.squares[columns] + np.einsum("nq,nq->q", weights, joint)) / own
        detour, gap = self._detours.of(order, self._legs(order), columns)
        cells = np.arange(self._cell_count)[columns]
        return Options(cells, gain, own, weights, detour, gap)

    def _legs(self, order: Sequence[int]) -> list[float]:
        """Metres from each stop of a way to the next, from the start on."""
        return self._detours.legs(order, [self._cells[slot] for slot in order])

    def _shorten(self) -> None:
        self._order = self._detours.shortened(self._order, self.route)

    def _a_metre(self) -> float:
        """Mean variance, in sills, that a metre is worth where the search stands."""
        return self._dearer * self.price.at(self.variance, self._driven + self.metres)
