"""
Variograms, by name and of your own
===================================

For a geostatistician who wants to choose how variograms are estimated.

An estimator is a name, or a function from places and values to one model a layer. The default,
``pmc``, averages over what the readings leave open instead of fitting one curve.
"""

# %%
# The same 60 readings go to three estimators.

import numpy as np
from matplotlib.figure import Figure

import subsoil as ss
from subsoil.simulation import draw_truth

field = ss.Field.from_metres([(0, 0), (180, 0), (180, 130), (0, 130)])
layers = ss.Layers((0.0, 0.1, 0.2, 0.3, 0.4))
rng = np.random.default_rng(42)
readings = draw_truth(field, rng, layers).readings(rng.choice(len(field.cells), 60, replace=False))


def forty_metres(at, z):  # noqa: ARG001 - it knows beforehand
    """A range of 40 m and a third of the variance as nugget, whatever the readings say."""
    sills = [np.nanvar(layer) for layer in z]
    return [ss.Exponential(nugget=sill / 3, range=40.0, psill=2 * sill / 3) for sill in sills]


estimators = {"pmc": "pmc", "spherical": "spherical", "my own": forty_metres}
fits = {name: ss.fit(readings, layers, estimator) for name, estimator in estimators.items()}

# %%
# Every fit brings the bins of its samples and the numbers of pairs in them. ``why`` says how it
# came about.

spherical = fits["spherical"]
print(spherical[0].why)
figure = ss.plots.variograms(
    spherical, ss.krige(field, readings, spherical), caption="least squares"
)
figure

# %%
# Curves may differ a good deal and yet agree with the same bins. What they make of short
# distances, where there are hardly any pairs, decides how smooth the map becomes and how sure of
# itself.

figure = Figure(figsize=(7.5, 4.2), layout="constrained")
axes = figure.subplots()
bins = spherical[1].empirical
axes.scatter(
    bins.lag,
    bins.semivariance / 1000,
    s=bins.pairs,
    color="#1a1a1a",
    alpha=0.6,
    label="pairs of readings",
)
lag = np.linspace(0.1, bins.lag[-1], 200)
for name, found in fits.items():
    axes.plot(lag, ss.semivariance(found[1].variogram, lag) / 1000, label=name)
axes.set(xlim=0, ylim=0, xlabel="distance (m)", ylabel="semivariance (10³ kPa²)")
axes.set_title(f"{layers.names[1]} under three estimators", loc="left")
axes.legend(frameon=False)
figure
