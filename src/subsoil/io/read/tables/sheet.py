"""A sheet: rows of cells as text, whatever kind of file they stood in."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

from subsoil.findings import Finding

Row = tuple[int, list[str]]
"""Its number in the file, and its cells."""

Meanings = Mapping[str, str]
"""What its owner says that headings mean."""
NO_MEANINGS: Meanings = MappingProxyType({})

MOST_CELLS = 4_000_000
"""No survey has more; they would take gigabytes of memory."""


@dataclass(frozen=True)
class Sheet:
    """A table before anybody asks what it means.

    Attributes
    ----------
    file
        Name of the file.
    rows
        Rows with anything in them, top of the file first; titles and heading among them.
    by_program
        Whether a program wrote the numbers, so that they have decimal points and no other marks.
    places
        Longitude and latitude, or easting and northing, of rows whose features have a geometry.
    crs
        Frame of the places; empty if the file does not say.
    findings
        What is to be known of the file already.
    name
        Name of the sheet, where a file may have several.
    """

    file: str
    rows: list[Row]
    by_program: bool = False
    places: Mapping[int, tuple[float, float]] = field(default_factory=dict)
    crs: str = ""
    findings: tuple[Finding, ...] = ()
    name: str = ""

    @property
    def where(self) -> str:
        """File and sheet, for messages."""
        return f"{self.file}, sheet {self.name}" if self.name else self.file
