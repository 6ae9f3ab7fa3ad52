"""A covariate from the command line: into the survey file, the fits and the maps."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from subsoil.journal import read_events
from subsoil.survey import decision, fold
from subsoil.survey.events import Fitted, Opened, same

Cli = Callable[..., Any]


CELLS = np.column_stack(
    [k.ravel() for k in np.meshgrid(np.arange(2.5, 60.0, 5.0), np.arange(2.5, 40.0, 5.0))]
)
EC = 30.0 + 5.0 * np.sin(CELLS[:, 0] / 9.0) + np.random.default_rng(4).normal(0.0, 4.0, len(CELLS))


@pytest.fixture
def ec(tmp_path: Path) -> Path:
    """EC of every cell of the plot, much of it unlike that of the cells around."""
    rows = [f"{x},{y},{value}" for (x, y), value in zip(CELLS, EC, strict=True)]
    path = tmp_path / "ec.csv"
    path.write_text("easting,northing,ec\n" + "\n".join(rows) + "\n")
    return path


@pytest.fixture
def dense(tmp_path: Path) -> Path:
    """Readings in 24 cells whose first layer follows the EC and whose second does not."""
    rng = np.random.default_rng(5)
    cells = rng.choice(len(CELLS), 24, replace=False)
    first = 900.0 + 12.0 * EC[cells] + rng.normal(0.0, 10.0, 24)
    second = 1500.0 + rng.normal(0.0, 50.0, 24)
    readings = zip(CELLS[cells], first, second, strict=True)
    rows = [f"{x},{y},{a},{b}" for (x, y), a, b in readings]
    path = tmp_path / "dense.csv"
    path.write_text("easting,northing,kpa_5cm,kpa_10cm\n" + "\n".join(rows) + "\n")
    return path


def started(cli: Cli, outline: Path, ec: Path, path: Path) -> Path:
    assert cli("init", path, "--boundary", outline, "--covariate", ec).code == 0
    return path


def test_a_map_follows_the_covariate_where_it_tells(
    cli: Cli, outline: Path, dense: Path, ec: Path, tmp_path: Path
) -> None:
    command = ("map", dense, "--boundary", outline, "--layers", "0.025,0.075,0.125",
               "--covariate", ec, "--out", tmp_path, "--json")  # fmt: skip
    found = cli(*command).json
    without = cli(*command, "--drift", "never").json
    assert found["drift"] == [found["layers"][0]["layer"]]
    assert without["drift"] == []
    first, plain = (result["layers"][0]["loo_rmse_kpa"] for result in (found, without))
    assert first < plain
    assert any(note.endswith("the mean follows the covariate") for note in found["notes"])


def test_a_survey_keeps_the_covariate_and_replays_exactly(
    cli: Cli, outline: Path, ec: Path, tmp_path: Path
) -> None:
    path = started(cli, outline, ec, tmp_path / "survey.gpkg")
    assert cli("run", path, "--samples", 10, "--drift", "always").code == 0
    events = read_events(path)
    opened = events[0]
    assert isinstance(opened, Opened)
    assert len(opened.covariate) == 96
    fitted = [event for event in events if isinstance(event, Fitted)]
    assert fitted[-1].drift == tuple(range(8))
    assert all(not event.drift for event in fitted if event.samples < 8)
    state = fold(events)
    assert state.soil_map.drift == tuple(range(8))
    again = decision(fold(events[: events.index(fitted[-1])]))
    assert isinstance(again, Fitted)
    assert same(again, fitted[-1], tolerance=0.0)
    assert again.drift == fitted[-1].drift
    assert cli("verify", path).code == 0


@pytest.mark.parametrize(
    "goal",
    [
        ("--target-rmse", 5),
        ("--target-rmse", 5, "--probability", 0.9),
        ("--threshold-kpa", 1500, "--decided", 0.99),
        ("--min-gain", 0.1),
    ],
    ids=str,
)
def test_goals_can_be_measured_on_a_map_with_drift(
    cli: Cli, outline: Path, ec: Path, tmp_path: Path, goal: tuple[object, ...]
) -> None:
    path = started(cli, outline, ec, tmp_path / "survey.gpkg")
    command = ("run", path, "--samples", 14, "--estimator", "pmc", "--drift", "always", *goal)
    assert cli(*command).code == 0
    assert fold(read_events(path)).soil_map.drift == tuple(range(8))


def test_a_survey_that_must_not_follow_does_not(
    cli: Cli, outline: Path, ec: Path, tmp_path: Path
) -> None:
    path = started(cli, outline, ec, tmp_path / "survey.gpkg")
    assert cli("run", path, "--samples", 10, "--drift", "never").code == 0
    assert fold(read_events(path)).soil_map.drift == ()


def test_a_survey_without_a_covariate_says_nothing_of_one(
    cli: Cli, outline: Path, tmp_path: Path
) -> None:
    path = tmp_path / "survey.gpkg"
    assert cli("init", path, "--boundary", outline).code == 0
    assert cli("run", path, "--samples", 9).code == 0
    assert fold(read_events(path)).soil_map.drift == ()


def test_a_covariate_that_cannot_be_used_is_one_line_and_leaves_nothing_behind(
    cli: Cli, outline: Path, ec: Path, tmp_path: Path
) -> None:
    ec.write_text("easting,northing,ec\n5,5,1\n")
    path = tmp_path / "survey.gpkg"
    result = cli("init", path, "--boundary", outline, "--covariate", ec)
    assert result.code == 2
    assert result.err.count("\n") == 1
    assert "ec.csv: nothing is known within 25 m of" in result.err
    assert not path.exists()


def test_a_rule_that_is_not_there_is_refused(
    cli: Cli, outline: Path, ec: Path, tmp_path: Path
) -> None:
    path = started(cli, outline, ec, tmp_path / "survey.gpkg")
    result = cli("run", path, "--drift", "perhaps")
    assert result.code == 2
    assert "'perhaps' is not one of 'auto', 'always', 'never'" in result.err
