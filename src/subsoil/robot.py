"""What subsoil asks of a robot, or of a person who plays one.

Three methods: drive somewhere, push the rod, stop. Everything a robot does leaves as a value; a
push that cannot be made is a :class:`Refusal`, not an exception.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from subsoil.penetrometer import Insertion


@dataclass(frozen=True)
class Arrival:
    """The robot came to a stop.

    Attributes
    ----------
    at
        Easting and northing in m where it says it is.
    metres
        Way driven for this stop, by the odometer, in m.
    seconds
        Time that took, in s.
    """

    at: tuple[float, float]
    metres: float
    seconds: float


@dataclass(frozen=True)
class Push:
    """The rod went in and came out again.

    Attributes
    ----------
    at
        Easting and northing in m of the hole.
    insertion
        Force by depth.
    seconds
        Time at the stop, retries included, in s.
    tries
        Number of pushes made at this stop, the kept one included.
    """

    at: tuple[float, float]
    insertion: Insertion
    seconds: float
    tries: int = 1


@dataclass(frozen=True)
class Refusal:
    """No push here gave a usable reading.

    Attributes
    ----------
    reason
        Why, in a few words.
    seconds
        Time at the stop in s.
    tries
        Number of pushes made at this stop.
    """

    reason: str
    seconds: float
    tries: int = 1


class Robot(Protocol):
    """A carrier of a penetrometer."""

    def go_to(self, at: tuple[float, float]) -> Arrival:
        """Drive to a place given as easting and northing in m.

        Raises
        ------
        RobotError
            If it cannot get there, or go on at all.
        """

    def probe(self) -> Push | Refusal:
        """Push the rod in here, with as many retries as it takes or the machine allows.

        Called again before driving elsewhere, it makes a further push beside the holes so far.
        """

    def stop(self) -> None:
        """Come to rest and stay."""
