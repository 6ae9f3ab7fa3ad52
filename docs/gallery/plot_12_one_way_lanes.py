"""
Lanes that are driven one way
=============================

For somebody whose robot keeps to the lanes of an orchard or a controlled-traffic field.

Where one may stop, and how far it is from here to there, is an ``Access``: five members, and no
class to inherit from. Strategies ask it for every distance, so that a plan keeps to lanes without
knowing of them.
"""

# %%
# Lanes lead east and west by turns, 15 m apart, and end at headlands that are driven both ways.
# One stops in lanes only.

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from matplotlib.figure import Figure

import subsoil as ss


@dataclass(frozen=True)
class Lanes:
    """Rows of cells driven one way, every third of the field; headlands west and east of them."""

    field: ss.Field
    is_symmetric = False

    @property
    def stops(self):
        """(N,) cells in a lane."""
        return self._row(self.at) % 3 == 1

    @property
    def at(self):
        """(N, 2) one stops at the centres."""
        return self.field.cells

    def between(self, a, b):
        """(k, l) metres: along the lane where it leads there, else by the headlands."""
        here, there = (np.asarray(places, dtype=float).reshape(-1, 2) for places in (a, b))
        here, there = here[:, None], there[None]
        leave, enter = self._end(here, out=True), self._end(there, out=False)
        around = (
            np.abs(leave - here[..., 0])
            + np.abs(enter - leave)
            + np.abs(there[..., 1] - here[..., 1])
            + np.abs(there[..., 0] - enter)
        )
        along = (there[..., 0] - here[..., 0]) * self._heading(here)
        direct = (self._row(here) == self._row(there)) & (along >= 0)
        return np.where(direct, np.hypot(*np.moveaxis(there - here, -1, 0)), around)

    def way(self, a, b):
        """(p, 2) places along the way: ends and bends."""
        here, there = np.asarray(a, dtype=float), np.asarray(b, dtype=float)
        if self.between(here, there)[0, 0] <= np.hypot(*(there - here)) + 1e-9:
            return np.array([here, there])
        leave, enter = self._end(here, out=True), self._end(there, out=False)
        bends = [[leave, here[1]], [enter, here[1]], [enter, there[1]]]
        return np.array([here, *bends, there])

    def _row(self, at):
        return np.floor((at[..., 1] - self.field.boundary.bounds[1]) / self.field.cell_size).astype(
            int
        )

    def _heading(self, at):
        """East 1, west -1."""
        return np.where(self._row(at) // 3 % 2 == 0, 1, -1)

    def _end(self, at, *, out):
        """Easting of the headland at which the lane of a place ends, or begins."""
        west, _, east, _ = self.field.boundary.bounds
        return np.where((self._heading(at) > 0) == out, east, west)


field = ss.Field.from_metres([(0, 0), (150, 0), (150, 105), (0, 105)])
lanes = Lanes(field)
start = (0.0, 7.5)

# %%
# The same strategy with and without lanes. On open land the way is short and crosses the lanes;
# with them it goes along each and comes back in the next.

plans = {
    "open land": ss.plan(field, "joint", samples=14, start=start),
    "one-way lanes": ss.plan(field, "joint", samples=14, start=start, access=lanes),
}
figure = Figure(figsize=(9.5, 3.9), layout="constrained")
for axes, (name, plan) in zip(figure.subplots(1, 2), plans.items(), strict=True):
    places = np.vstack([start, field.cells[list(plan.cells)]])
    for lane in range(7):
        north, heading = 7.5 + 15 * lane, 1 if lane % 2 == 0 else -1
        axes.axhspan(north - 2.5, north + 2.5, color="#efe6d5", zorder=0)
        for middle in (40, 110):
            axes.annotate(
                "",
                (middle + 9 * heading, north),
                (middle - 9 * heading, north),
                arrowprops={"arrowstyle": "->", "color": "#b39b6c"},
            )
    legs = [(a, b) if name == "open land" else lanes.way(a, b) for a, b in pairwise(places)]
    way = np.vstack(legs)
    axes.plot(*way.T, color="#2a5caa", linewidth=1.6)
    axes.plot(*places[1:].T, "o", color="white", markeredgecolor="black", markersize=6)
    axes.plot(*places[0], "s", color="#c2571a", markersize=7)
    metres = np.hypot(*np.diff(way, axis=0).T).sum()
    axes.set_title(f"{name}: {len(plan.cells)} stops, {metres:.0f} m", loc="left", fontsize=10)
    axes.set_aspect("equal")
    axes.set(xlim=(-4, 154), ylim=(-4, 109))
    axes.set_axis_off()
figure
