"""Stops still to make, as a GIS is to see them."""

from __future__ import annotations

from typing import NamedTuple

from subsoil.survey import Survey
from subsoil.ways.access import Access


class Target(NamedTuple):
    """A stop still to make, and the way to it.

    Attributes
    ----------
    stop
        Its number in the survey, from 1.
    cell
        Cell to probe.
    agent
        Who is on the way to it; empty while nobody is.
    start
        Where the way to it begins, easting and northing in m.
    """

    stop: int
    cell: int
    agent: str
    start: tuple[float, float]


class Ahead(NamedTuple):
    """What is still to be done.

    Attributes
    ----------
    on_way
        Stops that agents are on their way to.
    first
        Number of the first planned stop.
    cells
        Cells of the planned stops.
    start
        Where the way to the first of them begins.
    """

    on_way: tuple[Target, ...] = ()
    first: int = 1
    cells: tuple[int, ...] = ()
    start: tuple[float, float] = (0.0, 0.0)

    def targets(self, access: Access, last: int | None = None) -> set[Target]:
        """Stops on somebody's way, and the planned ones up to a number, or all."""
        cells = self.cells if last is None else self.cells[: max(last + 1 - self.first, 0)]
        centres = [(east, north) for east, north in access.at[list(cells)].tolist()]
        ahead = zip(cells, [self.start, *centres], strict=False)
        planned = (Target(n, cell, "", at) for n, (cell, at) in enumerate(ahead, self.first))
        return {*self.on_way, *planned}


NOTHING_DRAWN = Ahead()


def ahead_of(survey: Survey) -> Ahead:
    """What is still to be done: a plan goes on from where the last stop handed out is."""
    on_way: list[Target] = []
    start, last = survey.position, -1
    for agent in survey.agents:
        here = agent.position
        for lease in agent.leases:
            on_way.append(Target(lease.number + 1, lease.cell, agent.name, here))
            east, north = survey.access.at[lease.cell].tolist()
            here = (east, north)
            if lease.number > last:
                start, last = here, lease.number
    return Ahead(tuple(on_way), survey.assigned + 1, survey.plan.cells, start)
