"""Verbs that look at readings: maps, variograms, cross-validation."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np

from subsoil.cli.covariate import Column, CovariateFile, Drift, covariate_of
from subsoil.cli.field import Block, FieldName, OptionalBoundary, OptionalCellSize
from subsoil.cli.figures import FigureFormat
from subsoil.cli.found import exit_for, said
from subsoil.cli.material import Material, MaterialOptions
from subsoil.cli.output import AsJson, Out, Shown, folder, progress, tell, tell_table
from subsoil.cli.parsing import grouped
from subsoil.errors import ParameterError
from subsoil.io.read.boundary import read_field
from subsoil.io.write.rasters import write_geotiffs
from subsoil.kriging.drift import Covariate
from subsoil.kriging.memory import check_memory
from subsoil.land.field import Field
from subsoil.mapping.fit import Fits, fit
from subsoil.mapping.krige import krige
from subsoil.mapping.skill import LayerSkill, block_skills, layer_skills, unskilled
from subsoil.optional import FIGURES, GEOTIFF, require
from subsoil.plots import draw_readings, save_all
from subsoil.units import SYSTEMS, System, Units
from subsoil.variogram import Estimator, Fit, LeastSquares, Pooled, name_of

_CELL_M = 5.0


@grouped
def make_map(
    given: MaterialOptions,
    out: Out,
    boundary: OptionalBoundary = None,
    cell: OptionalCellSize = None,
    name: FieldName = "",
    covariate: CovariateFile = None,
    column: Column = None,
    drift: Drift = "auto",
    figures: FigureFormat = "png",
    units: Shown = "metric",
    as_json: AsJson = False,
) -> None:
    """Map real readings, layer by layer, with uncertainty and skill against the mean."""
    require(GEOTIFF, FIGURES)
    field, material = _on_field(given, boundary, cell, name)
    found, chosen = material.readings, given.estimator_of(material)
    ours, odd = covariate_of(covariate, column, field, given.crs)
    known, findings = _known(ours, material, field), (*found.findings, *odd)
    alike = isinstance(chosen, Pooled) and not len(known)
    material.check_memory(alike=alike, cells=len(field.cells))
    fits = fit(found, material.layers, chosen, covariate=known, drift=drift)
    soil_map = krige(field, found, fits)
    skills = _skills(material, fits)
    about = {
        "readings": given.readings,
        "field": field.name,
        "area_ha": field.area_ha,
        "samples": len(found),
        "std_dev_kpa": float(np.sqrt(soil_map.field_kv)),
        **said(findings, (*soil_map.notes, *unskilled(skills)), as_json=as_json),
        "drift": [material.layers.names[k] for k in fits.drift],
        "maps": write_geotiffs(soil_map, folder(out)),
        "figures": save_all(draw_readings(soil_map, fits.fits), out, figures),
    }
    title = "Leave-one-out (skill 0: no better than the mean; calibration 1: honest)"
    _tell_scored(about, title, material, [asdict(each) for each in skills], units, as_json)
    exit_for(findings)


def _on_field(
    given: MaterialOptions, boundary: Path | None, cell: float | None, name: str
) -> tuple[Field, Material]:
    """The field to map, a survey's own where no outline is given, and the readings of it.

    Raises
    ------
    ParameterError
        If there is no outline and the readings are no survey's.
    """
    if boundary is not None:
        field = read_field(boundary, crs=given.crs, cell_size=cell or _CELL_M, name=name)
        return field, given.read(field)
    material = given.read(None)
    if material.field is None:
        raise ParameterError(
            "a map of readings needs the outline of their field",
            where="--boundary",
            remedy="give --boundary FILE; only a survey knows its own",
        )
    return replace(material.field, cell_size=cell or material.field.cell_size), material


def _known(covariate: Covariate, material: Material, field: Field) -> Covariate:
    """What is known of the cells of a field: what is given, or what the survey was set up with."""
    if len(covariate) or not len(material.covariate):
        return covariate
    return Covariate(field.cells, material.covariate(field.cells))


@grouped
def variogram(
    given: MaterialOptions,
    boundary: OptionalBoundary = None,
    name: FieldName = "",
    units: Shown = "metric",
    as_json: AsJson = False,
) -> None:
    """Show empirical variograms with pair counts, and what was fitted to them."""
    material = given.read(read_field(boundary, crs=given.crs, name=name) if boundary else None)
    chosen = given.estimator_of(material)
    if not isinstance(chosen, LeastSquares):
        check_memory(len(material.readings))
    fits = fit(material.readings, material.layers, chosen)
    about = {**_about(material, as_json), **_posterior(chosen, material)}
    if as_json:
        reports = [_fit_dict(n, f) for n, f in zip(material.layers.names, fits, strict=True)]
        tell({**about, "layers": reports}, as_json)
    else:
        _tell(about, units)
        _tell_fits(material, fits, units)
    exit_for(material.readings.findings)


def _tell_fits(material: Material, fits: Fits, units: System) -> None:
    for name, each in zip(SYSTEMS[units].layers(material.layers), fits, strict=True):
        bins = each.empirical
        columns = bins.lag.tolist(), bins.pairs.tolist(), bins.semivariance.tolist()
        tell_table(
            f"{name}: {_in_words(each, SYSTEMS[units])}\n{each.why}",
            ("lag_m", "pairs", "semivariance_kpa2"),
            list(zip(*columns, strict=True)),
            SYSTEMS[units],
        )


@grouped
def cv(
    given: MaterialOptions,
    boundary: OptionalBoundary = None,
    name: FieldName = "",
    block: Block = 50.0,
    units: Shown = "metric",
    as_json: AsJson = False,
) -> None:
    """Leave readings out, one by one and by blocks, and score kriging against the mean."""
    material = given.read(read_field(boundary, crs=given.crs, name=name) if boundary else None)
    found = material.readings
    material.check_memory(alike=False)
    fits = fit(found, material.layers, given.estimator_of(material))
    skills = _skills(material, fits)
    with progress(f"leaving {block:g} m blocks out", len(fits)) as advance:
        blocks = block_skills(found, fits, block, advance)
    rows = [{**asdict(one), **asdict(other)} for one, other in zip(skills, blocks, strict=True)]
    about = {**_about(material, as_json, unskilled(skills)), "block_m": block}
    _tell_scored(about, f"Leave-one-out and {block:g} m blocks", material, rows, units, as_json)
    exit_for(found.findings)


def _skills(material: Material, fits: Fits) -> tuple[LayerSkill, ...]:
    with progress("leaving readings out", len(fits)) as advance:
        return layer_skills(material.readings, fits, advance)


def _about(material: Material, as_json: bool, further: Iterable[str] = ()) -> dict[str, object]:
    """How many readings are used, which are not and why, and what else to know."""
    found = material.readings
    return {"samples": len(found), **said(found.findings, tuple(further), as_json=as_json)}


def _tell(result: Mapping[str, object], units: System) -> None:
    """Print what a file holds, for people: rows of a file are left out, not refused."""
    names = {"refused": "left out"}
    tell({names.get(k, k): value for k, value in result.items()}, False, SYSTEMS[units])


def _tell_scored(
    about: Mapping[str, object],
    title: str,
    material: Material,
    rows: list[dict[str, object]],
    units: System,
    as_json: bool,
) -> None:
    """Print what was found, and how each layer scores."""
    if as_json:
        tell({**about, "layers": rows}, as_json)
        return
    _tell(about, units)
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
    found = estimator.posterior(material.readings.at, material.kpa)
    quantiles = (0.05, 0.5, 0.95)
    return {
        "posterior range_m": [found.range_at(p) for p in quantiles],
        "posterior nugget_share": [found.nugget_at(p) for p in quantiles],
        "posterior quantiles": list(quantiles),
        "posterior models": [f"{name} {p:.3f}" for name, p in found.kind_weights.items()],
        "independent layers": found.layers,
    }


def _fit_dict(name: str, found: Fit) -> dict[str, object]:
    return {
        "layer": name,
        "model": name_of(found.variogram),
        "nugget_kpa2": found.variogram.nugget,
        "range_m": found.variogram.range,
        "psill_kpa2": found.variogram.psill,
        "r2": found.r2,
        "at_bound": found.at_bound,
        "why": found.why,
        "lag_m": found.empirical.lag.tolist(),
        "pairs": found.empirical.pairs.tolist(),
        "semivariance_kpa2": found.empirical.semivariance.tolist(),
    }
