"""Files of strangers: nothing they name is opened, on this machine or on the network."""

from __future__ import annotations

import json
import os
import shutil
import sqlite3
import threading
from collections.abc import Iterator
from contextlib import closing, suppress
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path

import numpy as np
import pytest
import shapely
from shapely.geometry.base import BaseGeometry

from subsoil.errors import BoundaryError, InputError, MissingExtraError, ReadingsError
from subsoil.io.read.boundary import read_field
from subsoil.io.read.covariate import read_covariate
from subsoil.land.crs import WGS84
from subsoil.land.field import Field

pyogrio = pytest.importorskip("pyogrio")
rasterio = pytest.importorskip("rasterio")

UTM = "EPSG:32630"
HOME = Field.from_metres(
    np.add([(0, 0), (100, 0), (100, 80), (0, 80)], (681_000, 5_900_000)), crs=UTM, name="home"
)
SQUARE = [[-0.5, 53], [-0.498, 53], [-0.498, 53.002], [-0.5, 53]]
RING = " ".join(f"{x},{y}" for x, y in SQUARE)
SUFFIXES = (".kml", ".gpkg", ".shp", ".geojson", ".json", ".csv", ".txt", ".coords", ".tif")


class Listener(BaseHTTPRequestHandler):
    """Remembers what was asked for."""

    asked: list[str]

    def do_GET(self) -> None:
        self.asked.append(self.path)
        self.send_error(404)

    def do_HEAD(self) -> None:
        self.do_GET()

    def log_message(self, format: str, *args: object) -> None:
        """Say nothing."""


@pytest.fixture
def server() -> Iterator[tuple[str, list[str]]]:
    """Address of a server on this machine, and what it was asked for."""
    asked: list[str] = []
    handler = type("Handler", (Listener,), {"asked": asked})
    with HTTPServer(("127.0.0.1", 0), handler) as listening:
        thread = threading.Thread(target=listening.serve_forever, daemon=True)
        thread.start()
        yield f"http://127.0.0.1:{listening.server_port}", asked
        listening.shutdown()
        thread.join()


@pytest.fixture
def secret(tmp_path: Path) -> Path:
    """A file of this machine that no other file may open."""
    path = tmp_path / "secret.geojson"
    path.write_text(json.dumps({"type": "Polygon", "coordinates": [SQUARE]}))
    return path


def vector_vrt(source: str) -> str:
    return (
        f'<OGRVRTDataSource><OGRVRTLayer name="secret"><SrcDataSource>{source}</SrcDataSource>'
        "<SrcLayer>secret</SrcLayer><GeometryType>wkbPolygon</GeometryType>"
        "<LayerSRS>EPSG:4326</LayerSRS></OGRVRTLayer></OGRVRTDataSource>"
    )


def raster_vrt(source: str) -> str:
    return (
        f'<VRTDataset rasterXSize="20" rasterYSize="20"><SRS>{UTM}</SRS>'
        "<GeoTransform>680990,6,0,5900090,0,-6</GeoTransform>"
        f'<VRTRasterBand dataType="Float32" band="1"><SimpleSource><SourceFilename>{source}'
        "</SourceFilename></SimpleSource></VRTRasterBand></VRTDataset>"
    )


def kml(body: str, head: str = "") -> str:
    return f'<?xml version="1.0"?>{head}<kml xmlns="http://www.opengis.net/kml/2.2">{body}</kml>'


POLYGON = (
    "<Placemark><Polygon><outerBoundaryIs><LinearRing>"
    f"<coordinates>{RING}</coordinates></LinearRing></outerBoundaryIs></Polygon></Placemark>"
)
REMOTE = {
    "vector vrt": lambda url: vector_vrt(f"/vsicurl/{url}/x.json"),
    "raster vrt": lambda url: raster_vrt(f"/vsicurl/{url}/x.tif"),
    "wms": lambda url: (
        f'<GDAL_WMS><Service name="TMS"><ServerUrl>{url}/${{z}}/${{x}}/${{y}}.png</ServerUrl>'
        f"</Service><DataWindow><SizeX>20</SizeX><SizeY>20</SizeY></DataWindow><Projection>{UTM}"
        "</Projection><BandsCount>1</BandsCount></GDAL_WMS>"
    ),
    "wfs": lambda url: f"<OGRWFSDataSource><URL>{url}/wfs</URL></OGRWFSDataSource>",
    "address": lambda url: f'"{url}/f.json"',
    "prefix": lambda url: f"GeoJSON:{url}/f.json",
    "gml schema": lambda url: (
        '<ogr:FeatureCollection xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" '
        f'xsi:schemaLocation="http://ogr.maptools.org/ {url}/s.xsd" '
        'xmlns:ogr="http://ogr.maptools.org/"></ogr:FeatureCollection>'
    ),
    "vrt in the comment of a kml": lambda url: kml(
        f"<!-- {vector_vrt(f'/vsicurl/{url}/x.json')} -->"
    ),
    "vrt in a kml": lambda url: kml(vector_vrt(f"/vsicurl/{url}/x.json")),
    "entities": lambda url: kml(POLYGON, f'<!DOCTYPE kml [<!ENTITY x SYSTEM "{url}/ent">]>'),
    "vrt in json": lambda url: json.dumps({"type": vector_vrt(f"/vsicurl/{url}/x.json")}),
    "frame": lambda url: json.dumps(
        {
            "type": "Polygon",
            "crs": {"type": "name", "properties": {"name": f"{url}/4326"}},
            "coordinates": [SQUARE],
        }
    ),
}


@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.parametrize("case", REMOTE)
def test_a_file_that_names_an_address_is_refused_and_the_address_not_asked(
    tmp_path: Path, server: tuple[str, list[str]], case: str, suffix: str
) -> None:
    url, asked = server
    path = tmp_path / f"given{suffix}"
    path.write_text(REMOTE[case](url))
    with pytest.raises(InputError) as caught:
        read_field(path)
    assert "\n" not in str(caught.value)
    with pytest.raises(InputError):
        read_covariate(path, HOME)
    assert asked == []


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_file_that_names_another_file_does_not_open_it(
    tmp_path: Path, secret: Path, suffix: str
) -> None:
    for name in (secret.name, str(secret), f"/vsizip/{secret}", f"file://{secret}"):
        path = tmp_path / f"given{suffix}"
        path.write_text(vector_vrt(name))
        with pytest.raises(InputError):
            read_field(path)


def test_links_in_a_kml_are_not_followed(tmp_path: Path, server: tuple[str, list[str]]) -> None:
    url, asked = server
    link = f"<NetworkLink><Link><href>{url}/net.kml</href></Link></NetworkLink>"
    path = tmp_path / "home.kml"
    path.write_text(kml(f"<Document>{link}{POLYGON}</Document>"))
    assert read_field(path).area_ha == pytest.approx(1.49, abs=0.01)
    assert asked == []


def geopackage(path: Path, geometry: BaseGeometry, kind: str) -> None:
    pyogrio.raw.write(
        path, np.array([shapely.to_wkb(geometry)], dtype=object), [np.array([1.0])], ["ec"],
        geometry_type=kind, crs=WGS84, driver="GPKG" if path.suffix == ".gpkg" else None,
    )  # fmt: skip


@pytest.mark.parametrize(
    "statement",
    [
        "create view v as select ogr_geocode('x') as a",
        "create trigger t after insert on home begin select load_extension('x'); end",
    ],
)
def test_a_geopackage_that_would_run_something_is_refused(tmp_path: Path, statement: str) -> None:
    path = tmp_path / "home.gpkg"
    geopackage(path, shapely.Polygon(SQUARE), "Polygon")
    assert read_field(path).area_ha > 1
    with closing(sqlite3.connect(path)) as database, database:
        for (name,) in database.execute(
            "select name from sqlite_master where type='trigger'"
        ).fetchall():
            database.execute(f'drop trigger "{name}"')
        database.execute(statement)
    with pytest.raises(BoundaryError, match=r"home\.gpkg: reading its table or view .* would run"):
        read_field(path)


def test_a_geopackage_with_a_virtual_table_is_refused(
    tmp_path: Path, server: tuple[str, list[str]]
) -> None:
    url, asked = server
    path = tmp_path / "home.gpkg"
    geopackage(path, shapely.Polygon(SQUARE), "Polygon")
    with closing(sqlite3.connect(path)) as database, database:
        database.execute("pragma writable_schema=on")
        sql = f"CREATE VIRTUAL TABLE z USING VirtualOGR('/vsicurl/{url}/x.json')"
        database.execute("insert into sqlite_master values ('table', 'z', 'z', 0, ?)", (sql,))
    with pytest.raises(BoundaryError, match="would run something"):
        read_field(path)
    assert asked == []


def test_a_geopackage_that_is_being_written_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "home.gpkg"
    geopackage(path, shapely.Polygon(SQUARE), "Polygon")
    (tmp_path / "home.gpkg-wal").write_bytes(b"x" * 40)
    with pytest.raises(BoundaryError, match=r"home\.gpkg: another program has it open.*-wal"):
        read_field(path)


def test_files_beside_an_outline_are_not_read(
    tmp_path: Path, server: tuple[str, list[str]]
) -> None:
    url, asked = server
    path = tmp_path / "home.shp"
    geopackage(path, shapely.Polygon(SQUARE), "Polygon")
    for beside in ("home.gfs", "home.shp.aux.xml", "home.qix", "home.sbn", "home.vrt"):
        (tmp_path / beside).write_text(vector_vrt(f"/vsicurl/{url}/x.json"))
    assert read_field(path).area_ha == pytest.approx(1.49, abs=0.01)
    assert asked == []


@pytest.mark.parametrize("content", [b"\xff\xfe\x00garbage", b"PROJCS[", b"", b"\x80" * 300])
def test_a_damaged_prj_is_one_line(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "home.shp"
    geopackage(path, shapely.Polygon(SQUARE), "Polygon")
    (tmp_path / "home.prj").write_bytes(content)
    with pytest.raises(BoundaryError, match=r"home\.shp: the \.prj file beside it is damaged"):
        read_field(path)


def raster(path: Path) -> Path:
    grid, size = HOME.grid, HOME.cell_size
    with rasterio.open(
        path, "w", driver="GTiff", width=len(grid.easting), height=len(grid.northing), count=1,
        dtype="float32", crs=UTM,
        transform=rasterio.Affine(
            size, 0, grid.easting[0] - size / 2, 0, -size, grid.northing[-1] + size / 2
        ),
    ) as written:  # fmt: skip
        written.write(np.arange(grid.inside.size, dtype="float32").reshape(1, *grid.inside.shape))
    return path


def test_files_beside_a_raster_are_not_read(tmp_path: Path, server: tuple[str, list[str]]) -> None:
    url, asked = server
    path = raster(tmp_path / "ec.tif")
    plain = read_covariate(path, HOME).values
    overview = (
        f'<PAMDataset><Metadata domain="OVERVIEWS"><MDI key="OVERVIEW_FILE">/vsicurl/{url}/o.tif'
        '</MDI></Metadata><PAMRasterBand band="1"><NoDataValue>3</NoDataValue></PAMRasterBand>'
        "</PAMDataset>"
    )
    (tmp_path / "ec.tif.aux.xml").write_text(overview)
    for beside in ("ec.tif.ovr", "ec.tif.msk", "ec.ovr", "ec.tfw", "ec.rrd"):
        (tmp_path / beside).write_text(raster_vrt(f"/vsicurl/{url}/x.tif"))
    np.testing.assert_array_equal(read_covariate(path, HOME).values, plain)
    assert asked == []


def test_overviews_that_a_raster_names_elsewhere_are_not_opened(
    tmp_path: Path, server: tuple[str, list[str]]
) -> None:
    url, asked = server
    path = raster(tmp_path / "ec.tif")
    with rasterio.open(path, "r+") as written:
        written.update_tags(ns="OVERVIEWS", OVERVIEW_FILE=f"/vsicurl/{url}/o.tif")
    (tmp_path / "ec.tif.aux.xml").unlink(missing_ok=True)
    with pytest.raises(ReadingsError, match=r"ec\.tif: it keeps overviews in another file"):
        read_covariate(path, HOME)
    assert asked == []


def test_a_raster_too_large_to_hold_is_said_before_it_is_read(tmp_path: Path) -> None:
    path = tmp_path / "ec.tif"
    with rasterio.open(
        path, "w", driver="GTiff", width=60_000, height=60_000, count=1, dtype="uint8",
        crs=UTM, transform=rasterio.Affine(1, 0, 681_000, 0, -1, 5_900_000), SPARSE_OK="TRUE",
        tiled=True,
    ):  # fmt: skip
        pass
    with pytest.raises(ReadingsError, match=r"ec\.tif: it has 60000 x 60000 pixels"):
        read_covariate(path, HOME)


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ("<Document/>", "a file without a polygon is not an outline"),
        ("<Placemark><LinearRing><coordinates>0,52 0.001,52 0.001,52.001</coordinates></LinearRing>"
         "</Placemark>", "a LinearRing is not an outline: it is open, its ends are 130.7 m apart"),
        ("<Placemark><Point><coordinates>1,2</coordinates></Point></Placemark>", "a Point is not"),
        ("<Placemark><name>x</name><Polygon/></Placemark>", "feature 1 (x): a polygon has 0 outer"),
        (POLYGON.replace("-0.5,53 ", "-0.5;53 "), "not longitude,latitude pairs"),
        ("<Placemark>", "this is not XML"),
    ],
)  # fmt: skip
def test_a_kml_without_a_usable_polygon_says_what_is_there(
    tmp_path: Path, body: str, words: str
) -> None:
    path = tmp_path / "home.kml"
    path.write_text(kml(body))
    with pytest.raises(BoundaryError) as caught:
        read_field(path)
    assert words in str(caught.value)
    assert str(caught.value).startswith("home.kml")


def test_every_file_kept_from_an_earlier_trial_is_refused_or_harmless(
    tmp_path: Path, server: tuple[str, list[str]]
) -> None:
    folder = os.environ.get("SUBSOIL_BREAKAGE")
    if not folder:
        pytest.skip("SUBSOIL_BREAKAGE names no folder of broken files")
    url, asked = server
    kept = tmp_path / "kept"
    shutil.copytree(Path(folder) / "gdal", kept)
    for path in sorted(kept.iterdir()):
        if path.suffix != ".gpkg" or not path.read_bytes().startswith(b"SQLite"):
            path.write_bytes(path.read_bytes().replace(b"http://127.0.0.1:35171", url.encode()))
    for path in sorted(kept.iterdir()):
        for read in (read_field, lambda p: read_covariate(p, HOME)):
            with suppress(InputError, MissingExtraError):
                read(path)
    assert asked == []
