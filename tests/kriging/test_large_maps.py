"""Maps too large to keep the work on them: the same answers as their parts, in little memory."""

from __future__ import annotations

import subprocess
import sys
import tracemalloc
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from subsoil.arrays import Floats
from subsoil.errors import SingularSystemError
from subsoil.kriging import KrigedAt, at_cells, at_targets, condition
from subsoil.kriging.drift import Covariate, Drifted
from subsoil.kriging.memory import needed_gib
from subsoil.land.field import Field
from subsoil.layers import Layers, Sample
from subsoil.mapping.soilmap import SoilMap
from subsoil.variogram import Exponential, Gaussian, Matern32, Nested, Spherical, Structure

rng = np.random.default_rng(11)
AT = rng.uniform(0, 500, (60, 2))
Z = rng.normal(1000, 200, (3, 60))
TARGETS = np.concatenate([rng.uniform(0, 500, (79_990, 2)), AT[:10]])
PART = np.concatenate([np.arange(0, 80_000, 997), np.arange(79_980, 80_000)])
EVERYWHERE = np.concatenate([TARGETS, AT])
COVARIATE = Covariate(EVERYWHERE, 30 + 10 * np.sin(EVERYWHERE[:, 0] / 60))
POOLED = Nested(4e4, (Structure(0.6, Exponential, 150.0), Structure(0.3, Matern32, 90.0)))
EACH = (Exponential(0.0, 120.0, 9e3), Spherical(2e3, 160.0, 3e4), Matern32(5e3, 95.0, 1e4))

every_model = pytest.mark.parametrize("model", [POOLED, EACH], ids=["one model", "one a layer"])

PEAK = """
import atexit, pathlib, re, sys
from subsoil.__main__ import main

def say():
    status = pathlib.Path("/proc/self/status").read_text()
    print(re.search(r"VmHWM:\\s+(\\d+)", status)[1], file=sys.stderr)

atexit.register(say)
main()
"""
"""Does what the command line says, and then says the most KiB of memory that it took."""


def large_and_part(model: Nested | tuple[Exponential, Spherical, Matern32]) -> list[KrigedAt]:
    """Kriged at all targets and at some of them; only the few keep the work on them."""
    ok = condition(model, AT, Z)
    large, part = at_targets(ok, TARGETS), at_targets(ok, TARGETS[PART])
    assert large.kept is None
    assert part.kept is not None
    return [large, part]


@every_model
def test_a_large_map_is_as_its_parts(model: Nested) -> None:
    large, part = large_and_part(model)
    assert_allclose(large.prediction.mean[:, PART], part.prediction.mean, rtol=1e-11)
    assert_allclose(large.prediction.variance[:, PART], part.prediction.variance, rtol=1e-9)


@every_model
def test_a_large_map_with_drift_is_as_its_parts(model: Nested) -> None:
    large, part = (Drifted(each, COVARIATE).prediction for each in large_and_part(model))
    assert_allclose(large.mean[:, PART], part.mean, rtol=1e-11)
    assert_allclose(large.variance[:, PART], part.variance, rtol=1e-9, atol=1e-9)


@every_model
def test_a_large_map_follows_readings_as_its_parts_do(model: Nested) -> None:
    readings = np.array([[250.0, 240.0], AT[3], [10.0, 490.0]]), np.full((3, 3), 900.0)
    large, part = (each.append(*readings).prediction for each in large_and_part(model))
    assert_allclose(large.mean[:, PART], part.mean, rtol=1e-11)
    assert_allclose(large.variance[:, PART], part.variance, rtol=1e-9)


@every_model
def test_a_large_map_looks_ahead_as_its_parts_do(model: Nested) -> None:
    large, part = large_and_part(model)
    few = np.array([2, 7, 30])
    found, expected = large.error_covariance(PART[few], PART[:9]), part.error_covariance(few)
    scale = expected.max()
    assert_allclose(found, expected[:, :, :9], rtol=1e-9, atol=1e-12 * scale)
    assert "v" not in vars(large), "a few cells do not take the work on all"
    whole = large.error_covariance(PART[few])
    assert_allclose(whole[:, :, PART], expected, rtol=1e-9, atol=1e-12 * scale)
    drop = large.variance_drop(PART[few])[..., PART]
    assert_allclose(drop, part.variance_drop(few), rtol=1e-9, atol=1e-12 * scale)


def large_field() -> Field:
    """An L of 76 800 cells, readings of the module at the centres of some."""
    corners = [(0, 0), (500, 0), (500, 250), (250, 250), (250, 500), (0, 500)]
    return Field.from_metres(corners, cell_size=500 / 320)


def at_some_centres(field: Field) -> Floats:
    at = AT.copy()
    at[:20] = field.cells[:: len(field.cells) // 20][:20]
    return at


@pytest.mark.parametrize("exact", [False, True])
@every_model
def test_all_cells_of_a_large_field_are_kriged_as_one_by_one(model: Nested, exact: bool) -> None:
    field = large_field()
    at = at_some_centres(field)
    ok = condition(model, at, Z, exact=exact)
    whole, each = at_cells(ok, field), at_targets(ok, field.cells)
    assert whole.kept is None
    assert_allclose(whole.mean, each.mean, atol=1e-9 * Z.std())
    assert_allclose(whole.variance, each.variance, rtol=0, atol=1e-9 * ok.system.scale.max())
    assert np.array_equal(np.sort(whole.pins, axis=0), np.sort(each.pins, axis=0))
    assert len(whole.pins) == 20
    readings = np.array([[240.0, 230.0], at[3]]), np.full((3, 2), 900.0)
    followed, expected = whole.append(*readings), each.append(*readings)
    assert_allclose(followed.mean, expected.mean, atol=2e-9 * Z.std())
    scale = ok.system.scale.max()
    assert_allclose(followed.variance, expected.variance, rtol=0, atol=2e-9 * scale)


@every_model
def test_drift_over_a_large_field_is_as_cell_by_cell(model: Nested) -> None:
    field = large_field()
    ok = condition(model, at_some_centres(field), Z)
    at, everywhere = ok.at, np.concatenate([field.cells, ok.at])
    covariate = Covariate(everywhere, 30 + 10 * np.sin(everywhere[:, 0] / 60))
    whole = Drifted(at_cells(ok, field), covariate)
    each = Drifted(at_targets(ok, field.cells), covariate)
    assert len(at) == len(AT)
    assert_allclose(whole.prediction.mean, each.prediction.mean, atol=1e-9 * Z.std())
    scale = each.prediction.variance.max()
    assert_allclose(whole.prediction.variance, each.prediction.variance, rtol=0, atol=1e-9 * scale)
    few = np.array([2, 700, 50_000])
    assert_allclose(whole.error_covariance(few, few), each.error_covariance(few, few), rtol=1e-9)


def test_a_strip_that_fills_little_of_its_rectangle_is_kriged_all_the_same() -> None:
    field = Field.from_metres([(0, 0), (2000, 2000), (1990, 2000), (0, 10)], cell_size=0.5)
    assert field.grid.inside.mean() < 0.01
    ok = condition(POOLED, 4 * AT, Z)
    some = np.arange(0, len(field.cells), 501)
    assert_allclose(
        at_cells(ok, field).mean[:, some], ok.predict(field.cells[some]).mean, rtol=1e-9
    )


def test_what_is_not_determined_is_refused_on_a_large_field_too() -> None:
    field = large_field()
    close = np.column_stack([100.0 + np.arange(6.0), 100.0 + 2 * np.arange(6.0)])
    ok = condition(Gaussian(0.0, 400.0, 1e4), close, Z[0, :6])
    with pytest.raises(SingularSystemError, match="not determined"):
        at_cells(ok, field)
    with pytest.raises(SingularSystemError, match="not determined"):
        ok.predict_grid(field.grid.easting, field.grid.northing)


def test_a_soil_map_of_a_large_field_is_as_that_of_its_cells() -> None:
    field = large_field()
    samples = tuple(
        Sample((float(e), float(n)), z, np.zeros(3, dtype=np.int8))
        for (e, n), z in zip(AT[:, :2], Z.T, strict=True)
        if field.contains([(e, n)])[0]
    )
    layers = Layers((0.0, 0.1, 0.2, 0.3))
    part = tuple(range(0, len(field.cells), 37))
    whole = SoilMap(field, layers, (POOLED,) * 3, samples)
    some = replace(whole, subset=part)
    assert_allclose(whole.mean[:, part], some.mean, atol=1e-6)
    assert_allclose(whole.kv[list(part)], some.kv, rtol=1e-9)


def test_layers_kriged_together_are_as_kriged_alone_however_many_readings() -> None:
    at, z = rng.uniform(0, 2000, (1300, 2)), rng.normal(1000, 200, (3, 1300))
    together = condition(EACH, at, z).predict(TARGETS[:50])
    for k, model in enumerate(EACH):
        alone = condition(model, at, z[k]).predict(TARGETS[:50])
        assert_allclose(together.mean[k], alone.mean, rtol=1e-10)
        assert_allclose(together.variance[k], alone.variance, rtol=1e-9)


def test_a_map_does_not_take_memory_for_readings_times_cells() -> None:
    at, z = rng.uniform(0, 2000, (200, 2)), rng.normal(1000, 200, (1, 200))
    targets = rng.uniform(0, 2000, (200_000, 2))
    ok = condition(POOLED, at, z)
    tracemalloc.start()
    mean = at_targets(ok, targets).prediction.mean
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert mean.shape == (1, 200_000)
    assert peak < 0.6 * 8 * 200 * 200_000


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="the peak is read from /proc")
@pytest.mark.parametrize("reached", [True, False], ids=["all reached", "some ended above"])
@pytest.mark.parametrize(("readings", "side"), [(300, 1250.0), (2500, 500.0)])
def test_memory_is_foreseen_within_a_tenth_below_and_twice_above(
    tmp_path: Path, readings: int, side: float, reached: bool
) -> None:
    at = rng.uniform(1, side - 1, (readings, 2))
    kpa = rng.normal(1000, 200, (8, readings))
    if not reached:
        kpa[np.arange(8)[:, None] > rng.integers(3, 30, readings)] = np.nan
    rows = np.column_stack([at, kpa.T]).round(1).astype(str)
    head = ",".join(["easting", "northing", *(f"kpa_{5 * k}cm" for k in range(1, 9))])
    lines = [head, *(",".join(row).replace("nan", "") for row in rows)]
    (tmp_path / "readings.csv").write_text("\n".join(lines))
    square = f"easting,northing\n0,0\n{side},0\n{side},{side}\n0,{side}\n"
    (tmp_path / "field.csv").write_text(square)
    layers = ",".join(f"{k / 20}" for k in range(9))
    done = subprocess.run(
        [sys.executable, "-c", PEAK, "map", "readings.csv", "--boundary", "field.csv",
         "--out", "map", "--layers", layers],
        cwd=tmp_path, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    systems = np.unique(np.isfinite(kpa), axis=0).sum(axis=1).tolist()
    cells = round(side / 5) ** 2
    needed = needed_gib(readings, systems=systems, cells=cells, layers=8)
    assert 0.9 < needed / (int(done.stderr) / 2**20) < 2.0
