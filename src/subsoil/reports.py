"""What an agent says of its work: plain data that travels as JSON and needs no mathematics.

A report is a fact. It carries its own id, so that it can be sent again; the place and time of what
it reports; and who says so. Whether its numbers can be true is checked where it enters a survey
(:mod:`subsoil.survey.admission`), not here.
"""

from __future__ import annotations

from datetime import datetime
from typing import Literal, Self
from uuid import uuid4

from pydantic import AwareDatetime, BaseModel, ConfigDict, Field

Place = tuple[float, float]
"""Easting and northing in m, or longitude and latitude in degrees."""
LONLAT = "EPSG:4326"
"""Frame of longitude and latitude, in this order, as satellite receivers give them."""
STOPPED = "stopped"
"""Why a robot that was told to stop did not get there, or has no reading."""

Ending = Literal["stroke", "force", "stone", "no-contact", "stalled", "stopped", "unknown"]
"""Why a push ended: the rod reached the end of its stroke, the force its limit in the soil, or it
met a stone, met no soil at all, did not move, was told to stop; or nobody knows."""
Clock = Literal["host", "agent", "gnss", "file", "unknown"]
"""Whose clock a time is from: the survey's host, the agent's, a satellite's, or a file's."""
Kind = Literal["robot", "person", "file", "simulator"]
"""What took a reading."""


class Plain(BaseModel):
    """Base of values that travel as JSON: frozen, and strict about names."""

    model_config = ConfigDict(frozen=True, extra="forbid", ser_json_inf_nan="constants")


class Happening(Plain):
    """What everything that happens in a survey has: an identity and a time.

    Attributes
    ----------
    id
        Its own, whatever happens to it on the way: what comes twice counts once.
    time
        When it happened; ``None`` until somebody says.
    clock
        Whose clock says so.
    """

    id: str = Field(default_factory=lambda: str(uuid4()))
    time: AwareDatetime | None = None
    clock: Clock = "unknown"

    def stamped(self, now: datetime, clock: Clock = "host") -> Self:
        """The same with a time, if it has none."""
        if self.time is not None:
            return self
        return self.model_copy(update={"time": now, "clock": clock})


class Tip(Plain):
    """The cone of a penetrometer: base area in mm2 (10 to 10 000), full apex angle in degrees."""

    area_mm2: float
    angle_deg: float = 30.0


class Quantity(Plain):
    """Something measured beside resistance, such as moisture, temperature or conductivity.

    Attributes
    ----------
    name, unit
        What it is, and in what its values are.
    depth_m
        Depth of each value in m; empty for one value of the place.
    values
        As many as depths.
    """

    name: str
    unit: str
    depth_m: tuple[float, ...] = ()
    values: tuple[float, ...]


class Reading(Plain):
    """One push as the instrument saw it: force, or pressure, by depth.

    Attributes
    ----------
    depth_m
        Depths in m, positive down, in the order they were read.
    force_n
        Force at each in N; empty where the instrument gives pressure.
    kpa
        Cone index at each in kPa; empty where it gives force.
    tip
        Cone that the force was measured with, if not the survey's.
    ending
        What ended the push.
    flags
        What is odd about it, in words such as ``"bounced"``.
    further
        What else was measured there; kept, not mapped.
    top_m
        Depths from which on values stand for the soil, where it is not since the one above.
    """

    depth_m: tuple[float, ...]
    force_n: tuple[float, ...] = ()
    kpa: tuple[float, ...] = ()
    tip: Tip | None = None
    ending: Ending = "stroke"
    flags: tuple[str, ...] = ()
    further: tuple[Quantity, ...] = ()
    top_m: tuple[float, ...] = ()


class Source(Plain):
    """Where a report comes from: what took it, and for a file its name and row."""

    kind: Kind = "robot"
    file: str = ""
    row: int = 0


class _Report(Happening):
    """What all reports of an agent have.

    Attributes
    ----------
    agent
        Name of the agent.
    assignment
        Id of the assignment it is about; empty for a place that nobody asked for.
    source
        What took it.
    at
        Where it was.
    frame
        Frame of ``at``: empty for the field's own, or :data:`LONLAT`, or any other by name.
    accuracy_m
        Standard deviation of the place in m, if the receiver says.
    metres, seconds
        Way driven and time spent since the last report.
    tries
        Pushes made for it.
    """

    agent: str
    assignment: str = ""
    source: Source = Source()
    at: Place
    frame: str = ""
    accuracy_m: float | None = None
    metres: float = 0.0
    seconds: float = 0.0
    tries: int = 1


class Sampled(_Report):
    """A push gave a reading. Further pushes at a stop are reports of their own."""

    kind: Literal["sampled"] = "sampled"
    reading: Reading


class Refused(_Report):
    """A stop gave no reading, or no further one.

    Attributes
    ----------
    reason
        Why, in a few words.
    cause
        Whether the soil gave no reading, the place could not be reached, somebody left it out, or
        what was reported could not be true.
    """

    kind: Literal["refused"] = "refused"
    reason: str
    cause: Literal["soil", "unreachable", "skipped", "report", "lapsed"] = "soil"


Report = Sampled | Refused
