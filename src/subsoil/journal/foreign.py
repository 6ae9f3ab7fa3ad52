"""What other programs put into a survey file: harmless, or able to change what it says."""

from __future__ import annotations

import re
import sqlite3
from dataclasses import dataclass

from subsoil.errors import brief
from subsoil.journal.content import ANCHOR_TABLE
from subsoil.journal.gis import LAYERS
from subsoil.journal.owner import OWNER

OWN_TABLES = {
    "events", OWNER, ANCHOR_TABLE, *LAYERS, "gpkg_spatial_ref_sys", "gpkg_contents",
    "gpkg_geometry_columns",
}  # fmt: skip
"""Every table that subsoil makes."""

_INDEX = re.compile(r"rtree_(\w+?)_geom(_node|_rowid|_parent)?")
_GIS_TABLES = {
    "gpkg_extensions", "gpkg_ogr_contents", "layer_styles", "qgis_projects", "gpkg_metadata",
    "gpkg_metadata_reference", "gpkg_data_columns", "gpkg_data_column_constraints",
    "gpkg_tile_matrix", "gpkg_tile_matrix_set", "gpkgext_relations", "qgis_layer_metadata",
}  # fmt: skip
_GIS_TRIGGER = re.compile(
    r"(rtree_\w+_(insert|update\d?|delete)|trigger_(insert|delete)_feature_count_\w+)"
)
_BODY = re.compile(r"\bBEGIN\b(.*)\bEND\s*;?\s*$", re.IGNORECASE | re.DOTALL)
_GIS_STATEMENT = re.compile(
    r"\s*(INSERT\s+(OR\s+REPLACE\s+)?INTO|UPDATE(\s+OR\s+REPLACE)?|DELETE\s+FROM)\s+"
    r"[\"'`]?(rtree_\w+_geom|gpkg_ogr_contents)[\"'`]?\s.*",
    re.IGNORECASE | re.DOTALL,
)
_OWN_OF_SQLITE = "sqlite_"


@dataclass(frozen=True)
class Foreign:
    """What a survey file holds that subsoil did not make.

    Attributes
    ----------
    strange
        What could change what the file says, one by one, in words.
    known
        What is known of GDAL and QGIS and changes nothing that subsoil wrote, in words.
    """

    strange: tuple[str, ...]
    known: str


def foreign(database: sqlite3.Connection) -> Foreign:
    """Tables, views, triggers and indexes beside those that subsoil made."""
    strange: list[str] = []
    known: set[str] = set()
    query = "SELECT type, name, tbl_name, coalesce(sql, '') FROM sqlite_master ORDER BY name"
    for kind, name, table, sql in database.execute(query):
        if name.startswith(_OWN_OF_SQLITE) or (kind == "table" and name in OWN_TABLES):
            continue
        if _harmless(kind, name, sql):
            index = _INDEX.match(name)
            known.add(f"spatial index of {index[1]}" if index else name)
        else:
            place = f" on {brief(table)}" if kind in {"trigger", "index"} else ""
            strange.append(f"{kind} {brief(name)!r}{place} of another program is in the file")
    return Foreign(tuple(strange), ", ".join(sorted(known)))


def _harmless(kind: str, name: str, sql: str) -> bool:
    match kind:
        case "table":
            return name in _GIS_TABLES or _INDEX.fullmatch(name) is not None
        case "trigger":
            return _GIS_TRIGGER.fullmatch(name) is not None and _keeps_count_only(sql)
        case "index":
            return "unique" not in sql.lower()
    return False


def _keeps_count_only(sql: str) -> bool:
    """Whether a trigger writes to spatial indexes and counts of features only."""
    body = _BODY.search(sql)
    if not body:
        return False
    statements = [part for part in body[1].split(";") if part.strip()]
    return all(_GIS_STATEMENT.fullmatch(part) for part in statements)
