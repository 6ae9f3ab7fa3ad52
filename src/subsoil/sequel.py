"""What follows from the state of a survey without anything from outside.

Variograms are estimated anew on schedule, the strategy plans after every report, and the survey
finishes when a limit or a goal is reached. Each is an event that is a pure function of the state.
"""

from __future__ import annotations

from math import nan

import numpy as np

from subsoil.errors import ParameterError
from subsoil.events import Event, Finished, Fitted, Planned, model_record
from subsoil.kriging.choice import learn
from subsoil.strategies import Plan, View, strategy_named
from subsoil.survey import NEVER, Survey, estimator_of

_STRATEGY_STREAM = 2
_FEW = 12
"""Samples up to which variograms are estimated anew after each, whatever the schedule."""


def next_event(survey: Survey) -> Event | None:
    """What follows from the state alone; ``None`` when the next thing must come from an agent."""
    if survey.finished or survey.due:
        return None
    settings = survey.configured
    taken = len(survey.visited)
    if taken and _refit_due(survey):
        return _fit(survey)
    if reason := settings.limits.reached(survey.spent):
        return Finished(reason=reason)
    if survey.planned_at != survey.step:
        return _plan(survey)
    if reason := _enough(survey):
        return Finished(reason=reason)
    return None


def view(survey: Survey) -> View:
    """The survey as its strategy sees it."""
    settings = survey.configured
    key = np.random.SeedSequence(settings.seed, spawn_key=(_STRATEGY_STREAM, survey.step))
    return View(
        field=survey.field,
        soil_map=survey.soil_map,
        position=survey.position,
        plan=survey.plan,
        visited=survey.visited,
        refused=survey.refused,
        budget=settings.samples,
        fresh=survey.planned_at == NEVER,
        rng=np.random.default_rng(key),
        metres=survey.metres,
        pace=settings.pace,
        metres_left=settings.metres - survey.metres,
        minutes_left=settings.minutes - survey.minutes,
        pushes=survey.pushes,
        repeats=survey.repeats,
    )


def _refit_due(survey: Survey) -> bool:
    """Whether variograms are due: often while samples are few, on schedule, and at the end."""
    taken, settings = len(survey.visited), survey.configured
    on_schedule = taken % settings.refit_every == 0
    return taken != survey.fitted_at and (taken <= _FEW or on_schedule or taken >= settings.samples)


def _fit(survey: Survey) -> Fitted:
    soil_map, rule = survey.soil_map, survey.configured.drift
    learnt = learn(soil_map.at, soil_map.kpa, soil_map.covariate, estimator_of(survey), rule)
    return Fitted(
        samples=len(survey.visited),
        models=tuple(model_record(fit.variogram) for fit in learnt.fits),
        why=tuple(fit.why for fit in learnt.fits),
        drift=learnt.drift,
    )


def _plan(survey: Survey) -> Planned:
    settings = survey.configured
    plan = strategy_named(settings.strategy, settings.strategy_settings)(view(survey))
    _check_plan(survey, plan)
    return Planned(
        step=survey.step,
        cells=plan.cells,
        reason=plan.reason,
        mean_kv=survey.mean_kv,
        measures=_measures(survey, plan),
        pushes=plan.pushes,
    )


def _measures(survey: Survey, plan: Plan) -> tuple[float, ...]:
    """What the goals measure; nothing can be said of a map of one sample."""
    goals = survey.configured.goals
    if len(survey.visited) < 2:
        return (nan,) * len(goals)
    return tuple(goal.measure(survey.soil_map, plan.cells) for goal in goals)


def _enough(survey: Survey) -> str:
    """Why to stop once the plan is made; empty to go on to its next stop."""
    settings = survey.configured
    if reason := survey.standing.reached(settings.goals):
        return reason
    if not survey.plan:
        return survey.reason or "nothing is planned"
    return settings.limits.passed(survey.spent, survey.spent_after_next)


def _check_plan(survey: Survey, plan: Plan) -> None:
    where = f"strategy {survey.configured.strategy}"
    gone = {*survey.visited, *survey.refused}
    if plan.pushes and (len(plan.pushes) != len(plan.cells) or min(plan.pushes) < 1):
        raise ParameterError(
            f"it plans {plan.pushes} pushes at {len(plan.cells)} stops",
            where=where,
            remedy="plan one or more at each, or none for one each",
        )
    for k, cell in enumerate(plan.cells):
        if not 0 <= cell < len(survey.field.cells):
            raise ParameterError(f"it plans cell {cell}, which is not in the field", where=where)
        if cell in gone or cell in plan.cells[:k]:
            raise ParameterError(
                f"it plans cell {cell}, which is visited, refused or planned already",
                where=where,
                remedy="plan free cells only, each once",
            )
