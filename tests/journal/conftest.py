"""Survey files to tamper with, and other programs that look at them."""

from __future__ import annotations

import shutil
import sqlite3
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import pytest

from subsoil.agent import (
    Arrival,
    Assignment,
    Push,
    Refusal,
    Robot,
    Unreachable,
    drive,
)
from subsoil.errors import RobotError
from subsoil.journal import create, open_journal
from subsoil.land.field import Field
from subsoil.layers import Layers
from subsoil.penetrometer import SMALL_CONE
from subsoil.reports import Source
from subsoil.simulation import Truth
from subsoil.survey import LocalDispatch, fold, opening
from subsoil.survey.events import Configured, Opened, Simulation
from subsoil.survey.simulated import robot_of

Configure = Callable[..., Configured]
Work = Callable[[LocalDispatch, Truth], str]


@pytest.fixture(scope="session")
def pond_opened(plot: Field) -> Opened:
    """The plot, with a keep-out, somewhere in England."""
    pond = Field.from_metres([(12, 12), (18, 12), (18, 18), (12, 18)]).boundary
    return opening(replace(plot, crs="EPSG:32630", keep_outs=(pond,)), Layers(), SMALL_CONE)


@pytest.fixture(scope="session")
def half_done_file(
    tmp_path_factory: pytest.TempPathFactory,
    pond_opened: Opened,
    configured: Configure,
    plot_truth: Truth,
) -> Path:
    """A survey closed after a refusal and five readings, with stops still to make."""
    path = tmp_path_factory.mktemp("half") / "survey.gpkg"
    with create(path, pond_opened) as journal:
        dispatch = LocalDispatch(fold(journal.events()), journal)
        dispatch.record(configured(strategy="adaptive-greedy"))
        dispatch.join("robot", "simulator", simulation=Simulation(world="simulated", seed=3))
        robot = Stony(robot_of(dispatch.survey, plot_truth, name="robot"))
        with pytest.raises(RobotError, match="enough"):
            drive("robot", robot, dispatch, source=Source(kind="simulator"))
    return path


class Stony:
    """A robot that meets a stone at its second stop, and has had enough at its seventh."""

    def __init__(self, robot: Robot) -> None:
        self.robot, self.pushes = robot, 0

    def go_to(self, stop: Assignment) -> Arrival | Unreachable:
        return self.robot.go_to(stop)

    def probe(self) -> Push | Refusal:
        self.pushes += 1
        if self.pushes == 7:
            raise RobotError("enough")
        outcome = self.robot.probe()
        return Refusal("stone", seconds=30.0, tries=2) if self.pushes == 2 else outcome

    def stop(self) -> None:
        self.robot.stop()


@pytest.fixture(scope="session")
def finished_file(
    tmp_path_factory: pytest.TempPathFactory, half_done_file: Path, plot_truth: Truth, work: Work
) -> Path:
    """The same survey, finished."""
    path = tmp_path_factory.mktemp("whole") / "survey.gpkg"
    shutil.copy(half_done_file, path)
    with open_journal(path) as journal:
        work(LocalDispatch(fold(journal.events()), journal), plot_truth)
    return path


@pytest.fixture
def half_done(half_done_file: Path, tmp_path: Path) -> Path:
    return Path(shutil.copy(half_done_file, tmp_path / "survey.gpkg"))


@pytest.fixture
def finished(finished_file: Path, tmp_path: Path) -> Path:
    return Path(shutil.copy(finished_file, tmp_path / "survey.gpkg"))


@pytest.fixture
def program() -> Iterator[Callable[..., subprocess.Popen[str]]]:
    """Start Python code in a process of its own, with arguments; killed at the end of a test."""
    started: list[subprocess.Popen[str]] = []

    def start(code: str, *arguments: object) -> subprocess.Popen[str]:
        process = subprocess.Popen(
            [sys.executable, "-c", code, *map(str, arguments)],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
        )  # fmt: skip
        started.append(process)
        return process

    yield start
    for process in started:
        process.kill()
        process.communicate()


WRITER = """
import sys
from pathlib import Path
from subsoil.survey.events import Continued
from subsoil.journal import open_journal, read_events
from subsoil.survey import fold

path = Path(sys.argv[1])
journal = open_journal(path)
survey = fold(journal.events())
print("open", flush=True)
for line in sys.stdin:
    word = line.strip()
    if word == "close":
        journal.close()
    elif word == "read":
        read_events(path)
    else:
        journal.append(Continued(id=word), survey)
    print("done", flush=True)
"""
"""Opens a survey and does what each line says: writes an event of that id, reads, closes."""


class Writer:
    """A process that has a survey open."""

    def __init__(self, process: subprocess.Popen[str]) -> None:
        self.process = process
        assert process.stdout is not None
        assert process.stdout.readline() == "open\n"

    def told(self, *words: str) -> None:
        """Have events written under these ids, or the file ``read`` or ``close``d."""
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        for word in words:
            print(word, file=self.process.stdin, flush=True)
            assert self.process.stdout.readline() == "done\n"

    def killed(self) -> None:
        """End it as a power cut would."""
        self.process.kill()
        self.process.wait()


@pytest.fixture
def writer(program: Callable[..., subprocess.Popen[str]]) -> Callable[[Path], Writer]:
    return lambda path: Writer(program(WRITER, path))


@pytest.fixture(scope="session")
def change() -> Callable[..., None]:
    """Change a file with plain sqlite, as any program could."""

    def statements(path: Path, *lines: str) -> None:
        with closing(sqlite3.connect(path, isolation_level=None)) as database:
            for line in lines:
                database.execute(line)

    return statements
