"""Readings as a table: a row a push with a column a depth, or a row a depth.

The heading names the position and each depth with its units, in any usual order and spelling::

    lat,lon,kpa_2.5cm,kpa_5.0cm,kpa_7.5cm
    53.26092,-0.52711,17.2,123.3,459.9
    53.26092,-0.52681,2.2,209.0,

or, a row a depth::

    id,lat,lon,depth_cm,kpa
    1,53.26092,-0.52711,2.5,17.2
    1,53.26092,-0.52711,5.0,123.3

Titles above the heading do not matter. Other columns are left alone, and the notes name them.
Numbers are read by the whole column: a file whose marks leave doubt is refused.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from subsoil.errors import listed
from subsoil.findings import Finding
from subsoil.io.read.outlines.outlines import frame
from subsoil.io.read.recording import NEWTONS, Frame, Record, Recording
from subsoil.io.read.tables.columns import Columns, columns_of
from subsoil.io.read.tables.grid import Grid, grid_of
from subsoil.io.read.tables.heading_row import heading_of
from subsoil.io.read.tables.row_places import Positions, positions_of
from subsoil.io.read.tables.sheet import NO_MEANINGS, Meanings, Row, Sheet
from subsoil.io.read.tables.summaries import without_summaries
from subsoil.io.read.tables.tidy import tidy_records
from subsoil.io.read.tables.wide import wide_records
from subsoil.land.crs import WGS84

_SPOT_M = 1.0


def recording_of(
    sheet: Sheet, meanings: Meanings = NO_MEANINGS, *, unit: str = "", placed: bool = False
) -> Recording:
    """What a sheet says of pushes.

    Parameters
    ----------
    sheet
        The sheet.
    meanings
        What its owner says that headings mean.
    unit
        Unit of strength by its owner, which tells what marks in numbers can be.
    placed
        Whether places come from another file.

    Raises
    ------
    ReadingsError
        If the heading does not say what the columns are, or numbers may have thousands marks. A
        row that does not hold the numbers it promises is left out instead.
    """
    heading = heading_of(sheet, meanings)
    where = f"{sheet.where}, row {heading.row}" if heading.row else sheet.where
    elsewhere = placed or bool(sheet.places)
    columns = columns_of(heading.names, where, meanings, placed=elsewhere)
    body, odd = _paired(heading.body, columns, sheet.file)
    body, sums = without_summaries(body, sheet.file)
    positions = _of_features(sheet, body) or positions_of(
        body, columns, sheet.where, program=sheet.by_program
    )
    grid = grid_of(sheet, columns, body, positions, columns.unit or unit.lower())
    records, findings = (wide_records if columns.layers else tidy_records)(grid)
    said = tidy_unit if (tidy_unit := grid.unit_said) else columns.unit
    records, said = _by_cones(records, said)
    notes = (*sheet.findings, *_notes(grid, body), *_spot(records, positions, sheet.file))
    found = (*notes, *odd, *sums, *findings)
    return Recording(tuple(records), found, positions.frame, said, _crs(sheet, positions))


def _paired(rows: list[Row], columns: Columns, file: str) -> tuple[list[Row], list[Finding]]:
    """Rows with as many cells as there are headings, and findings about the others."""
    most = len(columns.names)
    least = max(k for k, name in enumerate(columns.names) if name) + 1
    body, findings = [], []
    for row, cells in rows:
        if len(cells) == most:
            body.append((row, cells))
        elif len(cells) < least or any(cell.strip() for cell in cells[most:]):
            comma = ", as a decimal comma makes" if len(cells) > most else ""
            seen = f"{len(cells)} cells do not pair with {most} columns{comma}"
            findings.append(Finding(seen, "left out", "left out", file, row))
        else:
            body.append((row, [*cells, *[""] * most][:most]))
    return body, findings


def _of_features(sheet: Sheet, body: list[Row]) -> Positions | None:
    """Places of rows whose features have a geometry; ``None`` for a sheet without any."""
    if not sheet.places:
        return None
    nowhere = (np.nan, np.nan)
    at = np.array([sheet.places.get(row, nowhere) for row, _ in body]).reshape(-1, 2)
    wrong = {int(k): ("", "it has no place") for k in np.flatnonzero(np.isnan(at).any(axis=1))}
    lonlat = not sheet.crs or frame(sheet.crs, sheet.file) == WGS84
    return Positions(at[:, 0], at[:, 1], "lonlat" if lonlat else "metres", wrong)


def _crs(sheet: Sheet, positions: Positions) -> str:
    home: Frame = positions.frame
    return frame(sheet.crs, sheet.file) if sheet.crs and home == "metres" else ""


def _by_cones(records: list[Record], unit: str) -> tuple[list[Record], str]:
    """Records in kPa where the file has forces and the cone of each; else as they are."""
    if unit not in NEWTONS or not all(record.cone for record in records):
        return records, unit
    pressures = [
        replace(r, values=r.values * r.cone.pressure_kpa(NEWTONS[unit])) for r in records if r.cone
    ]
    return pressures, "kpa"


def _notes(grid: Grid, body: list[Row]) -> list[Finding]:
    """Columns that are left alone, and depths that are written with a minus."""
    names, used = grid.columns.names, grid.used
    others = [name for k, name in enumerate(names) if k not in used and name]
    others += [
        f"column {k + 1} without a heading"
        for k, name in enumerate(names)
        if k not in used and not name and any(cells[k].strip() for _, cells in body)
    ]
    notes = []
    if others:
        notes.append(Finding(f"columns left alone: {listed(others, 12)}", file=grid.file))
    if any(grid.columns.meanings[k].above for k in grid.columns.layers):
        notes.append(Finding("depths with a minus are taken as below the ground", file=grid.file))
    return notes


def _spot(records: list[Record], positions: Positions, file: str) -> list[Finding]:
    """A doubt about places in metres that all lie within one."""
    x, y = np.array([r.x for r in records]), np.array([r.y for r in records])
    if positions.frame != "metres" or len({(r.x, r.y) for r in records}) < 2:
        return []
    span = max(float(np.ptp(x)), float(np.ptp(y)))
    if span >= _SPOT_M:
        return []
    seen = f"all readings lie within {span:.2g} m"
    return [Finding(seen, "check the unit of places (km?)", "doubt", file)]
