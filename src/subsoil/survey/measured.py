"""What a survey measured: samples of its readings, their fits, and readings to map as others."""

from __future__ import annotations

from math import isfinite

import numpy as np

from subsoil.findings import Finding
from subsoil.layers import Sample
from subsoil.mapping.drift_choice import residuals
from subsoil.penetrometer import faults, profile_of
from subsoil.readings import Readings
from subsoil.registry import NOBODY, Allowed
from subsoil.reports import Sampled
from subsoil.survey.state import Survey
from subsoil.variogram import (
    ESTIMATORS,
    Estimator,
    Fit,
    bins_of,
    empirical_layers,
    estimator_named,
)


def readings_of(survey: Survey) -> Readings:
    """Readings of a survey that count, in the order of its stops."""
    kept = [report for report in survey.readings if mappable(survey, report)]
    return Readings(
        np.array([report.at for report in kept], dtype=float).reshape(-1, 2),
        tuple(profile_of(report.reading, survey.cone) for report in kept),
        survey.field.extent_m,
        np.arange(1, len(kept) + 1),
        crs=survey.field.crs,
        source=survey.name,
        findings=tuple(Finding(note) for note in survey.notes),
        simulated=survey.simulated,
    )


def estimator_of(survey: Survey, allowed: Allowed = NOBODY) -> Estimator:
    """What estimates the survey's variograms, by a registered name or of an allowed module."""
    settings = survey.settings
    return estimator_named(
        settings.estimator, survey.field.extent_m, settings.estimator_settings, allowed
    )


def fits_of(survey: Survey) -> tuple[Fit, ...]:
    """The fits that the map was kriged with, one a layer, with the bins of its samples.

    Nothing is fitted again: the bins are a function of the samples, and of what the covariate
    leaves of them in the layers that follow it.
    """
    soil_map = survey.soil_map
    rest = soil_map.kpa.copy()
    for layer in soil_map.drift:
        rest[layer] = residuals(soil_map.covariate(soil_map.at), rest[layer])
    if survey.settings.estimator in ESTIMATORS:
        bins = bins_of(estimator_of(survey), soil_map.at, rest)
    else:
        bins = empirical_layers(soil_map.at, rest)
    return tuple(record.fit(curve) for record, curve in zip(survey.fits, bins, strict=True))


def sample_of(survey: Survey, report: Sampled) -> Sample:
    """Layer values that a push gave, at its own place."""
    return survey.layers.sample(profile_of(report.reading, survey.cone), report.at)


def mappable(survey: Survey, report: Sampled) -> bool:
    """Whether a reading has a place, and says something that can be true.

    None that enters today does not; files of earlier versions hold some.
    """
    east, north = report.at
    return isfinite(east) and isfinite(north) and not faults(report.reading, survey.cone)
