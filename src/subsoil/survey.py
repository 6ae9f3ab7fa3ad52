"""A survey is a fold: its state is ``reduce(apply, events)``.

:func:`apply` takes one event into account; :func:`next_event` says what follows from a state
without anything from outside: variograms are refitted on schedule, the strategy plans after every
report, and the survey finishes when a limit or a goal is reached. Both are pure, so a survey that
was cut short goes on exactly as one that was not.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import reduce
from math import hypot, nan

import numpy as np
import shapely
from shapely.geometry import MultiPolygon, Polygon

from subsoil.errors import CorruptJournalError, JournalError, ParameterError
from subsoil.events import (
    BatterySwapped,
    Configured,
    Event,
    Finished,
    Fitted,
    Opened,
    Planned,
    Refused,
    Sampled,
    model_record,
)
from subsoil.field import Field
from subsoil.layers import Layers, Sample
from subsoil.penetrometer import Cone, Insertion
from subsoil.soilmap import SoilMap
from subsoil.stopping import Rates, Spent, Standing
from subsoil.strategies import Plan, View, strategy_named
from subsoil.variogram import estimator_named

_STRATEGY_STREAM = 2
_NEVER = -1
_NOTHING_MEASURED = Standing()
_FEW = 12
"""Samples up to which variograms are estimated anew after each, whatever the schedule."""


@dataclass(frozen=True)
class Survey:
    """State of a survey.

    Attributes
    ----------
    name, field, layers, cone
        What was set up.
    settings
        How to survey, as last decided; empty before that.
    soil_map
        The map so far.
    plan
        Cells still to visit, in order.
    reason
        Why this plan.
    visited, refused
        Cells probed and cells that refused, in order.
    position
        Where the agent is, easting and northing in m.
    metres, seconds
        Way driven and time spent.
    charged_at
        Value of ``seconds`` when the battery was last full.
    planned_at
        Reports taken into account by the plan; -1 if there is none under these settings.
    fitted_at
        Samples taken into account by the variograms.
    standing
        How the goals of these settings stand.
    finished
        Why it is over; empty while it is not.
    reports
        Ids of the reports so far.
    """

    name: str
    field: Field
    layers: Layers
    cone: Cone
    soil_map: SoilMap
    settings: tuple[Configured, ...] = ()
    plan: tuple[int, ...] = ()
    reason: str = ""
    visited: tuple[int, ...] = ()
    refused: tuple[int, ...] = ()
    position: tuple[float, float] = (0.0, 0.0)
    metres: float = 0.0
    seconds: float = 0.0
    charged_at: float = 0.0
    planned_at: int = _NEVER
    fitted_at: int = 0
    standing: Standing = _NOTHING_MEASURED
    finished: str = ""
    reports: frozenset[str] = frozenset()

    @property
    def configured(self) -> Configured:
        """How to survey.

        Raises
        ------
        JournalError
            If that was never decided.
        """
        if not self.settings:
            raise JournalError(
                "no strategy was chosen yet", where=self.name, remedy="subsoil run SURVEY.gpkg"
            )
        return self.settings[-1]

    @property
    def step(self) -> int:
        """Number of reports so far."""
        return len(self.visited) + len(self.refused)

    @property
    def minutes(self) -> float:
        """Time spent in min."""
        return self.seconds / 60.0

    @property
    def spent(self) -> Spent:
        """What it has cost, and what it has to show."""
        return self._spent(len(self.visited), self.metres, self.minutes)

    @property
    def spent_after_next(self) -> Spent:
        """What it will have cost after the next planned stop, at its pace and with one push."""
        east, north = self.field.cells[self.plan[0]]
        metres = hypot(east - self.position[0], north - self.position[1])
        minutes = self.minutes + self.configured.pace.minutes(metres, 1)
        return self._spent(len(self.visited) + 1, self.metres + metres, minutes)

    def _spent(self, samples: int, metres: float, minutes: float) -> Spent:
        rates = self.settings[-1].rates if self.settings else Rates()
        money = rates.money(samples, metres, minutes)
        return Spent(samples, metres, minutes, self.mean_kv, money)

    @property
    def mean_kv(self) -> float:
        """Field average of the kriging variance in kPa2; NaN before a second sample.

        One sample tells nothing of how much the soil varies: its variances are in no known unit
        and only good for comparing cells.
        """
        return self.soil_map.mean_kv if len(self.visited) > 1 else nan


def opened(event: Opened) -> Survey:
    """Survey as set up."""
    field = Field(
        _area(event.boundary_wkt),
        event.crs,
        tuple(_area(wkt) for wkt in event.keep_outs_wkt),
        event.cell_size_m,
        event.name,
    )
    layers = Layers(event.layer_edges_m, event.layer_weights)
    cone = Cone(event.cone_area_mm2, event.cone_angle_deg)
    return Survey(event.name, field, layers, cone, SoilMap(field.cells, layers))


def opening(field: Field, layers: Layers, cone: Cone) -> Opened:
    """Event that sets up a survey."""
    return Opened(
        name=field.name,
        boundary_wkt=_wkt(field.boundary),
        keep_outs_wkt=tuple(_wkt(area) for area in field.keep_outs),
        crs=field.crs,
        cell_size_m=field.cell_size,
        layer_edges_m=layers.edges_m,
        layer_weights=layers.weights,
        cone_area_mm2=cone.area_mm2,
        cone_angle_deg=cone.angle_deg,
    )


def fold(events: Iterable[Event]) -> Survey:
    """State after events, the first of which set the survey up.

    Raises
    ------
    CorruptJournalError
        If the first event is another.
    """
    stream = iter(events)
    first = next(stream, None)
    if not isinstance(first, Opened):
        raise CorruptJournalError("the survey was never set up", remedy="subsoil init")
    return reduce(apply, stream, opened(first))


def apply(survey: Survey, event: Event) -> Survey:
    """State after one more event; a report that is already in changes nothing."""
    match event:
        case Configured():
            return _configure(survey, event)
        case Sampled() | Refused() if event.id in survey.reports:
            return survey
        case Sampled():
            survey = replace(survey, soil_map=_with_sample(survey, event))
            return replace(_moved(survey, event), visited=(*survey.visited, event.cell))
        case Refused():
            return replace(_moved(survey, event), refused=(*survey.refused, event.cell))
        case Fitted():
            variograms = tuple(model.variogram for model in event.models)
            soil_map = survey.soil_map.refit(variograms)
            return replace(survey, soil_map=soil_map, fitted_at=event.samples)
        case Planned():
            goals, taken = survey.configured.goals, len(survey.visited)
            standing = survey.standing.updated(goals, taken, event.measures)
            survey = replace(survey, plan=event.cells, reason=event.reason, standing=standing)
            return replace(survey, planned_at=event.step)
        case BatterySwapped():
            return replace(survey, charged_at=survey.seconds, finished="")
        case Finished():
            return replace(survey, finished=event.reason)
        case Opened():
            raise CorruptJournalError("the survey is set up twice", where=survey.name)


def next_event(survey: Survey) -> Event | None:
    """What follows from the state alone; ``None`` when the next thing must come from an agent."""
    if survey.finished:
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
        fresh=survey.planned_at == _NEVER,
        rng=np.random.default_rng(key),
    )


def sample_of(survey: Survey, event: Sampled) -> Sample:
    """Layer values that a push gave."""
    insertion = Insertion(np.array(event.depth_m), np.array(event.force_n), event.ending)
    return survey.layers.sample(insertion.profile(survey.cone), event.at)


def _configure(survey: Survey, event: Configured) -> Survey:
    return replace(
        survey,
        settings=(*survey.settings, event),
        position=survey.position if survey.step else event.start,
        plan=(),
        planned_at=_NEVER,
        standing=_NOTHING_MEASURED,
        finished="",
    )


def _with_sample(survey: Survey, event: Sampled) -> SoilMap:
    sample = sample_of(survey, event)
    if survey.soil_map.variograms:
        return survey.soil_map.append(sample)
    first = SoilMap(survey.soil_map.cells, survey.layers, (), ())
    fits = estimator_named(survey.configured.estimator)(
        np.array([sample.at]), sample.measured_kpa[:, None]
    )
    return replace(first, variograms=tuple(fit.variogram for fit in fits), samples=(sample,))


def _moved(survey: Survey, event: Sampled | Refused) -> Survey:
    return replace(
        survey,
        position=tuple(survey.field.cells[event.cell].tolist()),
        plan=tuple(cell for cell in survey.plan if cell != event.cell),
        metres=survey.metres + event.metres,
        seconds=survey.seconds + event.seconds,
        reports=survey.reports | {event.id},
    )


def _refit_due(survey: Survey) -> bool:
    """Whether variograms are due: often while samples are few, on schedule, and at the end."""
    taken, settings = len(survey.visited), survey.configured
    on_schedule = taken % settings.refit_every == 0
    return taken != survey.fitted_at and (taken <= _FEW or on_schedule or taken >= settings.samples)


def _fit(survey: Survey) -> Fitted:
    fits = survey.soil_map.fit(estimator_named(survey.configured.estimator))
    return Fitted(
        samples=len(survey.visited),
        models=tuple(model_record(fit.variogram) for fit in fits),
        why=tuple(fit.why for fit in fits),
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
        return "every planned stop is made"
    return settings.limits.passed(survey.spent, survey.spent_after_next)


def _check_plan(survey: Survey, plan: Plan) -> None:
    where = f"strategy {survey.configured.strategy}"
    gone = {*survey.visited, *survey.refused}
    for k, cell in enumerate(plan.cells):
        if not 0 <= cell < len(survey.field.cells):
            raise ParameterError(f"it plans cell {cell}, which is not in the field", where=where)
        if cell in gone or cell in plan.cells[:k]:
            raise ParameterError(
                f"it plans cell {cell}, which is visited, refused or planned already",
                where=where,
                remedy="plan free cells only, each once",
            )


def _area(wkt: str) -> Polygon | MultiPolygon:
    area = shapely.from_wkt(wkt)
    if not isinstance(area, Polygon | MultiPolygon):
        raise CorruptJournalError(f"an outline is a {area.geom_type}, not a polygon")
    return area


def _wkt(area: Polygon | MultiPolygon) -> str:
    return shapely.to_wkt(area, rounding_precision=-1)
