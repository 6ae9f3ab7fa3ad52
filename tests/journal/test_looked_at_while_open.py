"""What was acknowledged stays, whoever looks at the file or copies it meanwhile."""

from __future__ import annotations

import random
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from subsoil.journal import copy, open_journal, read_events, read_survey, verify

Start = Callable[[Path], Any]

SQLITE = """
import sqlite3, sys
database = sqlite3.connect(sys.argv[1])
print(database.execute("SELECT count(*) FROM events").fetchone()[0])
database.close()
"""
GDAL = """
import pyogrio, sys
print(pyogrio.read_info(sys.argv[1], layer="samples")["features"])
"""
SUBSOIL = """
import sys
from pathlib import Path
from subsoil.journal import read_events
print(len(read_events(Path(sys.argv[1]))))
"""
LOOKS = {"sqlite": SQLITE, "gdal": GDAL, "subsoil": SUBSOIL}


def look(path: Path, looker: str) -> None:
    """Open and close a file in another process."""
    code = [sys.executable, "-c", LOOKS[looker], str(path)]
    assert int(subprocess.run(code, capture_output=True, text=True, check=True).stdout) > 0


def ids(path: Path) -> list[str]:
    return [event.id for event in read_events(path)]


def copied_alone(path: Path) -> Path:
    return Path(shutil.copy(path, path.parent / "copy.gpkg"))


@pytest.mark.parametrize("looker", LOOKS)
def test_what_is_written_after_a_look_outlives_the_writer(
    half_done: Path, writer: Start, looker: str
) -> None:
    """The writer itself has read the file by another way before; that must not cost its locks."""
    open_ = writer(half_done)
    open_.told("a", "read")
    look(half_done, looker)
    open_.told("b", "c", "d", "e", "f")
    open_.killed()
    assert ids(half_done)[-6:] == ["a", "b", "c", "d", "e", "f"]
    assert verify(half_done).findings == ()


def test_what_is_written_after_a_rival_was_refused_outlives_the_writer(
    half_done: Path, writer: Start
) -> None:
    open_ = writer(half_done)
    rival = [sys.executable, "-m", "subsoil", "resume", str(half_done)]
    assert subprocess.run(rival, capture_output=True, check=False).returncode == 3
    open_.told("a", "b")
    look(half_done, "sqlite")
    open_.told("c")
    open_.killed()
    assert ids(half_done)[-3:] == ["a", "b", "c"]


def test_a_copy_of_an_open_file_alone_says_that_it_may_lack_the_last_events(
    half_done: Path, writer: Start
) -> None:
    open_ = writer(half_done)
    open_.told("a", "b")
    alone = copied_alone(half_done)
    (note,) = read_survey(alone).notes
    assert note.startswith("copied while open, may lack the last events")
    assert f"process {open_.process.pid}" in note


def test_a_copy_made_before_the_first_event_says_so_too(half_done: Path, writer: Start) -> None:
    writer(half_done)
    assert "copied while open" in read_survey(copied_alone(half_done)).notes[0]


def test_a_copy_of_a_resumed_file_whose_writer_was_killed_says_so_too(
    half_done: Path, writer: Start
) -> None:
    first = writer(half_done)
    first.told("a")
    first.killed()
    second = writer(half_done)
    second.told("b")
    assert "copied while open" in read_survey(copied_alone(half_done)).notes[0]


def test_a_copy_of_an_open_file_can_be_gone_on_with_and_says_so(
    half_done: Path, writer: Start
) -> None:
    writer(half_done).told("a", "b")
    alone = copied_alone(half_done)
    with open_journal(alone) as journal:
        assert "copied while open" in journal.notes[0]
    assert read_survey(alone).notes == ()
    assert verify(alone).findings == ()


def test_a_copy_of_such_a_copy_says_so_too(half_done: Path, writer: Start) -> None:
    writer(half_done).told("a")
    again = half_done.parent / "again.gpkg"
    copy(copied_alone(half_done), again)
    assert "copied while open" in read_survey(again).notes[0]


def test_an_open_file_is_no_copy(half_done: Path, writer: Start) -> None:
    writer(half_done).told("a")
    assert read_survey(half_done).notes == ()


def test_a_copy_of_a_closed_file_is_as_good_as_the_file(half_done: Path, writer: Start) -> None:
    open_ = writer(half_done)
    open_.told("a", "close")
    record = read_survey(copied_alone(half_done))
    assert record.notes == ()
    assert record.events[-1].id == "a"


@pytest.mark.parametrize("looker", [None, *LOOKS])
def test_a_file_whose_writer_was_killed_is_no_copy(
    half_done: Path, writer: Start, looker: str | None
) -> None:
    open_ = writer(half_done)
    open_.told("a")
    open_.killed()
    if looker:
        look(half_done, looker)
    assert read_survey(half_done).notes == ()
    with open_journal(half_done) as journal:
        assert journal.notes == ()
        assert journal.events()[-1].id == "a"


def test_a_survey_is_closed_while_another_program_has_it_open(
    half_done: Path, writer: Start, program: Callable[..., subprocess.Popen[str]]
) -> None:
    open_ = writer(half_done)
    open_.told("a")
    code = (
        "import sqlite3, sys; d = sqlite3.connect(sys.argv[1], isolation_level=None);"
        "d.execute('BEGIN'); d.execute('SELECT 1 FROM events').fetchone();"
        "print(1, flush=True);"
        "sys.stdin.readline(); d.close(); print('closed', flush=True)"
    )
    looking = program(code, half_done)
    assert looking.stdout is not None
    looking.stdout.readline()
    open_.told("b", "close")
    assert ids(half_done)[-2:] == ["a", "b"]
    looking.communicate("\n")
    assert ids(half_done)[-2:] == ["a", "b"]
    assert read_survey(half_done).notes == ()
    open_journal(half_done).close()
    assert [path.name for path in half_done.parent.iterdir()] == [half_done.name]


LOOKING_ALL_THE_TIME = """
import subprocess, sys
while True:
    for code in sys.argv[2:]:
        subprocess.run([sys.executable, "-c", code, sys.argv[1]], stdout=subprocess.DEVNULL,
                       stderr=subprocess.DEVNULL)
    print("looked", flush=True)
"""


@pytest.mark.slow
def test_a_writer_killed_thirty_times_while_others_look_loses_nothing(
    half_done: Path, writer: Start, program: Callable[..., subprocess.Popen[str]]
) -> None:
    looking = program(LOOKING_ALL_THE_TIME, half_done, *LOOKS.values())
    chance, told = random.Random(3), []
    for life in range(30):
        open_ = writer(half_done)
        for k in range(chance.randrange(1, 40)):
            told.append(f"{life}-{k}")
            open_.told(told[-1], *(["read"] if chance.random() < 0.2 else []))
            time.sleep(chance.uniform(0.0, 0.03))
        open_.killed()
    looking.kill()
    assert ids(half_done)[-len(told) :] == told
    assert verify(half_done).findings == ()
    assert read_survey(half_done).notes == ()
