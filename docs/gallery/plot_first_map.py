"""
A first map
===========

From sixty readings to a map of two layers, with how sure it is.
"""

import numpy as np

import subsoil as ss
from subsoil.plots import depth_slices, std_dev, variograms

# %%
# A field, and readings in it
# ---------------------------
# Places are easting and northing in metres. Here they are drawn, and the soil gets firmer to the
# north-east; :func:`subsoil.read_field` and :func:`subsoil.read_readings` take files instead.
rng = np.random.default_rng(1)
field = ss.Field.from_metres([(0, 0), (120, 0), (120, 80), (0, 80)])
at = rng.uniform((0, 0), (120, 80), (60, 2))
trend = 900 + 5 * at.sum(axis=1) + 150 * np.sin(at[:, 0] / 15)
kpa = np.column_stack([trend, trend + 300]) + rng.normal(0, 40, (60, 2))
readings = ss.Readings.of(at, [0.1, 0.2], kpa, field=field)
readings

# %%
# Variograms
# ----------
# One a layer, and in words how each was come by.
fits = ss.fit(readings, ss.Layers((0.0, 0.1, 0.2)))
fits

# %%
# The map
# -------
# ``soil.mean`` and ``soil.variance`` are arrays with layers first.
soil = ss.krige(field, readings, fits)
depth_slices(soil)

# %%
# How sure it is: the standard deviation grows away from the readings.
std_dev(soil)

# %%
# What the variograms stand on.
variograms(fits, soil)
