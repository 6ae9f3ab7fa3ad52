"""Events of every format there has been, as events of today.

=======  =============================================================================
format
=======  =============================================================================
0        versions 0.1: one robot, always simulated by the command line; no times, no
         agents, no assignments; force in N under the survey's cone; a stop is its cell
1        today
=======  =============================================================================

A file says its format in its first event; :class:`~subsoil.survey.events.Continued` says that it
goes on in a newer one. What an older format did not say is not made up: assignments of format 0
get ids that follow from their reports.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from typing import Any

from subsoil.errors import JournalError, brief
from subsoil.reports import Reading, Refused, Sampled, Source
from subsoil.survey.events import (
    FORMAT,
    Assigned,
    BatterySwapped,
    Configured,
    Continued,
    Event,
    Finished,
    Fitted,
    Joined,
    Opened,
    Planned,
    Simulation,
    from_json,
)
from subsoil.survey.records import FitRecord
from subsoil.survey.settings import Settings

Old = dict[str, Any]
METHOD_0 = "0.1"
"""Version of what files of format 0 were computed by."""
_SIMULATED_0 = "simulated robot"
_WORLDS_0 = {"simulated", "riseholme", "surrogate", "signal"}


class Reader:
    """Reads the events of a file one after the other, from whatever format they are in."""

    def __init__(self) -> None:
        self.format = FORMAT
        self._upcast: Mapping[str, Callable[[Old], tuple[Event, ...]]] = {}

    def read(self, body: str, recorded: str) -> tuple[Event, ...]:
        """Events of today that a recorded line stands for: one, as a rule.

        Parameters
        ----------
        body
            Line of JSON.
        recorded
            When it was recorded, which events of format 0 do not say.

        Raises
        ------
        pydantic.ValidationError
            If it is not an event.
        JournalError
            If its format is newer than this version of subsoil.
        ValueError, KeyError, TypeError
            If it is not an event of its format.
        """
        old = json.loads(body)
        if old["kind"] in ("opened", "continued"):
            self._enter(int(old.get("format", 0)))
        if not self._upcast:
            return (from_json(body),)
        del old["kind"]
        old |= {"time": recorded, "clock": "host"}
        return self._upcast[json.loads(body)["kind"]](old)

    def _enter(self, format_: int) -> None:
        """Read what follows in a format.

        Raises
        ------
        JournalError
            If nothing here reads it.
        """
        if not 0 <= format_ <= FORMAT:
            raise JournalError(
                f"its format {brief(str(format_))} is newer than {FORMAT}, "
                "the newest that is read here",
                remedy="update subsoil",
            )
        self.format = format_
        self._upcast = _Format0().table if format_ == 0 else {}


class _Format0:
    """Events of format 0 to events of today."""

    def __init__(self) -> None:
        self.table: Mapping[str, Callable[[Old], tuple[Event, ...]]] = {
            "opened": lambda old: (Opened(**old, format=0, method=METHOD_0),),
            "configured": self._configured,
            "planned": self._planned,
            "sampled": self._sampled,
            "refused": self._refused,
            "fitted": self._fitted,
            "battery-swapped": lambda old: (BatterySwapped(**old, agent=self._first),),
            "finished": lambda old: (Finished(**old),),
        }
        self._agents: list[str] = []
        self._world, self._seed = "", 0
        self._asked: dict[int, int] = {}
        self._assignments: dict[int, str] = {}

    @property
    def _first(self) -> str:
        return self._agents[0] if self._agents else _SIMULATED_0

    @property
    def _source(self) -> Source:
        return Source(kind="simulator" if self._world in _WORLDS_0 else "robot")

    def _configured(self, old: Old) -> tuple[Event, ...]:
        stamp = _stamp(old)
        self._world, self._seed = old.pop("world"), old["seed"]
        event = Configured(**stamp, method=METHOD_0, settings=Settings(**old))
        if self._world not in _WORLDS_0:
            return (event,)
        return (event, *self._joined(_SIMULATED_0, stamp))

    def _joined(self, agent: str, stamp: Old) -> tuple[Event, ...]:
        if agent in self._agents:
            return ()
        self._agents.append(agent)
        simulation = None
        if self._source.kind == "simulator":
            simulation = Simulation(world=self._world, seed=self._seed)
        kind = self._source.kind
        return (Joined(**_derived(stamp, agent), agent=agent, source=kind, simulation=simulation),)

    def _planned(self, old: Old) -> tuple[Event, ...]:
        event = Planned(**old)
        self._asked = dict(zip(event.cells, event.pushes, strict=False))
        return (event,)

    def _reported(self, old: Old) -> tuple[tuple[Event, ...], Old]:
        """What a report implies that format 0 did not say, and what all reports have."""
        stamp, cell, agent = _stamp(old), int(old.pop("cell")), old["agent"]
        before = self._joined(agent, stamp)
        if cell not in self._assignments:
            assigned = Assigned(
                **_derived(stamp, "assigned"), agent=agent, cell=cell,
                pushes=self._asked.get(cell, 1),
            )  # fmt: skip
            self._assignments[cell] = assigned.id
            before = (*before, assigned)
        return before, {**stamp, **old, "assignment": self._assignments[cell]}

    def _sampled(self, old: Old) -> tuple[Event, ...]:
        before, report = self._reported(old)
        reading = Reading(
            depth_m=report.pop("depth_m"), force_n=report.pop("force_n"),
            ending=report.pop("ending"),
        )  # fmt: skip
        return (*before, Sampled(**report, reading=reading, source=self._source))

    def _refused(self, old: Old) -> tuple[Event, ...]:
        before, report = self._reported(old)
        return (*before, Refused(**report, source=self._source))

    def _fitted(self, old: Old) -> tuple[Event, ...]:
        models, why = old.pop("models"), old.pop("why")
        fits = tuple(
            FitRecord(model=model, why=words, is_prior="prior" in words)
            for model, words in zip(models, why, strict=True)
        )
        return (Fitted(**old, fits=fits),)


def _stamp(old: Old) -> Old:
    """Take out of an event what all events have."""
    return {name: old.pop(name) for name in ("id", "time", "clock")}


def _derived(stamp: Old, name: str) -> Old:
    """Identity of an event that another one implies."""
    return {**stamp, "id": f"{stamp['id']}/{name}"}


__all__ = ["METHOD_0", "Continued", "Reader"]
