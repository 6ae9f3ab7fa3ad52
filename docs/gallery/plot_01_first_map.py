"""
A first map from readings
=========================

For somebody who has readings in arrays and wants a map of the field.

Three calls lead from readings to a map: :func:`subsoil.fit` estimates how soil differs with
distance in every layer, :func:`subsoil.krige` makes the map, and a function of ``plots`` draws
it.
"""

# %%
# A field is an outline in metres. :func:`subsoil.read_field` reads one from a file instead.

import numpy as np

import subsoil as ss
from subsoil.simulation import draw_truth

field = ss.Field.from_metres(
    [(0, 20), (170, 0), (190, 110), (90, 135), (10, 120)], name="Long Acre"
)
layers = ss.Layers((0.0, 0.1, 0.2, 0.3, 0.4))

# %%
# The readings here are pushes in a simulated soil, at 40 places drawn at random. With readings of
# your own write ``ss.Readings.of(at, depth_m, kpa, field=field)``, or
# :func:`subsoil.read_readings` for a file.

rng = np.random.default_rng(50)
truth = draw_truth(field, rng, layers)
readings = truth.readings(rng.choice(len(field.cells), 40, replace=False))
readings

# %%
# One variogram a layer: soil differs by the nugget from one push to the next, and by the sill
# between places farther apart than the range.

fits = ss.fit(readings, layers)
print(fits)

# %%
# The map knows the mean and the variance of every layer in every cell. Circles are the readings.

soil = ss.krige(field, readings, fits)
figure = ss.plots.depth_slices(soil, caption="40 readings of a simulated soil")
figure
