"""Everything that happens in a survey, as values that go into its journal.

Events are the truth of a survey: its state is the fold of :func:`subsoil.survey.apply` over them.
They hold plain numbers with units in their names, validate themselves, and survive a round trip
through JSON bit for bit.
"""

from __future__ import annotations

from math import inf
from typing import Annotated, Literal
from uuid import uuid4

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, FiniteFloat, TypeAdapter

from subsoil.kriging.choice import DriftRule
from subsoil.stopping import Goal, Limits, Pace, Rates
from subsoil.variogram import Bounded, Nested, Structure, model_named, name_of, name_of_kind

Place = tuple[float, float]


class _Event(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", ser_json_inf_nan="constants")

    id: str = Field(default_factory=lambda: str(uuid4()))


class Opened(_Event):
    """A survey was set up: where, in which layers, with which cone."""

    kind: Literal["opened"] = "opened"
    name: str
    boundary_wkt: str
    keep_outs_wkt: tuple[str, ...]
    crs: str
    cell_size_m: float
    layer_edges_m: tuple[float, ...]
    layer_weights: tuple[float, ...]
    cone_area_mm2: float
    cone_angle_deg: float
    covariate: tuple[FiniteFloat, ...] = ()
    """What is known beforehand of each cell, in order, if anything is."""


class Configured(_Event):
    """It was decided how to survey; holds until decided anew."""

    kind: Literal["configured"] = "configured"
    strategy: str
    strategy_settings: dict[str, float | str] = Field(default_factory=dict)
    estimator: str
    estimator_settings: dict[str, float] = Field(default_factory=dict)
    refit_every: int = Field(ge=1)
    seed: int = Field(ge=0)
    start: Place
    world: str
    samples: int
    metres: float
    minutes: float
    mean_kv: float
    money: float = inf
    rates: Rates = Field(default_factory=Rates)
    pace: Pace = Field(default_factory=Pace)
    goals: tuple[Annotated[Goal, Field(discriminator="kind")], ...] = ()
    drift: DriftRule = "auto"

    @property
    def limits(self) -> Limits:
        """What the survey may cost."""
        return Limits(self.samples, self.metres, self.minutes, self.mean_kv, self.money, self.rates)


class Planned(_Event):
    """A strategy laid down the stops still to make."""

    kind: Literal["planned"] = "planned"
    step: int
    cells: tuple[int, ...]
    reason: str
    mean_kv: float
    """Field average of the kriging variance at that moment in kPa2; NaN before a sample."""
    measures: tuple[float, ...] = ()
    """What each goal measured at that moment; NaN before a second sample."""
    pushes: tuple[int, ...] = ()
    """How often to push at each stop; empty for once."""


class Sampled(_Event):
    """A push gave a reading; force by depth as the machine saw it.

    Further pushes at a stop are reports of their own, on the same cell and without a way.
    """

    kind: Literal["sampled"] = "sampled"
    agent: str
    cell: int
    at: Place
    depth_m: tuple[float, ...]
    force_n: tuple[float, ...]
    ending: Literal["stroke", "force"]
    metres: float
    seconds: float
    tries: int


class Refused(_Event):
    """No push at a stop gave a reading."""

    kind: Literal["refused"] = "refused"
    agent: str
    cell: int
    at: Place
    reason: str
    metres: float
    seconds: float
    tries: int


class _Record(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class BoundedRecord(_Record):
    """A bounded variogram by name and parameters."""

    name: str
    nugget: float
    range: float
    psill: float

    @property
    def variogram(self) -> Bounded:
        """The model recorded."""
        return model_named(self.name)(self.nugget, self.range, self.psill)


class NestedRecord(_Record):
    """A nested variogram by its sill and structures: share of the sill, model, range in m."""

    sill: float
    structures: tuple[tuple[float, str, float], ...]

    @property
    def variogram(self) -> Nested:
        """The model recorded."""
        terms = (Structure(share, model_named(n), reach) for share, n, reach in self.structures)
        return Nested(self.sill, tuple(terms))


Model = BoundedRecord | NestedRecord


def model_record(variogram: Bounded | Nested) -> Model:
    """Record of a variogram."""
    if isinstance(variogram, Nested):
        terms = ((s.share, name_of_kind(s.kind), s.range) for s in variogram.structures)
        return NestedRecord(sill=variogram.sill, structures=tuple(terms))
    return BoundedRecord(
        name=name_of(variogram),
        nugget=variogram.nugget,
        range=variogram.range,
        psill=variogram.psill,
    )


class Fitted(_Event):
    """Variograms were estimated anew, one a layer, each with the estimator's own words on why."""

    kind: Literal["fitted"] = "fitted"
    samples: int
    models: tuple[Model, ...]
    why: tuple[str, ...]
    drift: tuple[int, ...] = ()
    """Indices of the layers that follow the covariate."""


class BatterySwapped(_Event):
    """The robot got a full battery."""

    kind: Literal["battery-swapped"] = "battery-swapped"


class Finished(_Event):
    """There was enough, or nothing left to do."""

    kind: Literal["finished"] = "finished"
    reason: str


Event = Annotated[
    Opened | Configured | Planned | Sampled | Refused | Fitted | BatterySwapped | Finished,
    Field(discriminator="kind"),
]
Report = Sampled | Refused

_ADAPTER: TypeAdapter[Event] = TypeAdapter(Event)


def to_json(event: Event) -> str:
    """One line of JSON.

    Examples
    --------
    >>> to_json(Finished(id="a", reason="30 samples taken"))
    '{"id":"a","kind":"finished","reason":"30 samples taken"}'
    """
    return event.model_dump_json()


def from_json(text: str) -> Event:
    """Event of one line of JSON.

    Raises
    ------
    pydantic.ValidationError
        If it is not an event.
    """
    return _ADAPTER.validate_json(text)


def same(a: Event, b: Event, tolerance: float = 1e-6) -> bool:
    """Whether two events say the same, numbers to a relative tolerance, ids aside."""
    return type(a) is type(b) and _alike(
        a.model_dump(exclude={"id"}), b.model_dump(exclude={"id"}), tolerance
    )


def _alike(a: object, b: object, tolerance: float) -> bool:
    if isinstance(a, float) and isinstance(b, float):
        return bool(np.isclose(a, b, rtol=tolerance, atol=0.0, equal_nan=True))
    if isinstance(a, dict) and isinstance(b, dict):
        return a.keys() == b.keys() and all(_alike(a[k], b[k], tolerance) for k in a)
    if isinstance(a, tuple) and isinstance(b, tuple):
        return len(a) == len(b) and all(_alike(x, y, tolerance) for x, y in zip(a, b, strict=True))
    return a == b
