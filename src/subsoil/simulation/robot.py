"""A robot that drives and probes in a known soil."""

from __future__ import annotations

from math import cos, hypot, isfinite, pi, sin

import numpy as np

from subsoil.errors import BatteryError, RobotError
from subsoil.penetrometer import Insertion
from subsoil.robot import Arrival, Push, Refusal
from subsoil.simulation.probe import Machine, push
from subsoil.simulation.truth import Truth

ROBOT = 1
"""Key of the robot's random streams under a survey's seed."""

Place = tuple[float, float]


class SimulatedRobot:
    """A :class:`subsoil.robot.Robot` in a simulated soil.

    Chance is a pure function of the seed and the number of the stop, and everything else about
    the robot is in its arguments: a robot made with another's ``position``, ``stops`` and
    ``battery_s`` goes on exactly as that one would.

    It drives in straight lines and arrives exactly where it was sent; what it reports is off by
    the error of its receiver, the same for arrival and holes of a stop. A push reads the cell
    nearest to its hole. A push that the force limit ends is tried again beside the first hole;
    the deepest counts. A stop is over with its :meth:`probe`.

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
    stop
        Number of stops already made.
    battery_s
        Time in s the battery still lasts; by default it is full.

    Examples
    --------
    >>> from subsoil.field import Field
    >>> from subsoil.penetrometer import SMALL_CONE
    >>> from subsoil.simulation import simulate
    >>> field = Field.from_metres([(0, 0), (50, 0), (50, 40), (0, 40)])
    >>> truth = simulate(field, np.random.default_rng(1))
    >>> robot = SimulatedRobot(truth, Machine(SMALL_CONE), seed=1, position=(0.0, 0.0))
    >>> robot.go_to((30.0, 40.0)).metres, robot.probe().seconds, robot.stops
    (50.0, 50.0, 1)
    """

    def __init__(
        self,
        truth: Truth,
        machine: Machine,
        *,
        seed: int,
        position: Place,
        stop: int = 0,
        battery_s: float | None = None,
    ) -> None:
        self.truth, self.machine, self.seed = truth, machine, seed
        self.position: Place = (float(position[0]), float(position[1]))
        self.stops = stop
        self.battery_s = machine.battery_s if battery_s is None else battery_s
        self._resting = False

    def go_to(self, at: Place) -> Arrival:
        """Drive to a place given as easting and northing in m.

        Raises
        ------
        BatteryError
            If the battery does not last for the drive and a stop with all its tries; the robot
            then stays where it is.
        RobotError
            If the place is not a place, or the robot was stopped.
        """
        if not (isfinite(at[0]) and isfinite(at[1])):
            raise RobotError(f"cannot drive to ({at[0]:g}, {at[1]:g})", remedy="give metres")
        metres = hypot(at[0] - self.position[0], at[1] - self.position[1])
        seconds = metres / self.machine.speed_mps
        self._check_ready(seconds + self.machine.longest_stop_s)
        self.battery_s -= seconds
        self.position = (float(at[0]), float(at[1]))
        return Arrival(self._reported(self.position, self._stream()), metres, seconds)

    def probe(self) -> Push | Refusal:
        """Push the rod in here, and again beside the hole while the force limit ends the push.

        Raises
        ------
        BatteryError
            If the battery does not last for all tries.
        RobotError
            If the robot was stopped.
        """
        self._check_ready(self.machine.longest_stop_s)
        rng = self._stream()
        east, north = self._reported(self.position, rng)
        pushes = self._pushes(rng)
        seconds = self.machine.stop_s + (len(pushes) - 1) * self.machine.retry_s
        self.stops += 1
        self.battery_s -= seconds
        (across, along), best = max(pushes, key=lambda each: each[1].depth_m[-1])
        if best.depth_m[-1] < self.machine.usable_m:
            reason = f"the rod got no deeper than {best.depth_m[-1]:.3f} m"
            return Refusal(reason, seconds, len(pushes))
        return Push((east + across, north + along), best, seconds, len(pushes))

    def stop(self) -> None:
        """Come to rest and stay: driving or probing again raises :class:`RobotError`."""
        self._resting = True

    def _pushes(self, rng: np.random.Generator) -> list[tuple[Place, Insertion]]:
        """Offset of the hole on the gantry and what the push there gave, until one goes through."""
        pushes: list[tuple[Place, Insertion]] = []
        for k in range(self.machine.tries):
            offset = self._gantry(k)
            hole = (self.position[0] + offset[0], self.position[1] + offset[1])
            kpa = self.truth.reading(self.truth.field.nearest_cell(hole))
            pushes.append((offset, push(self.machine, self.truth.layers, kpa, rng)))
            if pushes[-1][1].ending == "stroke":
                break
        return pushes

    def _gantry(self, push_number: int) -> Place:
        """Offset in m: none at first, then spread around the first hole, starting to the east."""
        if push_number == 0:
            return (0.0, 0.0)
        angle = 2.0 * pi * (push_number - 1) / (self.machine.tries - 1)
        return (self.machine.gantry_m * cos(angle), self.machine.gantry_m * sin(angle))

    def _stream(self) -> np.random.Generator:
        return np.random.default_rng(
            np.random.SeedSequence(self.seed, spawn_key=(ROBOT, self.stops))
        )

    def _reported(self, at: Place, rng: np.random.Generator) -> Place:
        error = self.machine.fix_sd_m * rng.standard_normal(2)
        return (at[0] + float(error[0]), at[1] + float(error[1]))

    def _check_ready(self, seconds: float) -> None:
        if self._resting:
            raise RobotError("the robot was stopped", remedy="start it anew")
        if seconds > self.battery_s:
            raise BatteryError(
                f"{self.battery_s / 60:.0f} minutes of battery are left and the next stop may "
                f"take {seconds / 60:.0f}",
                where=f"stop {self.stops + 1}",
                remedy="change the battery, then `subsoil resume --fresh-battery`",
            )
