"""XML of strangers: no entities, nothing fetched, whatever the prefix of its namespace."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

from subsoil.errors import BoundaryError, brief
from subsoil.io.read.text import read_text

Element = ElementTree.Element


def parsed(path: Path, kind: str) -> Element:
    """Root of a file of some kind, such as ``"kml"``.

    Raises
    ------
    BoundaryError
        If it is not that kind of XML, or declares entities.
    """
    text, file, again = (
        read_text(path, BoundaryError),
        path.name,
        f"export it again as {kind.upper()}",
    )
    if "<!DOCTYPE" in text or "<!ENTITY" in text:
        raise BoundaryError(
            f"it declares entities, which no {kind.upper()} needs",
            where=file,
            remedy="export it again",
        )
    text = text.lstrip()
    try:
        root = ElementTree.fromstring(text.partition("?>")[2] if text.startswith("<?xml") else text)
    except (ElementTree.ParseError, RecursionError, ValueError) as error:
        raise BoundaryError(
            f"this is not XML: {brief(str(error), 200)}", where=file, remedy=again
        ) from error
    if kind_of(root) != kind:
        raise BoundaryError(
            f"this is {brief(kind_of(root))}, not {kind.upper()}", where=file, remedy=again
        )
    return root


def kind_of(element: Element) -> str:
    """Name of an element without its namespace; comments have none."""
    return str(element.tag).rpartition("}")[2]


def word_of(element: Element, kind: str) -> str:
    """Text of the first child of a kind; empty if there is none."""
    found = (each.text or "" for each in element if kind_of(each) == kind)
    return next(found, "").strip()
