"""Ordinary kriging: conditioning, prediction, following readings, dense maps."""

from subsoil.kriging.estimate import Estimate, over
from subsoil.kriging.ordinary import OrdinaryKriging, condition
from subsoil.kriging.prediction import Prediction

__all__ = ["Estimate", "OrdinaryKriging", "Prediction", "condition", "over"]
