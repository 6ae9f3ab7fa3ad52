"""Agents, the stops that are theirs to make, and the stops they made."""

from __future__ import annotations

from dataclasses import dataclass

from subsoil.reports import Kind, Place, Refused, Sampled


@dataclass(frozen=True)
class Lease:
    """A stop that was handed out and is not over.

    Attributes
    ----------
    id
        That of the assignment.
    number
        Its number in the survey.
    cell
        Cell to probe.
    pushes, made
        Pushes to make there, and made.
    """

    id: str
    number: int
    cell: int
    pushes: int = 1
    made: int = 0


@dataclass(frozen=True)
class Agent:
    """A robot or a person at work.

    Attributes
    ----------
    name, kind
        Who and what it is.
    position
        Where it says it is, easting and northing in m.
    metres, seconds
        Way it drove and time it spent.
    charged_at
        Value of ``seconds`` when its battery was last full.
    leases
        Stops it is to make, in order.
    here
        Whether it has not left.
    """

    name: str
    kind: Kind
    position: Place
    metres: float = 0.0
    seconds: float = 0.0
    charged_at: float = 0.0
    leases: tuple[Lease, ...] = ()
    here: bool = True


@dataclass(frozen=True)
class Stop:
    """A stop that was made, or is being made.

    Attributes
    ----------
    id
        That of its assignment, or of its report where nobody asked for it.
    agent
        Who made it.
    cell
        Cell it counts for; -1 if it lies in none.
    readings
        Reports of its pushes, in order; each has a place and a time of its own.
    refusal
        What ended it without a reading, or without a further one.
    """

    id: str
    agent: str
    cell: int
    readings: tuple[Sampled, ...] = ()
    refusal: Refused | None = None
