"""Lines of the first format stand for events of today, and say no more than they said."""

from __future__ import annotations

import json
from typing import Any

import pytest

from subsoil.errors import JournalError
from subsoil.reports import Refused, Sampled
from subsoil.survey import fold
from subsoil.survey.events import (
    Assigned,
    BatterySwapped,
    Configured,
    Event,
    Finished,
    Fitted,
    Joined,
    Opened,
    Planned,
    to_json,
)
from subsoil.survey.formats import METHOD_0, Reader

RECORDED = "2024-03-01T08:00:00+00:00"

OPENED: dict[str, Any] = {
    "id": "o", "kind": "opened", "name": "plot",
    "boundary_wkt": "POLYGON ((0 0, 60 0, 60 40, 0 40, 0 0))", "keep_outs_wkt": [], "crs": "",
    "cell_size_m": 5.0, "layer_edges_m": [0.0, 0.2, 0.4], "layer_weights": [0.5, 0.5],
    "cone_area_mm2": 130.0, "cone_angle_deg": 30.0,
}  # fmt: skip
MODEL = {"name": "spherical", "nugget": 1.0, "range": 20.0, "psill": 9.0}


def configured(world: str) -> dict[str, Any]:
    return {
        "id": "c", "kind": "configured", "strategy": "area-split", "estimator": "paper-10",
        "seed": 4, "start": [0.0, 0.0], "world": world, "samples": 5,
    }  # fmt: skip


def planned(cells: list[int], pushes: list[int]) -> dict[str, Any]:
    return {
        "id": "p", "kind": "planned", "step": 0, "cells": cells, "reason": "as planned",
        "mean_kv": 9.0, "measures": [], "pushes": pushes,
    }  # fmt: skip


def sampled(id_: str, cell: int, agent: str = "rob") -> dict[str, Any]:
    return {
        "id": id_, "kind": "sampled", "agent": agent, "cell": cell, "at": [2.5, 2.5],
        "depth_m": [0.2, 0.4], "force_n": [90.0, 120.0], "ending": "stroke", "metres": 4.0,
        "seconds": 54.0, "tries": 2,
    }  # fmt: skip


def refused(id_: str, cell: int, agent: str = "rob") -> dict[str, Any]:
    return {
        "id": id_, "kind": "refused", "agent": agent, "cell": cell, "at": [7.5, 2.5],
        "reason": "a stone", "metres": 4.0, "seconds": 106.0, "tries": 3,
    }  # fmt: skip


def read(*lines: dict[str, Any]) -> list[Event]:
    reader = Reader()
    return [event for line in (OPENED, *lines) for event in reader.read(json.dumps(line), RECORDED)]


def kinds(events: list[Event]) -> list[str]:
    return [event.kind for event in events]


def test_a_file_that_names_no_format_is_of_the_first_and_has_the_times_of_its_rows() -> None:
    (event,) = read()
    assert isinstance(event, Opened)
    assert (event.format, event.method, event.clock) == (0, METHOD_0, "host")
    assert event.time is not None
    assert event.time.isoformat() == RECORDED
    assert fold([event]).name == "plot"


@pytest.mark.parametrize("world", ["simulated", "riseholme", "surrogate", "signal"])
def test_a_simulated_world_has_its_one_robot_from_the_start(world: str) -> None:
    _, event, joined = read(configured(world))
    assert isinstance(event, Configured)
    assert (event.method, event.settings.seed, event.settings.samples) == (METHOD_0, 4, 5)
    assert isinstance(joined, Joined)
    assert (joined.agent, joined.source, joined.id) == (
        "simulated robot", "simulator", "c/simulated robot",
    )  # fmt: skip
    assert joined.simulation is not None
    assert (joined.simulation.world, joined.simulation.seed) == (world, 4)
    assert joined.simulation.check_kpa == ()


def test_a_robot_on_real_land_joins_with_its_first_report_and_is_no_simulation() -> None:
    events = read(configured("mine:robot"), sampled("s1", 0), sampled("s2", 1), refused("r", 2))
    assert kinds(events) == [
        "opened", "configured", "joined", "assigned", "sampled", "assigned", "sampled",
        "assigned", "refused",
    ]  # fmt: skip
    joined = events[2]
    assert isinstance(joined, Joined)
    assert (joined.agent, joined.source, joined.simulation) == ("rob", "robot", None)
    reports = [event for event in events if isinstance(event, Sampled | Refused)]
    assert {report.source.kind for report in reports} == {"robot"}
    survey = fold(events)
    assert survey.visited == (0, 1)
    assert survey.refused == (2,)
    assert not survey.simulated
    assert (survey.metres, survey.minutes) == (12.0, (54 + 54 + 106) / 60)


def test_a_stop_is_its_cell_and_all_pushes_in_it_are_of_one_assignment() -> None:
    events = read(
        configured("simulated"), planned([8, 3], [3, 1]),
        sampled("s1", 8, "simulated robot"), sampled("s2", 8, "simulated robot"),
        sampled("s3", 3, "simulated robot"),
    )  # fmt: skip
    assigned = [event for event in events if isinstance(event, Assigned)]
    assert [(each.id, each.cell, each.pushes) for each in assigned] == [
        ("s1/assigned", 8, 3), ("s3/assigned", 3, 1),
    ]  # fmt: skip
    reports = [event for event in events if isinstance(event, Sampled)]
    assert [each.assignment for each in reports] == ["s1/assigned", "s1/assigned", "s3/assigned"]
    first = reports[0]
    assert (first.reading.depth_m, first.reading.force_n) == ((0.2, 0.4), (90.0, 120.0))
    assert (first.tries, first.reading.ending, first.source.kind) == (2, "stroke", "simulator")
    assert kinds(events).count("joined") == 1
    (plan,) = (event for event in events if isinstance(event, Planned))
    assert (plan.cells, plan.pushes) == ((8, 3), (3, 1))


def test_a_cell_that_no_plan_asked_for_was_pushed_once() -> None:
    events = read(configured("x"), planned([8], [2]), sampled("s", 40))
    (assigned,) = (event for event in events if isinstance(event, Assigned))
    assert (assigned.cell, assigned.pushes) == (40, 1)


def test_the_same_lines_give_the_same_events_whenever_they_are_read() -> None:
    lines = (configured("simulated"), planned([8], [2]), sampled("s", 8), refused("r", 9))
    assert list(map(to_json, read(*lines))) == list(map(to_json, read(*lines)))
    ids = [event.id for event in read(*lines)]
    assert len(set(ids)) == len(ids)


def test_a_battery_is_that_of_the_robot_there_was() -> None:
    swap = {"id": "b", "kind": "battery-swapped"}
    (*_, by_name) = read(configured("mine:robot"), sampled("s", 0), swap)
    (*_, by_default) = read(swap)
    assert isinstance(by_name, BatterySwapped)
    assert isinstance(by_default, BatterySwapped)
    assert (by_name.agent, by_default.agent) == ("rob", "simulated robot")


def test_a_fit_was_a_prior_where_its_words_say_so_and_an_end_is_an_end() -> None:
    fitted = {
        "id": "f", "kind": "fitted", "samples": 2, "models": [MODEL, MODEL],
        "why": ["a prior: 2 samples only", "least squares"],
    }  # fmt: skip
    _, fit, end = read(fitted, {"id": "e", "kind": "finished", "reason": "5 samples taken"})
    assert isinstance(fit, Fitted)
    assert [each.is_prior for each in fit.fits] == [True, False]
    assert [each.why for each in fit.fits] == fitted["why"]
    assert {each.model.variogram.sill for each in fit.fits} == {10.0}
    assert isinstance(end, Finished)
    assert end.reason == "5 samples taken"


def test_from_a_continued_on_lines_are_those_of_today() -> None:
    reader = Reader()
    reader.read(json.dumps(OPENED), RECORDED)
    assert reader.format == 0
    (event,) = reader.read('{"id": "k", "kind": "continued", "format": 1}', RECORDED)
    assert (event.kind, reader.format, event.time) == ("continued", 1, None)
    (joined,) = reader.read('{"id": "j", "kind": "joined", "agent": "anna"}', RECORDED)
    assert isinstance(joined, Joined)
    assert joined.time is None


@pytest.mark.parametrize("number", [2, 99])
def test_a_format_that_there_is_not_is_refused_with_what_to_do(number: int) -> None:
    with pytest.raises(JournalError) as caught:
        Reader().read(json.dumps({**OPENED, "format": number}), RECORDED)
    assert caught.value.remedy == "update subsoil"
    assert f"its format {number} is newer than 1" in str(caught.value)


@pytest.mark.parametrize(
    ("line", "error"),
    [
        ("{", ValueError),
        ('{"id": "x"}', KeyError),
        ('{"id": "x", "kind": "no such"}', KeyError),
        ('["opened"]', TypeError),
        ('{"id": "p", "kind": "planned"}', ValueError),
        ('{"id": "c", "kind": "configured"}', KeyError),
    ],
)
def test_a_line_that_is_no_event_is_an_error_that_a_file_can_name(
    line: str, error: type[Exception]
) -> None:
    reader = Reader()
    reader.read(json.dumps(OPENED), RECORDED)
    with pytest.raises(error):
        reader.read(line, RECORDED)
