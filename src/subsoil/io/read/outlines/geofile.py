"""GeoPackages and shapefiles, through pyogrio where it is installed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import shapely
from numpy.typing import NDArray
from shapely.errors import ShapelyError
from shapely.geometry import GeometryCollection, LineString, MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

from subsoil.errors import BoundaryError, InputError, brief, listed
from subsoil.io.read.alone import alone
from subsoil.io.read.outlines.outlines import (
    NOTHING,
    Feature,
    Outlines,
    frame,
    left_alone,
    name_among,
    outlines_of,
)
from subsoil.io.read.text import check_file
from subsoil.land.outline import Area
from subsoil.optional import load


@dataclass(frozen=True)
class Layer:
    """A layer of a file.

    Attributes
    ----------
    crs
        Its CRS; empty if the file names none.
    shapes
        (n,) geometries as WKB.
    fields
        (n,) values of each attribute, by its name.
    others
        Layers that the file has beside it.
    asked_for
        Whether it was chosen by its name among several.
    """

    crs: str
    shapes: NDArray[Any]
    fields: dict[str, NDArray[Any]]
    others: tuple[str, ...] = ()
    asked_for: bool = False


def read_geofile(path: Path, crs: str | None, name: str = "") -> Outlines:
    """Read a layer of polygons of a file.

    Parameters
    ----------
    path
        The file.
    crs
        Frame of a file that does not name one, such as a shapefile without its ``.prj``.
    name
        Which layer to read, where there are several, if it is called that.

    Raises
    ------
    BoundaryError
        If it cannot be read, has no or several layers of polygons, or no CRS.
    MissingExtraError
        If pyogrio is not installed.
    """
    layer = read_layer(path, "Polygon", BoundaryError, name)
    home = layer.crs or crs
    if not home:
        raise BoundaryError(
            "it does not name its CRS",
            where=path.name,
            remedy="keep the .prj file beside it, or name the CRS",
        )
    features = list(_features(layer, path.name))
    if layer.asked_for:
        features = [replace(each, name=name) for each in features]
    found = outlines_of(features, frame(home, path.name), path.name)
    others = left_alone([f"layer {name}" for name in layer.others], path.name)
    return replace(found, findings=(*found.findings, *others))


def read_layer(path: Path, kind: str, wrong: type[InputError], called: str = "") -> Layer:
    """Read the only layer of a kind of shape, or the one of a name.

    Parameters
    ----------
    path
        GeoPackage or shapefile.
    kind
        ``"Polygon"`` or ``"Point"``.
    wrong
        Kind of error to raise.
    called
        Which layer to read, where there are several.

    Raises
    ------
    InputError
        Of the kind ``wrong``, if it cannot be read, or has no or several such layers.
    MissingExtraError
        If pyogrio is not installed.
    """
    check_file(path, wrong)
    what = f"reading {path.suffix} files"
    pyogrio = load("pyogrio", "geo", what, where=path.name, instead="save it as GeoJSON")
    with alone(path, wrong) as copy:
        _check_prj(copy.with_suffix(".prj"), path, wrong)
        try:
            layers = [(name, of) for name, of in pyogrio.list_layers(copy) if of]
            name, asked_for = _named(layers, kind, called, path.name, wrong)
            meta, _, shapes, columns = pyogrio.raw.read(copy, layer=name, force_2d=True)
        except (RuntimeError, ValueError) as error:
            said = " ".join(str(error).split())
            raise wrong(
                f"GDAL cannot read it: {brief(said.replace(str(copy), 'it'), 200)}",
                where=path.name,
                remedy="export it again",
            ) from error
    fields = dict(zip(meta["fields"], columns, strict=True))
    others = tuple(str(each) for each, _ in layers if each != name)
    return Layer(meta["crs"] or "", shapes, fields, others, asked_for)


def _check_prj(prj: Path, path: Path, wrong: type[InputError]) -> None:
    """Check that the CRS beside a shapefile can be read; GDAL's reader fails on some."""
    if not prj.exists():
        return
    try:
        from pyproj import CRS

        CRS.from_wkt(prj.read_text("utf-8-sig"))
    except (OSError, ValueError, RuntimeError) as error:
        raise wrong(
            "the .prj file beside it is damaged", where=path.name, remedy="export it again"
        ) from error


def _features(layer: Layer, file: str) -> Iterator[Feature]:
    for k, shape in enumerate(layer.shapes):
        properties = {key: _word(column[k]) for key, column in layer.fields.items()}
        name, role = name_among(properties), properties.get("role", "")
        where = f"{file}, feature {k + 1}" + (f" ({brief(name)})" if name else "")
        try:
            geometry = shapely.from_wkb(shape) if shape else None
        except ShapelyError as error:
            raise BoundaryError(
                "its geometry cannot be read",
                where=where,
                remedy="curves are no outline: export it with straight edges",
            ) from error
        for each in _shapes(geometry):
            yield Feature(where, each, role, name)


def _word(value: Any) -> str:
    return value if isinstance(value, str) else ""


def _shapes(geometry: BaseGeometry | None) -> Iterator[Area | LineString | str]:
    """Areas and lines of a geometry; the names of the kinds of all else."""
    if geometry is None or geometry.is_empty:
        yield NOTHING
    elif isinstance(geometry, GeometryCollection):
        for part in geometry.geoms:
            yield from _shapes(part)
    else:
        known = geometry if isinstance(geometry, Polygon | MultiPolygon | LineString) else None
        yield known or geometry.geom_type


def _named(
    layers: list[tuple[str, str]], kind: str, called: str, file: str, wrong: type[InputError]
) -> tuple[str, bool]:
    """Name of the layer to read, and whether it was chosen among several."""
    names = [name for name, of in layers if kind in of or of in ("Unknown", "GeometryCollection")]
    asked = [name for name in names if name == called] or [
        name for name in names if called and name.casefold() == called.casefold()
    ]
    if len(names) > 1 and asked:
        return asked[0], True
    lines = [name for name, of in layers if "LineString" in of]
    if kind == "Polygon" and not names and len(lines) == 1:
        return lines[0], False
    if len(names) != 1:
        raise wrong(
            f"layers of {kind.lower()}s: {listed(names) or 'none'}",
            where=file,
            remedy="choose one with --name" if names else "save a file with that layer alone",
        )
    return names[0], False
