"""A surrogate is the kriged map of real readings, layer by layer."""

from __future__ import annotations

import csv
import os
from pathlib import Path

import numpy as np
import pytest
import shapely
from pykrige.ok import OrdinaryKriging

from subsoil.errors import ReadingsError
from subsoil.land.field import Field
from subsoil.layers import Layers
from subsoil.penetrometer import profile
from subsoil.simulation import Kriged, surrogate
from subsoil.variogram import Exponential, LeastSquares

FIELD = Field.from_metres([(0, 0), (80, 0), (80, 60), (0, 60)])
LAYERS = Layers((0.0, 0.2, 0.4))
EXPONENTIAL = LeastSquares(Exponential)
DATA = os.environ.get("SUBSOIL_DATA")


def _readings(n: int = 60) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(4)
    at = rng.uniform((0, 0), (80, 60), (n, 2))
    wave = 200 * np.sin(at[:, 0] / 15) + 100 * np.cos(at[:, 1] / 10)
    return at, np.array([[800.0], [1500.0]]) + wave + rng.normal(0, 30, (2, n))


def test_it_agrees_with_pykrige_under_its_own_variograms() -> None:
    at, kpa = _readings()
    truth = surrogate(FIELD, at, kpa, LAYERS, estimator=EXPONENTIAL)
    assert isinstance(truth.origin, Kriged)
    for layer, z, fit in zip(truth.kpa, kpa, truth.origin.fits, strict=True):
        model = fit.variogram
        peer = OrdinaryKriging(
            *at.T,
            z,
            variogram_model="exponential",
            variogram_parameters=[model.psill, model.range, model.nugget],
        )
        expected, _ = peer.execute("points", *FIELD.cells.T)
        assert layer == pytest.approx(np.asarray(expected), abs=1e-6)
    assert not truth.noise.any()


def test_a_layer_is_kriged_from_the_readings_that_reached_it() -> None:
    at, kpa = _readings()
    kpa[1, :20] = np.nan
    truth = surrogate(FIELD, at, kpa, LAYERS)
    alone = surrogate(FIELD, at[20:], kpa[1:, 20:], Layers((0.2, 0.4)))
    assert isinstance(truth.origin, Kriged)
    assert isinstance(alone.origin, Kriged)
    assert truth.origin.readings == (60, 40)
    # The bins of the variogram follow all places, those of both layers.
    box = [at.max(axis=0), at.min(axis=0)]
    assert np.allclose(box, [at[20:].max(axis=0), at[20:].min(axis=0)], atol=6.0)
    assert truth.kpa[1] == pytest.approx(alone.kpa[0], rel=0.05)


def test_readings_near_zero_are_kriged_to_zero_at_least_and_say_so() -> None:
    at, kpa = _readings()
    kpa[0] = np.maximum(kpa[0] - 900.0, 0.0)
    truth = surrogate(FIELD, at, kpa, LAYERS, estimator=EXPONENTIAL)
    assert isinstance(truth.origin, Kriged)
    assert truth.kpa.min() == 0.0
    (note,) = truth.origin.notes
    cells = int((truth.kpa[0] == 0.0).sum())
    assert note.startswith(f"0.00-0.20 m: kriged below zero in {cells} of 192 cells")


def test_a_layer_with_too_few_readings_is_named() -> None:
    at, kpa = _readings()
    kpa[1, 3:] = np.nan
    with pytest.raises(ReadingsError, match=r"0\.20-0\.40 m.*3 samples only"):
        surrogate(FIELD, at, kpa, LAYERS)


def test_readings_must_fit_the_layers() -> None:
    at, kpa = _readings()
    with pytest.raises(ReadingsError, match=r"\(2, 60\) do not fit 8 layers"):
        surrogate(FIELD, at, kpa, Layers())


def _rows(path: Path) -> list[dict[str, str]]:
    return list(csv.DictReader(path.read_text().splitlines()))


def _lonlat(row: dict[str, str]) -> tuple[float, float]:
    return float(row["lon"]), float(row["lat"])


@pytest.mark.skipif(DATA is None, reason="SUBSOIL_DATA does not name a folder of data sets")
def test_the_papers_field_has_a_surrogate() -> None:
    folder = Path(DATA or "") / "riseholme"
    outline = _rows(folder / "field_outline.csv")
    field = Field.from_lonlat(shapely.Polygon([_lonlat(row) for row in outline]))
    rows = _rows(folder / "riseholme_cosmos_177.csv")
    names = [name for name in rows[0] if name.startswith("kpa_")]
    depth = np.array([float(n[4:-2].replace("p", ".")) / 100 for n in names])
    layers, columns = Layers(), []
    for row in rows:
        kpa = np.array([float(row[name]) for name in names if row[name]])
        sample = layers.sample(profile(depth[: kpa.size], kpa), (0.0, 0.0))
        columns.append(sample.measured_kpa)
    at = field.to_metres(*np.array([_lonlat(row) for row in rows]).T)
    kpa = np.array(columns).T
    truth = surrogate(field, at, kpa, layers)
    assert truth.kpa.shape == (8, len(field.cells))
    assert truth.kpa.mean(axis=1)[1:] == pytest.approx(np.nanmean(kpa, axis=1)[1:], rel=0.1)
