"""Surveys: events, the state that is their fold, what follows from it, and who goes where next."""

from subsoil.survey.decide import decision, settled, view
from subsoil.survey.dispatch import LocalDispatch, Memory, Observer, Recorder
from subsoil.survey.fold import apply, fold, opened, opening
from subsoil.survey.settings import DEFAULT_ESTIMATOR, DEFAULT_STRATEGY, Settings, checked
from subsoil.survey.state import Agent, Lease, Stop, Survey, estimator_of, fits_of, sample_of

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
