"""Processes of a survey with several agents: one that owns its file, and one an agent.

A script, run by ``test_killed.py``; what they say to each other is a stand-in for a network.

    two_agents.py own FILE SOCKET
    two_agents.py work NAME SOCKET ACKNOWLEDGED
"""

from __future__ import annotations

import os
import sys
import time
from contextlib import suppress
from datetime import timedelta
from multiprocessing.connection import Client, Connection, Listener
from pathlib import Path
from threading import Thread
from typing import Any

from subsoil.agent import Assignment, Done, Wait, drive
from subsoil.errors import SubsoilError
from subsoil.journal import open_journal
from subsoil.reports import Report, Source
from subsoil.survey import LocalDispatch, Survey, fold
from subsoil.survey.simulated import robot_of, simulation_of
from subsoil.worlds import truth_of

KEY = b"survey"
SEED = 3


def own(file: Path, address: str) -> None:
    """Own a survey file, and serve agents until the process is killed."""
    with suppress(FileNotFoundError):
        Path(address).unlink()
    with open_journal(file) as journal, Listener(address, authkey=KEY) as listener:
        state = fold(journal.events())
        dispatch = LocalDispatch(state, journal, patience=timedelta(seconds=20))
        while True:
            with suppress(EOFError, ConnectionError):
                Thread(target=serve, args=(listener.accept(), dispatch), daemon=True).start()


def serve(connection: Connection, dispatch: LocalDispatch) -> None:
    """Answer an agent as long as it is there."""
    with suppress(EOFError, ConnectionError):
        while True:
            name, arguments = connection.recv()
            try:
                connection.send(answer(dispatch, name, arguments))
            except SubsoilError as error:
                connection.send(error)


def answer(dispatch: LocalDispatch, name: str, arguments: tuple[Any, ...]) -> object:
    match name:
        case "join":
            survey = dispatch.survey
            truth = truth_of("simulated", survey.field, survey.layers, SEED)
            simulation = simulation_of(truth, "simulated", SEED)
            (agent,) = arguments
            dispatch.join(agent, "simulator", simulation=simulation)
            return None
        case "survey":
            return dispatch.survey
        case "assign":
            return dispatch.assign(*arguments)
        case "report":
            dispatch.report(*arguments)
            return None
    raise AssertionError(name)


class Remote:
    """Dispatch of another process; asks again, with the same words, until there is an answer."""

    def __init__(self, address: str, acknowledged: Path) -> None:
        self._address = address
        self._connection: Connection | None = None
        self._acknowledged = acknowledged.open("a")

    def ask(self, name: str, *arguments: object) -> Any:
        while True:
            try:
                if self._connection is None:
                    self._connection = Client(self._address, authkey=KEY)
                self._connection.send((name, arguments))
                said = self._connection.recv()
            except (EOFError, OSError):
                self._connection = None
                time.sleep(0.02)
                continue
            if isinstance(said, SubsoilError):
                raise said
            return said

    def assign(self, agent: str, ahead: int = 1) -> Assignment | Wait | Done:
        answer: Assignment | Wait | Done = self.ask("assign", agent, ahead)
        return Wait(answer.reason, 0.05) if isinstance(answer, Wait) else answer

    def report(self, report: Report) -> None:
        self.ask("report", report)
        self._acknowledged.write(f"{report.id}\n")
        self._acknowledged.flush()
        os.fsync(self._acknowledged.fileno())


def work(name: str, address: str, acknowledged: Path) -> None:
    """Work on a survey until it is over."""
    remote = Remote(address, acknowledged)
    remote.ask("join", name)
    survey: Survey = remote.ask("survey")
    truth = truth_of("simulated", survey.field, survey.layers, SEED)
    robot = robot_of(survey, truth, 1000.0, name)
    print(drive(name, robot, remote, source=Source(kind="simulator")))


if __name__ == "__main__":
    if sys.argv[1] == "own":
        own(Path(sys.argv[2]), sys.argv[3])
    else:
        work(sys.argv[2], sys.argv[3], Path(sys.argv[4]))
