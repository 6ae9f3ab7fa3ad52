"""The ten lines of a researcher: from a field and its readings to a map, a plan and a survey."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import subsoil as ss
from subsoil.arrays import Floats
from subsoil.errors import ParameterError, ReadingsError

OUTLINE = [
    [-0.5262, 53.2610], [-0.5244, 53.2610], [-0.5244, 53.2622], [-0.5262, 53.2622],
    [-0.5262, 53.2610],
]  # fmt: skip


def mine(view: ss.View) -> ss.Plan:
    """The free cell farthest from what was visited."""
    free = np.flatnonzero(view.free)
    seen = view.field.cells[list(view.visited)] if view.visited else np.array([view.position])
    away = np.hypot(*(view.field.cells[free][:, None] - seen).transpose(2, 0, 1)).min(axis=1)
    return ss.Plan((int(free[np.argmax(away)]),), "farthest from all")


@pytest.fixture
def files(tmp_path: Path) -> tuple[Path, Path]:
    boundary, table = tmp_path / "field.geojson", tmp_path / "readings.csv"
    boundary.write_text(json.dumps({"type": "Polygon", "coordinates": [OUTLINE]}))
    rng = np.random.default_rng(1)
    rows = ["lat,lon,kpa_5cm,kpa_10cm,kpa_15cm"]
    for lat, lon in zip(
        rng.uniform(53.2612, 53.262, 30), rng.uniform(-0.526, -0.5246, 30), strict=True
    ):
        kpa = 800 + 3e5 * (lat - 53.2612) + rng.normal(0, 20, 3)
        rows.append(",".join(map(str, (lat, lon, *kpa.round(1)))))
    table.write_text("\n".join(rows) + "\n")
    return boundary, table


def test_ten_lines_lead_from_files_to_a_map_a_plan_and_a_survey(files: tuple[Path, Path]) -> None:
    boundary, table = files
    layers = ss.Layers((0.0, 0.05, 0.10, 0.15))
    field = ss.read_field(boundary)
    readings = ss.read_readings(table, field=field)
    fits = ss.fit(readings, layers)
    soil = ss.krige(field, readings, fits)
    plan = ss.plan(field, strategy=mine, samples=10)
    further = ss.plan(soil, strategy="joint", samples=4)
    run = ss.simulate(field, strategy=mine, samples=4, seed=1)
    assert len(fits) == 3
    assert soil.mean.shape == (3, len(field.cells))
    assert np.isfinite(soil.mean).all()
    assert (len(plan.cells), len(further.cells)) == (1, 4)
    assert len(run.soil_map.samples) == 4
    assert run.metres > 0


def fixed(at: Floats, z: Floats) -> list[ss.Spherical]:  # noqa: ARG001 - it knows beforehand
    return [ss.Spherical(100.0, 50.0, 900.0) for _ in z]


def failing(at: Floats, z: Floats) -> list[ss.Spherical]:  # noqa: ARG001
    if np.isfinite(z[-1]).sum() == 3:
        raise ZeroDivisionError("nothing to divide by")
    return [ss.Spherical(100.0, 50.0, 900.0) for _ in z]


def test_an_estimator_of_ones_own_may_give_models(files: tuple[Path, Path]) -> None:
    boundary, table = files
    field = ss.read_field(boundary)
    fits = ss.fit(ss.read_readings(table, field=field), ss.Layers((0.0, 0.05, 0.10)), fixed)
    assert fits.variograms == (ss.Spherical(100.0, 50.0, 900.0),) * 2
    run = ss.simulate(field, "area-split", samples=3, estimator=fixed)
    assert set(run.soil_map.variograms) == {ss.Spherical(100.0, 50.0, 900.0)}


def test_an_estimator_that_fails_in_a_layer_is_named_with_the_layer() -> None:
    field = ss.Field.from_metres([(0, 0), (60, 0), (60, 40), (0, 40)])
    at = [(5.0, 5.0), (25.0, 15.0), (45.0, 35.0)]
    kpa = [[900.0, 950.0], [800.0, 810.0], [700.0, 770.0]]
    readings = ss.Readings.of(at, [0.1, 0.2], kpa, field=field)
    with pytest.raises(ParameterError, match="failing: it failed in layer 1: ZeroDivisionError"):
        ss.fit(readings, ss.Layers((0.0, 0.1, 0.2)), failing)
    with pytest.raises(ParameterError, match="failing: it failed in layer 1: ZeroDivisionError"):
        ss.simulate(field, "area-split", samples=4, estimator=failing)
    with pytest.raises(ParameterError, match="gave 5 for layer 1, which is no variogram"):
        ss.fit(readings, ss.Layers((0.0, 0.1)), lambda *_: [5])  # type: ignore[arg-type]
    with pytest.raises(ParameterError, match="gave 1 variograms for 2 layers"):
        ss.fit(readings, ss.Layers((0.0, 0.1, 0.2)), lambda *_: [ss.Spherical(1.0, 2.0, 3.0)])


@pytest.mark.parametrize(
    ("answer", "said"),
    [(None, "which is no plan"), (ss.Plan((0, 0), ""), "planned already"),
     (ss.Plan((10**6,), ""), "not in the field"), (ss.Plan((0.5,), ""), "no number of a cell")],  # type: ignore[arg-type]
)  # fmt: skip
def test_a_strategy_that_returns_nonsense_is_named_with_what_to_do(
    answer: object, said: str
) -> None:
    field = ss.Field.from_metres([(0, 0), (60, 0), (60, 40), (0, 40)])
    with pytest.raises(ParameterError, match=said):
        ss.plan(field, strategy=lambda _: answer)  # type: ignore[arg-type]


def test_readings_with_nan_places_or_holes_are_refused_by_row() -> None:
    with pytest.raises(ReadingsError, match="row 2: its place"):
        ss.Readings.of([(0, 0), (np.nan, 1)], [0.1], [[900.0], [800.0]])
    with pytest.raises(ReadingsError, match=r"row 1: nothing was read at 0\.1 m"):
        ss.Readings.of([(0, 0)], [0.1, 0.2], [[np.nan, 900.0]])


def test_values_are_short_in_print_and_tables_in_notebooks(files: tuple[Path, Path]) -> None:
    boundary, table = files
    layers = ss.Layers((0.0, 0.05, 0.10))
    field = ss.read_field(boundary)
    readings = ss.read_readings(table, field=field)
    fits = ss.fit(readings, layers)
    soil = ss.krige(field, readings, fits)
    plan = ss.plan(soil, "joint", samples=8)
    run = ss.simulate(field, "area-split", samples=3)
    for value, words in [
        (field, "field field.geojson: 1.60 ha"), (soil, "soil map of field.geojson: 2 layers"),
        (plan, "plan of 8 stops in cells"), (run, "survey of field.geojson: 3 samples"),
        (readings, "30 readings"),
    ]:  # fmt: skip
        assert words in repr(value)
        assert len(repr(value)) < 200
        assert "\n" not in repr(value)
    first, second, why = repr(fits).split("\n")
    assert ("0.00-0.05 m: " in first, "0.05-0.10 m: " in second) == (True, True)
    assert why.startswith("all: pooled posterior mean")
    for shown in (field, soil, plan, run, fits):
        html = shown._repr_html_()
        assert "<svg" in html if shown is field else html.startswith("<table>")
        assert "nan" not in html
