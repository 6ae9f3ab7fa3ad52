"""Kriging: conditioning, prediction, following readings, leaving them out, dense maps."""

from subsoil.kriging.kriged import Kriged
from subsoil.kriging.kriged_at import KrigedAt, at_cells, at_targets
from subsoil.kriging.leave_one_out import LeaveOneOut, block_out, leave_one_out
from subsoil.kriging.ordinary import OrdinaryKriging, condition
from subsoil.kriging.prediction import Prediction

__all__ = [
    "Kriged",
    "KrigedAt",
    "LeaveOneOut",
    "OrdinaryKriging",
    "Prediction",
    "at_cells",
    "at_targets",
    "block_out",
    "condition",
    "leave_one_out",
]
