"""Where kriging a layer is worth it: leave-one-out scores of a map, and what they say in words."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from subsoil.arrays import Floats
from subsoil.kriging import LeaveOneOut, condition, leave_one_out
from subsoil.kriging.drift import NO_COVARIATE, Covariate, leave_one_out_with
from subsoil.variogram.models import Variogram

FEWEST = 3
"""Readings in a layer below which none can be left out."""


def layer_scores(
    at: Floats,
    kpa: Floats,
    variograms: Sequence[Variogram],
    covariate: Covariate = NO_COVARIATE,
    drift: Sequence[int] = (),
) -> Iterator[LeaveOneOut | None]:
    """Leave-one-out scores layer by layer; none where fewer than three readings reached it.

    Parameters
    ----------
    at
        (n, 2) places in m.
    kpa
        (m, n) layer means, NaN where not measured.
    variograms
        m models.
    covariate, drift
        What the layers with these indices follow.
    """
    for k, (variogram, values) in enumerate(zip(variograms, kpa, strict=True)):
        known = np.isfinite(values)
        if known.sum() < FEWEST:
            yield None
            continue
        ok = condition(variogram, at[known], values[None, known])
        yield leave_one_out_with(covariate, ok) if k in drift else leave_one_out(ok)


def no_better_than_mean(
    names: Sequence[str], scores: Iterable[LeaveOneOut | None]
) -> Iterator[str]:
    """Name the layers in which kriging predicts left-out readings no better than their mean."""
    for name, score in zip(names, scores, strict=True):
        if score is not None and score.skill[0] <= 0:
            yield (
                f"{name}: kriging does not beat the field's mean (leave-one-out skill "
                f"{score.skill[0]:z.2f}); what the map shows there beyond the mean is not reliable."
            )
