"""
A strategy of your own
======================

For a researcher with an idea of where to probe.

A strategy is one function from a :class:`subsoil.View`, the survey as far as it is known, to a
:class:`subsoil.Plan`. It is asked again after every sample. Hand it over as it is; nothing is
registered and nothing inherited.
"""

# %%
# This one cares about one question, whether the soil is above 1.5 MPa: of some cells drawn at
# random it takes the one that would lower the variance most where that is undecided, for the
# metres to it. ``kv_drop`` is the exact fall of the variance in every cell if one of the
# candidates were probed.

import numpy as np

import subsoil as ss


def near_the_threshold(view: ss.View) -> ss.Plan:
    """The cell that tells most about what is above 1.5 MPa, for the way to it."""
    free = np.flatnonzero(view.free)
    if not free.size or view.remaining < 1:
        return ss.Plan((), "nothing left to do")
    if not view.informed:
        return ss.Plan((int(view.rng.choice(free)),), "first stop, anywhere")
    off = (view.soil_map.profile_mean - 1500) / np.sqrt(view.soil_map.kv)
    tried = view.rng.choice(free, min(80, free.size), replace=False)
    gain = view.soil_map.kv_drop(tried) @ np.exp(-(off**2) / 2)
    (metres,) = view.access.between([view.position], view.access.at[tried])
    best = int(np.argmax(gain / (50 + metres)))
    return ss.Plan((int(tried[best]),), f"{metres[best]:.0f} m to where most is undecided")


# %%
# A simulated robot surveys with it. Soil, robot and strategy each draw from a stream of the one
# seed.

field = ss.Field.from_metres([(0, 20), (170, 0), (190, 110), (90, 135), (10, 120)])
layers = ss.Layers((0.0, 0.1, 0.2, 0.3, 0.4))
run = ss.simulate(field, near_the_threshold, samples=25, seed=7, layers=layers)
run

# %%
# The white line is its way, from the square on.

figure = ss.plots.depth_slices(run, caption="a strategy of one's own, simulated")
figure
