"""A robot that drives and probes in a known soil."""

from __future__ import annotations

from math import cos, inf, isfinite, pi, sin
from time import monotonic, sleep

import numpy as np

from subsoil.agent import Arrival, Assignment, Push, Refusal, Unreachable
from subsoil.errors import BatteryError
from subsoil.penetrometer import Insertion, reading_of
from subsoil.reports import STOPPED, Place
from subsoil.simulation.probe import Machine, push
from subsoil.simulation.truth import Truth
from subsoil.ways.access import Access
from subsoil.ways.open_land import OpenLand

ROBOT = 1
"""Key of the robot's random streams under a survey's seed."""
_LOOK_S = 0.05
"""Time in s after which it looks again whether it was told to stop."""


class SimulatedRobot:
    """A :class:`subsoil.agent.Robot` in a simulated soil.

    Chance is a pure function of the seed and the number of the stop, and everything else about
    the robot is in its arguments: a robot made with another's ``position`` and ``battery_s`` goes
    on exactly as that one would.

    It drives the shortest way and arrives exactly where it was sent; what it reports is off by the
    error of its receiver, the same for arrival and holes of a stop. A push reads the cell nearest
    to its hole. A push that the force limit ends is tried again beside the first hole; the deepest
    counts. Probing again before driving elsewhere is a further push at the stop, on a wider circle
    of holes and with a deviation of its own.

    Parameters
    ----------
    truth
        The soil.
    machine
        What the robot can do.
    seed
        Seed of the survey.
    position
        Easting and northing in m where it really stands: where it was last sent.
    battery_s
        Time in s the battery still lasts; by default it is full.
    access
        Ways it can take; by default all that the open land of the field allows.
    faster
        How many times faster than a real one it works. Default: at once.

    Examples
    --------
    >>> from subsoil.land.field import Field
    >>> from subsoil.penetrometer import SMALL_CONE
    >>> from subsoil.simulation import draw_truth
    >>> field = Field.from_metres([(0, 0), (50, 0), (50, 40), (0, 40)])
    >>> truth = draw_truth(field, np.random.default_rng(1))
    >>> robot = SimulatedRobot(truth, Machine(SMALL_CONE), seed=1, position=(0.0, 0.0))
    >>> robot.go_to(Assignment("a", 0, 0, (30.0, 40.0))).metres, robot.probe().seconds
    (50.0, 50.0)
    """

    def __init__(
        self,
        truth: Truth,
        machine: Machine,
        *,
        seed: int,
        position: Place,
        battery_s: float | None = None,
        access: Access | None = None,
        faster: float = inf,
    ) -> None:
        self.truth, self.machine, self.seed = truth, machine, seed
        self.position: Place = (float(position[0]), float(position[1]))
        self.battery_s = machine.battery_s if battery_s is None else battery_s
        self.access = OpenLand(truth.field) if access is None else access
        self.stop_number, self.pushed = 0, 0
        self._faster = faster
        self._stopped = False

    def go_to(self, stop: Assignment) -> Arrival | Unreachable:
        """Drive to a stop; where it stands, stay.

        Raises
        ------
        BatteryError
            If the battery does not last for the drive and a stop with all its tries; the robot
            then stays where it is.
        """
        at = stop.at
        if self._stopped:
            return Unreachable(STOPPED, self.position)
        if not (isfinite(at[0]) and isfinite(at[1])):
            return Unreachable(f"({at[0]:g}, {at[1]:g}) is no place", self.position)
        metres = float(self.access.between(self.position, at)[0, 0])
        if not isfinite(metres):
            return Unreachable("no way leads there", self.position)
        seconds = metres / self.machine.speed_mps
        self._check_battery(seconds + self._longest_s(stop.made), stop.number)
        if self._halted(seconds):
            return Unreachable(STOPPED, self.position)
        self.battery_s -= seconds
        self.position = (float(at[0]), float(at[1]))
        self.stop_number, self.pushed = stop.number, stop.made
        return Arrival(self._reported(self._stream()), metres, seconds)

    def probe(self) -> Push | Refusal:
        """Push the rod in here, and again beside the hole while the force limit ends the push.

        Where it was pushed in before, this is a further push.

        Raises
        ------
        BatteryError
            If the battery does not last for all tries.
        """
        if self._stopped:
            return Refusal(STOPPED, 0.0, 0)
        self._check_battery(self._longest_s(self.pushed), self.stop_number)
        rng = self._stream()
        east, north = self._reported(rng)
        pushes = self._pushes(self._stream(self.pushed) if self.pushed else rng)
        seconds = self._first_s(self.pushed) + (len(pushes) - 1) * self.machine.retry_s
        if self._halted(seconds):
            return Refusal(STOPPED, 0.0, 0)
        self.pushed += 1
        self.battery_s -= seconds
        (across, along), best = max(pushes, key=lambda each: each[1].depth_m[-1])
        if best.depth_m[-1] < self.machine.usable_m:
            reason = f"the rod got no deeper than {best.depth_m[-1]:.3f} m"
            return Refusal(reason, seconds, len(pushes))
        return Push((east + across, north + along), reading_of(best), seconds, len(pushes))

    def stop(self) -> None:
        """Come to rest and stay: from now on it goes nowhere and probes nothing."""
        self._stopped = True

    def _halted(self, seconds: float) -> bool:
        """Spend some time; whether it was told to stop meanwhile, or before."""
        end = monotonic() + seconds / self._faster
        while not self._stopped and (left := end - monotonic()) > 0:
            sleep(min(left, _LOOK_S))
        return self._stopped

    def _pushes(self, rng: np.random.Generator) -> list[tuple[Place, Insertion]]:
        """Offset of each hole and what the push there gave, until one goes through."""
        pushes: list[tuple[Place, Insertion]] = []
        for k in range(self.machine.tries):
            offset = self._gantry(self.pushed * self.machine.tries + k)
            hole = (self.position[0] + offset[0], self.position[1] + offset[1])
            kpa = self.truth.reading(self.truth.field.nearest_cell(hole), self.pushed)
            pushes.append((offset, push(self.machine, self.truth.layers, kpa, rng)))
            if pushes[-1][1].ending == "stroke":
                break
        return pushes

    def _gantry(self, hole: int) -> Place:
        """Offset in m: none at first, then on circles around the first hole, from the east."""
        if hole == 0:
            return (0.0, 0.0)
        k, circle, holes = hole - 1, 1, max(self.machine.tries - 1, 1)
        while k >= holes:
            k, circle, holes = k - holes, circle + 1, 6 * (circle + 1)
        radius, angle = circle * self.machine.gantry_m, 2.0 * pi * k / holes
        return (radius * cos(angle), radius * sin(angle))

    def _first_s(self, pushed: int) -> float:
        """Time in s of the next push where so many were made: the stop's, if it is the first."""
        return self.machine.retry_s if pushed else self.machine.stop_s

    def _longest_s(self, pushed: int) -> float:
        """Time in s of the next push if it takes all its tries."""
        return self._first_s(pushed) + (self.machine.tries - 1) * self.machine.retry_s

    def _stream(self, *push: int) -> np.random.Generator:
        """Random generator of the stop it is at, or of a further push there."""
        key = (ROBOT, self.stop_number, *push)
        return np.random.default_rng(np.random.SeedSequence(self.seed, spawn_key=key))

    def _reported(self, rng: np.random.Generator) -> Place:
        error = self.machine.fix_sd_m * rng.standard_normal(2)
        return (self.position[0] + float(error[0]), self.position[1] + float(error[1]))

    def _check_battery(self, seconds: float, stop: int) -> None:
        if seconds > self.battery_s:
            raise BatteryError(
                f"{self.battery_s / 60:.0f} minutes of battery are left and the next stop may "
                f"take {seconds / 60:.0f}",
                where=f"stop {stop + 1}",
                remedy="change the battery, then `subsoil resume --fresh-battery`",
            )
