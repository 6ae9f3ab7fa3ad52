"""Files of every format there has been open, resume and verify, and reading never changes them."""

from __future__ import annotations

import gzip
import shutil
from hashlib import sha256
from pathlib import Path

import numpy as np
import pytest

from subsoil.cli import run
from subsoil.errors import JournalError
from subsoil.journal import open_journal, read_events, verify
from subsoil.survey import LocalDispatch, fold
from subsoil.survey.events import (
    Assigned,
    Configured,
    Continued,
    Event,
    Finished,
    Fitted,
    Joined,
    Opened,
    Sampled,
    to_json,
)
from subsoil.survey.formats import Reader

DATA = Path(__file__).parents[1] / "data"
OLD = ("finished", "under-way", "own")
"""Surveys of version 0.1: over; with further pushes due; by a strategy of somebody's own."""


@pytest.fixture
def old(tmp_path: Path) -> dict[str, Path]:
    """Files of format 0 by name."""
    paths = {name: tmp_path / f"{name}.gpkg" for name in OLD}
    for name, path in paths.items():
        with gzip.open(DATA / f"format-0-{name}.gpkg.gz") as source, path.open("wb") as target:
            shutil.copyfileobj(source, target)
    return paths


def digest(path: Path) -> str:
    return sha256(path.read_bytes()).hexdigest()


def test_an_old_survey_is_what_it_was(old: dict[str, Path]) -> None:
    survey = fold(read_events(old["finished"]))
    assert survey.visited == (38, 60, 65, 122, 193, 188, 183)
    assert survey.finished == "7 samples taken"
    assert survey.metres == pytest.approx(155.122, abs=1e-3)
    assert survey.minutes == pytest.approx(10.285, abs=1e-3)
    assert survey.method == "0.1"
    assert survey.simulated
    assert [agent.name for agent in survey.agents] == ["simulated robot"]
    assert len(survey.fits) == 3


def test_a_stop_with_pushes_due_is_still_its_robots(old: dict[str, Path]) -> None:
    survey = fold(read_events(old["under-way"]))
    (lease,) = survey.leases
    assert (lease.cell, lease.pushes, lease.made) == (63, 3, 1)
    assert survey.repeats == (57, 57)


def test_every_event_of_an_old_file_says_when_it_was_recorded(old: dict[str, Path]) -> None:
    events = read_events(old["finished"])
    assert all(event.time is not None and event.clock == "host" for event in events)
    assert len({event.id for event in events}) == len(events)
    kinds = {type(event) for event in events}
    assert {Joined, Assigned, Configured, Fitted, Finished, Sampled} <= kinds


@pytest.mark.parametrize("name", OLD)
@pytest.mark.parametrize("verb", ["status", "verify", "plan", "replay"])
def test_reading_an_old_file_never_rewrites_it(
    old: dict[str, Path], name: str, verb: str, capsys: pytest.CaptureFixture[str]
) -> None:
    before = digest(old[name])
    run([verb, str(old[name]), *(["--at", "3"] if verb == "replay" else [])])
    capsys.readouterr()
    assert digest(old[name]) == before


def test_verify_says_what_of_an_old_file_was_not_computed_again(old: dict[str, Path]) -> None:
    verdict = verify(old["finished"])
    assert verdict.findings == ()
    assert any("not recomputed: made by 0.1" in note for note in verdict.notes)


def test_an_old_survey_goes_on_as_the_version_that_began_it_would_have(
    old: dict[str, Path], capsys: pytest.CaptureFixture[str]
) -> None:
    """The ends below are those that version 0.1 came to."""
    assert run(["resume", str(old["under-way"])]) == 0
    capsys.readouterr()
    events = read_events(old["under-way"])
    survey = fold(events)
    assert survey.visited == (57, 63, 69, 194, 188, 182)
    assert survey.repeats == tuple(c for c in survey.visited for _ in range(2))
    assert survey.metres == pytest.approx(180.104, abs=1e-3)
    assert survey.minutes == pytest.approx(15.0017, abs=1e-4)
    assert sum(isinstance(event, Continued) for event in events) == 1
    assert verify(old["under-way"]).findings == ()


def test_code_that_an_old_file_names_runs_only_if_allowed(
    old: dict[str, Path],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    (tmp_path / "rows.py").write_text(
        "from subsoil.strategies import Plan\n"
        "def rows(view):\n"
        "    return Plan(view.plan, 'as planned', view.pushes)\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    assert run(["resume", str(old["own"])]) == 2
    assert "--allow rows" in capsys.readouterr().err
    assert run(["resume", str(old["own"]), "--allow", "rows"]) == 0
    survey = fold(read_events(old["own"]))
    assert survey.visited == (5, 30, 44)
    assert survey.metres == pytest.approx(83.584, abs=1e-3)
    assert survey.minutes == pytest.approx(6.2264, abs=1e-4)


def test_a_file_goes_on_in_the_format_of_today_from_its_first_new_event(
    old: dict[str, Path],
) -> None:
    before = read_events(old["finished"])
    with open_journal(old["finished"]) as journal:
        dispatch = LocalDispatch(fold(journal.events()), journal)
        last = next(e for e in reversed(before) if isinstance(e, Sampled))
        dispatch.withdraw(last.id, "a trial")
    events = read_events(old["finished"])
    assert [e.id for e in events[: len(before)]] == [e.id for e in before]
    assert [e.kind for e in events[len(before) :]] == ["continued", "withdrawn"]
    assert verify(old["finished"]).findings == ()
    assert np.isfinite(fold(events).soil_map.mean).all()


def test_events_of_today_read_back_as_they_were() -> None:
    opened = Opened(
        name="a", boundary_wkt="", keep_outs_wkt=(), crs="", cell_size_m=5.0,
        layer_edges_m=(0.0, 0.4), layer_weights=(1.0,), cone_area_mm2=130.0, cone_angle_deg=30.0,
    )  # fmt: skip
    reader, events = Reader(), (opened, Finished(reason="rain"))
    back: list[Event] = []
    for event in events:
        back += reader.read(to_json(event), "2026-01-01T00:00:00.000+00:00")
    assert tuple(back) == events


def test_a_newer_format_is_named_with_what_to_do() -> None:
    line = to_json(Continued(format=2, method="9"))
    with pytest.raises(JournalError, match=r"format 2 is newer than 1.*update subsoil"):
        Reader().read(line, "")
