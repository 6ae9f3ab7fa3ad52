"""The survey file keeps what it acknowledged, whatever happens."""

from __future__ import annotations

import os
import random
import shutil
import signal
import sqlite3
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pyogrio
import pytest

from subsoil.errors import CorruptJournalError, JournalError, SurveyBusyError
from subsoil.journal import Journal, create, open_journal, read_events, verify
from subsoil.simulation import Truth
from subsoil.survey import LocalDispatch, Survey, fold
from subsoil.survey.events import Configured, Finished, Opened, Planned

Configure = Callable[..., Configured]
Work = Callable[[LocalDispatch, Truth], str]

OUTLINE = "easting,northing\n0,0\n60,0\n60,40\n0,40\n"


def subsoil(*arguments: object) -> list[str]:
    return [sys.executable, "-m", "subsoil", *map(str, arguments)]


def done(*arguments: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run(subsoil(*arguments), capture_output=True, text=True, check=False)


def test_a_closed_file_holds_every_event_and_verifies(finished: Path) -> None:
    events = read_events(finished)
    assert isinstance(events[0], Opened)
    assert isinstance(events[-1], Finished)
    assert len(fold(events).visited) == 8
    assert verify(finished).findings == ()


def test_a_closed_file_is_alone_in_its_folder_and_can_be_copied(
    finished: Path, tmp_path: Path
) -> None:
    assert [path.name for path in finished.parent.iterdir()] == ["survey.gpkg"]
    copy = Path(shutil.copy(finished, tmp_path / "copy.gpkg"))
    assert [e.id for e in read_events(copy)] == [e.id for e in read_events(finished)]


def test_other_programs_read_the_layers_while_the_survey_runs(
    tmp_path: Path, plot_opened: Opened, configured: Configure, plot_truth: Truth, work: Work
) -> None:
    path = tmp_path / "survey.gpkg"
    code = (
        "import pyogrio, sys; m, _, g, f = pyogrio.raw.read(sys.argv[1], layer='samples');"
        "print(len(g), f[list(m['fields']).index('kpa_0_5cm')][-1])"
    )
    seen: list[int] = []

    def look(survey: Survey, event: object) -> None:
        if isinstance(event, Planned) and survey.taken in {1, 2, 6}:
            gdal = [sys.executable, "-c", code, str(path)]
            number, kpa = subprocess.run(gdal, capture_output=True, check=True).stdout.split()
            seen.append(int(number))
            assert float(kpa) == pytest.approx(survey.soil_map.samples[-1].kpa[0])

    with create(path, plot_opened) as journal:
        dispatch = LocalDispatch(fold(journal.events()), journal, look)
        dispatch.record(configured())
        work(dispatch, plot_truth)
    assert seen == [1, 2, 6]


def test_every_layer_opens_in_gdal_with_its_geometry(finished: Path) -> None:
    layers = dict(pyogrio.list_layers(finished))
    assert layers["boundary"] == "MultiPolygon"
    assert layers["samples"] == layers["targets"] == layers["refusals"] == "Point"
    assert layers["route"] == "LineString"
    info = pyogrio.read_info(finished, layer="samples")
    assert info["features"] == 8
    assert {"kpa_0_5cm", "kpa_5_10cm", "agent", "source", "time"} <= set(info["fields"])


def test_a_field_on_earth_keeps_its_frame(tmp_path: Path, plot_opened: Opened) -> None:
    path = tmp_path / "utm.gpkg"
    with create(path, plot_opened.model_copy(update={"crs": "EPSG:32630"})):
        pass
    assert pyogrio.read_info(path, layer="boundary")["crs"] == "EPSG:32630"


def test_an_event_that_comes_twice_is_kept_once(tmp_path: Path, plot_opened: Opened) -> None:
    with create(tmp_path / "s.gpkg", plot_opened) as journal:
        event = Finished(reason="rain")
        survey = fold([plot_opened, event])
        journal.append(event, survey)
        journal.append(event, survey)
        assert len(journal.events()) == 2


def _append_and_fail(journal: Journal, survey: Survey) -> None:
    journal.append(Finished(id="c", reason="enough"), survey)
    raise CorruptJournalError("half way")


def test_events_appended_together_are_all_there_or_none(
    tmp_path: Path, plot_opened: Opened
) -> None:
    path = tmp_path / "together.gpkg"
    with create(path, plot_opened) as journal:
        survey = fold(journal.events())
        with journal.together():
            journal.append(Finished(id="a", reason="enough"), survey)
            journal.append(Finished(id="b", reason="enough"), survey)
            assert [event.id for event in read_events(path)[1:]] == []
        with pytest.raises(CorruptJournalError), journal.together():
            _append_and_fail(journal, survey)
        journal.append(Finished(id="d", reason="enough"), survey)
    assert [event.id for event in read_events(path)[1:]] == ["a", "b", "d"]


def test_a_second_writer_is_refused_with_the_name_of_the_first(
    tmp_path: Path, plot_opened: Opened
) -> None:
    path = tmp_path / "s.gpkg"
    with create(path, plot_opened), pytest.raises(SurveyBusyError, match=f"process {os.getpid()}"):
        open_journal(path)
    open_journal(path).close()


def test_a_second_process_is_refused_too(tmp_path: Path, plot_opened: Opened) -> None:
    path = tmp_path / "s.gpkg"
    with create(path, plot_opened):
        rival = done("run", path)
        assert rival.returncode == 3
        assert f"process {os.getpid()}" in rival.stderr
        assert done("status", path, "--json").returncode == 0


def test_a_file_is_not_started_twice(finished: Path, plot_opened: Opened) -> None:
    before = finished.read_bytes()
    with pytest.raises(JournalError, match="exists already"):
        create(finished, plot_opened)
    assert finished.read_bytes() == before


@pytest.mark.parametrize("content", [b"", b"not a database at all, but long enough" * 40])
def test_a_file_that_is_no_geopackage_is_refused_and_left_alone(
    tmp_path: Path, content: bytes
) -> None:
    path = tmp_path / "x.gpkg"
    path.write_bytes(content)
    for use in (open_journal, read_events):
        with pytest.raises(JournalError, match="not a subsoil survey but no GeoPackage"):
            use(path)
    assert path.read_bytes() == content


def test_another_programs_geopackage_is_refused_and_left_alone(tmp_path: Path) -> None:
    path = tmp_path / "roads.gpkg"
    points = np.array([bytes.fromhex("010100000000000000000000000000000000000000")], dtype=object)
    pyogrio.raw.write(
        path, points, [np.array([1])], fields=["a"], geometry_type="Point", crs="EPSG:32630"
    )
    before = path.read_bytes()
    with pytest.raises(JournalError, match="another program's GeoPackage"):
        open_journal(path)
    assert path.read_bytes() == before


def test_a_missing_file_says_how_to_start_one(tmp_path: Path) -> None:
    with pytest.raises(JournalError, match=r"no such file.*subsoil init"):
        read_events(tmp_path / "none.gpkg")


def test_a_changed_event_is_found(finished: Path) -> None:
    with sqlite3.connect(finished) as database:
        database.execute("UPDATE events SET body = body || ' ' WHERE seq = 5")
    database.close()
    with pytest.raises(CorruptJournalError, match="event 5: the event, or one before it"):
        read_events(finished)


def test_a_changed_sample_row_is_found(finished: Path) -> None:
    with sqlite3.connect(finished) as database:
        database.execute("UPDATE samples SET kpa_5_10cm = kpa_5_10cm + 1 WHERE fid = 3")
    database.close()
    (finding,) = verify(finished).findings
    assert finding.startswith("layer samples: kpa_5_10cm of row")


def test_a_full_disk_loses_nothing_that_was_acknowledged(
    tmp_path: Path, plot_opened: Opened, configured: Configure, plot_truth: Truth, work: Work
) -> None:
    path = tmp_path / "survey.gpkg"
    acknowledged: list[str] = []
    with create(path, plot_opened) as journal:
        (pages,) = journal._database.execute("PRAGMA page_count").fetchone()
        journal._database.execute(f"PRAGMA max_page_count = {pages + 30}")
        dispatch = LocalDispatch(
            fold(journal.events()), journal, lambda _, event: acknowledged.append(event.id)
        )
        dispatch.record(configured(samples=40))
        with pytest.raises(JournalError, match=r"full.*free some space"):
            work(dispatch, plot_truth)
    assert len(acknowledged) > 3
    assert [event.id for event in read_events(path)[1:]] == acknowledged


def test_a_file_that_cannot_be_written_is_refused(finished: Path) -> None:
    if os.geteuid() == 0:
        pytest.skip("root may write anywhere")
    finished.chmod(0o444)
    with pytest.raises(JournalError, match="cannot be written"):
        open_journal(finished)


@pytest.fixture(scope="module")
def uninterrupted(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Survey]:
    """Outline of a field, and the survey of it that nothing stopped."""
    folder = tmp_path_factory.mktemp("whole")
    outline = folder / "plot.csv"
    outline.write_text(OUTLINE)
    path = folder / "survey.gpkg"
    assert done("init", path, "--boundary", outline).returncode == 0
    assert done("run", path, *RUN).returncode == 0
    return outline, fold(read_events(path))


RUN = ("--robot", "sim", "--strategy", "adaptive-greedy", "--samples", 25, "--seed", 7)


def killed_and_resumed(path: Path, outline: Path, moments: Iterator[float]) -> int:
    """Survey with the process killed at moments in s after it started writing; number of kills."""
    assert done("init", path, "--boundary", outline).returncode == 0
    opened = len(read_events(path))
    kills = 0
    command: tuple[object, ...] = ("run", path, *RUN)
    for moment in moments:
        process = subprocess.Popen(subsoil(*command), stdout=subprocess.DEVNULL)
        while process.poll() is None and len(read_events(path)) == opened:
            time.sleep(0.01)
        time.sleep(moment)
        if process.poll() is None:
            process.send_signal(signal.SIGKILL)
            kills += 1
        process.wait()
        events = read_events(path)
        opened = len(events)
        if isinstance(events[-1], Finished):
            return kills
        command = ("resume", path)
    assert done("resume", path).returncode == 0
    return kills


def assert_same_end(path: Path, whole: Survey) -> None:
    again = fold(read_events(path))
    assert again.finished == whole.finished
    assert again.visited == whole.visited
    assert again.metres == pytest.approx(whole.metres, abs=1e-9)
    assert np.array_equal(again.soil_map.mean, whole.soil_map.mean)
    assert np.array_equal(again.soil_map.variance, whole.soil_map.variance)
    assert verify(path).findings == ()


def test_a_killed_survey_resumes_to_the_same_end(
    tmp_path: Path, uninterrupted: tuple[Path, Survey]
) -> None:
    outline, whole = uninterrupted
    kills = killed_and_resumed(tmp_path / "s.gpkg", outline, iter([0.05, 0.2]))
    assert kills >= 1
    assert_same_end(tmp_path / "s.gpkg", whole)


@pytest.mark.slow
def test_a_survey_killed_at_fifty_random_moments_resumes_to_the_same_end(
    tmp_path: Path, uninterrupted: tuple[Path, Survey]
) -> None:
    outline, whole = uninterrupted
    chance = random.Random(50)
    kills = attempt = 0
    while kills < 50:
        path = tmp_path / f"survey{attempt}.gpkg"
        moments = (chance.uniform(0.0, 0.25) for _ in range(100))
        kills += killed_and_resumed(path, outline, moments)
        assert_same_end(path, whole)
        attempt += 1
        assert attempt < 60
