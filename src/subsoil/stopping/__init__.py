"""When a survey has had enough, and what more probing would buy."""

from subsoil.stopping.costs import Pace, Rates, Spent
from subsoil.stopping.forecast import forecast, further
from subsoil.stopping.goals import (
    DecidedShare,
    Goal,
    GoalProgress,
    LeastGain,
    SureRmse,
    TargetRmse,
    first_stop,
)
from subsoil.stopping.limits import FEWEST, Limits

__all__ = [
    "FEWEST",
    "DecidedShare",
    "Goal",
    "GoalProgress",
    "LeastGain",
    "Limits",
    "Pace",
    "Rates",
    "Spent",
    "SureRmse",
    "TargetRmse",
    "first_stop",
    "forecast",
    "further",
]
