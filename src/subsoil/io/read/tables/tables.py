"""Tables of readings in files of any kind: delimited text, workbooks, points."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

from subsoil.errors import ReadingsError, listed
from subsoil.findings import Finding
from subsoil.io.read.recording import Recording
from subsoil.io.read.tables.delimited import looks_like_table, read_delimited
from subsoil.io.read.tables.point_sheet import looks_like_points, read_point_sheet
from subsoil.io.read.tables.sheet import NO_MEANINGS, Meanings, Sheet
from subsoil.io.read.tables.table import recording_of
from subsoil.io.read.tables.workbook import looks_like_workbook, read_workbook


@dataclass(frozen=True)
class SheetReader:
    """How files of one kind become sheets.

    Attributes
    ----------
    name
        What people call them.
    sniff
        Whether a file is one, by its first 4 096 bytes and its name.
    sheets
        Sheets of a path.
    """

    name: str
    sniff: Callable[[bytes, str], bool]
    sheets: Callable[[Path], tuple[Sheet, ...]]


SHEETS: dict[str, SheetReader] = {
    "workbook": SheetReader("workbook (.xlsx)", looks_like_workbook, read_workbook),
    "points": SheetReader(
        "points (GeoPackage, shapefile, GeoJSON)", looks_like_points, read_point_sheet
    ),
    "table": SheetReader("table (CSV, text)", looks_like_table, read_delimited),
}
"""By the name that forces one, in the order in which they are asked."""


def read_sheets(
    kind: SheetReader,
    path: Path,
    meanings: Meanings = NO_MEANINGS,
    *,
    unit: str = "",
    placed: bool = False,
) -> Recording:
    """Read the sheet of a file that holds readings.

    Parameters
    ----------
    kind
        One of :data:`SHEETS`.
    path
        The file.
    meanings, unit, placed
        As in :func:`~subsoil.io.read.tables.table.recording_of`.

    Raises
    ------
    ReadingsError
        If no sheet reads as a table of readings, or more than one does.
    """
    sheets = kind.sheets(path)
    if not any(sheet.rows for sheet in sheets):
        raise ReadingsError("all its cells are blank", where=path.name, remedy="export it again")
    if len(sheets) == 1:
        return recording_of(sheets[0], meanings, unit=unit, placed=placed)
    found: list[tuple[str, Recording]] = []
    errors: list[ReadingsError] = []
    for sheet in sheets:
        try:
            found.append((sheet.name, recording_of(sheet, meanings, unit=unit, placed=placed)))
        except ReadingsError as error:
            errors.append(error)
    if not found:
        raise max(errors, key=lambda error: len(str(error)))
    if len(found) > 1:
        raise ReadingsError(
            f"sheets {listed([name for name, _ in found])} all hold readings",
            where=path.name,
            remedy="save each as a file of its own",
        )
    ((name, recording),) = found
    others = [sheet.name for sheet in sheets if sheet.name != name and sheet.rows]
    seen = f"sheet {name} is read" + (f", others left alone: {listed(others)}" if others else "")
    return replace(recording, findings=(Finding(seen, file=path.name), *recording.findings))
