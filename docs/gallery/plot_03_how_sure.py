"""
What the uncertainty means
==========================

For somebody who has to decide on the strength of a map: where may it be believed?

Every cell has a kriging standard deviation beside its mean. It is small near readings and large
far from them, and turns a map of kPa into a map of probabilities.
"""

# %%
# Readings in one part of the field only leave the rest uncertain.

import numpy as np
from matplotlib.figure import Figure

import subsoil as ss
from subsoil.mapping.uncertainty import probability_above
from subsoil.simulation import draw_truth

field = ss.Field.from_metres([(0, 0), (180, 0), (180, 100), (0, 100)], name="Home Piece")
layers = ss.Layers((0.0, 0.2, 0.4))
rng = np.random.default_rng(50)
truth = draw_truth(field, rng, layers)
west = np.flatnonzero(field.cells[:, 0] < 110)
readings = truth.readings(rng.choice(west, 40, replace=False))
soil = ss.krige(field, readings, ss.fit(readings, layers))
figure = ss.plots.std_dev(soil, caption="40 readings of a simulated soil, all in the west")
figure

# %%
# Along a line through the field, 95 of 100 places should lie within two standard deviations of
# the mean. The soil is known here, so this can be looked at. East of the last readings the band
# is as wide as the soil differs at all: the map falls back to the mean of the field.
#
# The question of an agronomist is rather: is it above 1.5 MPa here? Close to 0 or 1 the map has
# an answer, and around one half it has none.

row = np.flatnonzero(field.cells[:, 1] == 52.5)
east, mean, sd = field.cells[row, 0], soil.mean[1, row], np.sqrt(soil.variance[1, row])
figure = Figure(figsize=(7.5, 5.4), layout="constrained")
above, below = figure.subplots(2, sharex=True)
above.fill_between(
    east, mean - 2 * sd, mean + 2 * sd, color="#2a5caa", alpha=0.2, label="mean ± 2 sd"
)
above.plot(east, mean, color="#2a5caa", label="map")
above.plot(east, truth.kpa[1, row], color="#1a1a1a", linewidth=1, label="the soil")
above.axhline(1500, color="#c2571a", linestyle="--", label="1.5 MPa")
above.set_ylabel("0.2-0.4 m (kPa)")
above.legend(ncols=2, fontsize=8, frameon=False)
below.plot(east, probability_above(mean, sd, 1500.0), color="#c2571a")
below.set(ylim=(0, 1), xlabel="easting (m)", ylabel="probability above 1.5 MPa")
below.axhspan(0.2, 0.8, color="#e5e5e5")
below.text(2, 0.72, "undecided at 80 %", va="center", fontsize=8, color="#6b6b6b")
figure
