"""GeoPackages and shapefiles, through pyogrio where it is installed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.errors import ShapelyError
from shapely.geometry import MultiPolygon, Polygon

from subsoil.errors import BoundaryError, InputError, brief, listed
from subsoil.io.read.alone import alone
from subsoil.io.read.outlines import NOTHING, Feature, Outlines, frame, left_alone, outlines_of
from subsoil.io.read.text import check_file
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
        Layers of other shapes that the file has.
    """

    crs: str
    shapes: NDArray[Any]
    fields: dict[str, NDArray[Any]]
    others: tuple[str, ...] = ()


def read_geofile(path: Path, crs: str | None) -> Outlines:
    """Read the only layer of polygons of a file.

    Parameters
    ----------
    path
        The file.
    crs
        Frame of a file that does not name one, such as a shapefile without its ``.prj``.

    Raises
    ------
    BoundaryError
        If it cannot be read, has no or several layers of polygons, or no CRS.
    MissingExtraError
        If pyogrio is not installed.
    """
    layer = read_layer(path, "Polygon", BoundaryError)
    home = layer.crs or crs
    if not home:
        raise BoundaryError(
            "it does not name its CRS",
            where=path.name,
            remedy="keep the .prj file beside it, or name the CRS",
        )
    roles = layer.fields.get("role", np.full(len(layer.shapes), ""))
    features = _features(layer.shapes, roles, path.name)
    found = outlines_of(features, frame(home, path.name), path.name)
    others = left_alone([f"layer {name}" for name in layer.others], path.name)
    return replace(found, findings=(*found.findings, *others))


def read_layer(path: Path, kind: str, wrong: type[InputError]) -> Layer:
    """Read the only layer of a kind of shape.

    Parameters
    ----------
    path
        GeoPackage or shapefile.
    kind
        ``"Polygon"`` or ``"Point"``.
    wrong
        Kind of error to raise.

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
            name = _named(layers, kind, path.name, wrong)
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
    return Layer(meta["crs"] or "", shapes, fields, others)


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


def _features(shapes: NDArray[Any], roles: NDArray[Any], file: str) -> Iterator[Feature]:
    for k, (shape, role) in enumerate(zip(shapes, roles, strict=True), 1):
        where = f"{file}, feature {k}"
        try:
            geometry = shapely.from_wkb(shape) if shape else None
        except ShapelyError as error:
            raise BoundaryError("its geometry cannot be read", where=where) from error
        kind = NOTHING if geometry is None else geometry.geom_type
        area = geometry if isinstance(geometry, Polygon | MultiPolygon) else kind
        yield Feature(where, area, str(role or ""))


def _named(layers: list[tuple[str, str]], kind: str, file: str, wrong: type[InputError]) -> str:
    names = [name for name, of in layers if kind in of or of == "Unknown"]
    if len(names) != 1:
        raise wrong(
            f"layers of {kind.lower()}s: {listed(names) or 'none'}",
            where=file,
            remedy="save a file with that layer alone",
        )
    return names[0]
