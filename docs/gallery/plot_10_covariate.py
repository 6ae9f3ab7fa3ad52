"""
A covariate: when it helps, and when it is left alone
=====================================================

For somebody with a conductivity or yield map of the field and few readings.

A map of something known everywhere can lend its pattern to the soil's, by kriging with external
drift. By default a layer follows it only where leaving readings out shows that it predicts
better.
"""

# %%
# Two maps come with the field: one of conductivity, which half has to do with the soil, and one
# that has not.

import numpy as np
from matplotlib.figure import Figure

import subsoil as ss
from subsoil.kriging.drift import Covariate
from subsoil.mapping.scores import rmse
from subsoil.simulation import draw_field

rng = np.random.default_rng(21)
truth, other = draw_field(rng, "signal"), draw_field(rng, "signal")
field, layers = truth.field, truth.layers


def standardised(values):
    """Deviations from the mean, in standard deviations."""
    return (values - values.mean()) / values.std()


clay = standardised(truth.kpa.mean(axis=0))
nothing = standardised(other.kpa.mean(axis=0))
conductivity = Covariate(field.cells, 30 + 5 * clay + 5 * nothing)
unrelated = Covariate(field.cells, 30 + 5 * nothing)

# %%
# Sixteen readings, mapped without, with the one and with the other. ``drift`` tells which layers
# follow.

readings = truth.readings(rng.choice(len(field.cells), 16, replace=False))
plain = ss.fit(readings, layers)
helped = ss.fit(readings, layers, covariate=conductivity)
not_helped = ss.fit(readings, layers, covariate=unrelated)
print(f"conductivity is followed in {len(helped.drift)} of {len(layers)} layers")
print(f"the unrelated map is followed in {len(not_helped.drift)}")

# %%
# One layer of the soil, beside what the readings make of it alone and with the conductivity map.

k = 4
alone = ss.krige(field, readings, plain).mean
followed = ss.krige(field, readings, helped).mean
pictures = {
    "the soil": truth.kpa,
    f"readings alone: RMSE {rmse(alone, truth.kpa):.0f} kPa": alone,
    f"with conductivity: RMSE {rmse(followed, truth.kpa):.0f} kPa": followed,
}
low, high = truth.kpa[k].min(), truth.kpa[k].max()
figure = Figure(figsize=(10, 3.0), layout="constrained")
panels = figure.subplots(1, 3)
for axes, (name, values) in zip(panels, pictures.items(), strict=True):
    image = axes.pcolormesh(
        field.grid.easting, field.grid.northing, field.grid.image(values[k]), vmin=low, vmax=high
    )
    axes.plot(*readings.at.T, "o", color="white", markeredgecolor="black", markersize=4)
    axes.set_title(name, loc="left", fontsize=10)
    axes.set_aspect("equal")
    axes.set_axis_off()
figure.colorbar(image, ax=panels, shrink=0.8, label=f"{layers.names[k]} (kPa)")
figure
