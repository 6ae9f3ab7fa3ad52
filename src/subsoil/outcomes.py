"""What passes between a dispatch, an agent and its robot: stops to make, and what came of them."""

from __future__ import annotations

from dataclasses import dataclass

from subsoil.reports import Place, Reading


@dataclass(frozen=True)
class Assignment:
    """A stop for an agent to make.

    Attributes
    ----------
    id
        What reports about it refer to.
    number
        Its number in the survey, from 0: no other has it.
    cell
        Index of the cell to probe.
    at, frame
        Where in it to stop, easting and northing in m in the field's frame, and that frame's name;
        a local frame has none.
    lonlat
        The same place as longitude and latitude in degrees; ``None`` in a local frame.
    pushes
        How often to push the rod there, in all.
    made
        How many of these pushes were made already.
    ahead
        Stops that are this agent's too, to be made after this one.
    """

    id: str
    number: int
    cell: int
    at: Place
    frame: str = ""
    lonlat: Place | None = None
    pushes: int = 1
    made: int = 0
    ahead: tuple[Assignment, ...] = ()


@dataclass(frozen=True)
class Wait:
    """There is no stop for this agent now, but there may be one later.

    Attributes
    ----------
    reason
        Why.
    seconds
        After what time in s to ask again.
    """

    reason: str
    seconds: float = 1.0


@dataclass(frozen=True)
class Done:
    """There is nothing left to do, and why."""

    reason: str


@dataclass(frozen=True)
class Arrival:
    """The robot came to a stop.

    Attributes
    ----------
    at
        Where it says it is.
    metres
        Way driven for this stop, by the odometer, in m.
    seconds
        Time that took, in s.
    frame
        Frame of ``at``: empty for the field's, or :data:`subsoil.reports.LONLAT`.
    accuracy_m
        Standard deviation of the place in m, if the receiver says.
    """

    at: Place
    metres: float
    seconds: float
    frame: str = ""
    accuracy_m: float | None = None


@dataclass(frozen=True)
class Unreachable:
    """The robot did not get there.

    Attributes
    ----------
    reason
        Why; :data:`subsoil.reports.STOPPED` if it was told to stop.
    at
        Where it says it is.
    metres, seconds
        Way driven in m and time spent in s all the same.
    frame
        Frame of ``at``.
    """

    reason: str
    at: Place
    metres: float = 0.0
    seconds: float = 0.0
    frame: str = ""


@dataclass(frozen=True)
class Push:
    """The rod went in and came out again.

    Attributes
    ----------
    at
        Where the hole is, in the frame of the arrival.
    reading
        Force or pressure by depth.
    seconds
        Time at the stop, retries included, in s.
    tries
        Number of pushes made at this stop, the kept one included.
    """

    at: Place
    reading: Reading
    seconds: float
    tries: int = 1


@dataclass(frozen=True)
class Refusal:
    """No push here gave a usable reading.

    Attributes
    ----------
    reason
        Why, in a few words; :data:`subsoil.reports.STOPPED` if the robot was told to stop.
    seconds
        Time at the stop in s.
    tries
        Number of pushes made at this stop.
    """

    reason: str
    seconds: float
    tries: int = 1
