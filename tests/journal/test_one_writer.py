"""A survey has one writer, by whatever name its file goes."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from subsoil.errors import CorruptJournalError, JournalError, SurveyBusyError
from subsoil.journal import copy, open_journal, read_events, read_survey, verify
from subsoil.survey import fold
from subsoil.survey.events import Continued

Start = Callable[[Path], Any]
Change = Callable[..., None]


def ids(path: Path) -> list[str]:
    return [event.id for event in read_events(path)]


def renamed(path: Path) -> Path:
    """A survey that was renamed together with what lies beside it."""
    for end in ("", "-wal", "-shm"):
        Path(f"{path}{end}").rename(f"{path.parent / 'other.gpkg'}{end}")
    return path.parent / "other.gpkg"


def in_renamed_folder(path: Path) -> Path:
    folder = path.parent.rename(path.parent.with_name("moved"))
    return folder / path.name


def by_symlink(path: Path) -> Path:
    (path.parent / "alias.gpkg").symlink_to(path.name)
    return path.parent / "alias.gpkg"


def by_hard_link(path: Path) -> Path:
    os.link(path, path.parent / "twin.gpkg")
    return path.parent / "twin.gpkg"


def by_relative_path(path: Path) -> Path:
    return Path(os.path.relpath(path))


def after_deletion_of_whatever_looks_like_a_lock(path: Path) -> Path:
    for beside in path.parent.iterdir():
        if "lock" in beside.name:
            beside.unlink()
    return path


NAMES = [
    renamed, in_renamed_folder, by_symlink, by_hard_link, by_relative_path,
    after_deletion_of_whatever_looks_like_a_lock,
]  # fmt: skip


@pytest.fixture
def survey(half_done: Path, tmp_path: Path) -> Path:
    """A survey in a folder that may be renamed."""
    (tmp_path / "surveys").mkdir()
    return half_done.rename(tmp_path / "surveys" / "survey.gpkg")


@pytest.mark.parametrize("other_name", NAMES)
def test_a_second_writer_is_refused_by_any_name(
    survey: Path, writer: Start, other_name: Callable[[Path], Path]
) -> None:
    first = writer(survey)
    first.told("a")
    other = other_name(survey)
    with pytest.raises(SurveyBusyError):
        open_journal(other)
    first.told("b", "c")


def test_the_second_writer_is_told_who_the_first_is(survey: Path, writer: Start) -> None:
    first = writer(survey)
    with pytest.raises(SurveyBusyError, match=rf"process {first.process.pid} of \w+ on "):
        open_journal(survey)


@pytest.mark.parametrize("other_name", [by_symlink, by_hard_link])
def test_a_second_writer_in_the_same_process_is_refused_and_takes_no_lock_away(
    survey: Path, other_name: Callable[[Path], Path]
) -> None:
    with open_journal(survey):
        other = other_name(survey)
        for name in (survey, other):
            with pytest.raises(SurveyBusyError):
                open_journal(name)
        held = subprocess.run(
            [sys.executable, "-m", "subsoil", "resume", str(survey)],
            capture_output=True, text=True, check=False,
        )  # fmt: skip
        assert held.returncode == 3
        assert f"process {os.getpid()}" in held.stderr


@pytest.mark.parametrize("end", ["close", "kill"])
def test_the_next_writer_gets_in_when_the_first_is_gone(
    survey: Path, writer: Start, end: str
) -> None:
    first = writer(survey)
    first.told("a")
    if end == "close":
        first.told("close")
    else:
        first.killed()
    with open_journal(survey) as journal:
        assert journal.notes == ()
        assert [e.id for e in journal.events()][-1] == "a"


def test_nothing_lies_beside_a_closed_survey(survey: Path) -> None:
    open_journal(survey).close()
    assert [path.name for path in survey.parent.iterdir()] == [survey.name]


def test_nothing_is_written_once_another_program_has_written(
    half_done: Path, change: Change
) -> None:
    with open_journal(half_done) as journal:
        state = fold(journal.events())
        journal.append(Continued(id="mine"), state)
        change(
            half_done,
            "INSERT INTO events(id, kind, recorded, body, digest) VALUES ('x', 'y', 'z', '', '')",
        )
        for _ in range(2):
            with pytest.raises(JournalError, match=r"another program wrote to the file.*verify"):
                journal.append(Continued(id="more"), state)
        change(half_done, "DELETE FROM events WHERE id = 'x'")
        journal.append(Continued(id="after all"), state)
    assert "more" not in str(half_done.read_bytes())


@pytest.mark.parametrize("deed", ["DELETE FROM events WHERE id = NEW.id",
                                  "UPDATE events SET digest = '' WHERE id = NEW.id"])  # fmt: skip
def test_an_event_that_a_trigger_undoes_is_not_acknowledged(
    half_done: Path, change: Change, deed: str
) -> None:
    before = len(read_events(half_done))
    change(half_done, f"CREATE TRIGGER t AFTER INSERT ON events BEGIN {deed}; END")
    with open_journal(half_done) as journal:
        assert journal.notes == ("trigger 't' on events of another program is in the file",)
        state = fold(journal.events())
        with pytest.raises(JournalError, match="another program"):
            journal.append(Continued(), state)
    assert len(read_events(half_done)) == before


def test_a_hard_link_to_a_survey_whose_writer_was_killed_is_not_written_to(
    survey: Path, writer: Start
) -> None:
    first = writer(survey)
    first.told("a", "b")
    first.killed()
    twin = by_hard_link(survey)
    with pytest.raises(JournalError, match=r"last events are in .*survey\.gpkg-wal.*open it as"):
        open_journal(twin)
    (note,) = read_survey(twin).notes
    assert "may lack the last events" in note
    assert ids(survey)[-2:] == ["a", "b"]


def test_a_survey_renamed_without_what_lies_beside_it_is_not_written_to(
    survey: Path, writer: Start
) -> None:
    first = writer(survey)
    first.told("a", "b")
    first.killed()
    moved = survey.rename(survey.parent / "moved.gpkg")
    with pytest.raises(JournalError, match="last events are in"):
        open_journal(moved)
    Path(f"{survey}-wal").rename(f"{moved}-wal")
    with open_journal(moved) as journal:
        assert journal.notes == ()
        assert [e.id for e in journal.events()][-2:] == ["a", "b"]


def test_a_copy_holds_every_event_and_is_closed(
    half_done: Path, tmp_path: Path, writer: Start
) -> None:
    first = writer(half_done)
    first.told("a", "b")
    copy(half_done, tmp_path / "copy.gpkg")
    first.told("c")
    record = read_survey(tmp_path / "copy.gpkg")
    assert [e.id for e in record.events][-2:] == ["a", "b"]
    assert record.notes == ()
    assert verify(tmp_path / "copy.gpkg").findings == ()
    with pytest.raises(JournalError, match="exists already"):
        copy(half_done, tmp_path / "copy.gpkg")


def test_two_surveys_are_written_to_at_once(half_done: Path, tmp_path: Path) -> None:
    other = Path(shutil.copy(half_done, tmp_path / "other.gpkg"))
    with open_journal(half_done), open_journal(other):
        pass


def test_a_failed_opening_lets_go_of_the_file(half_done: Path, change: Change) -> None:
    change(half_done, "PRAGMA application_id = 7")
    for _ in range(2):
        with pytest.raises(JournalError, match="no GeoPackage") as refused:
            open_journal(half_done)
        assert not isinstance(refused.value, SurveyBusyError | CorruptJournalError)


def test_a_survey_renamed_with_what_lies_beside_it_is_closed_whole(
    survey: Path, writer: Start
) -> None:
    first = writer(survey)
    first.told("a")
    moved = renamed(survey)
    first.told("b", "close")
    assert ids(moved)[-2:] == ["a", "b"]
    with open_journal(moved) as journal:
        assert journal.notes == ()
        journal.append(Continued(id="c"), fold(journal.events()))
    assert ids(moved)[-3:] == ["a", "b", "c"]
    assert verify(moved).findings == ()


def test_a_survey_renamed_alone_while_open_loses_nothing(survey: Path, writer: Start) -> None:
    first = writer(survey)
    first.told("a")
    moved = survey.rename(survey.parent / "moved.gpkg")
    first.told("b", "close")
    assert ids(moved)[-2:] == ["a", "b"]
    assert read_survey(moved).notes == ()
    with open_journal(moved) as journal:
        journal.append(Continued(id="c"), fold(journal.events()))
    assert ids(moved)[-3:] == ["a", "b", "c"]


def test_a_new_survey_under_the_name_of_one_renamed_while_open_is_another(
    survey: Path, writer: Start, half_done_file: Path
) -> None:
    first = writer(survey)
    first.told("a")
    moved = renamed(survey)
    shutil.copy(half_done_file, survey)
    second = writer(survey)
    second.told("x")
    first.told("b", "close")
    second.told("y", "close")
    assert ids(moved)[-2:] == ["a", "b"]
    assert ids(survey)[-2:] == ["x", "y"]
    assert verify(moved).findings == verify(survey).findings == ()
