"""Everything that happens in a survey, as values that go into its journal.

Events are the truth of a survey: its state is the fold of :func:`subsoil.survey.fold.apply` over
them. They hold plain numbers with units in their names, validate themselves, and survive a round
trip through JSON bit for bit. What an agent reports (:mod:`subsoil.reports`) is an event as it is.
"""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from pydantic import Field, FiniteFloat, TypeAdapter

from subsoil.penetrometer import LARGEST_MM2, SMALLEST_MM2
from subsoil.reports import Happening, Kind, Place, Plain, Refused, Report, Sampled
from subsoil.survey.records import FitRecord
from subsoil.survey.settings import Settings

FORMAT = 1
"""Format of the events written here."""
METHOD = "0.2"
"""Version of what is computed: plans and fits of another one are not computed again."""


class Opened(Happening):
    """A survey was set up: where, in which layers, with which cone."""

    kind: Literal["opened"] = "opened"
    format: int = FORMAT
    method: str = METHOD
    name: str
    boundary_wkt: str
    keep_outs_wkt: tuple[str, ...]
    crs: str
    cell_size_m: float
    layer_edges_m: tuple[float, ...]
    layer_weights: tuple[float, ...]
    cone_area_mm2: float = Field(ge=SMALLEST_MM2, le=LARGEST_MM2)
    cone_angle_deg: float = Field(gt=0, lt=180)
    covariate: tuple[FiniteFloat, ...] = ()
    """What is known beforehand of each cell, in order, if anything is."""


class Continued(Happening):
    """A survey of an older format goes on in this one."""

    kind: Literal["continued"] = "continued"
    format: int = FORMAT
    method: str = METHOD


class Configured(Happening):
    """It was decided how to survey; holds until decided anew."""

    kind: Literal["configured"] = "configured"
    method: str = METHOD
    settings: Settings


class Simulation(Plain):
    """A soil that was simulated.

    Attributes
    ----------
    world, seed
        What it is drawn from.
    check_kpa
        Some of its values in kPa, by which to tell whether it is the same again.
    """

    world: str
    seed: int
    check_kpa: tuple[float, ...] = ()


class Joined(Happening):
    """An agent began to work on the survey.

    Attributes
    ----------
    agent
        Its name.
    source
        What it is.
    at
        Where it is; the start of the settings if nobody says.
    simulation
        The soil it works in, if that is simulated.
    """

    kind: Literal["joined"] = "joined"
    agent: str
    source: Kind = "robot"
    at: Place | None = None
    simulation: Simulation | None = None


class Left(Happening):
    """An agent works on the survey no more; what it was to do is open again."""

    kind: Literal["left"] = "left"
    agent: str
    reason: str = ""


class Assigned(Happening):
    """A stop was handed out; the id of this event is that of the assignment."""

    kind: Literal["assigned"] = "assigned"
    agent: str
    cell: int
    pushes: int = 1


class Released(Happening):
    """An assignment is no longer its agent's, and its stop is open again."""

    kind: Literal["released"] = "released"
    agent: str
    assignment: str
    reason: str
    cause: Literal["given-back", "lapsed"] = "given-back"


class Amended(Happening):
    """A reading was corrected: the new report stands in the place of the old one."""

    kind: Literal["amended"] = "amended"
    report: str
    reason: str
    by: Sampled


class Withdrawn(Happening):
    """A reading does not count any more."""

    kind: Literal["withdrawn"] = "withdrawn"
    report: str
    reason: str


class Planned(Happening):
    """A strategy laid down the stops still to make."""

    kind: Literal["planned"] = "planned"
    step: int
    cells: tuple[int, ...] = ()
    kept: bool = False
    """Whether the plan is what is left of the last one; no cells are named again then."""
    reason: str
    mean_kv: float
    """Field average of the kriging variance at that moment in kPa2; NaN before a sample."""
    measures: tuple[float, ...] = ()
    """What each goal measured at that moment; NaN before a second sample."""
    pushes: tuple[int, ...] = ()
    """How often to push at each stop; empty for once."""


class Fitted(Happening):
    """Variograms were estimated anew, one a layer."""

    kind: Literal["fitted"] = "fitted"
    samples: int
    fits: tuple[FitRecord, ...]
    drift: tuple[int, ...] = ()
    """Indices of the layers that follow the covariate."""


class BatterySwapped(Happening):
    """An agent got a full battery."""

    kind: Literal["battery-swapped"] = "battery-swapped"
    agent: str


class Finished(Happening):
    """There was enough, or nothing left to do."""

    kind: Literal["finished"] = "finished"
    reason: str


Event = Annotated[
    Opened
    | Continued
    | Configured
    | Joined
    | Left
    | Assigned
    | Released
    | Sampled
    | Refused
    | Amended
    | Withdrawn
    | Planned
    | Fitted
    | BatterySwapped
    | Finished,
    Field(discriminator="kind"),
]

_ADAPTER: TypeAdapter[Event] = TypeAdapter(Event)


def to_json(event: Event) -> str:
    """One line of JSON.

    Examples
    --------
    >>> to_json(Finished(id="a", reason="30 samples taken"))
    '{"id":"a","time":null,"clock":"unknown","kind":"finished","reason":"30 samples taken"}'
    """
    return event.model_dump_json()


def from_json(text: str) -> Event:
    """Event of one line of JSON in the format of today.

    Raises
    ------
    pydantic.ValidationError
        If it is not an event.
    """
    return _ADAPTER.validate_json(text)


def same(a: Event, b: Event, tolerance: float = 1e-6) -> bool:
    """Whether two events say the same, numbers to a relative tolerance, ids and times aside.

    Numbers near zero may differ by a thousandth of the tolerance outright.
    """
    aside = {"id", "time", "clock"}
    return type(a) is type(b) and _alike(
        a.model_dump(exclude=aside), b.model_dump(exclude=aside), tolerance
    )


def _alike(a: object, b: object, tolerance: float) -> bool:
    if isinstance(a, float) and isinstance(b, float):
        return bool(np.isclose(a, b, rtol=tolerance, atol=1e-3 * tolerance, equal_nan=True))
    if isinstance(a, dict) and isinstance(b, dict):
        return a.keys() == b.keys() and all(_alike(a[k], b[k], tolerance) for k in a)
    if isinstance(a, tuple) and isinstance(b, tuple):
        return len(a) == len(b) and all(_alike(x, y, tolerance) for x, y in zip(a, b, strict=True))
    return a == b


__all__ = [
    "FORMAT",
    "METHOD",
    "Amended",
    "Assigned",
    "BatterySwapped",
    "Configured",
    "Continued",
    "Event",
    "Finished",
    "Fitted",
    "Joined",
    "Left",
    "Opened",
    "Planned",
    "Refused",
    "Released",
    "Report",
    "Sampled",
    "Simulation",
    "Withdrawn",
    "from_json",
    "same",
    "to_json",
]
