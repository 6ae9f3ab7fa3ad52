"""Does a survey file say what its events imply? Check, compute and compare everything."""

from __future__ import annotations

import sqlite3
from collections.abc import Callable, Iterable, Iterator
from datetime import datetime
from pathlib import Path

from subsoil.errors import CorruptJournalError, SubsoilError, brief, printable
from subsoil.journal import format_0, gis
from subsoil.journal.ahead import ahead_of
from subsoil.journal.connection import reading
from subsoil.journal.content import ROOT, Recorded, cut_off, digest_of, read_row, rows_of
from subsoil.journal.foreign import foreign
from subsoil.journal.geopackage import geometry_of, srs_of_frame
from subsoil.journal.marks import marks
from subsoil.registry import NOBODY, Allowed
from subsoil.survey import Survey, fold
from subsoil.survey.events import Event, Opened
from subsoil.survey.formats import Reader
from subsoil.survey.recompute import Verdict, recomputed

_CLOSE = 1e-9
"""Relative difference of numbers that are the same."""
_MOST = 20
"""Findings of one kind that are named one by one."""


def verify(
    path: Path,
    allowed: Allowed = NOBODY,
    progress: Callable[[int], None] = lambda _: None,
) -> Verdict:
    """Differences between a survey file and what its events imply.

    Digests, numbers and columns of all events; every fit, plan and ending, decided again from the
    events before it; every row that a GIS shows; and whatever else is in the file that could change
    what is kept in it.

    Parameters
    ----------
    path
        The survey file.
    allowed
        Modules whose strategies may be run, beside the registered ones.
    progress
        Told how many events are done.

    Raises
    ------
    JournalError
        If the file is missing or not a survey, or of a newer format.
    """
    with reading(path) as database:
        verdict = _checked_pages(database) + _checked_schema(database)
        verdict += Verdict(notes=marks(database, path))
        numbered, events = _checked_events(database, path)
        verdict += events
        if not numbered or not isinstance(numbered[0][1], Opened):
            return verdict + Verdict(("no event sets the survey up",))
        try:
            verdict += recomputed(numbered, allowed, progress)
            survey = fold(event for _, event in numbered)
        except SubsoilError as error:
            return verdict + Verdict((f"the events do not add up: {error}",))
        seen = (*_registered(database, survey.field.crs), *_layers(database, survey, numbered))
        return verdict + Verdict(tuple(_few(seen)))


def _checked_pages(database: sqlite3.Connection) -> Verdict:
    """What sqlite itself finds wrong with the file."""
    found = [row[0] for row in database.execute("PRAGMA quick_check(5)")]
    return Verdict(tuple(f"damaged: {what}" for what in found if what != "ok"))


def _checked_schema(database: sqlite3.Connection) -> Verdict:
    """What other programs put into the file: a finding if it could change what the file says."""
    found = foreign(database)
    notes = (f"added by a GIS: {found.known}",) if found.known else ()
    return Verdict(tuple(map(printable, found.strange)), notes)


def _checked_events(
    database: sqlite3.Connection, path: Path
) -> tuple[list[tuple[int, Event]], Verdict]:
    """Events by their numbers, as far as they can be read, and what is wrong with their rows."""
    numbered: list[tuple[int, Event]] = []
    findings: list[str] = []
    reader, digest, last = Reader(), ROOT, (0, ROOT)
    for row in rows_of(database):
        expected = digest_of(digest, row.body)
        if row.digest != expected:
            findings.append(f"event {row.seq}: it, or one before it, was changed")
        if row.seq != last[0] + 1:
            findings.append(f"event {row.seq}: it follows event {last[0]}")
        digest, last = row.digest, (row.seq, row.digest)
        try:
            events = read_row(reader, row, path)
        except CorruptJournalError as error:
            findings.append(f"event {row.seq}: {error.what}")
            break
        findings += _columns(row, events[-1 if reader.format == 0 else 0])
        numbered += [(row.seq, event) for event in events]
    if cut := cut_off(database, last):
        findings.append(cut)
    return numbered, Verdict(tuple(_few(findings)))


def _columns(row: Recorded, event: Event) -> Iterator[str]:
    """Columns of an event's row that differ from the event."""
    recorded = _time(row.recorded)
    if recorded is None:
        yield f"event {row.seq}: recorded at {brief(row.recorded)!r}, which is no time"
    elif event.time is not None and recorded != _milliseconds(event.time):
        yield f"event {row.seq}: column recorded differs from the event"
    if row.id != event.id and not event.id.startswith(row.id):
        yield f"event {row.seq}: column id differs from the event"
    if row.kind != event.kind and not (row.kind == "configured" and event.kind == "joined"):
        yield f"event {row.seq}: column kind differs from the event"


def _time(text: str) -> datetime | None:
    try:
        time = datetime.fromisoformat(text)
    except ValueError:
        return None
    return time if time.tzinfo else None


def _milliseconds(time: datetime) -> datetime:
    return time.replace(microsecond=time.microsecond // 1000 * 1000)


def _layers(
    database: sqlite3.Connection, survey: Survey, numbered: list[tuple[int, Event]]
) -> Iterator[str]:
    """Rows that a GIS sees and that differ from what the survey's state implies."""
    old = all(getattr(event, "format", 0) == 0 for _, event in numbered)
    expected = format_0.rows(survey) if old else _rows(survey)
    for table, rows in expected.items():
        try:
            yield from _table(database, table, rows)
            yield from _index(database, table)
        except (sqlite3.Error, ValueError) as error:
            yield f"layer {table}: {brief(str(error), 200)}"


def _registered(database: sqlite3.Connection, crs: str) -> Iterator[str]:
    """Layers that are not registered as they were made, or not in the survey's frame."""
    query = (
        "SELECT c.table_name, c.data_type, c.identifier, c.srs_id, g.column_name, g.srs_id"
        " FROM gpkg_contents c JOIN gpkg_geometry_columns g USING (table_name)"
    )
    found = {row[0]: row[1:] for row in database.execute(query)}
    frame = srs_of_frame(crs)
    for layer in gis.LAYERS:
        if layer not in found:
            yield f"layer {layer} is not registered"
        elif found[layer][:2] != ("features", layer) or found[layer][3] != "geom":
            yield f"layer {layer} is registered as something else"
        elif {found[layer][2], found[layer][4]} != {frame}:
            yield f"layer {layer} is not in the survey's frame, {brief(crs) or 'a local one'}"


def _rows(survey: Survey) -> dict[str, list[gis.Row]]:
    """Rows of every layer."""
    rows = {
        "boundary": list(gis.boundary_rows(survey.field)),
        "samples": list(gis.sample_rows(survey)),
        "refusals": list(gis.refusal_rows(survey)),
        "targets": [],
        "route": [],
    }
    for target in ahead_of(survey).targets(survey.access):
        for table, row in gis.target_rows(survey, target).items():
            rows[table].append(row)
    return rows


def _table(database: sqlite3.Connection, table: str, expected: Iterable[gis.Row]) -> Iterator[str]:
    """Rows of a layer that are missing, too many, or differ."""
    rows = {_key(row.values): row for row in expected}
    names = list(next(iter(rows.values())).values) if rows else _names(database, table)
    seen: set[object] = set()
    for blob, *values in database.execute(f"SELECT geom, {', '.join(names)} FROM {table}"):
        found = dict(zip(names, values, strict=True))
        key = _key(found)
        shown = brief(str(key))
        if key not in rows or key in seen:
            yield f"layer {table}: row {shown} follows from no event"
            continue
        seen.add(key)
        row = rows[key]
        wrong = [name for name in names if not _same(found[name], row.values[name])]
        if not geometry_of(blob).equals_exact(row.geometry, _CLOSE):
            wrong.append("geometry")
        if wrong:
            yield f"layer {table}: {', '.join(wrong)} of row {shown} differ from the events"
    for key in rows.keys() - seen:
        yield f"layer {table}: row {brief(str(key))} is missing"


def _index(database: sqlite3.Connection, table: str) -> Iterator[str]:
    """Whether a spatial index that a GIS built names other rows than there are."""
    index = f"rtree_{table}_geom"
    query = "SELECT 1 FROM sqlite_master WHERE name = ?"
    if not database.execute(query, (index,)).fetchone():
        return
    named, there = (
        {row[0] for row in database.execute(f"SELECT {key} FROM {where}")}
        for key, where in (("id", index), ("fid", table))
    )
    if named != there:
        yield f"layer {table}: its spatial index does not name the rows that there are"


def _names(database: sqlite3.Connection, table: str) -> list[str]:
    known = [row[1] for row in database.execute(f"PRAGMA table_info({table})")]
    return [name for name in known if name not in ("fid", "geom")]


def _key(values: object) -> object:
    """What tells a row of a layer from the others."""
    assert isinstance(values, dict)
    for name in ("id", "stop", "cell", "role"):
        if name in values:
            key = values[name]
            return key if name != "role" else f"{key} of {values['area_ha']:.6f} ha"
    return "the only one"


def _same(a: object, b: object) -> bool:
    if isinstance(a, float) and isinstance(b, float):
        return abs(a - b) <= _CLOSE * max(abs(a), abs(b))
    return a == b


def _few(findings: Iterable[str]) -> Iterator[str]:
    """Pass on the first findings, and the number of the others."""
    more = 0
    for k, finding in enumerate(findings):
        if k < _MOST:
            yield finding
        else:
            more += 1
    if more:
        yield f"and {more} more of this kind"
