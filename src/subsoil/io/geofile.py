"""Outlines as GeoPackage, shapefile or KML, through pyogrio where it is installed."""

from __future__ import annotations

from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from types import ModuleType

import shapely
from shapely.errors import ShapelyError

from subsoil.errors import BoundaryError, MissingExtraError
from subsoil.io.drawing import Drawing, Feature, draw, frame
from subsoil.io.text import check_file


def read_geofile(path: Path, crs: str | None) -> Drawing:
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
    check_file(path, BoundaryError)
    pyogrio = _pyogrio(path)
    try:
        layer = _layer(pyogrio.list_layers(path), path.name)
        meta, _, shapes, columns = pyogrio.raw.read(path, layer=layer, force_2d=True)
    except (pyogrio.errors.DataSourceError, pyogrio.errors.DataLayerError) as error:
        raise BoundaryError(
            f"GDAL cannot read it: {' '.join(str(error).split())}",
            where=path.name,
            remedy="export it again",
        ) from error
    home = meta["crs"] or crs
    if not home:
        raise BoundaryError(
            "it does not name its CRS",
            where=path.name,
            remedy="keep the .prj file beside it, or name the CRS",
        )
    roles = dict(zip(meta["fields"], columns, strict=True)).get("role", [""] * len(shapes))
    return draw(_features(shapes, roles, path.name), frame(home, path.name))


def _features(shapes: list[bytes | None], roles: list[str | None], file: str) -> Iterator[Feature]:
    for k, (shape, role) in enumerate(zip(shapes, roles, strict=True), 1):
        where = f"{file}, feature {k}"
        try:
            geometry = shapely.from_wkb(shape) if shape else shapely.Polygon()
        except ShapelyError as error:
            raise BoundaryError("its geometry cannot be read", where=where) from error
        yield Feature(where, geometry, str(role or ""))


def _layer(layers: list[tuple[str, str | None]], file: str) -> str:
    names = [name for name, kind in layers if kind and ("Polygon" in kind or kind == "Unknown")]
    if len(names) != 1:
        raise BoundaryError(
            f"layers of polygons: {', '.join(names) or 'none'}",
            where=file,
            remedy="save a file with the outline alone",
        )
    return names[0]


def _pyogrio(path: Path) -> ModuleType:
    try:
        return import_module("pyogrio")
    except ImportError as error:
        raise MissingExtraError(
            f"reading {path.suffix} files needs pyogrio, which is not installed",
            where=path.name,
            remedy="pip install 'subsoil[geo]', or save the outline as GeoJSON",
        ) from error
