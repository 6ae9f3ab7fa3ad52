"""The simulated machine: its limits, and a push of its rod into a known soil."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from subsoil.arrays import Floats
from subsoil.errors import ParameterError
from subsoil.layers import Layers
from subsoil.penetrometer import Cone, Insertion

_STONE_N_PER_M = 200_000.0
"""Rise of the force on a stone: 600 N within 3 mm."""


@dataclass(frozen=True)
class Machine:
    """A robot with a penetrometer; the defaults are the paper's (sec. IV-A) where it gives them.

    Parameters
    ----------
    cone
        Tip of the rod.
    speed_mps
        Driving speed in m/s.
    fix_sd_m
        SD in m of each coordinate of a reported position. Default 0.3, a receiver with satellite
        corrections; RTK has about 0.02.
    battery_s
        Time in s a full battery lasts, driving or probing.
    stop_s, retry_s
        Time in s of a stop with one push, and of every further push.
    tries
        Most pushes at a stop.
    gantry_m
        Distance in m from the first hole to the holes of retries.
    stroke_m, readings
        Depth in m the rod reaches, and evenly spaced force readings on the way.
    usable_m
        Depth in m that a push must reach to be worth keeping.
    force_limit_n
        Force in N at which a push ends.
    load_cell_n
        Force in N above which the load cell always says the same.
    force_sd_n
        SD in N of a force reading. Default 2, 0.2 % of the load cell's range.
    stone_probability
        Probability that a push meets a stone, at any depth of the stroke alike.

    Raises
    ------
    ParameterError
        If a number is outside what it may be.
    """

    cone: Cone
    speed_mps: float = 1.0
    fix_sd_m: float = 0.3
    battery_s: float = 8 * 3600.0
    stop_s: float = 50.0
    retry_s: float = 28.0
    tries: int = 3
    gantry_m: float = 0.2
    stroke_m: float = 0.50
    readings: int = 300
    usable_m: float = 0.10
    force_limit_n: float = 600.0
    load_cell_n: float = 1100.0
    force_sd_n: float = 2.0
    stone_probability: float = 0.05

    def __post_init__(self) -> None:
        for name in ("speed_mps", "battery_s", "stroke_m", "force_limit_n", "load_cell_n"):
            self._require(getattr(self, name) > 0, name, "greater than zero")
        for name in ("fix_sd_m", "stop_s", "retry_s", "gantry_m", "usable_m", "force_sd_n"):
            self._require(getattr(self, name) >= 0, name, "zero or more")
        for name in ("tries", "readings"):
            self._require(getattr(self, name) >= 1, name, "one or more")
        self._require(0 <= self.stone_probability <= 1, "stone_probability", "between 0 and 1")

    def _require(self, ok: bool, name: str, need: str) -> None:
        value = getattr(self, name)
        if not ok or not np.isfinite(value):
            raise ParameterError(f"{name} must be {need}, not {value:g}", where="machine")


def push(machine: Machine, layers: Layers, kpa: Floats, rng: np.random.Generator) -> Insertion:
    """Push the rod once into soil of known layer means.

    Where the soil, or a stone in it, asks for more than the force limit, the actuator gives the
    limit and the push ends. The load cell sees the force with its noise, from zero to its range.

    Parameters
    ----------
    machine
        What pushes.
    layers
        Depth bands of the soil.
    kpa
        (m,) mean resistance of each in kPa.
    rng
        Source of the stone and the noise; every push draws the same number of times.
    """
    depth = machine.stroke_m * np.arange(1, machine.readings + 1) / machine.readings
    asked = mean_resistance(layers, kpa, depth) * machine.cone.area_mm2 / 1000.0
    stone, stone_depth = rng.random(2)
    if stone < machine.stone_probability:
        asked += _STONE_N_PER_M * np.maximum(depth - stone_depth * machine.stroke_m, 0.0)
    stalled = np.flatnonzero(asked >= machine.force_limit_n)
    end = int(stalled[0]) + 1 if stalled.size else machine.readings
    noise = machine.force_sd_n * rng.standard_normal(machine.readings)
    seen = np.clip(np.minimum(asked, machine.force_limit_n) + noise, 0.0, machine.load_cell_n)
    return Insertion(depth[:end], seen[:end], "force" if stalled.size else "stroke")


def mean_resistance(layers: Layers, kpa: Floats, depth_m: Floats) -> Floats:
    """Mean resistance between readings of a smooth profile with given layer means.

    The resistance summed from the surface down is known at every layer's edge. A monotone cubic
    through it (PCHIP; Fritsch & Carlson, *SIAM J. Numer. Anal.* 17, 1980) is a smooth profile that
    is nowhere negative and keeps every layer's mean. Above and below the layers the outermost
    values go on.

    Parameters
    ----------
    layers
        Depth bands.
    kpa
        (m,) mean resistance of each in kPa.
    depth_m
        (k,) increasing depths of readings in m.

    Returns
    -------
    ndarray
        (k,) mean in kPa from the reading above, or the surface, to each depth.

    Examples
    --------
    >>> mean_resistance(Layers((0.0, 0.1, 0.2)), np.array([500.0, 900.0]), np.array([0.1, 0.2]))
    array([500., 900.])
    """
    edges = np.array(layers.edges_m)
    if edges[0] > 0.0:
        edges, kpa = np.insert(edges, 0, 0.0), np.insert(kpa, 0, kpa[0])
    if depth_m[-1] > edges[-1]:
        edges, kpa = np.append(edges, depth_m[-1]), np.append(kpa, kpa[-1])
    summed = np.concatenate([[0.0], np.cumsum(kpa * np.diff(edges))])
    to_readings = scipy.interpolate.PchipInterpolator(edges, summed)(
        np.concatenate([[0.0], depth_m])
    )
    return np.diff(to_readings) / np.diff(depth_m, prepend=0.0)
