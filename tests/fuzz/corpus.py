"""Small sound files of every kind that is read, to be broken."""

from __future__ import annotations

import io
import json
import zipfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyogrio
import rasterio
import shapely
from rasterio.transform import from_origin

WEST, SOUTH, STEP = -0.5270, 53.2610, 0.0002
DEPTHS_CM = (5, 10, 15, 20, 25, 30)
RING = [(WEST, SOUTH), (WEST + 0.004, SOUTH), (WEST + 0.004, SOUTH + 0.003), (WEST, SOUTH + 0.003)]


@dataclass(frozen=True)
class Sound:
    """A file that can be read: its name, its bytes, and what reads it."""

    name: str
    data: bytes
    kind: str


def pushes(count: int = 9) -> Iterator[tuple[float, float, list[int]]]:
    """Longitude, latitude and kPa by depth."""
    random = np.random.default_rng(5)
    for k in range(count):
        kpa = (400 + 60 * np.arange(len(DEPTHS_CM)) + random.normal(0, 30, len(DEPTHS_CM))).round()
        yield WEST + STEP * (k % 3 + 1), SOUTH + STEP * (k // 3 + 1), kpa.astype(int).tolist()


def wide(delimiter: str = ",", decimal: str = ".") -> str:
    head = delimiter.join(["lat", "lon", *(f"kpa_{d}cm" for d in DEPTHS_CM)])
    rows = [
        delimiter.join([f"{lat:.6f}", f"{lon:.6f}", *map(str, kpa)]) for lon, lat, kpa in pushes()
    ]
    return "\n".join([head, *(row.replace(".", decimal) for row in rows)]) + "\n"


def tidy() -> str:
    rows = [
        f"{k},{lat:.6f},{lon:.6f},{depth},{value}"
        for k, (lon, lat, kpa) in enumerate(pushes(), 1)
        for depth, value in zip(DEPTHS_CM, kpa, strict=True)
    ]
    return "\n".join(["id,lat,lon,depth_cm,kpa", *rows]) + "\n"


def robot() -> str:
    names = ", ".join(f"{depth}.0 cm" for depth in DEPTHS_CM)
    entries = [
        f"- position: {{lat: {lat:.6f}, lon: {lon:.6f}}}\n  data: {kpa}\n"
        for lon, lat, kpa in pushes()
    ]
    return f"names: [{names}]\ndata:\n{''.join(entries)}"


def sc900() -> str:
    head = ["Name:", "Serial #:", "Datum:WGS84", "Soil Compation In KPa"]
    columns = ",".join(f"{2.5 * k} cm" for k in range(7))
    rows = [
        f"{lon:.6f},{lat:.6f},N= {k} , {' , '.join(map(str, [0, *kpa]))} ,1/2 Inch"
        for k, (lon, lat, kpa) in enumerate(pushes(), 1)
    ]
    header = f"Longitude,Latitude,Number,{columns},Cone Size"
    return "\r\n".join([*head, header, ",,Logger Started", *rows]) + "\r\n"


def penetrologger() -> str:
    head = [
        "Eijkelkamp Penetro Viewer Vs. 6.08", "", "Project :\ttest", "Cone type :\t2.0cm2\t60deg",
        "Penetration speed :\t2\tcm/s", "Depth unit :\tcm", "Pressure unit :\tMPa", "",
        "PENETRATION DATA",
    ]  # fmt: skip
    rows = [
        f"PLOT-001.{k}\tN53 15.{600 + 12 * k} W000 31.{500 + 7 * k}\t"
        + "\t".join(f"{0.1 * (k + j):.2f}" for j in range(30))
        for k in range(1, 9)
    ]
    return "\r\n".join([*head, *rows]) + "\r\n"


def gef() -> str:
    head = [
        "#GEFID= 1, 1, 0", "#FILEOWNER= test", "#COLUMN= 2",
        "#COLUMNINFO= 1, m, penetration length, 1", "#COLUMNINFO= 2, MPa, cone resistance, 2",
        "#COLUMNVOID= 2, -99", "#LASTSCAN= 30", "#XYID= 31000, 120500.0, 480700.0",
        "#ZID= 31000, 0.5", "#MEASUREMENTVAR= 1, 1000, mm2, cone area", "#EOH=",
    ]  # fmt: skip
    rows = [f"{0.02 * k:.2f} {0.3 + 0.05 * k:.3f}" for k in range(1, 31)]
    return "\r\n".join([*head, *rows]) + "\r\n"


def geojson(geometry: object, **properties: object) -> str:
    feature = {"type": "Feature", "properties": properties, "geometry": geometry}
    return json.dumps({"type": "FeatureCollection", "features": [feature]})


def outline() -> str:
    return geojson({"type": "Polygon", "coordinates": [[*RING, RING[0]]]}, name="Long Acre")


def points() -> str:
    features = [
        {
            "type": "Feature",
            "properties": {f"kpa_{d}cm": value for d, value in zip(DEPTHS_CM, kpa, strict=True)},
            "geometry": {"type": "Point", "coordinates": [lon, lat]},
        }
        for lon, lat, kpa in pushes()
    ]
    return json.dumps({"type": "FeatureCollection", "features": features})


def kml() -> str:
    ring = " ".join(f"{x},{y},0" for x, y in [*RING, RING[0]])
    return (
        '<?xml version="1.0" encoding="UTF-8"?><kml xmlns="http://www.opengis.net/kml/2.2">'
        "<Document><Folder><name>Farm</name><Placemark><name>gate</name><Point><coordinates>"
        f"{WEST},{SOUTH},0</coordinates></Point></Placemark><Placemark><name>Long Acre</name>"
        f"<Polygon><outerBoundaryIs><LinearRing><coordinates>{ring}</coordinates></LinearRing>"
        "</outerBoundaryIs></Polygon></Placemark></Folder></Document></kml>"
    )


def gpx() -> str:
    stops = "".join(
        f'<wpt lat="{lat:.6f}" lon="{lon:.6f}"><name>{k}</name></wpt>'
        for k, (lon, lat, _) in enumerate(pushes(), 1)
    )
    return (
        '<?xml version="1.0"?><gpx version="1.1" creator="t" '
        f'xmlns="http://www.topografix.com/GPX/1/1">{stops}</gpx>'
    )


def conductivity() -> str:
    rows = [
        f"{SOUTH + 0.0002 * j:.5f},{WEST + 0.0003 * k:.5f},{20 + j + k / 2}"
        for j in range(-1, 18)
        for k in range(-1, 16)
    ]
    return "\n".join(["lat,lon,ec", *rows]) + "\n"


def zipped(files: dict[str, bytes]) -> bytes:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            archive.writestr(name, data)
    return packed.getvalue()


def workbook() -> bytes:
    openpyxl = __import__("openpyxl")
    book = openpyxl.Workbook()
    for line in wide().splitlines():
        book.active.append(
            [float(c) if c[-1].isdigit() and "cm" not in c else c for c in line.split(",")]
        )
    packed = io.BytesIO()
    book.save(packed)
    return packed.getvalue()


def geofiles(folder: Path) -> Iterator[Sound]:
    """Outlines and points as GDAL writes them."""
    ring = np.array([shapely.to_wkb(shapely.Polygon(RING))], dtype=object)
    at = [shapely.to_wkb(shapely.Point(lon, lat)) for lon, lat, _ in pushes()]
    values = np.array([kpa for _, _, kpa in pushes()], dtype=float).T
    names = [f"kpa_{d}cm" for d in DEPTHS_CM]
    for suffix, driver in ((".gpkg", "GPKG"), (".shp", "ESRI Shapefile")):
        area, spots = folder / f"field{suffix}", folder / f"points{suffix}"
        pyogrio.raw.write(
            area, ring, [np.array(["Long Acre"])], ["name"], geometry_type="Polygon",
            crs="EPSG:4326", driver=driver,
        )  # fmt: skip
        pyogrio.raw.write(
            spots, np.array(at, dtype=object), list(values), names, geometry_type="Point",
            crs="EPSG:4326", driver=driver,
        )  # fmt: skip
        if suffix == ".gpkg":
            yield Sound(area.name, area.read_bytes(), "outline")
            yield Sound(spots.name, spots.read_bytes(), "readings")
    parts = [part for part in sorted(folder.glob("field.*")) if part.suffix != ".gpkg"]
    yield Sound("field.zip", zipped({p.name: p.read_bytes() for p in parts}), "outline")


def raster(folder: Path) -> bytes:
    path = folder / "ec.tif"
    grid = np.linspace(20, 40, 20 * 25, dtype=np.float32).reshape(20, 25)
    where = from_origin(WEST - 0.001, SOUTH + 0.004, 0.0003, 0.0003)
    with rasterio.open(
        path, "w", driver="GTiff", width=25, height=20, count=1, dtype="float32",
        crs="EPSG:4326", transform=where,
    ) as file:  # fmt: skip
        file.write(grid, 1)
    return path.read_bytes()


def corpus(folder: Path) -> list[Sound]:
    """All of them."""
    texts: dict[str, tuple[Callable[[], str], str]] = {
        "wide.csv": (wide, "readings"),
        "semicolons.csv": (lambda: wide(";", ","), "readings"),
        "tidy.csv": (tidy, "readings"),
        "robot.yaml": (robot, "readings"),
        "sc900.txt": (sc900, "readings"),
        "penetrologger.txt": (penetrologger, "readings"),
        "cone.gef": (gef, "elsewhere"),
        "points.geojson": (points, "readings"),
        "field.geojson": (outline, "outline"),
        "field.kml": (kml, "outline"),
        "field.csv": (lambda: "lon,lat\n" + "".join(f"{x},{y}\n" for x, y in RING), "outline"),
        "field.coords": (lambda: "".join(f"{y}, {x}\n" for x, y in RING), "outline"),
        "positions.gpx": (gpx, "positions"),
        "ec.csv": (conductivity, "covariate"),
    }
    found = [Sound(name, make().encode(), kind) for name, (make, kind) in texts.items()]
    found += geofiles(folder)
    found.append(Sound("field.kmz", zipped({"doc.kml": kml().encode()}), "outline"))
    found.append(Sound("readings.xlsx", workbook(), "readings"))
    found.append(Sound("ec.tif", raster(folder), "covariate"))
    return found
