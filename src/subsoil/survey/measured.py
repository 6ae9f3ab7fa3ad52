"""The readings of a survey, to be mapped as any others."""

from __future__ import annotations

import numpy as np

from subsoil.penetrometer import profile_of
from subsoil.readings import Readings
from subsoil.survey.state import Survey, mappable


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
        notes=survey.notes,
        simulated=survey.simulated,
    )
