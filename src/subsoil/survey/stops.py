"""What reports and leases do to the stops of a survey: the part of the fold that agents cause.

A reading is a fact: it counts where it was taken, once, whoever's the lease was. It belongs to the
cell that was assigned unless it lies far from it, and ends the lease when all pushes are made. An
assigned cell that got no reading that way is planned again, last.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import hypot, isfinite

from subsoil.errors import CorruptJournalError, brief
from subsoil.mapping.soilmap import SoilMap
from subsoil.reports import Place, Refused, Sampled, Source
from subsoil.strategies.view import Plan
from subsoil.survey.agents import Agent, Lease, Stop
from subsoil.survey.events import Assigned, Released
from subsoil.survey.measured import mappable, sample_of
from subsoil.survey.state import NOWHERE, Survey, cell_of, with_agent
from subsoil.variogram import Exponential

FAR_CELLS = 2.0
"""Distance in cells from the assigned one at which a reading no longer counts for it."""
FAR_DEVIATIONS = 3.0
"""The same in standard deviations of its place, if that is further."""
LAPSES = 2
"""Leases of a cell that run out before it counts as refused."""


def after(survey: Survey, event: Assigned | Released | Sampled | Refused) -> Survey:
    """State after one of these events.

    Raises
    ------
    CorruptJournalError
        If it names an agent or cell that does not exist.
    """
    match event:
        case Assigned():
            return assigned(survey, event)
        case Released():
            return released(survey, event)
        case Sampled():
            return sampled(survey, event)
        case Refused():
            return refused(survey, event)


def agent_of(survey: Survey, name: str) -> Agent:
    """Agent of a name.

    Raises
    ------
    CorruptJournalError
        If none of that name has joined.
    """
    try:
        return survey.agent(name)
    except KeyError:
        raise CorruptJournalError(
            f"agent {brief(name)!r} never joined",
            where=survey.name,
            remedy="go back to a copy of the file",
        ) from None


def assigned(survey: Survey, event: Assigned) -> Survey:
    """A stop is handed out, once."""
    agent = agent_of(survey, event.agent)
    leases = (*survey.leases, *survey.former)
    if event.id in {lease.id for lease in leases} | {stop.id for stop in survey.stops}:
        return survey
    if not 0 <= event.cell < len(survey.field.cells):
        raise CorruptJournalError(
            f"cell {event.cell} is assigned, which does not exist",
            where=survey.name,
            remedy="go back to a copy of the file",
        )
    lease = Lease(event.id, survey.assigned, event.cell, event.pushes)
    survey = with_agent(survey, replace(agent, leases=(*agent.leases, lease)))
    return replace(survey, assigned=survey.assigned + 1, plan=_without(survey.plan, event.cell))


def released(survey: Survey, event: Released) -> Survey:
    """A stop is its agent's no more: open again, or refused if that happens once too often."""
    known = survey.known | {event.id}
    for lease in survey.lease(event.assignment):
        lapses = survey.lapses
        if event.cause == "lapsed":
            lapses = (*lapses, lease.cell)
        if lapses.count(lease.cell) >= LAPSES and not lease.made:
            stop = Stop(lease.id, event.agent, lease.cell, refusal=_lapsed(survey, event, lease))
            survey = _closed(replace(survey, stops=(*survey.stops, stop)), (lease,), lease.id)
        else:
            survey = given_back(survey, lease)
        survey = replace(survey, lapses=lapses)
    return replace(survey, known=known)


def _lapsed(survey: Survey, event: Released, lease: Lease) -> Refused:
    """What is taken for reported of a stop that two agents in turn did not report on."""
    east, north = survey.access.at[lease.cell].tolist()
    return Refused(
        id=event.id, time=event.time, clock=event.clock, agent=event.agent, assignment=lease.id,
        source=Source(kind=survey.agent(event.agent).kind), at=(east, north), tries=0,
        reason="its lease ran out twice", cause="lapsed",
    )  # fmt: skip


def given_back(survey: Survey, lease: Lease) -> Survey:
    """A lease is over: its stop is the next to be made, or over if some pushes were made."""
    if lease.made:
        return _closed(survey, (lease,), lease.id)
    survey = replace(_unleased(survey, lease), former=(*survey.former, lease))
    plan = survey.plan
    asked = plan.pushes or (1,) * len(plan.cells)
    pushes = (lease.pushes, *asked) if max((lease.pushes, *asked)) > 1 else ()
    return replace(survey, plan=Plan((lease.cell, *plan.cells), plan.reason, pushes))


def sampled(survey: Survey, report: Sampled) -> Survey:
    """A reading counts: for the map at its place, for its stop, for its agent's clock."""
    leases = survey.lease(report.assignment)
    cell = _counted(survey, report.at, report.accuracy_m, report.assignment)
    id_ = report.assignment or report.id
    survey = _moved(survey, report)
    survey = replace(survey, soil_map=_appended(survey, report), finished="")
    if any(stop.id == id_ for stop in survey.stops):
        survey = changed(survey, id_, lambda s: replace(s, readings=(*s.readings, report)))
    else:
        stop = Stop(id_, report.agent, cell, (report,))
        survey = replace(survey, stops=(*survey.stops, stop))
    if leases and leases[0].made + 1 < leases[0].pushes:
        return _covered(_pushed(survey, leases[0]), cell, id_)
    survey = _closed(_covered(survey, cell, id_), leases, id_)
    for lease in leases:
        survey = reopened(survey, lease.cell)
    return survey


def refused(survey: Survey, report: Refused) -> Survey:
    """A stop is over without a reading, or without a further one."""
    leases = survey.lease(report.assignment)
    cell = leases[0].cell if leases else cell_of(survey, report.at)
    survey = _moved(survey, report)
    id_ = report.assignment or report.id
    if any(stop.id == id_ for stop in survey.stops):
        survey = changed(survey, id_, lambda s: replace(s, refusal=report))
        return _closed(survey, leases, id_) if leases else survey
    if not leases and (cell == NOWHERE or cell in survey.visited):
        return survey
    stop = Stop(id_, report.agent, cell, refusal=report)
    survey = _covered(replace(survey, stops=(*survey.stops, stop)), cell, id_)
    return _closed(survey, leases, id_)


def reopened(survey: Survey, cell: int) -> Survey:
    """Plan with a cell at its end, unless it is on somebody's way or needs no visit any more."""
    leased = (lease.cell for lease in survey.leases)
    if cell in {NOWHERE, *survey.visited, *survey.refused, *survey.plan.cells, *leased}:
        return survey
    plan = survey.plan
    pushes = (*plan.pushes, 1) if plan.pushes else ()
    return replace(survey, plan=Plan((*plan.cells, cell), plan.reason, pushes))


def _appended(survey: Survey, report: Sampled) -> SoilMap:
    if not mappable(survey, report):
        return survey.soil_map
    soil_map, sample = survey.soil_map, sample_of(survey, report)
    if soil_map.variograms:
        return soil_map.append(sample)
    unit = Exponential(nugget=0.1, range=survey.field.extent_m / 5.0, psill=0.9)
    models = (unit,) * len(survey.layers)
    return replace(soil_map, variograms=models, samples=(sample,))


def _counted(survey: Survey, at: Place, accuracy_m: float | None, assignment: str) -> int:
    """Cell that a reading counts for: the assigned one, unless it was taken far from it."""
    for lease in (*survey.leases, *survey.former):
        if lease.id == assignment and not far(survey, at, accuracy_m, lease.cell):
            return lease.cell
    return cell_of(survey, at)


def far(survey: Survey, at: Place, accuracy_m: float | None, cell: int) -> bool:
    """Whether a place is too far from a cell to count for it."""
    east, north = survey.access.at[cell].tolist()
    away = hypot(at[0] - east, at[1] - north)
    near = FAR_CELLS * survey.field.cell_size
    return not away <= max(near, FAR_DEVIATIONS * (accuracy_m or 0.0))


def _moved(survey: Survey, report: Sampled | Refused) -> Survey:
    agent = agent_of(survey, report.agent)
    there = isfinite(report.at[0]) and isfinite(report.at[1])
    position = report.at if there else agent.position
    moved = replace(
        agent,
        position=position,
        metres=agent.metres + report.metres,
        seconds=agent.seconds + report.seconds,
    )
    return replace(
        with_agent(survey, moved), position=position, known=survey.known | {report.id}
    )  # fmt: skip


def _pushed(survey: Survey, lease: Lease) -> Survey:
    """One push of a lease is made, and more are to follow."""
    return with_lease(survey, lease, (replace(lease, made=lease.made + 1),))


def _closed(survey: Survey, leases: tuple[Lease, ...], id_: str) -> Survey:
    """A stop is over."""
    for lease in leases:
        survey = _unleased(survey, lease)
    read = any(stop.id == id_ and stop.readings for stop in survey.stops)
    return replace(survey, step=survey.step + 1, changes=survey.changes + read)


def _covered(survey: Survey, cell: int, id_: str) -> Survey:
    """Nobody needs to go to a cell any more: it is planned no longer, nor on another's way."""
    if cell == NOWHERE:
        return survey
    for lease in survey.leases:
        if lease.cell == cell and lease.id != id_ and not lease.made:
            survey = replace(_unleased(survey, lease), former=(*survey.former, lease))
    return replace(survey, plan=_without(survey.plan, cell))


def _unleased(survey: Survey, lease: Lease) -> Survey:
    return with_lease(survey, lease, ())


def with_lease(survey: Survey, lease: Lease, by: tuple[Lease, ...]) -> Survey:
    """Survey with a lease replaced by another one, or by none."""
    for agent in survey.agents:
        if lease in agent.leases:
            k = agent.leases.index(lease)
            leases = (*agent.leases[:k], *by, *agent.leases[k + 1 :])
            return with_agent(survey, replace(agent, leases=leases))
    return survey


def changed(survey: Survey, id_: str, change: Callable[[Stop], Stop]) -> Survey:
    """Survey with a stop changed."""
    stops = tuple(change(stop) if stop.id == id_ else stop for stop in survey.stops)
    return replace(survey, stops=stops)


def _without(plan: Plan, cell: int) -> Plan:
    if cell not in plan.cells:
        return plan
    k = plan.cells.index(cell)
    pushes = (*plan.pushes[:k], *plan.pushes[k + 1 :]) if plan.pushes else ()
    return Plan((*plan.cells[:k], *plan.cells[k + 1 :]), plan.reason, pushes)
