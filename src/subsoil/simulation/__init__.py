"""Soils that are known everywhere, and a robot to survey them with."""

from subsoil.simulation.conditional import conditional_truth
from subsoil.simulation.fields import Scheme, draw_field, draw_truth
from subsoil.simulation.probe import Machine, push
from subsoil.simulation.robot import SimulatedRobot
from subsoil.simulation.soil import Soil
from subsoil.simulation.surrogate import surrogate
from subsoil.simulation.truth import Conditioned, Kriged, Truth

__all__ = [
    "Conditioned",
    "Kriged",
    "Machine",
    "Scheme",
    "SimulatedRobot",
    "Soil",
    "Truth",
    "conditional_truth",
    "draw_field",
    "draw_truth",
    "push",
    "surrogate",
]
