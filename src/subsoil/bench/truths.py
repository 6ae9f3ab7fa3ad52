"""The field and soil of a task, and a robot that reads it without physics of its own."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import shapely
from shapely.geometry import MultiPolygon, Polygon

from subsoil.agent import Arrival, Assignment, Push, Refusal, Unreachable
from subsoil.bench.task import Setting, soil_rng
from subsoil.errors import ParameterError, brief
from subsoil.land.field import Field
from subsoil.layers import Layers
from subsoil.penetrometer import LARGE_CONE
from subsoil.reports import STOPPED, Place, Reading
from subsoil.simulation import Machine, Scheme, Truth, draw_field
from subsoil.simulation.fields import TEST_BED
from subsoil.ways.access import Access
from subsoil.ways.routing import length


class TruthReader:
    """Robot that reads layer means straight from the truth, as in the paper's own simulation.

    It takes the time of a :class:`~subsoil.simulation.Machine`: its speed on the way, one push a
    stop, and no refusals.
    """

    def __init__(self, truth: Truth, access: Access, position: Place) -> None:
        self.truth, self.access, self.position = truth, access, position
        self.machine = Machine(LARGE_CONE)
        self.pushed = 0
        self._stopped = False

    def go_to(self, stop: Assignment) -> Arrival | Unreachable:
        """Drive to a stop the shortest way through the field."""
        if self._stopped:
            return Unreachable(STOPPED, self.position)
        self.pushed = stop.made
        metres = length(self.access, self.position, [stop.at])
        self.position = stop.at
        return Arrival(stop.at, metres, metres / self.machine.speed_mps)

    def probe(self) -> Push | Refusal:
        """Read the cell it stands in: the force at the foot of each layer is that of its mean.

        A further push without driving is faster, and has a deviation of its own.
        """
        if self._stopped:
            return Refusal(STOPPED, 0.0, 0)
        kpa = self.truth.reading(self.truth.field.nearest_cell(self.position), self.pushed)
        seconds = self.machine.retry_s if self.pushed else self.machine.stop_s
        self.pushed += 1
        depth, force = self.truth.layers.bottom_m, kpa * LARGE_CONE.area_mm2 / 1000.0
        reading = Reading(depth_m=tuple(depth.tolist()), force_n=tuple(force.tolist()))
        return Push(self.position, reading, seconds)

    def stop(self) -> None:
        """Stay: from now on it goes nowhere and probes nothing."""
        self._stopped = True


def truth_of(setting: Setting, field: int) -> Truth:
    """Soil of a field, drawn as the protocol says.

    The test bed's protocols draw it on the test bed or within the boundary. ``"riseholme"`` draws
    soils that agree with the robot's real readings of :func:`subsoil.datasets.riseholme`, on the
    half field of the paper or within the boundary.

    Raises
    ------
    DataUnavailableError
        If real readings are needed and not at hand.
    """
    return _drawn(setting, field)


@lru_cache(maxsize=1)
def _drawn(setting: Setting, field: int) -> Truth:
    rng = soil_rng(setting.seed, field)
    if setting.protocol == "riseholme":
        return _riseholme(land_of(setting), rng)
    protocol: Scheme = "surrogate" if setting.protocol == "surrogate" else "signal"
    if not setting.boundary_wkt:
        return draw_field(rng, protocol)
    return draw_field(rng, protocol, field=land_of(setting))


def _riseholme(land: Field, rng: np.random.Generator) -> Truth:
    from subsoil.datasets import riseholme
    from subsoil.simulation.conditional import conditional_truth

    layers, readings = Layers(), riseholme().readings
    return conditional_truth(land, readings.at, readings.layer_means(layers), layers, rng)


def land_of(setting: Setting) -> Field:
    """Field of a setting: its boundary's, or else the protocol's own.

    Raises
    ------
    ParameterError
        If real readings are to be used in another frame than theirs.
    """
    if setting.protocol == "riseholme":
        from subsoil.datasets import half_field

        own = half_field()
        if setting.boundary_wkt and setting.crs != own.crs:
            raise ParameterError(
                f"the boundary is in {brief(setting.crs) or 'a local frame'}, "
                f"the readings in {own.crs}",
                where="--boundary",
                remedy=f"give it in {own.crs}",
            )
    else:
        own = TEST_BED
    if not setting.boundary_wkt:
        return own
    outline = shapely.from_wkt(setting.boundary_wkt)
    if not isinstance(outline, Polygon | MultiPolygon):
        raise ParameterError(f"it is a {outline.geom_type}, not a polygon", where="--boundary")
    return Field(outline, setting.crs, name="bench field")
