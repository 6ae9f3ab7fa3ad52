"""Ordinary kriging: conditioning, prediction, following readings, dense maps."""

from subsoil.kriging.estimate import Estimate, over
from subsoil.kriging.ordinary import OrdinaryKriging, Prediction, condition

__all__ = ["Estimate", "OrdinaryKriging", "Prediction", "condition", "over"]
