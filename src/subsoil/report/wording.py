"""What a report says: its tables and its notes, as text."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from subsoil.layers import LayerState
from subsoil.mapping.skill import layer_scores, no_better_than_mean
from subsoil.mapping.soilmap import SoilMap
from subsoil.mapping.uncertainty import standard_deviation
from subsoil.plots.semivariance import remark
from subsoil.survey import Survey
from subsoil.survey.outlook import SURE, Outlook, in_words, outlook
from subsoil.survey.progress import Progress
from subsoil.units import METRIC, Units
from subsoil.variogram import Fit, name_of


@dataclass(frozen=True)
class Row:
    """A layer in the table of layers, as text."""

    name: str
    numbers: tuple[str, ...]
    model: str
    parameters: tuple[str, ...]
    why: str
    remark: str


def headline(
    survey: Survey, history: Sequence[Progress], units: Units = METRIC
) -> Iterator[tuple[str, str]]:
    """Names and values of the first table."""
    field = survey.field
    yield "Field", field.name
    yield (
        "Area",
        f"{units.area.text(field.area_ha)}, {len(field.cells)} cells of "
        f"{units.length.text(field.cell_size)}",
    )
    yield "CRS", field.crs or "none: a local frame"
    yield "Samples", str(survey.taken)
    yield "Stops without a reading", str(len(survey.refused))
    yield "Way driven", units.length.text(survey.metres)
    yield "Time", f"{survey.minutes:.0f} min"
    settings = survey.settings
    if not settings.rates.free:
        yield "Cost", f"{survey.spent.money:,.0f} {settings.rates.currency}"
    yield "Mean kriging variance", _variance(survey.mean_kv, units)
    if survey.taken > 1:
        prospects = outlook(survey)
        yield "Outlook", _expected(survey, prospects, history, units)
    if history and math.isfinite(history[-1].rmse):
        last = history[-1]
        after = _count(last.samples, "sample", "samples")
        yield "RMSE", f"{units.pressure.text(last.rmse)} against the simulated truth after {after}"
    if survey.method:
        yield "Strategy", settings.strategy
        every = f"{settings.refit_every} samples" if settings.refit_every > 1 else "sample"
        yield "Estimator", f"{settings.estimator}, fitted anew every {every}"
        yield "Seed", str(settings.seed)
    yield "Readings", _origin(survey)
    yield "Cone", f"{survey.cone.area_mm2:g} mm², {survey.cone.angle_deg:g}°"
    yield (
        "State",
        survey.finished or f"under way, {_count(len(survey.plan.cells), 'stop', 'stops')} planned",
    )


def _expected(survey: Survey, prospects: Outlook, history: Sequence[Progress], units: Units) -> str:
    """What the survey expects by its own variograms, and whether the error kept to it."""
    words = f"By its own variograms, {in_units(survey, prospects, units)}"
    if not history or history[-1].samples != survey.taken or not math.isfinite(history[-1].rmse):
        return words
    return f"{words} {promise_kept(prospects, history[-1].rmse, units)}"


def promise_kept(prospects: Outlook, rmse: float, units: Units = METRIC) -> str:
    """Say whether an error in kPa against a known truth is what the map promised, if it did."""
    unit, promised = units.pressure, prospects.error.rmse(SURE)
    if not math.isfinite(promised):
        return ""
    side = "below" if rmse < promised else "above"
    return (
        f"The error against the simulated truth is {unit.text(rmse)}: {side} the "
        f"{unit.text(promised)} that it was {100 * SURE:.0f} % sure to stay below."
    )


def _origin(survey: Survey) -> str:
    """Say who took the readings, and whether they were simulated."""
    if survey.simulated:
        soils = dict.fromkeys(f"{each.world}, seed {each.seed}" for each in survey.simulation)
        return f"simulated; soil: {'; '.join(soils) or 'unknown'}"
    return ", ".join(f"{agent.name} ({agent.kind})" for agent in survey.agents) or "none"


def in_units(survey: Survey, prospects: Outlook, units: Units) -> str:
    """Say how good the map is and what more would buy, with errors in some unit."""
    unit = units.pressure
    ahead = tuple(replace(entry, rmse=unit.factor * entry.rmse) for entry in prospects.ahead)
    error = replace(prospects.error, kv=units.variance.factor * prospects.error.kv)
    shown = replace(prospects, rmse=unit.factor * prospects.rmse, error=error, ahead=ahead)
    return in_words(survey, shown).replace(" kPa", f" {unit.name}")


def _variance(kpa2: float, units: Units) -> str:
    if math.isnan(kpa2):
        return "unknown: one sample tells no variance"
    deviation = units.pressure.text(float(standard_deviation(kpa2)))
    variance = units.variance
    return f"{variance.factor * kpa2:,.0f} {variance.name}, a standard deviation of {deviation}"


def rows(survey: Survey, fits: Sequence[Fit], units: Units = METRIC) -> tuple[Row, ...]:
    """Table of layers: mean and spread of the map, its standard deviation, and its variogram."""
    soil_map = survey.soil_map
    deviation = standard_deviation(soil_map.variance)
    used = soil_map.kriged_with
    scale, square = units.pressure.factor, units.variance.factor
    return tuple(
        Row(
            name,
            _whole(
                np.isfinite(soil_map.kpa[k]).sum(),
                scale * soil_map.mean[k].mean(),
                scale * soil_map.mean[k].std(),
                scale * deviation[k].mean(),
            ),
            name_of(fit.variogram),
            _whole(
                square * fit.variogram.nugget,
                square * fit.variogram.sill,
                units.length.factor * fit.variogram.range,
            ),
            fit.why,
            remark(fit, used[k]),
        )
        for k, (name, fit) in enumerate(zip(units.layers(soil_map.layers), fits, strict=True))
    )


def _whole(*numbers: float) -> tuple[str, ...]:
    """Whole numbers as text, with a dash where there is none."""
    return tuple(f"{number:,.0f}" if math.isfinite(number) else "–" for number in numbers)


def notes(survey: Survey, history: Sequence[Progress], fits: Sequence[Fit]) -> Iterator[str]:
    """What a reader has to know before trusting the map."""
    soil_map = survey.soil_map
    yield (
        "The standard deviation takes the variograms for known. They were estimated from these "
        "samples, so the true uncertainty is larger, most of all with few samples."
    )
    if len(soil_map.samples) == 1:
        yield "One sample tells no variance: standard deviations follow from an assumed sill."
    if priors := sum(fit.is_prior for fit in fits):
        yield (
            f"In {priors} of {_count(len(fits), 'layer', 'layers')} there is too little to fit a "
            "variogram to: it is a prior, and the standard deviation follows from it."
        )
    if bounds := _pushes(soil_map, LayerState.AT_LEAST):
        yield (
            f"The force limit ended {_count(bounds, 'push', 'pushes')} inside a layer. Such lower "
            "bounds are shown but not kriged: where soil is hardest the map is likely too soft."
        )
    if short := _pushes(soil_map, LayerState.UNREACHED):
        pushes = _count(short, "push", "pushes")
        yield f"{pushes} did not reach the deepest layer: deeper layers have fewer samples."
    if survey.refused:
        yield (
            f"{_count(len(survey.refused), 'stop', 'stops')} gave no reading: a cross on the map, "
            "not on the line, though metres and minutes count."
        )
    if history and math.isfinite(history[-1].rmse):
        yield (
            "The truth is simulated, and its error says how the survey did on that soil. It does "
            "not say how it would do on another field."
        )
    yield from survey.notes
    scores = layer_scores(
        soil_map.at, soil_map.kpa, soil_map.kriged_with, soil_map.covariate, soil_map.drift
    )
    yield from no_better_than_mean(soil_map.layers.names, scores)


def _pushes(soil_map: SoilMap, state: LayerState) -> int:
    """Count the samples with a layer in a state."""
    return sum(bool((sample.state == state).any()) for sample in soil_map.samples)


def _count(number: int, one: str, several: str) -> str:
    return f"{number} {one if number == 1 else several}"
