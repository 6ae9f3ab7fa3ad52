"""Files that are no survey, or no longer one, are refused on one line."""

from __future__ import annotations

import os
import random
import shutil
import sqlite3
import subprocess
import sys
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from subsoil.errors import SubsoilError
from subsoil.journal import copy, open_journal, read_survey, verify
from subsoil.survey import fold

Use = Callable[[Path], object]
USES: list[Use] = [read_survey, verify, open_journal]


def outcome(use: Use, path: Path) -> str:
    """What a use ends in: nothing, or one line."""
    said = ""
    try:
        result = use(path)
    except SubsoilError as error:
        said = str(error)
    else:
        if close := getattr(result, "close", None):
            close()
    assert said.isprintable()
    assert not said or "remedy" in said
    return said


def page_of(path: Path, table: str) -> int:
    with closing(sqlite3.connect(path)) as database:
        query = "SELECT rootpage FROM sqlite_master WHERE name = ?"
        return int(database.execute(query, (table,)).fetchone()[0])


def truncated(path: Path) -> None:
    os.truncate(path, path.stat().st_size // 2)


def without_a_page_of_events(path: Path) -> None:
    offset = 4096 * (page_of(path, "events") - 1)
    with path.open("r+b") as file:
        file.seek(offset)
        file.write(bytes(4096))


def with_a_table_whose_name_is_no_text(path: Path) -> None:
    content = path.read_bytes()
    path.write_bytes(content.replace(b"CREATE TABLE samples", b"CREATE TABLE s\xff\xfeples", 1))


def with_an_event_that_is_no_text(path: Path) -> None:
    content = path.read_bytes()
    path.write_bytes(content.replace(b'"kind":"sampled"', b'"kind":"s\xff\xfepled"', 1))


def of_a_newer_sqlite(path: Path) -> None:
    with path.open("r+b") as file:
        file.seek(18)
        file.write(b"\x09\x09")


def of_another_program(path: Path) -> None:
    path.unlink()
    with closing(sqlite3.connect(path, isolation_level=None)) as database:
        database.execute("PRAGMA application_id = 1196444487")
        database.execute("CREATE TABLE events (fid INTEGER PRIMARY KEY)")


def with_another_table_of_events(path: Path) -> None:
    with closing(sqlite3.connect(path, isolation_level=None)) as database:
        database.execute("DROP TABLE events")
        database.execute("CREATE TABLE events (fid INTEGER PRIMARY KEY)")


def without_layers(path: Path) -> None:
    with closing(sqlite3.connect(path, isolation_level=None)) as database:
        database.execute("DROP TABLE gpkg_geometry_columns")
        database.execute("DROP TABLE samples")


def empty(path: Path) -> None:
    path.write_bytes(b"")


def a_folder(path: Path) -> None:
    path.unlink()
    path.mkdir()


def a_dangling_link(path: Path) -> None:
    path.unlink()
    path.symlink_to("nowhere.gpkg")


def a_link_to_itself(path: Path) -> None:
    path.unlink()
    path.symlink_to(path.name)


def a_pipe(path: Path) -> None:
    path.unlink()
    os.mkfifo(path)


DAMAGES = [
    truncated, without_a_page_of_events, with_a_table_whose_name_is_no_text,
    with_an_event_that_is_no_text, of_a_newer_sqlite, of_another_program,
    with_another_table_of_events, without_layers, empty, a_folder, a_dangling_link,
    a_link_to_itself, a_pipe,
]  # fmt: skip


@pytest.mark.parametrize("damage", DAMAGES)
def test_a_file_that_is_no_survey_any_more_is_said_on_one_line(
    half_done: Path, damage: Callable[[Path], None]
) -> None:
    damage(half_done)
    said = [outcome(use, half_done) for use in USES]
    assert said[1] or verify(half_done).findings
    if damage is not without_layers:
        assert said[0]
        assert said[2] or with_an_event_that_is_no_text is damage


def test_random_damage_never_ends_in_a_traceback(half_done: Path) -> None:
    whole, chance = half_done.read_bytes(), random.Random(5)
    for _ in range(60):
        content = bytearray(whole)
        place = chance.randrange(len(content))
        for k in range(place, min(place + chance.choice([1, 20]), len(content))):
            content[k] = chance.randrange(256)
        half_done.write_bytes(content)
        for use in (read_survey, verify):
            outcome(use, half_done)


@pytest.mark.skipif(os.geteuid() != 0, reason="only root may become somebody else")
@pytest.mark.parametrize(("folder", "file"), [(0o755, 0o000), (0o700, 0o644), (0o755, 0o444)])
def test_a_file_without_rights_is_said(half_done: Path, folder: int, file: int) -> None:
    code = (
        "import os, sys; from pathlib import Path; from subsoil.journal import *;"
        "from subsoil.errors import JournalError\n"
        "os.setuid(65534)\n"
        "for use in (read_survey, open_journal):\n"
        "    try: use(Path(sys.argv[1]))\n"
        "    except JournalError as error: print(error)"
    )
    with TemporaryDirectory() as room:
        path = Path(shutil.copy(half_done, room))
        path.chmod(file)
        Path(room).chmod(folder)
        command = [sys.executable, "-c", code, str(path)]
        said = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    lines = said.splitlines()
    assert len(lines) == (1 if file == 0o444 else 2)
    assert all("check" in line and "Permission denied" in line for line in lines[-1:])


@pytest.mark.parametrize("statement", [
    "UPDATE sqlite_sequence SET seq = 'x'", "UPDATE subsoil_anchor SET seq = 'x'",
    "UPDATE events SET digest = x'ff00' WHERE seq = (SELECT max(seq) FROM events)",
    "INSERT INTO subsoil_owner(who, since, path, device, number, boot)"
    " VALUES (x'ff', x'ff', x'ff', x'ff', x'ff', x'ff')",
])  # fmt: skip
def test_columns_of_other_kinds_are_no_traceback(half_done: Path, statement: str) -> None:
    with closing(sqlite3.connect(half_done, isolation_level=None)) as database:
        database.execute(statement)
    for use in USES:
        outcome(use, half_done)


def test_a_copy_of_what_is_no_survey_is_not_made(half_done: Path, tmp_path: Path) -> None:
    truncated(half_done)
    outcome(lambda path: copy(path, tmp_path / "copy.gpkg"), half_done)
    empty(half_done)
    assert outcome(lambda path: copy(path, tmp_path / "more.gpkg"), half_done)
    assert not (tmp_path / "more.gpkg").exists()


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@pytest.mark.skipif("SUBSOIL_BREAKAGE" not in os.environ, reason="SUBSOIL_BREAKAGE names no folder")
@pytest.mark.parametrize(
    "name", ["bitrot-UnicodeDecodeError-277", "ev-IndexError-86", "ev-ValueError-88", "flip-472"]
)
def test_survey_files_that_once_broke_a_verb_do_so_no_more(name: str, tmp_path: Path) -> None:
    path = tmp_path / "s.gpkg"
    path.write_bytes((Path(os.environ["SUBSOIL_BREAKAGE"]) / f"{name}.gpkg").read_bytes())
    assert outcome(verify, path) or verify(path).findings
    outcome(lambda given: fold(read_survey(given).events), path)
