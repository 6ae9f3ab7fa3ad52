"""
The nugget: filtered out, or taken for soil
===========================================

For somebody who wonders why the map does not pass through the readings.

Two pushes a hand's breadth apart differ. By default that difference, the nugget, is taken for what a single
push says beyond the soil, and filtered out. ``exact=True`` takes every reading at its word.
"""

# %%
# Thirty readings along a line in which the soil rises and falls slowly, and single pushes scatter.

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
model = ss.Spherical(nugget=90.0**2, range=60.0, psill=35_000.0)

# %%
# The same model conditions on the same readings, once filtering and once exact.

line = np.linspace(0, 120, 481)
targets = np.column_stack([line, np.zeros(481)])
filtered = ss.condition(model, at, kpa).predict(targets)
exact = ss.condition(model, at, kpa, exact=True).predict(targets)


def rmse(mean):
    """Root mean square error in kPa against the soil."""
    return float(np.sqrt(np.mean((mean - soil(line)) ** 2)))


# %%
# Exact kriging jumps to every reading and back: right where the map has to reproduce the readings, as in a
# benchmark, and no better anywhere else. For soil strength, filter.

figure = Figure(figsize=(7.5, 5.6), layout="constrained")
panels = figure.subplots(2, sharex=True, sharey=True)
for axes, found, name in zip(panels, (filtered, exact), ("filtered (default)", "exact=True"), strict=True):
    sd = np.sqrt(found.variance)
    axes.fill_between(line, found.mean - 2 * sd, found.mean + 2 * sd, color="#2a5caa", alpha=0.2)
    axes.plot(line, found.mean, color="#2a5caa", label="map ± 2 sd")
    axes.plot(line, soil(line), "--", color="#1a1a1a", linewidth=1, label="the soil")
    axes.plot(east, kpa, "o", color="#c2571a", markersize=4, label="readings")
    axes.set_title(f"{name}: {rmse(found.mean):.0f} kPa off the soil", loc="left")
    axes.set_ylabel("kPa")
panels[0].legend(ncols=3, fontsize=8, frameon=False, loc="upper right")
panels[1].set_xlabel("easting (m)")
figure
