"""Surveys: events, the state that is their fold, what follows from it, and who goes where next."""

from subsoil.survey.agents import Agent, Lease, Stop
from subsoil.survey.decide import decision, settled, view
from subsoil.survey.dispatch import LocalDispatch
from subsoil.survey.fold import apply, fold, opened, opening
from subsoil.survey.measured import estimator_of, fits_of, sample_of
from subsoil.survey.recorder import Memory, Observer, Recorder
from subsoil.survey.settings import DEFAULT_ESTIMATOR, DEFAULT_STRATEGY, Settings, checked
from subsoil.survey.state import Survey

__all__ = [
    "DEFAULT_ESTIMATOR",
    "DEFAULT_STRATEGY",
    "Agent",
    "Lease",
    "LocalDispatch",
    "Memory",
    "Observer",
    "Recorder",
    "Settings",
    "Stop",
    "Survey",
    "apply",
    "checked",
    "decision",
    "estimator_of",
    "fits_of",
    "fold",
    "opened",
    "opening",
    "sample_of",
    "settled",
    "view",
]
