"""What follows from the state of a survey without anything from outside.

Variograms are estimated anew on schedule, the strategy plans after every stop, and the survey
finishes when a limit or a goal is reached. Each is an event that is a pure function of the state,
and of the modules whose strategies the user allows (:mod:`subsoil.strategies`).
"""

from __future__ import annotations

from math import nan

import numpy as np

from subsoil.errors import brief
from subsoil.mapping.drift_choice import learn
from subsoil.registry import NOBODY, Allowed
from subsoil.strategies import Plan, View, planned, strategy_named
from subsoil.survey.events import Event, Finished, Fitted, Planned
from subsoil.survey.fold import apply
from subsoil.survey.measured import estimator_of
from subsoil.survey.records import fit_record
from subsoil.survey.state import NEVER, Survey

_STRATEGY_STREAM = 2
_FEW = 12
"""Samples up to which variograms are estimated anew after each, whatever the schedule."""


def settled(survey: Survey, allowed: Allowed = NOBODY) -> tuple[Survey, tuple[Event, ...]]:
    """Run what follows from a state to where an agent is needed, or the survey is finished.

    Parameters
    ----------
    survey
        State to go on from.
    allowed
        Modules whose strategies may be run, beside the registered ones.

    Returns
    -------
    tuple
        The state then, and the events that lead there.
    """
    events: list[Event] = []
    while (event := decision(survey, allowed)) is not None:
        survey = apply(survey, event)
        events.append(event)
    return survey, tuple(events)


def decision(survey: Survey, allowed: Allowed = NOBODY) -> Event | None:
    """What follows next from the state alone; ``None`` where that must come from an agent."""
    if survey.finished:
        return None
    if survey.taken and _refit_due(survey):
        return _fit(survey, allowed)
    if reason := survey.settings.limits.reached(survey.spent):
        return Finished(reason=reason)
    if _plan_due(survey):
        return _plan(survey, allowed)
    if reason := _enough(survey):
        return Finished(reason=reason)
    return None


def view(survey: Survey) -> View:
    """The survey as its strategy sees it."""
    settings = survey.settings
    key = np.random.SeedSequence(settings.seed, spawn_key=(_STRATEGY_STREAM, survey.step))
    return View(
        field=survey.field,
        access=survey.access,
        soil_map=survey.soil_map,
        position=survey.position,
        plan=survey.plan.cells,
        visited=survey.visited,
        refused=survey.refused,
        budget=settings.samples,
        fresh=survey.planned_at == NEVER,
        rng=np.random.default_rng(key),
        metres=survey.metres,
        pace=settings.pace,
        metres_left=settings.metres - survey.metres,
        minutes_left=settings.minutes - survey.minutes,
        pushes=survey.plan.pushes,
        repeats=survey.repeats,
        taken=survey.taken,
        leased=tuple(lease.cell for lease in survey.leases if not lease.made),
    )


def _refit_due(survey: Survey) -> bool:
    """Whether variograms are due: often while samples are few, on schedule, and at the end."""
    taken, settings = survey.taken, survey.settings
    on_schedule = taken % settings.refit_every == 0 or taken >= settings.samples
    due = taken <= _FEW or on_schedule or survey.corrected
    return survey.changes != survey.fitted_at and due


def _plan_due(survey: Survey) -> bool:
    """Whether to plan: after every stop, and where all that was planned is on somebody's way."""
    if survey.planned_at != survey.step:
        return True
    left = survey.settings.samples - survey.taken - sum(not each.made for each in survey.leases)
    all_on_way = bool(survey.leases) and not survey.plan.cells and left > 0
    return all_on_way and survey.planned_for != survey.assigned


def _fit(survey: Survey, allowed: Allowed) -> Fitted:
    soil_map, rule = survey.soil_map, survey.settings.drift
    estimator = estimator_of(survey, allowed)
    learnt = learn(soil_map.at, soil_map.kpa, soil_map.covariate, estimator, rule)
    return Fitted(
        samples=survey.taken,
        fits=tuple(fit_record(fit) for fit in learnt.fits),
        drift=learnt.drift,
    )


def _plan(survey: Survey, allowed: Allowed) -> Planned:
    settings = survey.settings
    strategy = strategy_named(settings.strategy, settings.strategy_settings, allowed)
    plan = planned(strategy, view(survey), f"strategy {brief(settings.strategy)}")
    kept = survey.planned_at != NEVER and (plan.cells, plan.pushes) == (
        survey.plan.cells,
        survey.plan.pushes,
    )
    return Planned(
        step=survey.step,
        cells=() if kept else plan.cells,
        kept=kept,
        reason=plan.reason,
        mean_kv=survey.mean_kv,
        measures=_measures(survey, plan),
        pushes=() if kept else plan.pushes,
    )


def _measures(survey: Survey, plan: Plan) -> tuple[float, ...]:
    """What the goals measure; nothing can be said of a map of one sample."""
    goals = survey.settings.goals
    if survey.taken < 2:
        return (nan,) * len(goals)
    return tuple(goal.measure(survey.soil_map, plan.cells) for goal in goals)


def _enough(survey: Survey) -> str:
    """Why to stop once the plan is made; empty to go on to its next stop, or to wait for others."""
    settings = survey.settings
    if reason := survey.goal_progress.reached(settings.goals):
        return reason
    if not survey.plan.cells:
        return "" if survey.leases else survey.plan.reason or "nothing is planned"
    return settings.limits.passed(survey.spent, survey.spent_after_next)
