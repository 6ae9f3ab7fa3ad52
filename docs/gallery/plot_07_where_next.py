"""
Where to probe next
===================

For somebody with a few readings and an hour left.

:func:`subsoil.plan` goes on from a map: its readings count as taken. ``area-split`` goes to the
centres of equal areas, ``joint`` weighs stops and way against one another, and ``greedy`` names
the one next stop of highest variance.
"""

# %%
# Ten readings were taken along the gate side of the field.

import numpy as np
from matplotlib.figure import Figure

import subsoil as ss
from subsoil.simulation import draw_truth
from subsoil.stopping import forecast

field = ss.Field.from_metres([(0, 20), (170, 0), (190, 110), (90, 135), (10, 120)])
layers = ss.Layers((0.0, 0.2, 0.4))
rng = np.random.default_rng(50)
truth = draw_truth(field, rng, layers)
near = np.flatnonzero(field.cells[:, 1] < 55)
readings = truth.readings(rng.choice(near, 10, replace=False))
soil = ss.krige(field, readings, ss.fit(readings, layers))

# %%
# A plan is a list of cells in the order of the way, and a reason.

plans = {name: ss.plan(soil, name, samples=8) for name in ("area-split", "joint")}
for name, plan in plans.items():
    print(f"{name}: {plan.reason}")
greedy = ss.plan(soil, "greedy", samples=8)
print(f"greedy: {greedy.reason}")

# %%
# What a plan will bring follows from where its stops are, not from what they will say: the error
# that the map will expect of itself is known beforehand.

figure = Figure(figsize=(9.5, 4.0), layout="constrained")
panels = figure.subplots(1, 2, sharey=True)
grid = field.grid
for axes, (name, plan) in zip(panels, plans.items(), strict=True):
    way = np.vstack([field.entrance, field.cells[list(plan.cells)]])
    metres = np.hypot(*np.diff(way, axis=0).T).sum()
    expected = forecast(soil, plan.cells)[-1]
    deviation = grid.image(np.sqrt(soil.kv))
    image = axes.pcolormesh(grid.easting, grid.northing, deviation, cmap="magma")
    axes.plot(
        *soil.at.T, "o", color="white", markeredgecolor="black", markersize=5, label="readings"
    )
    axes.plot(*way.T, "-", color="white", linewidth=1.5)
    axes.plot(
        *way[1:].T, "s", color="#7fd4ff", markeredgecolor="black", markersize=7, label="planned"
    )
    axes.plot(
        *field.cells[greedy.cells[0]],
        "*",
        color="yellow",
        markeredgecolor="black",
        markersize=13,
        label="greedy",
    )
    axes.set_title(
        f"{name}: {metres:.0f} m, then {expected:.0f} kPa expected", loc="left", fontsize=10
    )
    axes.set_aspect("equal")
    axes.set_axis_off()
panels[0].legend(
    loc="lower center", bbox_to_anchor=(0.5, -0.14), ncols=3, frameon=False, fontsize=8
)
figure.colorbar(image, ax=panels, shrink=0.8, label="standard deviation now (kPa)")
figure
