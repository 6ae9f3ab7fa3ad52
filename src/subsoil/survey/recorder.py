"""Who keeps the events of a survey, and who is told of them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from subsoil.survey.events import Event
from subsoil.survey.state import Survey


class Recorder(Protocol):
    """Keeps events."""

    def append(self, event: Event, survey: Survey) -> None:
        """Keep an event, with the state after it; returns when it cannot be lost any more."""


class Memory:
    """Recorder that keeps events in memory."""

    def __init__(self) -> None:
        self.events: list[Event] = []

    def append(self, event: Event, survey: Survey) -> None:  # noqa: ARG002 - a Recorder
        """Keep an event as long as the process lives."""
        self.events.append(event)


Observer = Callable[[Survey, Event], None]
"""Told of every event and the state after it."""
