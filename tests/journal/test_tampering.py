"""Whoever changes a survey file is found out, or at the least has another fingerprint."""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from subsoil.errors import CorruptJournalError
from subsoil.journal import last_event, open_journal, read_survey, verify
from subsoil.journal.content import ROOT, digest_of

Body = dict[str, Any]


def edited(path: Path, *statements: str) -> None:
    with closing(sqlite3.connect(path)) as database:
        for statement in statements:
            database.execute(statement)
        database.commit()


def bodies(path: Path) -> list[Body]:
    with closing(sqlite3.connect(path)) as database:
        return [json.loads(row[0]) for row in database.execute("SELECT body FROM events")]


def forged(path: Path, change: Callable[[list[Body]], object]) -> None:
    """Change events as somebody would who knows the format: digests, columns and anchor fit."""
    events = bodies(path)
    change(events)
    digest, seq = ROOT, 0
    with closing(sqlite3.connect(path)) as database:
        database.execute("DELETE FROM events")
        for seq, event in enumerate(events, start=1):
            body = json.dumps(event, separators=(",", ":"))
            digest = digest_of(digest, body)
            recorded = event["time"][:23] + "+00:00"
            row = (seq, event["id"], event["kind"], recorded, body, digest)
            database.execute("INSERT INTO events VALUES (?, ?, ?, ?, ?, ?)", row)
        database.execute("UPDATE subsoil_anchor SET seq = ?, digest = ?", (seq, digest))
        database.execute("UPDATE sqlite_sequence SET seq = ? WHERE name = 'events'", (seq,))
        database.commit()


def of(events: list[Body], kind: str, which: int = 0) -> Body:
    return [event for event in events if event["kind"] == kind][which]


@pytest.mark.parametrize(
    "statement",
    [
        "UPDATE events SET body = replace(body, '\"seed\":3', '\"seed\":4')",
        "UPDATE events SET body = body || ' ' WHERE seq = 7",
        "UPDATE events SET body = '{}' WHERE seq = 7",
        "UPDATE events SET body = 'no json' WHERE seq = 9",
        "UPDATE events SET digest = 'x' WHERE seq = 3",
        "UPDATE events SET digest = upper(digest) WHERE seq = 1",
        "DELETE FROM events WHERE seq = 5",
        "DELETE FROM events WHERE seq = 1",
        "DELETE FROM events WHERE kind = 'finished'",
        "DELETE FROM events WHERE seq > 30",
        "DELETE FROM events WHERE seq > 1",
        "DELETE FROM events",
        "UPDATE events SET id = 'other' WHERE seq = 6",
        "UPDATE events SET kind = 'refused' WHERE kind = 'sampled'",
        "UPDATE events SET recorded = '2001-01-01T00:00:00.000+00:00' WHERE seq = 6",
        "UPDATE events SET recorded = 'yesterday' WHERE seq = 6",
        "UPDATE events SET seq = 1000 WHERE kind = 'finished'",
        "UPDATE events SET seq = seq + 100",
        "UPDATE subsoil_anchor SET digest = 'x'",
        "UPDATE subsoil_anchor SET seq = seq + 1",
        "DELETE FROM subsoil_anchor",
        "INSERT INTO events SELECT seq + 1, 'again', kind, recorded, body, digest FROM events"
        " WHERE kind = 'finished'",
    ],
)
def test_a_change_of_the_events_is_found(finished: Path, statement: str) -> None:
    edited(finished, statement)
    assert verify(finished).findings


@pytest.mark.parametrize("after", [1, 10, 30])
@pytest.mark.parametrize("rows_too", [False, True])
def test_an_end_that_was_cut_off_is_found_and_nobody_goes_on_from_it(
    finished: Path, after: int, rows_too: bool
) -> None:
    edited(finished, f"DELETE FROM events WHERE seq > {after}")
    if rows_too:
        edited(finished, "DELETE FROM samples", "DELETE FROM targets", "DELETE FROM route")
    assert any("the last events are missing" in finding for finding in verify(finished).findings)
    for use in (read_survey, open_journal):
        with pytest.raises(CorruptJournalError, match="the last events are missing"):
            use(finished)


FORGERIES: dict[str, Callable[[list[Body]], object]] = {
    "force": lambda e: of(e, "sampled")["reading"]["force_n"].__setitem__(99, 500.0),
    "place": lambda e: of(e, "sampled").update(at=[30.0, 20.0]),
    "seed": lambda e: of(e, "configured")["settings"].update(seed=4),
    "samples": lambda e: of(e, "configured")["settings"].update(samples=9),
    "strategy": lambda e: of(e, "configured")["settings"].update(strategy="w-shape"),
    "estimator": lambda e: of(e, "configured")["settings"].update(estimator="pmc"),
    "boundary": lambda e: of(e, "opened").update(
        boundary_wkt="POLYGON ((0 0, 60 0, 60 30, 0 30, 0 0))"
    ),
    "keep-out": lambda e: of(e, "opened").update(
        keep_outs_wkt=["POLYGON ((0 0, 20 0, 20 20, 0 20, 0 0))"]
    ),
    "cells": lambda e: of(e, "opened").update(cell_size_m=4.0),
    "cone": lambda e: of(e, "opened").update(cone_area_mm2=323.0),
    "layers": lambda e: of(e, "opened").update(layer_edges_m=[0.06 * k for k in range(9)]),
    "model": lambda e: of(e, "fitted", 5)["fits"][0]["model"].update(nugget=1.0),
    "prior": lambda e: of(e, "fitted", 0)["fits"][0].update(is_prior=False),
    "planned cells": lambda e: of(e, "planned", 2).update(cells=[1, 2, 3], kept=False),
    "mean KV": lambda e: of(e, "planned", 4).update(mean_kv=1.0),
    "assigned cell": lambda e: of(e, "assigned", 3).update(cell=5),
    "reason of the end": lambda e: of(e, "finished").update(reason="enough"),
    "no end": lambda e: e.append({**of(e, "finished"), "id": "again"}),
    "a reading gone": lambda e: e.remove(of(e, "sampled", 4)),
    "a plan gone": lambda e: e.remove(of(e, "planned", 4)),
    "a reading twice": lambda e: e.insert(8, {**of(e, "sampled"), "id": "again"}),
    "an unknown agent": lambda e: of(e, "sampled", 1).update(agent="nobody"),
    "a huge cell": lambda e: of(e, "planned", 1).update(cells=[10**9], kept=False),
    "an unknown kind": lambda e: of(e, "planned", 1).update(kind="guessed"),
    "set up twice": lambda e: e.insert(3, {**of(e, "opened"), "id": "again"}),
}
"""Changes that do not add up, whatever the digests say."""


@pytest.mark.parametrize("name", FORGERIES)
def test_a_forgery_that_does_not_add_up_is_found(finished: Path, name: str) -> None:
    forged(finished, FORGERIES[name])
    assert verify(finished).findings, name


PLAUSIBLE: dict[str, Callable[[list[Body]], object]] = {
    "way": lambda e: of(e, "sampled", 3).update(metres=1.0),
    "time spent": lambda e: of(e, "sampled", 3).update(seconds=1.0),
    "ending": lambda e: of(e, "sampled")["reading"].update(ending="stone"),
    "assignment": lambda e: of(e, "sampled", 2).update(assignment="another"),
    "reason of a plan": lambda e: of(e, "planned", 0).update(reason="because"),
    "rates": lambda e: of(e, "configured")["settings"]["rates"].update(hour=1.0),
    "name": lambda e: of(e, "opened").update(name="another field"),
    "tries": lambda e: of(e, "sampled").update(tries=2),
    "source": lambda e: of(e, "joined").update(simulation=None),
    "time": lambda e: of(e, "sampled").update(time="2020-01-01T00:00:00.000000Z"),
}
"""Changes that could be true."""


@pytest.mark.parametrize("name", PLAUSIBLE)
def test_a_forgery_that_adds_up_has_another_fingerprint(finished: Path, name: str) -> None:
    before = last_event(finished)
    print(read_survey(finished).fingerprint)
    forged(finished, PLAUSIBLE[name])
    assert last_event(finished) != before


def test_writing_the_events_anew_as_they_were_changes_no_digest(finished: Path) -> None:
    """The forger of these tests is right: what differs above is due to what was changed."""
    with closing(sqlite3.connect(finished)) as database:
        rows = database.execute("SELECT * FROM events").fetchall()
        database.execute("DELETE FROM events")
        database.executemany("INSERT INTO events VALUES (?, ?, ?, ?, ?, ?)", rows)
        database.commit()
    assert verify(finished).findings == ()


@pytest.mark.parametrize(
    "statement",
    [
        "UPDATE samples SET geom = (SELECT geom FROM samples WHERE fid = 2) WHERE fid = 1",
        "UPDATE samples SET geom = x'00' WHERE fid = 1",
        "UPDATE samples SET cell = 5 WHERE fid = 1",
        "UPDATE samples SET depth_m = 0.1 WHERE fid = 1",
        "UPDATE samples SET tries = 9 WHERE fid = 1",
        "UPDATE samples SET states = 'measured' WHERE fid = 1",
        "UPDATE samples SET kpa_5_10cm = kpa_5_10cm + 0.01 WHERE fid = 3",
        "UPDATE samples SET kpa_5_10cm = NULL WHERE fid = 3",
        "UPDATE samples SET agent = 'me' WHERE fid = 3",
        "UPDATE samples SET source = 'robot' WHERE fid = 3",
        "UPDATE samples SET time = '2020' WHERE fid = 3",
        "UPDATE samples SET flags = 'stone' WHERE fid = 3",
        "UPDATE samples SET id = 'x' WHERE fid = 3",
        "DELETE FROM samples WHERE fid = 3",
        "INSERT INTO samples(geom, id, cell) SELECT geom, 'x', 4 FROM samples WHERE fid = 1",
        "UPDATE boundary SET geom = (SELECT geom FROM samples LIMIT 1)",
        "UPDATE boundary SET area_ha = 100",
        "UPDATE boundary SET name = 'another'",
        "UPDATE boundary SET role = 'keep-out'",
        "DELETE FROM boundary",
        "INSERT INTO boundary(geom, name, role, area_ha) SELECT geom, name, 'keep-out', 1"
        " FROM boundary",
        "INSERT INTO refusals(geom, id, cell) SELECT geom, 'x', 4 FROM samples WHERE fid = 1",
        "INSERT INTO targets(geom, cell, stop, agent) SELECT geom, 4, 99, '' FROM samples LIMIT 1",
        "INSERT INTO route(geom, stop, metres) SELECT geom, 99, 4 FROM samples LIMIT 1",
        "UPDATE gpkg_contents SET srs_id = 4326 WHERE table_name = 'samples'",
        "UPDATE gpkg_geometry_columns SET srs_id = 4326 WHERE table_name = 'samples'",
        "UPDATE gpkg_contents SET data_type = 'attributes' WHERE table_name = 'samples'",
        "DELETE FROM gpkg_contents WHERE table_name = 'refusals'",
        "CREATE TRIGGER eat AFTER INSERT ON samples BEGIN DELETE FROM samples; END",
        "CREATE TRIGGER rtree_samples_geom_insert AFTER INSERT ON events BEGIN"
        " DELETE FROM events WHERE id = NEW.id; END",
        "CREATE VIEW better AS SELECT * FROM samples",
        "DROP TABLE route",
    ],
)
def test_what_a_gis_would_see_wrongly_is_found(finished: Path, statement: str) -> None:
    edited(finished, statement)
    assert verify(finished).findings, statement


def test_a_frame_in_the_place_of_another_is_found(finished: Path) -> None:
    for table in ("gpkg_contents", "gpkg_geometry_columns"):
        edited(finished, f"UPDATE {table} SET srs_id = 4326 WHERE table_name != 'x'")
    assert verify(finished).findings


@pytest.mark.parametrize("area", [0.0, 9.0, 1e300, float("nan")])
def test_a_file_with_a_cone_that_there_is_not_is_said_to_be_wrong(
    finished: Path, area: float
) -> None:
    forged(finished, lambda e: of(e, "opened").update(cone_area_mm2=area))
    for use in (read_survey, open_journal):
        with pytest.raises(CorruptJournalError, match=r"event 1: .*opened\.cone_area_mm2: Input"):
            use(finished)
    assert any("cone_area_mm2" in finding for finding in verify(finished).findings)


LONG = "x" * 5000
LONG_WORDS: dict[str, Callable[[list[Body]], object]] = {
    "name": lambda e: of(e, "opened").update(name=LONG, crs="nonsense"),
    "frame": lambda e: of(e, "opened").update(crs=LONG),
    "outline": lambda e: of(e, "opened").update(boundary_wkt=LONG),
    "strategy": lambda e: of(e, "configured")["settings"].update(strategy=LONG),
    "code": lambda e: of(e, "configured")["settings"].update(strategy=f"{LONG}:own"),
    "setting": lambda e: of(e, "configured")["settings"].update(strategy_settings={LONG: 1.0}),
    "currency": lambda e: of(e, "configured")["settings"]["rates"].update(currency=LONG),
    "model": lambda e: of(e, "fitted")["fits"][0]["model"].update(name=LONG),
    "agent": lambda e: of(e, "assigned").update(agent=LONG),
    "member": lambda e: of(e, "assigned").update({LONG: 1}),
}


@pytest.mark.parametrize("name", LONG_WORDS)
def test_words_without_end_in_a_file_do_not_fill_what_is_said_of_it(
    finished: Path, name: str
) -> None:
    forged(finished, LONG_WORDS[name])
    found = verify(finished)
    assert found.findings or found.notes
    assert all(len(line) < 600 for line in (*found.findings, *found.notes))


def test_a_row_with_a_name_without_end_is_named_shortly(finished: Path) -> None:
    edited(finished, f"UPDATE samples SET id = '{LONG}' WHERE fid = 1")
    edited(finished, f"CREATE VIEW v{LONG} AS SELECT 1")
    findings = verify(finished).findings
    assert any("follows from no event" in finding for finding in findings)
    assert all(len(finding) < 600 for finding in findings)
