"""
Which of two strategies is better?
==================================

For a researcher who compares, and wants an interval and not a lucky field.

Fields differ far more from one another than strategies do on one field. So let both survey the
same fields, and look at the differences.
"""

# %%
# Ten simulated fields, each surveyed by both with the same seed. ``subsoil bench`` does the same
# with many fields and processes, and writes tables.

import numpy as np
from matplotlib.figure import Figure
from scipy import stats

import subsoil as ss
from subsoil.mapping.scores import rmse
from subsoil.simulation import draw_field

truths = [draw_field(np.random.default_rng(k), "signal") for k in range(10)]


def errors(strategy):
    """RMSE in kPa of a survey of 20 samples, field by field."""
    runs = [
        ss.simulate(truth.field, strategy, samples=20, seed=k, truth=truth)
        for k, truth in enumerate(truths)
    ]
    return np.array(
        [rmse(run.soil_map.mean, truth.kpa) for run, truth in zip(runs, truths, strict=True)]
    )


greedy, spread = errors("greedy"), errors("area-split")

# %%
# A Student's interval of the paired differences.

difference = spread - greedy
low, high = stats.ttest_1samp(difference, 0.0).confidence_interval(0.95)
print(f"area-split minus greedy: {difference.mean():.1f} kPa, 95 % from {low:.1f} to {high:.1f}")

# %%
# On the left each line is a field: the lines lie far apart, and most go down. On the right
# nothing is left but the differences: going to the cell of highest variance, as ``greedy`` does,
# leads along the edges of the field, and costs accuracy. The means alone, taken over other fields
# each, would not have told.

figure = Figure(figsize=(8, 4), layout="constrained")
left, right = figure.subplots(1, 2, width_ratios=[2, 1])
left.plot([0, 1], [greedy, spread], "o-", color="#2a5caa", alpha=0.6)
left.set_xticks([0, 1], ["greedy", "area-split"])
left.set(xlim=(-0.3, 1.3), ylabel="error of the map, RMSE (kPa)")
left.set_title("ten fields, each surveyed by both", loc="left", fontsize=10)
right.axhline(0, color="#1a1a1a", linewidth=1)
right.plot(np.zeros(10), difference, "o", color="#2a5caa", alpha=0.6)
right.errorbar(
    [0.4],
    [difference.mean()],
    [[difference.mean() - low], [high - difference.mean()]],
    fmt="s",
    color="#c2571a",
    capsize=6,
)
right.set_xticks([0, 0.4], ["fields", "mean, 95 %"])
right.set(xlim=(-0.3, 0.7), ylabel="area-split minus greedy (kPa)")
right.set_title("paired", loc="left", fontsize=10)
for axes in (left, right):
    axes.spines[["top", "right"]].set_visible(False)
figure
