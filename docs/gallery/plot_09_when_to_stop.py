"""
When is it enough?
==================

For somebody who pays by the hour.

After every sample the map knows what error it expects of itself, and what further samples would
make of it: variances follow from where samples are, not from what they say.
"""

# %%
# A survey of eight samples.

import numpy as np
from matplotlib.figure import Figure

import subsoil as ss
from subsoil.mapping.scores import rmse
from subsoil.simulation import draw_field
from subsoil.survey.outlook import in_words, outlook

truth = draw_field(np.random.default_rng(53), "signal")
run = ss.simulate(truth.field, samples=8, truth=truth, seed=1)

# %%
# The outlook in a sentence, as ``subsoil status`` says it.

ahead = outlook(run)
print(in_words(run, ahead))

# %%
# The soil is known here, so the promise can be held against what longer surveys of it came to.
# This field was picked because it keeps the promise: on eleven that were tried, the error after 8
# samples was 0.8 to 1.3 times what was expected, which is what ``80 % sure`` is for. The curve
# flattens: at some point another hour buys hardly anything. ``subsoil run`` stops there by itself
# with ``--target-rmse``, ``--min-gain`` or ``--minutes``.

numbers = [8, 14, 20, 28]
longer = [ss.simulate(truth.field, samples=number, truth=truth, seed=1) for number in numbers[1:]]
errors = [rmse(each.soil_map.mean, truth.kpa) for each in (run, *longer)]

figure = Figure(figsize=(7.5, 4.4), layout="constrained")
axes = figure.subplots()
samples = [ahead.samples, *(ahead.samples + entry.more for entry in ahead.ahead)]
expected = [ahead.rmse, *(entry.rmse for entry in ahead.ahead)]
axes.plot(samples, expected, color="#2a5caa", label="foreseen after 8 samples")
axes.plot(numbers, errors, "o", color="#c2571a", label="what longer surveys came to")
for entry in ahead.milestones:
    axes.annotate(
        f"{entry.more} more, {entry.minutes:.0f} min",
        (ahead.samples + entry.more, entry.rmse),
        xytext=(0, 42),
        textcoords="offset points",
        ha="center",
        fontsize=9,
        arrowprops={"arrowstyle": "-", "color": "#6b6b6b"},
    )
axes.set_xticks(range(5, 31, 5))
axes.set(
    ylim=(0, 1.3 * max(*expected, *errors)), xlabel="samples", ylabel="error of the map, RMSE (kPa)"
)
axes.legend(frameon=False, loc="lower left")
axes.spines[["top", "right"]].set_visible(False)
figure
