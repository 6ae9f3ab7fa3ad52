"""QGIS and GDAL look at a survey and build their indexes in it; the survey goes on."""

from __future__ import annotations

import os
import shutil
import sqlite3
import subprocess
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from subsoil.journal import open_journal, read_events, read_survey, verify
from subsoil.journal.spatial_index import know_functions
from subsoil.simulation import Truth
from subsoil.survey import LocalDispatch, fold

Start = Callable[[Path], Any]
Index = Callable[[Path], None]

LAYERS = ("boundary", "samples", "refusals", "targets", "route")
PYTHON_OF_QGIS = "/usr/bin/python3"

LOOK_IN_QGIS = """
import sys
from qgis.core import QgsApplication, QgsProject, QgsVectorLayer

QgsApplication.setPrefixPath("/usr", True)
application = QgsApplication([], False)
application.initQgis()
layers = {
    name: QgsVectorLayer(f"{sys.argv[1]}|layername={name}", name, "ogr")
    for name in ("boundary", "samples", "refusals", "targets", "route")
}
assert all(layer.isValid() for layer in layers.values())
print("looking", len(list(layers["samples"].getFeatures())), flush=True)
if sys.argv[2] == "index":
    assert all(layer.dataProvider().createSpatialIndex() for layer in layers.values())
    assert layers["samples"].saveStyleToDatabase("plain", "", True, "") == ""
    QgsProject.instance().addMapLayer(layers.pop("samples"))
    assert QgsProject.instance().write(f"geopackage:{sys.argv[1]}?projectName=p")
if sys.argv[2] == "wait":
    sys.stdin.readline()
    print("still", len(list(layers["samples"].getFeatures())), flush=True)
QgsProject.instance().clear()
layers.clear()
application.exitQgis()
print("done", flush=True)
"""


def has_qgis() -> bool:
    found = [PYTHON_OF_QGIS, "-c", "import qgis.core"]
    try:
        return subprocess.run(found, capture_output=True, check=False, env=plain()).returncode == 0
    except OSError:
        return False


def plain() -> dict[str, str]:
    """Environment of a program of the system."""
    kept = {name: os.environ[name] for name in ("PATH", "HOME") if name in os.environ}
    return {**kept, "QT_QPA_PLATFORM": "offscreen", "XDG_RUNTIME_DIR": "/tmp"}


needs_qgis = pytest.mark.skipif(not has_qgis(), reason="QGIS is not installed")
needs_gdal = pytest.mark.skipif(not shutil.which("ogrinfo"), reason="gdal-bin is not installed")


def in_qgis(path: Path, how: str) -> subprocess.Popen[str]:
    """QGIS, once it has read every layer."""
    looking = subprocess.Popen(
        [PYTHON_OF_QGIS, "-c", LOOK_IN_QGIS, str(path), how], env=plain(), text=True,
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    assert looking.stdout is not None
    assert looking.stdout.readline().startswith("looking")
    return looking


def indexed_by_qgis(path: Path) -> None:
    said, _ = in_qgis(path, "index").communicate()
    assert "done" in said


def indexed_by_ogrinfo(path: Path) -> None:
    for layer in LAYERS:
        query = f"SELECT CreateSpatialIndex('{layer}', 'geom')"
        subprocess.run(["ogrinfo", "-q", path, "-sql", query], check=True, capture_output=True)


BUILDERS = [
    pytest.param(indexed_by_qgis, marks=[pytest.mark.gis, needs_qgis]),
    pytest.param(indexed_by_ogrinfo, marks=[pytest.mark.gis, needs_gdal]),
]


@pytest.fixture
def went_on(
    plot_truth: Truth, work: Callable[[LocalDispatch, Truth], str]
) -> Callable[[Path], None]:
    def go_on(path: Path) -> None:
        with open_journal(path) as journal:
            dispatch = LocalDispatch(fold(journal.events()), journal)
            work(dispatch, plot_truth)

    return go_on


def indexed_boxes(path: Path, layer: str) -> list[int]:
    with closing(sqlite3.connect(path)) as database:
        found = database.execute(f"SELECT id FROM rtree_{layer}_geom ORDER BY id").fetchall()
        return [row[0] for row in found]


def fids(path: Path, layer: str) -> list[int]:
    with closing(sqlite3.connect(path)) as database:
        found = database.execute(f"SELECT fid FROM {layer} ORDER BY fid").fetchall()
        return [row[0] for row in found]


@pytest.mark.parametrize("build", BUILDERS)
def test_a_survey_in_which_a_gis_built_an_index_goes_on_and_the_index_with_it(
    half_done: Path, build: Index, went_on: Callable[[Path], None]
) -> None:
    build(half_done)
    verdict = verify(half_done)
    assert verdict.findings == ()
    assert "spatial index of samples" in verdict.notes[0]
    assert indexed_boxes(half_done, "targets") == fids(half_done, "targets") != []
    went_on(half_done)
    assert [event.kind for event in read_events(half_done)][-1] == "finished"
    verdict = verify(half_done)
    assert verdict.findings == ()
    assert len(verdict.notes) == 1
    for layer in LAYERS:
        assert indexed_boxes(half_done, layer) == fids(half_done, layer)


@pytest.mark.gis
@needs_qgis
def test_what_is_written_while_qgis_looks_outlives_the_writer(
    half_done: Path, writer: Start
) -> None:
    open_ = writer(half_done)
    open_.told("a", "read")
    looking = in_qgis(half_done, "wait")
    open_.told("b", "c")
    looking.communicate("\n")
    in_qgis(half_done, "glance").communicate()
    open_.told("d", "e")
    open_.killed()
    assert [event.id for event in read_events(half_done)][-5:] == ["a", "b", "c", "d", "e"]
    assert read_survey(half_done).notes == ()
    assert verify(half_done).findings == ()


@pytest.mark.gis
@needs_qgis
def test_a_survey_is_closed_while_qgis_looks(half_done: Path, writer: Start) -> None:
    open_ = writer(half_done)
    looking = in_qgis(half_done, "wait")
    open_.told("a", "close")
    assert [event.id for event in read_events(half_done)][-1] == "a"
    looking.communicate("\n")
    assert [event.id for event in read_events(half_done)][-1] == "a"
    assert read_survey(half_done).notes == ()


@pytest.mark.gis
@needs_qgis
def test_a_survey_whose_writer_was_killed_is_no_copy_after_qgis_looked(
    half_done: Path, writer: Start
) -> None:
    open_ = writer(half_done)
    open_.told("a", "b")
    open_.killed()
    in_qgis(half_done, "glance").communicate()
    record = read_survey(half_done)
    assert record.notes == ()
    assert [event.id for event in record.events][-2:] == ["a", "b"]


# As GDAL from 3.7 on writes them (OGC 12-128r19): two updates more, and counts of features.
TRIGGERS_OF_NEWER_GDAL = """
CREATE VIRTUAL TABLE "rtree_targets_geom" USING rtree(id, minx, maxx, miny, maxy);
INSERT INTO rtree_targets_geom SELECT fid, ST_MinX(geom), ST_MaxX(geom), ST_MinY(geom),
 ST_MaxY(geom) FROM targets;
CREATE TABLE gpkg_extensions (table_name TEXT, column_name TEXT, extension_name TEXT NOT NULL,
 definition TEXT NOT NULL, scope TEXT NOT NULL);
CREATE TABLE gpkg_ogr_contents (table_name TEXT NOT NULL PRIMARY KEY, feature_count INTEGER);
INSERT INTO gpkg_ogr_contents SELECT 'targets', count(*) FROM targets;
CREATE TRIGGER "rtree_targets_geom_insert" AFTER INSERT ON "targets"
 WHEN (new."geom" NOT NULL AND NOT ST_IsEmpty(NEW."geom"))
 BEGIN INSERT OR REPLACE INTO "rtree_targets_geom" VALUES (NEW."fid", ST_MinX(NEW."geom"),
 ST_MaxX(NEW."geom"), ST_MinY(NEW."geom"), ST_MaxY(NEW."geom")); END;
CREATE TRIGGER "rtree_targets_geom_update6" AFTER UPDATE OF "geom" ON "targets"
 WHEN OLD."fid" = NEW."fid" AND (NEW."geom" NOTNULL AND NOT ST_IsEmpty(NEW."geom"))
 AND (OLD."geom" NOTNULL AND NOT ST_IsEmpty(OLD."geom"))
 BEGIN UPDATE "rtree_targets_geom" SET minx = ST_MinX(NEW."geom"), maxx = ST_MaxX(NEW."geom"),
 miny = ST_MinY(NEW."geom"), maxy = ST_MaxY(NEW."geom") WHERE id = NEW."fid"; END;
CREATE TRIGGER "rtree_targets_geom_delete" AFTER DELETE ON "targets" WHEN old."geom" NOT NULL
 BEGIN DELETE FROM "rtree_targets_geom" WHERE id = OLD."fid"; END;
CREATE TRIGGER "trigger_insert_feature_count_targets" AFTER INSERT ON "targets"
 BEGIN UPDATE gpkg_ogr_contents SET feature_count = feature_count + 1
 WHERE lower(table_name) = lower('targets'); END;
CREATE TRIGGER "trigger_delete_feature_count_targets" AFTER DELETE ON "targets"
 BEGIN UPDATE gpkg_ogr_contents SET feature_count = feature_count - 1
 WHERE lower(table_name) = lower('targets'); END;
"""


def test_indexes_and_counts_of_a_newer_gdal_are_kept_right(
    half_done: Path, went_on: Callable[[Path], None]
) -> None:
    with closing(sqlite3.connect(half_done)) as database:
        know_functions(database)
        database.executescript(TRIGGERS_OF_NEWER_GDAL)
        database.execute("UPDATE targets SET geom = geom")
        database.commit()
    verdict = verify(half_done)
    assert verdict.findings == ()
    assert "spatial index of targets" in verdict.notes[0]
    went_on(half_done)
    assert verify(half_done).findings == ()
    left = fids(half_done, "targets")
    assert left
    assert indexed_boxes(half_done, "targets") == left
    with closing(sqlite3.connect(half_done)) as database:
        counted = database.execute("SELECT feature_count FROM gpkg_ogr_contents").fetchone()
    assert counted == (len(left),)
    changed = "INSERT INTO rtree_targets_geom VALUES (99, 0, 1, 0, 1)"
    with closing(sqlite3.connect(half_done, isolation_level=None)) as database:
        database.execute(changed)
    (finding,) = verify(half_done).findings
    assert "spatial index does not name" in finding
