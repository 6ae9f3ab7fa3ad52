"""A survey file is there whole, or not at all."""

from __future__ import annotations

import os
import random
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from subsoil.errors import JournalError
from subsoil.journal import create, open_journal, read_survey, verify
from subsoil.survey.events import Opened

CREATE = """
import sys
from pathlib import Path
from subsoil.survey.events import from_json
from subsoil.journal import create
opening = from_json(sys.argv[2])
print("ready", flush=True)
sys.stdin.readline()
create(Path(sys.argv[1]), opening).close()
"""
SYSTEM_CALLS = ["openat", "pwrite64", "fdatasync", "fsync", "unlink", "link", "flock",
                "close", "fcntl"]  # fmt: skip


def assert_good_or_absent(path: Path) -> bool:
    """Whether the file is there; it then is a survey."""
    if not os.path.lexists(path):
        return False
    assert len(read_survey(path).events) == 1
    assert verify(path).findings == ()
    return True


@pytest.mark.skipif(not shutil.which("strace"), reason="strace is not installed")
@pytest.mark.parametrize("call", SYSTEM_CALLS)
@pytest.mark.slow
def test_a_start_killed_at_any_system_call_leaves_a_survey_or_nothing(
    tmp_path: Path, pond_opened: Opened, call: str
) -> None:
    killed = 0
    for when in (1, 2, 4, 9):
        path = tmp_path / f"{when}.gpkg"
        command = [sys.executable, "-c", CREATE, str(path), pond_opened.model_dump_json()]
        with subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        ) as p:
            assert p.stdout is not None
            p.stdout.readline()
            tracer = subprocess.Popen(
                ["strace", "-f", "-qq", "-o", os.devnull, "-e", f"trace={call}",
                 "-e", f"inject={call}:signal=KILL:when={when}", "-p", str(p.pid)],
            )  # fmt: skip
            time.sleep(0.3)
            p.communicate("\n")
            tracer.wait()
        killed += p.returncode == -signal.SIGKILL
        if not assert_good_or_absent(path):
            create(path, pond_opened).close()
        create(tmp_path / f"next{when}.gpkg", pond_opened).close()
        assert_good_or_absent(path)
        assert [left.name for left in tmp_path.glob(".*")] == []
    assert killed


def test_a_start_killed_at_random_leaves_a_survey_or_nothing(
    tmp_path: Path, pond_opened: Opened, program: Callable[..., subprocess.Popen[str]]
) -> None:
    chance = random.Random(8)
    for attempt in range(4):
        path = tmp_path / f"{attempt}.gpkg"
        starting = program(CREATE, path, pond_opened.model_dump_json())
        assert starting.stdout is not None
        assert starting.stdin is not None
        starting.stdout.readline()
        print(file=starting.stdin, flush=True)
        time.sleep(chance.uniform(0.0, 0.03))
        starting.kill()
        starting.wait()
        assert_good_or_absent(path)


def test_what_a_killed_start_left_is_taken_away_by_the_next(
    tmp_path: Path, pond_opened: Opened
) -> None:
    for end in ("", "-journal"):
        (tmp_path / f".subsoil-unfinished-0123{end}").write_bytes(b"half")
    create(tmp_path / "s.gpkg", pond_opened).close()
    assert [path.name for path in tmp_path.iterdir()] == ["s.gpkg"]


def test_a_dangling_link_is_not_followed(tmp_path: Path, pond_opened: Opened) -> None:
    (tmp_path / "s.gpkg").symlink_to("victim.gpkg")
    with pytest.raises(JournalError, match="exists already"):
        create(tmp_path / "s.gpkg", pond_opened)
    assert [path.name for path in tmp_path.iterdir()] == ["s.gpkg"]


@pytest.mark.parametrize("there", ["file", "folder", "empty file"])
def test_what_is_there_is_left_alone(tmp_path: Path, pond_opened: Opened, there: str) -> None:
    path = tmp_path / "s.gpkg"
    path.mkdir() if there == "folder" else path.write_bytes(b"x" * (there == "file"))
    with pytest.raises(JournalError, match="exists already"):
        create(path, pond_opened)
    assert path.is_dir() == (there == "folder")
    assert [p.name for p in tmp_path.iterdir()] == ["s.gpkg"]


@pytest.mark.parametrize("end", ["-wal", "-journal"])
def test_what_another_survey_left_under_the_name_is_not_taken_for_its_own(
    tmp_path: Path, pond_opened: Opened, end: str
) -> None:
    left = tmp_path / f"s.gpkg{end}"
    left.write_bytes(b"events")
    with pytest.raises(JournalError, match="left from another survey"):
        create(tmp_path / "s.gpkg", pond_opened)
    assert [path.name for path in tmp_path.iterdir()] == [left.name]


def test_a_missing_folder_is_named(tmp_path: Path, pond_opened: Opened) -> None:
    with pytest.raises(JournalError, match=r"none: there is no such folder"):
        create(tmp_path / "none" / "s.gpkg", pond_opened)


def test_a_file_has_the_rights_that_new_files_have(tmp_path: Path, pond_opened: Opened) -> None:
    (tmp_path / "plain").touch()
    create(tmp_path / "s.gpkg", pond_opened).close()
    assert (tmp_path / "s.gpkg").stat().st_mode == (tmp_path / "plain").stat().st_mode


@pytest.mark.parametrize("name", ["a b.gpkg", "ü?#%&.gpkg", "-s.gpkg", "n" * 240 + ".gpkg"])
def test_names_of_any_kind_do(tmp_path: Path, pond_opened: Opened, name: str) -> None:
    create(tmp_path / name, pond_opened).close()
    open_journal(tmp_path / name).close()
    assert verify(tmp_path / name).findings == ()


def test_too_long_a_name_is_said_and_leaves_nothing(tmp_path: Path, pond_opened: Opened) -> None:
    with pytest.raises(JournalError):
        create(tmp_path / ("n" * 300), pond_opened)
    assert list(tmp_path.iterdir()) == []
