"""The state of a survey: its stops, its agents, its plan, and what follows from them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from math import isfinite, nan

import numpy as np

from subsoil.land.field import Field
from subsoil.layers import Layers
from subsoil.mapping.soilmap import SoilMap
from subsoil.notebook import table
from subsoil.penetrometer import Cone
from subsoil.reports import Place, Refused, Sampled
from subsoil.stopping import GoalProgress, Spent
from subsoil.strategies.view import Plan
from subsoil.survey.agents import Agent, Lease, Stop
from subsoil.survey.events import Simulation
from subsoil.survey.records import FitRecord
from subsoil.survey.settings import Settings
from subsoil.ways.access import Access
from subsoil.ways.routing import length

NEVER = -1
"""Step of a plan where there is none."""
NOWHERE = -1
"""Cell of a place that lies in none."""
NO_PLAN = Plan((), "")
NOTHING_MEASURED = GoalProgress()


@dataclass(frozen=True)
class Survey:
    """State of a survey.

    Attributes
    ----------
    name, field, layers, cone
        What was set up.
    access
        Where in the field one may stop, and the ways between.
    settings
        How to survey, as last decided.
    method
        Version of the methods it was decided for; empty while nothing was decided.
    stops
        In the order of their first reports.
    agents
        In the order they joined.
    simulation
        The soil that agents work in, where that is simulated.
    fits
        How the variograms were come by, one a layer.
    plan
        Stops still to make, those handed out apart.
    soil_map
        The map so far.
    goal_progress
        How the goals of these settings stand.
    finished
        Why it is over; empty while it is not.
    position
        Where the agent is that reported last, or where agents enter.
    assigned
        Assignments handed out.
    step
        Stops that came to an end, and corrections made. Never falls, so that chance and plans can
        hang on it.
    planned_at
        Step that the plan takes into account; -1 if there is none under these settings.
    planned_for
        Assignments handed out when the plan was made.
    changes
        Stops that ended with a reading, and corrections. Never falls.
    fitted_at
        Changes that the variograms take into account.
    corrected
        Whether a reading was corrected since the last fit.
    former
        Leases that ended without a report: their agents may still report.
    lapses
        Cells of the leases that ran out.
    known
        Ids of what was reported so far.
    """

    name: str
    field: Field
    layers: Layers
    cone: Cone
    access: Access
    settings: Settings
    soil_map: SoilMap
    method: str = ""
    stops: tuple[Stop, ...] = ()
    agents: tuple[Agent, ...] = ()
    simulation: tuple[Simulation, ...] = ()
    fits: tuple[FitRecord, ...] = ()
    plan: Plan = NO_PLAN
    goal_progress: GoalProgress = NOTHING_MEASURED
    finished: str = ""
    position: Place = (0.0, 0.0)
    assigned: int = 0
    step: int = 0
    planned_at: int = NEVER
    planned_for: int = 0
    changes: int = 0
    fitted_at: int = 0
    corrected: bool = False
    former: tuple[Lease, ...] = ()
    lapses: tuple[int, ...] = ()
    known: frozenset[str] = frozenset()

    def __repr__(self) -> str:
        return f"<survey of {self._in_short}>"

    def _repr_html_(self) -> str:
        rows = [
            (stop.id if len(stop.id) <= 8 else stop.id[:8], stop.agent, f"{stop.cell}",
             f"{len(stop.readings)}", stop.refusal.reason if stop.refusal else "")
            for stop in self.stops
        ]  # fmt: skip
        head = ("stop", "agent", "cell", "readings", "refused")
        return table(head, rows, f"Survey of {self._in_short}")

    @property
    def _in_short(self) -> str:
        way = f"{self.taken} samples, {self.metres:.0f} m, {self.minutes:.0f} min"
        origin = ", simulated" if self.simulated else ""
        state = self.finished or "not finished"
        return f"{self.name}: {way}{origin}; {state}"

    @cached_property
    def visited(self) -> tuple[int, ...]:
        """Cells with a reading, in order, each once."""
        cells = (stop.cell for stop in self.stops if stop.readings and stop.cell != NOWHERE)
        return tuple(dict.fromkeys(cells))

    @cached_property
    def refused(self) -> tuple[int, ...]:
        """Cells without a reading at which none could be had, in order."""
        visited = {*self.visited, NOWHERE}
        cells = (stop.cell for stop in self.stops if stop.refusal and not stop.readings)
        return tuple(cell for cell in dict.fromkeys(cells) if cell not in visited)

    @cached_property
    def repeats(self) -> tuple[int, ...]:
        """Cells of the readings beyond the first of their cell, in order."""
        seen: set[int] = set()
        further = []
        for stop in self.stops:
            for _ in stop.readings:
                if stop.cell in seen:
                    further.append(stop.cell)
                elif stop.cell != NOWHERE:
                    seen.add(stop.cell)
        return tuple(further)

    @cached_property
    def taken(self) -> int:
        """Number of stops with a reading."""
        return sum(bool(stop.readings) for stop in self.stops)

    @cached_property
    def readings(self) -> tuple[Sampled, ...]:
        """Reports of all pushes that count, stop by stop."""
        return tuple(report for stop in self.stops for report in stop.readings)

    @property
    def leases(self) -> tuple[Lease, ...]:
        """Stops handed out and not over."""
        return tuple(lease for agent in self.agents for lease in agent.leases)

    @property
    def simulated(self) -> bool:
        """Whether anything in it was simulated."""
        return self.soil_map.simulated

    @property
    def metres(self) -> float:
        """Way driven in m by all agents."""
        return sum(agent.metres for agent in self.agents)

    @property
    def minutes(self) -> float:
        """Time spent in min, by the agent that spent most: agents work side by side."""
        return max((agent.seconds for agent in self.agents), default=0.0) / 60.0

    @property
    def spent(self) -> Spent:
        """What it has cost, and what it has to show."""
        return self._spent(self.taken, self.metres, self.minutes, 0.0)

    @property
    def spent_after_next(self) -> Spent:
        """What it will have cost after the next planned stop and its pushes, at its pace."""
        stop = self.access.at[self.plan.cells[0]]
        metres = length(self.access, self.position, stop)
        further = self.plan.pushes[0] - 1 if self.plan.pushes else 0
        more = self.settings.pace.minutes(metres, 1, further)
        return self._spent(self.taken + 1, self.metres + metres, self.minutes + more, more)

    def _spent(self, samples: int, metres: float, minutes: float, more: float) -> Spent:
        worked = sum(agent.seconds for agent in self.agents) / 60.0 + more
        money = self.settings.rates.money(samples, metres, worked)
        return Spent(samples, metres, minutes, self.mean_kv, money)

    @property
    def mean_kv(self) -> float:
        """Field average of the kriging variance in kPa2; NaN before a second sample.

        One sample tells nothing of how much the soil varies: its variances are in no known unit
        and only good for comparing cells.
        """
        return self.soil_map.field_kv if self.taken > 1 else nan

    @property
    def notes(self) -> tuple[str, ...]:
        """What a reader of the survey should know."""
        lost = len(self.readings) - len(self.soil_map.samples)
        if not lost:
            return self.soil_map.notes
        words = "1 reading says" if lost == 1 else f"{lost} readings say"
        mapped = "is not mapped" if lost == 1 else "are not mapped"
        return (*self.soil_map.notes, f"{words} nothing that can be true, and {mapped}")

    def agent(self, name: str) -> Agent:
        """The agent of a name.

        Raises
        ------
        KeyError
            If there is none.
        """
        for agent in self.agents:
            if agent.name == name:
                return agent
        raise KeyError(name)

    def reading(self, report: str) -> Sampled:
        """The reading of a report's id.

        Raises
        ------
        KeyError
            If there is none that counts.
        """
        for reading in self.readings:
            if reading.id == report:
                return reading
        raise KeyError(report)

    def lease(self, assignment: str) -> tuple[Lease, ...]:
        """The lease of an assignment, if it is open."""
        return tuple(lease for lease in self.leases if lease.id == assignment)


def stop_of(survey: Survey, report: Sampled | Refused) -> Stop:
    """The stop that a report is about.

    Raises
    ------
    KeyError
        If it is about none.
    """
    id_ = report.assignment or report.id
    for stop in reversed(survey.stops):
        if stop.id == id_:
            return stop
    raise KeyError(id_)


def cell_of(survey: Survey, at: Place) -> int:
    """Cell that a place lies in; -1 if it lies in none."""
    if not (isfinite(at[0]) and isfinite(at[1])):
        return NOWHERE
    cell = survey.field.nearest_cell(at)
    off = np.abs(survey.field.cells[cell] - at).max()
    return cell if off <= survey.field.cell_size / 2 else NOWHERE


def with_agent(survey: Survey, agent: Agent) -> Survey:
    """Survey with an agent in the place of the one of its name."""
    agents = tuple(agent if each.name == agent.name else each for each in survey.agents)
    return replace(survey, agents=agents)
