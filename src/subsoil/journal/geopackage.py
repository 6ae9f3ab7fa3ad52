"""The part of OGC GeoPackage 1.3 that a survey file needs, on plain sqlite3.

Live tables carry no spatial index: its triggers need functions that only GDAL brings along.
"""

from __future__ import annotations

import sqlite3
import struct
from collections.abc import Mapping

import shapely
from shapely.geometry.base import BaseGeometry

APPLICATION_ID = 0x47504B47
"""``GPKG`` as a number, in the header of every GeoPackage."""
_USER_VERSION = 10300
_LOCAL_SRS = -1
_FIRST_OWN_SRS = 100_000
_HEADER = 8
_ENVELOPES = {0: 0, 1: 32, 2: 48, 3: 48, 4: 64}
"""Bytes of each kind of envelope between header and geometry."""

_TABLES = """
CREATE TABLE gpkg_spatial_ref_sys (
    srs_name TEXT NOT NULL, srs_id INTEGER PRIMARY KEY, organization TEXT NOT NULL,
    organization_coordsys_id INTEGER NOT NULL, definition TEXT NOT NULL, description TEXT);
CREATE TABLE gpkg_contents (
    table_name TEXT NOT NULL PRIMARY KEY, data_type TEXT NOT NULL, identifier TEXT UNIQUE,
    description TEXT DEFAULT '',
    last_change DATETIME NOT NULL DEFAULT (strftime('%Y-%m-%dT%H:%M:%fZ','now')),
    min_x DOUBLE, min_y DOUBLE, max_x DOUBLE, max_y DOUBLE, srs_id INTEGER,
    FOREIGN KEY (srs_id) REFERENCES gpkg_spatial_ref_sys(srs_id));
CREATE TABLE gpkg_geometry_columns (
    table_name TEXT NOT NULL UNIQUE, column_name TEXT NOT NULL, geometry_type_name TEXT NOT NULL,
    srs_id INTEGER NOT NULL, z TINYINT NOT NULL, m TINYINT NOT NULL,
    PRIMARY KEY (table_name, column_name),
    FOREIGN KEY (table_name) REFERENCES gpkg_contents(table_name),
    FOREIGN KEY (srs_id) REFERENCES gpkg_spatial_ref_sys(srs_id));
"""


def initialise(database: sqlite3.Connection, crs: str) -> int:
    """Make an empty database a GeoPackage; returns the id of its reference system.

    Parameters
    ----------
    database
        An open, empty database.
    crs
        Metric frame such as ``"EPSG:32630"``; empty for a local one.
    """
    database.execute(f"PRAGMA application_id = {APPLICATION_ID}")
    database.execute(f"PRAGMA user_version = {_USER_VERSION}")
    for statement in _TABLES.split(";"):
        database.execute(statement)
    systems = [
        ("Undefined Cartesian", _LOCAL_SRS, "NONE", _LOCAL_SRS, "undefined"),
        ("Undefined geographic", 0, "NONE", 0, "undefined"),
        _system("EPSG:4326"),
    ]
    if crs:
        systems.append(_system(crs))
    database.executemany(
        "INSERT INTO gpkg_spatial_ref_sys"
        "(srs_name, srs_id, organization, organization_coordsys_id, definition)"
        " VALUES (?, ?, ?, ?, ?)",
        systems,
    )
    return systems[-1][1] if crs else _LOCAL_SRS


def srs_of_frame(crs: str) -> int:
    """Id that layers in a frame refer to; that of the local frame for an empty name."""
    return _system(crs)[1] if crs else _LOCAL_SRS


def _system(name: str) -> tuple[str, int, str, int, str]:
    from pyproj import CRS

    crs = CRS.from_user_input(name)
    authority, code = crs.to_authority() or ("NONE", str(_FIRST_OWN_SRS))
    return crs.name, int(code), authority, int(code), crs.to_wkt("WKT1_GDAL")


def add_layer(
    database: sqlite3.Connection,
    table: str,
    geometry: str,
    columns: Mapping[str, str],
    *,
    srs: int,
    bounds: tuple[float, float, float, float],
    description: str,
) -> None:
    """Add a feature layer.

    Parameters
    ----------
    database
        The GeoPackage.
    table
        Name of the layer.
    geometry
        ``"POINT"``, ``"LINESTRING"``, ``"POLYGON"`` or ``"GEOMETRY"``.
    columns
        SQL type of each attribute by name.
    srs
        Id of the reference system.
    bounds
        West, south, east and north in m.
    description
        What the layer is.
    """
    _check(table, *columns)
    attributes = "".join(f", {name} {kind}" for name, kind in columns.items())
    database.execute(
        f"CREATE TABLE {table} (fid INTEGER PRIMARY KEY AUTOINCREMENT, geom {geometry}{attributes})"
    )
    database.execute(
        "INSERT INTO gpkg_contents(table_name, data_type, identifier, description,"
        " min_x, min_y, max_x, max_y, srs_id) VALUES (?, 'features', ?, ?, ?, ?, ?, ?, ?)",
        (table, table, description, *bounds, srs),
    )
    database.execute(
        "INSERT INTO gpkg_geometry_columns VALUES (?, 'geom', ?, ?, 0, 0)", (table, geometry, srs)
    )


def add_table(
    database: sqlite3.Connection, table: str, columns: Mapping[str, str], description: str
) -> None:
    """Add a table without geometry."""
    _check(table, *columns)
    body = ", ".join(f"{name} {kind}" for name, kind in columns.items())
    database.execute(f"CREATE TABLE {table} ({body})")
    database.execute(
        "INSERT INTO gpkg_contents(table_name, data_type, identifier, description)"
        " VALUES (?, 'attributes', ?, ?)",
        (table, table, description),
    )


def add_columns(database: sqlite3.Connection, table: str, columns: Mapping[str, str]) -> None:
    """Add the columns of a table that it does not have yet; unique ones only without that."""
    known = {row[1] for row in database.execute(f"PRAGMA table_info({table})")}
    _check(table, *columns)
    for name, kind in columns.items():
        if name not in known:
            database.execute(f"ALTER TABLE {table} ADD COLUMN {name} {kind.split()[0]}")


def geometry_of(blob: bytes) -> BaseGeometry:
    """Geometry of a GeoPackage binary.

    Raises
    ------
    ValueError
        If it is none.
    """
    if blob[:2] != b"GP" or len(blob) < _HEADER:
        raise ValueError("not a geometry of a GeoPackage")
    envelope = _ENVELOPES.get(blob[3] >> 1 & 0b111)
    if envelope is None:
        raise ValueError("a geometry with an unknown envelope")
    return shapely.from_wkb(blob[_HEADER + envelope :])


def insert(
    database: sqlite3.Connection,
    table: str,
    geometry: BaseGeometry,
    srs: int,
    values: Mapping[str, object],
) -> None:
    """Add a feature to a layer."""
    _check(table, *values)
    names = "".join(f", {name}" for name in values)
    marks = ", ?" * len(values)
    database.execute(
        f"INSERT INTO {table}(geom{names}) VALUES (?{marks})",
        (_blob(geometry, srs), *values.values()),
    )


def _blob(geometry: BaseGeometry, srs: int) -> bytes:
    """GeoPackage binary: magic, version 0, little-endian without envelope, then WKB."""
    flags = 0b0001_0001 if geometry.is_empty else 0b0000_0001
    return b"GP" + struct.pack("<BBi", 0, flags, srs) + shapely.to_wkb(geometry)


def _check(*names: str) -> None:
    for name in names:
        assert name.isidentifier(), f"not a column name: {name}"
