"""
Is the map better than the mean?
================================

For somebody who is about to act on a map, and should ask first whether it says more than one
number would.

Every reading is left out once and predicted from the others. Skill compares the error with that
of the mean of the others: 1 is perfect, 0 no better than the mean.
"""

# %%
# One field is read twelve times, another day sixty times. It was picked to show both: of twelve
# fields whose soil is alike over more than 40 m, five had a layer without skill after twelve
# readings, and one after sixty.

import numpy as np
from matplotlib.figure import Figure

import subsoil as ss
from subsoil.mapping.skill import layer_scores, no_better_than_mean
from subsoil.simulation import draw_truth

field = ss.Field.from_metres([(0, 0), (180, 0), (180, 130), (0, 130)])
layers = ss.Layers((0.0, 0.1, 0.2, 0.3, 0.4))
rng = np.random.default_rng(50)
truth = draw_truth(field, rng, layers)


def scores_of(number):
    """Leave-one-out scores of every layer, from so many readings."""
    readings = truth.readings(rng.choice(len(field.cells), number, replace=False))
    fits = ss.fit(readings, layers)
    return list(layer_scores(readings.at, readings.layer_means(layers), fits.variograms))


few, many = scores_of(12), scores_of(60)

# %%
# Where a layer has no skill, this is said in words; ``subsoil map`` and ``subsoil cv`` say it
# too.

print(*no_better_than_mean(layers.names, few), sep="\n")

# %%
# The other number to look at is calibration, the mean square of errors in units of the standard
# deviation that was expected of them: 1 where the map is as wrong as it says.

figure = Figure(figsize=(8.5, 3.8), layout="constrained")
left, right = figure.subplots(1, 2)
rows = np.arange(len(layers))
for offset, scores, name in ((-0.2, few, "12 readings"), (0.2, many, "60 readings")):
    left.barh(rows + offset, [score.skill[0] for score in scores], 0.38, label=name)
    right.barh(rows + offset, [score.calibration[0] for score in scores], 0.38, label=name)
left.axvline(0, color="#1a1a1a", linewidth=1)
left.set_title("skill: above 0 beats the mean", loc="left", fontsize=10)
right.axvline(1, color="#1a1a1a", linewidth=1, linestyle="--")
right.set_title("calibration: 1 is honest", loc="left", fontsize=10)
for axes in (left, right):
    axes.set_yticks(rows, layers.names)
    axes.invert_yaxis()
    axes.spines[["top", "right"]].set_visible(False)
left.legend(frameon=False, fontsize=8, loc="best")
figure
