"""Verbs that look at readings: maps, variograms, cross-validation."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from subsoil.cli.covariate import Column, CovariateFile, Drift, covariate_of
from subsoil.cli.field import (
    Block,
    Boundary,
    CellSize,
    Crs,
    Edges,
    OptionalBoundary,
    OptionalConeArea,
    ReadingsFile,
    ReadingUnit,
)
from subsoil.cli.material import Material, material_of
from subsoil.cli.options import (
    DEFAULT_EDGES,
    EstimatorName,
    EstimatorSettings,
    extent_of,
    numbers,
)
from subsoil.cli.output import AsJson, Out, Shown, folder, progress, tell, tell_table
from subsoil.errors import ParameterError
from subsoil.io.boundary import read_field
from subsoil.io.rasters import write_geotiffs
from subsoil.kriging import LeaveOneOut, block_out
from subsoil.kriging.drift import NO_COVARIATE, Covariate
from subsoil.kriging.memory import check_memory
from subsoil.mapping.drift_choice import learn
from subsoil.mapping.skill import layer_scores, no_better_than_mean
from subsoil.mapping.soilmap import SoilMap
from subsoil.optional import FIGURES, GEOTIFF, require
from subsoil.plots import readings_figures
from subsoil.units import SYSTEMS, System, Units
from subsoil.variogram import Estimator, Fit, Pooled, estimator_named, name_of

_ESTIMATOR = "pmc"


def make_map(
    readings: ReadingsFile,
    boundary: Boundary,
    out: Out,
    cell: CellSize = 5.0,
    layers: Edges = DEFAULT_EDGES,
    estimator: EstimatorName = _ESTIMATOR,
    setting: EstimatorSettings = None,
    cone_area: OptionalConeArea = None,
    reading_unit: ReadingUnit = None,
    crs: Crs = None,
    covariate: CovariateFile = None,
    column: Column = None,
    drift: Drift = "auto",
    units: Shown = "metric",
    as_json: AsJson = False,
) -> None:
    """Map real readings, layer by layer, with uncertainty and skill against the mean."""
    require(GEOTIFF, FIGURES)
    field = read_field(boundary, crs=crs, cell_size=cell)
    material = material_of(readings, layers, field, crs, cone_area, reading_unit)
    check_memory(len(material.samples), len(field.cells))
    known = covariate_of(covariate, column, field, crs)
    chosen = estimator_named(estimator, field.extent_m, numbers(setting))
    learnt = learn(material.at, material.kpa, known, chosen, drift)
    fits = learnt.fits
    soil_map = SoilMap(
        field, material.layers, tuple(fit.variogram for fit in fits), material.samples,
        known, learnt.drift, material.simulated,
    )  # fmt: skip
    scores = _scores(material, fits, known, learnt.drift)
    unskilled = _unskilled(material, scores)
    rasters = write_geotiffs(soil_map, folder(out))
    figures = readings_figures(soil_map, fits, out)
    result = {
        "readings": readings,
        "field": field.name,
        "area_ha": field.area_ha,
        "samples": len(material.samples),
        "refused": material.refused,
        "std_dev_kpa": float(np.sqrt(soil_map.field_kv)),
        "notes": tuple(dict.fromkeys((*material.notes, *soil_map.notes, *unskilled))),
        "drift": [material.layers.names[k] for k in learnt.drift],
        "maps": rasters,
        "figures": figures,
    }
    if as_json:
        tell({**result, "layers": _score_dicts(material, fits, scores)}, as_json)
        return
    _tell(result, units)
    _tell_scores(
        "Leave-one-out (skill 0: no better than the mean, calibration 1: honest variances)",
        material, _score_dicts(material, fits, scores), units,
    )  # fmt: skip


def variogram(
    readings: ReadingsFile,
    boundary: OptionalBoundary = None,
    layers: Edges = DEFAULT_EDGES,
    estimator: EstimatorName = _ESTIMATOR,
    setting: EstimatorSettings = None,
    cone_area: OptionalConeArea = None,
    reading_unit: ReadingUnit = None,
    crs: Crs = None,
    units: Shown = "metric",
    as_json: AsJson = False,
) -> None:
    """Show empirical variograms with pair counts, and what was fitted to them."""
    field = read_field(boundary, crs=crs) if boundary else None
    material = material_of(readings, layers, field, crs, cone_area, reading_unit)
    check_memory(len(material.samples))
    extent = field.extent_m if field else extent_of(material.at)
    chosen = estimator_named(estimator, extent, numbers(setting))
    fits = chosen(material.at, material.kpa)
    posterior = _posterior(chosen, material)
    if as_json:
        reports = [_fit_dict(n, f) for n, f in zip(material.layers.names, fits, strict=True)]
        tell({**_about(material), **posterior, "layers": reports}, as_json)
        return
    _tell({**_about(material), **posterior}, units)
    for name, fit in zip(SYSTEMS[units].layers(material.layers), fits, strict=True):
        bins = fit.empirical
        tell_table(
            f"{name}: {_in_words(fit, SYSTEMS[units])}\n{fit.why}",
            ("lag_m", "pairs", "semivariance_kpa2"),
            list(
                zip(bins.lag.tolist(), bins.pairs.tolist(), bins.semivariance.tolist(), strict=True)
            ),
            SYSTEMS[units],
        )


def cv(
    readings: ReadingsFile,
    boundary: OptionalBoundary = None,
    layers: Edges = DEFAULT_EDGES,
    estimator: EstimatorName = _ESTIMATOR,
    setting: EstimatorSettings = None,
    block: Block = 50.0,
    cone_area: OptionalConeArea = None,
    reading_unit: ReadingUnit = None,
    crs: Crs = None,
    units: Shown = "metric",
    as_json: AsJson = False,
) -> None:
    """Leave readings out, one by one and by blocks, and score kriging against the mean."""
    field = read_field(boundary, crs=crs) if boundary else None
    material = material_of(readings, layers, field, crs, cone_area, reading_unit)
    check_memory(len(material.samples))
    extent = field.extent_m if field else extent_of(material.at)
    fits = estimator_named(estimator, extent, numbers(setting))(material.at, material.kpa)
    scores = _scores(material, fits)
    about = {
        **_about(material),
        "notes": (*material.notes, *_unskilled(material, scores)),
    }
    blocks = []
    with progress(f"leaving {block:g} m blocks out", len(fits)) as advance:
        for name, fit, kpa in zip(material.layers.names, fits, material.kpa, strict=True):
            known = np.isfinite(kpa)
            blocks.append(block_out(fit.variogram, material.at[known], kpa[known], block))
            advance(len(blocks), name)
    rows = _score_dicts(material, fits, scores)
    for row, score in zip(rows, blocks, strict=True):
        row["block_rmse_kpa"] = float(score.rmse[0])
        row["block_skill"] = float(score.skill[0])
    if as_json:
        tell({**about, "block_m": block, "layers": rows}, as_json)
        return
    _tell(about, units)
    _tell_scores(f"Leave-one-out and {block:g} m blocks", material, rows, units)


def _scores(
    material: Material,
    fits: tuple[Fit, ...],
    covariate: Covariate = NO_COVARIATE,
    drift: tuple[int, ...] = (),
) -> list[LeaveOneOut]:
    scores = []
    variograms, names = [fit.variogram for fit in fits], material.layers.names
    found = layer_scores(material.at, material.kpa, variograms, covariate, drift)
    with progress("leaving readings out", len(fits)) as advance:
        for k, (name, score) in enumerate(zip(names, found, strict=True)):
            if score is None:
                raise ParameterError(
                    f"{np.isfinite(material.kpa[k]).sum()} readings reached the layer",
                    where=f"layer {name}",
                    remedy="leave it out with --layers",
                )
            scores.append(score)
            advance(len(scores), name)
    return scores


def _about(material: Material) -> dict[str, object]:
    """How many readings are used, which are not and why, and what else to know."""
    return {
        "samples": len(material.samples),
        "refused": material.refused,
        "notes": material.notes,
    }


def _unskilled(material: Material, scores: list[LeaveOneOut]) -> Iterator[str]:
    return no_better_than_mean(material.layers.names, scores)


def _score_dicts(
    material: Material, fits: tuple[Fit, ...], scores: list[LeaveOneOut]
) -> list[dict[str, object]]:
    return [
        {
            "layer": name,
            "samples": int(np.isfinite(kpa).sum()),
            "mean_kpa": float(np.nanmean(kpa)),
            "sd_kpa": float(np.nanstd(kpa)),
            "range_m": fit.variogram.range,
            "nugget_share": fit.variogram.nugget / fit.variogram.sill,
            "loo_rmse_kpa": float(score.rmse[0]),
            "loo_skill": float(score.skill[0]),
            "loo_calibration": float(score.calibration[0]),
        }
        for name, kpa, fit, score in zip(
            material.layers.names, material.kpa, fits, scores, strict=True
        )
    ]


def _tell(result: Mapping[str, object], units: System) -> None:
    """Print what a file holds, for people: rows of a file are left out, not refused."""
    names = {"refused": "left out"}
    tell({names.get(k, k): value for k, value in result.items()}, False, SYSTEMS[units])


def _tell_scores(
    title: str, material: Material, rows: list[dict[str, object]], units: System
) -> None:
    names = SYSTEMS[units].layers(material.layers)
    shown = [[n, *list(row.values())[1:]] for n, row in zip(names, rows, strict=True)]
    tell_table(title, list(rows[0]), shown, SYSTEMS[units])


def _in_words(fit: Fit, units: Units) -> str:
    model = fit.variogram
    return (
        f"{name_of(model)}, nugget {units.variance.text(model.nugget)}, "
        f"sill {units.variance.text(model.sill)}, range {units.length.text(model.range)}"
    )


def _posterior(estimator: Estimator, material: Material) -> dict[str, object]:
    """What a pooled estimator knows of the correlogram that all layers share; else nothing."""
    if not isinstance(estimator, Pooled):
        return {}
    found = estimator.posterior(material.at, material.kpa)
    quantiles = (0.05, 0.5, 0.95)
    return {
        "posterior range_m": [found.range_at(p) for p in quantiles],
        "posterior nugget_share": [found.nugget_at(p) for p in quantiles],
        "posterior quantiles": list(quantiles),
        "posterior models": [f"{name} {p:.3f}" for name, p in found.kind_weights.items()],
        "independent layers": found.layers,
    }


def _fit_dict(name: str, fit: Fit) -> dict[str, object]:
    return {
        "layer": name,
        "model": name_of(fit.variogram),
        "nugget_kpa2": fit.variogram.nugget,
        "range_m": fit.variogram.range,
        "psill_kpa2": fit.variogram.psill,
        "r2": fit.r2,
        "at_bound": fit.at_bound,
        "why": fit.why,
        "lag_m": fit.empirical.lag.tolist(),
        "pairs": fit.empirical.pairs.tolist(),
        "semivariance_kpa2": fit.empirical.semivariance.tolist(),
    }
