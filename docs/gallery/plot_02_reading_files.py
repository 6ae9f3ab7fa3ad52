"""
Readings and outlines from files
================================

For somebody who comes back from the field with a table and an outline.

A table has a row a push and a column a depth, with its unit in the heading. Rows that cannot be
used are left out and named; nothing is mended by guessing.
"""

# %%
# The files are written here first. The table has two mistakes in it: one reading lies in the next
# village, and one has a word where a number should be.

import json
import tempfile
from pathlib import Path

import numpy as np

import subsoil as ss

folder = Path(tempfile.mkdtemp())
outline = [[-0.5262, 53.2610], [-0.5241, 53.2608], [-0.5238, 53.2621], [-0.5260, 53.2623]]
polygon = {"type": "Polygon", "coordinates": [[*outline, outline[0]]]}
(folder / "field.geojson").write_text(json.dumps(polygon))

rng = np.random.default_rng(2)
rows = ["lat,lon,kpa_10cm,kpa_20cm,kpa_30cm"]
for _ in range(36):
    lat, lon = rng.uniform(53.2611, 53.2621), rng.uniform(-0.5258, -0.5242)
    wheel_track = 500 * np.exp(-(((lon + 0.5250) / 2e-4) ** 2))
    kpa = (
        np.array([700, 1300, 1600]) + wheel_track * np.array([1.0, 1.2, 0.4]) + rng.normal(0, 60, 3)
    )
    rows.append(f"{lat:.6f},{lon:.6f}," + ",".join(f"{value:.0f}" for value in kpa))
rows += ["53.3000,-0.5250,800,1200,1500", "53.2615,-0.5250,800,stone,1500"]
(folder / "readings.csv").write_text("\n".join(rows) + "\n")

# %%
# Longitude and latitude become metres in the UTM zone of the field.

field = ss.read_field(folder / "field.geojson")
field

# %%
# What was left out says in which row it was, and why.

readings = ss.read_readings(folder / "readings.csv", field=field)
print(*readings.findings, sep="\n")

# %%
# From here on it is a map like any other: a wheel track has left its mark, most of all between 10
# and 20 cm.

layers = ss.Layers((0.0, 0.1, 0.2, 0.3))
soil = ss.krige(field, readings, ss.fit(readings, layers))
figure = ss.plots.depth_slices(
    soil, caption=f"{len(readings)} readings, {len(readings.findings)} findings"
)
figure
