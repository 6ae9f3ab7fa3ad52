"""Pictures of a survey, each a function that returns a :class:`matplotlib.figure.Figure`.

Nothing here touches matplotlib's global state: figures have no window, and are saved by their own
``savefig``. matplotlib is loaded by the first picture that is made.
"""

from subsoil.plots.album import draw_readings, draw_survey, readings_figures, survey_figures
from subsoil.plots.depth import profiles
from subsoil.plots.learning import learning_curves, outlook_curve
from subsoil.plots.maps import depth_slices, std_dev
from subsoil.plots.semivariance import variograms

__all__ = [
    "depth_slices",
    "draw_readings",
    "draw_survey",
    "learning_curves",
    "outlook_curve",
    "profiles",
    "readings_figures",
    "std_dev",
    "survey_figures",
    "variograms",
]
