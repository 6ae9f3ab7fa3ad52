"""
The nugget: filtered out, or taken for soil
===========================================

For somebody who wonders why the map does not pass through the readings.

Two pushes a hand's breadth apart differ. By default that difference, the nugget, is taken for
what a single push says beyond the soil, and filtered out. ``exact=True`` takes every reading at
its word.
"""

# %%
# Readings along a line in which the soil rises and falls slowly, and single pushes scatter by 90
# kPa.

import numpy as np
from matplotlib.figure import Figure

import subsoil as ss

rng = np.random.default_rng(5)
east = np.sort(rng.uniform(0, 120, 30))


def soil(metres):
    """Resistance in kPa along the line."""
    return 1500 + 250 * np.sin(metres / 18)


kpa = soil(east) + rng.normal(0, 90, 30)
at = np.column_stack([east, np.zeros(30)])

# %%
# Filtered, exact, and a model that has no nugget at all.

model = ss.Spherical(nugget=90.0**2, range=60.0, psill=35_000.0)
without = ss.Spherical(nugget=0.0, range=60.0, psill=43_100.0)
line = np.union1d(np.linspace(0, 120, 481), east)
targets = np.column_stack([line, np.zeros_like(line)])
maps = {
    "filtered (default)": ss.condition(model, at, kpa).predict(targets),
    "exact=True": ss.condition(model, at, kpa, exact=True).predict(targets),
    "no nugget in the model": ss.condition(without, at, kpa).predict(targets),
}

# %%
# Exact kriging is the same map with a spike at every reading, and its band is that of a further
# push, nugget included. Without a nugget the map runs through every reading, is farther off, and
# is too sure of itself. For soil strength, filter; ``exact=True`` is for comparisons with classic
# kriging.

figure = Figure(figsize=(7.5, 7.2), layout="constrained")
panels = figure.subplots(3, sharex=True, sharey=True)
for axes, (name, found) in zip(panels, maps.items(), strict=True):
    sd = np.sqrt(found.variance)
    off = np.sqrt(np.mean((found.mean - soil(line)) ** 2))
    axes.fill_between(
        line, found.mean - 2 * sd, found.mean + 2 * sd, color="#2a5caa", alpha=0.2, linewidth=0
    )
    axes.plot(line, found.mean, color="#2a5caa", linewidth=1.2, label="map ± 2 sd")
    axes.plot(line, soil(line), "--", color="#1a1a1a", linewidth=1, label="the soil")
    axes.plot(east, kpa, "o", color="#c2571a", markersize=3.5, label="readings")
    axes.set_title(f"{name}: {off:.0f} kPa off the soil", loc="left", fontsize=10)
    axes.set_ylabel("kPa")
panels[0].legend(ncols=3, fontsize=8, frameon=False, loc="lower left")
panels[-1].set_xlabel("easting (m)")
figure
