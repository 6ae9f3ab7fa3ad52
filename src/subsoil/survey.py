"""A survey is a fold: its state is ``reduce(apply, events)``.

:func:`apply` takes one event into account; :func:`subsoil.sequel.next_event` says what follows from
a state without anything from outside. Both are pure, so a survey that was cut short goes on exactly
as one that was not.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import reduce
from math import nan

import numpy as np
import shapely
from shapely.geometry import MultiPolygon, Polygon

from subsoil.errors import CorruptJournalError, JournalError
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
)
from subsoil.field import Field
from subsoil.kriging.drift import NO_COVARIATE, Covariate
from subsoil.layers import Layers, Sample
from subsoil.penetrometer import Cone, Insertion
from subsoil.routing import length
from subsoil.soilmap import SoilMap
from subsoil.stopping import Rates, Spent, Standing
from subsoil.travel import travel_of
from subsoil.variogram import Estimator, estimator_named

NEVER = -1
"""Reports that a plan takes into account where there is none."""
_NOTHING_MEASURED = Standing()


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
    pushes
        How often to push at each of them; empty for once.
    reason
        Why this plan.
    visited, refused
        Cells probed and cells that refused, in order.
    places
        Easting and northing in m of the first hole in each cell probed: where all readings of
        the stop are taken to be, so that kriging averages them.
    repeats
        Cells of the readings beyond the first of their stop, in order.
    due
        Pushes still to make where the agent is.
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
    pushes: tuple[int, ...] = ()
    reason: str = ""
    visited: tuple[int, ...] = ()
    refused: tuple[int, ...] = ()
    places: tuple[tuple[float, float], ...] = ()
    repeats: tuple[int, ...] = ()
    due: int = 0
    position: tuple[float, float] = (0.0, 0.0)
    metres: float = 0.0
    seconds: float = 0.0
    charged_at: float = 0.0
    planned_at: int = NEVER
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
        """Number of stops so far, however many pushes were made there."""
        return len(self.visited) + len(self.refused)

    @property
    def next_stop(self) -> tuple[int, int]:
        """Cell to push the rod in, and how often: the last one again while pushes are due."""
        if self.due:
            return self.visited[-1], self.due
        return self.plan[0], self.pushes[0] if self.pushes else 1

    @property
    def pushed(self) -> int:
        """Pushes made at the stop that the agent is at, while more are due there."""
        return 1 + self.repeats.count(self.visited[-1]) if self.due else 0

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
        """What it will have cost after the next planned stop and its pushes, at its pace."""
        travel, stop = travel_of(self.field), self.field.cells[self.plan[0]]
        metres = length(travel, self.position, stop)
        further = self.next_stop[1] - 1
        minutes = self.minutes + self.configured.pace.minutes(metres, 1, further)
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
    covariate = NO_COVARIATE
    if event.covariate:
        covariate = Covariate(field.cells, np.array(event.covariate))
    soil_map = SoilMap(field.cells, layers, covariate=covariate)
    return Survey(event.name, field, layers, cone, soil_map)


def opening(field: Field, layers: Layers, cone: Cone, covariate: Sequence[float] = ()) -> Opened:
    """Event that sets up a survey; a covariate has one value a cell."""
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
        covariate=tuple(covariate),
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
            return _pushed(survey, event)
        case Refused() if event.cell in survey.visited:
            return replace(_moved(survey, event), due=0)
        case Refused():
            return replace(_moved(survey, event), refused=(*survey.refused, event.cell), due=0)
        case Fitted():
            variograms = tuple(model.variogram for model in event.models)
            soil_map = replace(survey.soil_map.refit(variograms), drift=event.drift)
            return replace(survey, soil_map=soil_map, fitted_at=event.samples)
        case Planned():
            goals, taken = survey.configured.goals, len(survey.visited)
            standing = survey.standing.updated(goals, taken, event.measures)
            survey = replace(survey, plan=event.cells, pushes=event.pushes, reason=event.reason)
            return replace(survey, standing=standing, planned_at=event.step)
        case BatterySwapped():
            return replace(survey, charged_at=survey.seconds, finished="")
        case Finished():
            return replace(survey, finished=event.reason)
        case Opened():
            raise CorruptJournalError("the survey is set up twice", where=survey.name)


def estimator_of(survey: Survey) -> Estimator:
    """What estimates the survey's variograms."""
    settings = survey.configured
    return estimator_named(settings.estimator, survey.field.extent_m, settings.estimator_settings)


def sample_of(survey: Survey, event: Sampled) -> Sample:
    """Layer values that a push gave, at the place of its stop's first one."""
    at = event.at
    if event.cell in survey.visited:
        at = survey.places[survey.visited.index(event.cell)]
    insertion = Insertion(np.array(event.depth_m), np.array(event.force_n), event.ending)
    return survey.layers.sample(insertion.profile(survey.cone), at)


def _configure(survey: Survey, event: Configured) -> Survey:
    return replace(
        survey,
        settings=(*survey.settings, event),
        position=survey.position if survey.step else event.start,
        plan=(),
        pushes=(),
        due=0,
        planned_at=NEVER,
        standing=_NOTHING_MEASURED,
        finished="",
    )


def _pushed(survey: Survey, event: Sampled) -> Survey:
    """Take a reading in: the first of a stop, or a further one."""
    survey = replace(survey, soil_map=_with_sample(survey, event))
    if event.cell in survey.visited:
        due = max(survey.due - 1, 0)
        return replace(_moved(survey, event), repeats=(*survey.repeats, event.cell), due=due)
    asked = dict(zip(survey.plan, survey.pushes, strict=False)).get(event.cell, 1)
    return replace(
        _moved(survey, event),
        visited=(*survey.visited, event.cell),
        places=(*survey.places, event.at),
        due=asked - 1,
    )


def _with_sample(survey: Survey, event: Sampled) -> SoilMap:
    sample = sample_of(survey, event)
    if survey.soil_map.variograms:
        return survey.soil_map.append(sample)
    first = survey.soil_map
    fits = estimator_of(survey)(np.array([sample.at]), sample.measured_kpa[:, None])
    return replace(first, variograms=tuple(fit.variogram for fit in fits), samples=(sample,))


def _moved(survey: Survey, event: Sampled | Refused) -> Survey:
    ahead = [k for k, cell in enumerate(survey.plan) if cell != event.cell]
    return replace(
        survey,
        position=tuple(survey.field.cells[event.cell].tolist()),
        plan=tuple(survey.plan[k] for k in ahead),
        pushes=tuple(survey.pushes[k] for k in ahead) if survey.pushes else (),
        metres=survey.metres + event.metres,
        seconds=survey.seconds + event.seconds,
        reports=survey.reports | {event.id},
    )


def _area(wkt: str) -> Polygon | MultiPolygon:
    area = shapely.from_wkt(wkt)
    if not isinstance(area, Polygon | MultiPolygon):
        raise CorruptJournalError(f"an outline is a {area.geom_type}, not a polygon")
    return area


def _wkt(area: Polygon | MultiPolygon) -> str:
    return shapely.to_wkt(area, rounding_precision=-1)
