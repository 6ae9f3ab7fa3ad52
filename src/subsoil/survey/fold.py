"""A survey is a fold: its state is ``reduce(apply, events)``.

:func:`apply` takes one event into account; :mod:`subsoil.survey.decide` says what follows from a
state without anything from outside. Both are pure, so a survey that was cut short goes on exactly
as one that was not. The fold reads no clock.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import reduce

import numpy as np
import shapely
from shapely.geometry import MultiPolygon, Polygon

from subsoil.errors import CorruptJournalError, brief, printable
from subsoil.kriging.drift import NO_COVARIATE, Covariate
from subsoil.land.field import Field
from subsoil.layers import Layers
from subsoil.mapping.soilmap import SoilMap
from subsoil.penetrometer import Cone
from subsoil.reports import Refused, Sampled
from subsoil.strategies.view import Plan
from subsoil.survey import corrections, stops
from subsoil.survey.agents import Agent
from subsoil.survey.events import (
    Amended,
    Assigned,
    BatterySwapped,
    Configured,
    Continued,
    Event,
    Finished,
    Fitted,
    Joined,
    Left,
    Opened,
    Planned,
    Released,
    Withdrawn,
)
from subsoil.survey.settings import Settings
from subsoil.survey.state import NEVER, NO_PLAN, NOTHING_MEASURED, Survey, with_agent
from subsoil.ways.open_land import OpenLand

_LONGEST_NAME = 255
"""Letters of a survey's name that are kept, as many as a file's name has."""


def opened(event: Opened) -> Survey:
    """Survey as set up."""
    name = brief(event.name, _LONGEST_NAME)
    field = Field(
        _area(event.boundary_wkt),
        event.crs,
        tuple(_area(wkt) for wkt in event.keep_outs_wkt),
        event.cell_size_m,
        name,
    )
    layers = Layers(event.layer_edges_m, event.layer_weights)
    cone = Cone(event.cone_area_mm2, event.cone_angle_deg)
    covariate = NO_COVARIATE
    if event.covariate:
        covariate = Covariate(field.cells, np.array(event.covariate))
    soil_map = SoilMap(field, layers, covariate=covariate)
    settings = Settings(start=field.entrance)
    return Survey(
        name, field, layers, cone, OpenLand(field), settings, soil_map,
        position=field.entrance,
    )  # fmt: skip


def opening(field: Field, layers: Layers, cone: Cone, covariate: Sequence[float] = ()) -> Opened:
    """Event that sets up a survey; a covariate has one value a cell."""
    return Opened(
        name=printable(field.name),
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
        If the first event is another, or one cannot follow those before it.
    """
    stream = iter(events)
    first = next(stream, None)
    if not isinstance(first, Opened):
        raise CorruptJournalError("the survey was never set up", remedy="subsoil init")
    return reduce(apply, stream, opened(first))


def apply(survey: Survey, event: Event) -> Survey:
    """State after one more event; what is known already changes nothing.

    Raises
    ------
    CorruptJournalError
        If the event cannot follow: an agent, cell or reading that does not exist.
    """
    if event.id in survey.known:
        return survey
    match event:
        case Assigned() | Released() | Sampled() | Refused():
            return stops.after(survey, event)
        case Amended() | Withdrawn():
            return corrections.after(survey, event)
        case Configured():
            return _configured(survey, event)
        case Joined():
            return _joined(survey, event)
        case Left():
            return _left(survey, event)
        case BatterySwapped():
            agent = stops.agent_of(survey, event.agent)
            return with_agent(survey, replace(agent, charged_at=agent.seconds))
        case Planned():
            return _planned(survey, event)
        case Fitted():
            return _fitted(survey, event)
        case Finished():
            return replace(survey, finished=event.reason)
        case Continued():
            return survey
        case Opened():
            raise CorruptJournalError("the survey is set up twice", where=survey.name)


def _configured(survey: Survey, event: Configured) -> Survey:
    agents = survey.agents
    if not survey.stops:
        agents = tuple(replace(agent, position=event.settings.start) for agent in agents)
    return replace(
        survey,
        settings=event.settings,
        method=event.method,
        agents=agents,
        position=survey.position if survey.stops else event.settings.start,
        plan=NO_PLAN,
        planned_at=NEVER,
        goal_progress=NOTHING_MEASURED,
        finished="",
    )


def _joined(survey: Survey, event: Joined) -> Survey:
    if event.agent in {agent.name for agent in survey.agents}:
        return with_agent(survey, replace(survey.agent(event.agent), here=True))
    at = event.at or survey.settings.start
    new = Agent(event.agent, event.source, at)
    simulation = (*survey.simulation, event.simulation) if event.simulation else survey.simulation
    simulated = survey.simulated or event.source == "simulator"
    return replace(
        survey,
        agents=(*survey.agents, new),
        simulation=simulation,
        soil_map=replace(survey.soil_map, simulated=simulated),
        position=survey.position if survey.agents else at,
    )


def _left(survey: Survey, event: Left) -> Survey:
    agent = stops.agent_of(survey, event.agent)
    for lease in reversed(agent.leases):
        survey = stops.given_back(survey, lease)
    return with_agent(survey, replace(survey.agent(agent.name), here=False))


def _planned(survey: Survey, event: Planned) -> Survey:
    cells = survey.plan.cells if event.kept else event.cells
    pushes = survey.plan.pushes if event.kept else event.pushes
    if wrong := [cell for cell in cells if not 0 <= cell < len(survey.field.cells)]:
        raise CorruptJournalError(
            f"a plan names cell {wrong[0]}, which does not exist",
            where=survey.name,
            remedy="go back to a copy of the file",
        )
    return replace(
        survey,
        plan=Plan(cells, event.reason, pushes),
        planned_at=event.step,
        planned_for=survey.assigned,
        goal_progress=survey.goal_progress.updated(
            survey.settings.goals, survey.taken, event.measures
        ),
    )


def _fitted(survey: Survey, event: Fitted) -> Survey:
    variograms = tuple(fit.model.variogram for fit in event.fits)
    return replace(
        survey,
        soil_map=replace(survey.soil_map.refit(variograms), drift=event.drift),
        fits=event.fits,
        fitted_at=survey.changes,
        corrected=False,
    )


def _area(wkt: str) -> Polygon | MultiPolygon:
    try:
        area = shapely.from_wkt(wkt)
    except shapely.errors.ShapelyError as error:
        raise CorruptJournalError(f"an outline cannot be read: {brief(str(error))}") from error
    if not isinstance(area, Polygon | MultiPolygon):
        raise CorruptJournalError(f"an outline is a {area.geom_type}, not a polygon")
    return area


def _wkt(area: Polygon | MultiPolygon) -> str:
    return shapely.to_wkt(area, rounding_precision=-1)
