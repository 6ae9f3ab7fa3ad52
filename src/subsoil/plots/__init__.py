"""Pictures of a survey, each a function that returns the figure that it drew.

``figure=`` draws into a figure of yours or a part of one, within its size; without it a new one is
made. What ends in ``_panel`` draws into axes of yours, ``ax=``, and returns them. Nothing here
touches pyplot: figures have no window, and are saved by their own ``savefig`` or by :func:`save`.
matplotlib is loaded by the first picture that is made.
"""

from subsoil.plots.album import draw_readings, draw_survey
from subsoil.plots.depth import profiles, profiles_panel
from subsoil.plots.field import route, route_panel
from subsoil.plots.learning import learning_curves, outlook_curve, outlook_panel
from subsoil.plots.maps import depth_slices, layer_panel, std_dev
from subsoil.plots.saving import save, save_all
from subsoil.plots.semivariance import variogram_panel, variograms

__all__ = [
    "depth_slices",
    "draw_readings",
    "draw_survey",
    "layer_panel",
    "learning_curves",
    "outlook_curve",
    "outlook_panel",
    "profiles",
    "profiles_panel",
    "route",
    "route_panel",
    "save",
    "save_all",
    "std_dev",
    "variogram_panel",
    "variograms",
]
