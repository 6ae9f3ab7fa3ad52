"""Where kriging a layer is worth it: leave-one-out scores of a map, and what they say in words."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from subsoil.arrays import Floats
from subsoil.errors import ParameterError
from subsoil.kriging import LeaveOneOut, block_out, condition, leave_one_out
from subsoil.kriging.drift import NO_COVARIATE, Covariate, leave_one_out_with
from subsoil.mapping.fit import Fits
from subsoil.readings import Readings
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


@dataclass(frozen=True)
class LayerSkill:
    """What the readings of a layer are like, and how well kriging predicts those left out.

    Attributes
    ----------
    layer
        Its name.
    samples
        Readings that reached it.
    mean_kpa, sd_kpa
        Mean and standard deviation of them.
    range_m, nugget_share
        Of its variogram; the nugget as a share of the sill.
    loo_rmse_kpa, loo_skill, loo_calibration
        Of :class:`~subsoil.kriging.LeaveOneOut`: error, skill (0: no better than the mean) and
        calibration (1: honest).
    """

    layer: str
    samples: int
    mean_kpa: float
    sd_kpa: float
    range_m: float
    nugget_share: float
    loo_rmse_kpa: float
    loo_skill: float
    loo_calibration: float


Told = Callable[[int, str], None]
"""Told how many layers are done, and the name of the last."""


def layer_skills(
    readings: Readings, fits: Fits, told: Told = lambda *_: None
) -> tuple[LayerSkill, ...]:
    """Leave readings out one by one, and score kriging against the mean layer by layer.

    Parameters
    ----------
    readings
        The readings.
    fits
        Variograms of m layers, from :func:`subsoil.mapping.fit.fit`.
    told
        Told of each layer that is done.

    Raises
    ------
    ParameterError
        If fewer than three readings reached a layer.
    """
    kpa = readings.layer_means(fits.layers)
    scores = layer_scores(readings.at, kpa, fits.variograms, fits.covariate, fits.drift)
    found: list[LayerSkill] = []
    for name, values, model, score in zip(
        fits.layers.names, kpa, fits.variograms, scores, strict=True
    ):
        known = values[np.isfinite(values)]
        if score is None:
            raise ParameterError(
                f"{known.size} readings reached the layer",
                where=f"layer {name}",
                remedy="leave that layer out",
            )
        found.append(
            LayerSkill(
                name, known.size, float(known.mean()), float(known.std()), model.range,
                model.nugget / model.sill, float(score.rmse[0]), float(score.skill[0]),
                float(score.calibration[0]),
            )
        )  # fmt: skip
        told(len(found), name)
    return tuple(found)


@dataclass(frozen=True)
class BlockSkill:
    """How well kriging predicts a layer where whole blocks were left out.

    Attributes
    ----------
    block_rmse_kpa, block_skill
        Error, and skill (0: no better than the mean).
    """

    block_rmse_kpa: float
    block_skill: float


def block_skills(
    readings: Readings, fits: Fits, block_m: float, told: Told = lambda *_: None
) -> tuple[BlockSkill, ...]:
    """Leave readings out by square blocks, and score kriging against the mean layer by layer.

    Parameters
    ----------
    readings, fits, told
        As in :func:`layer_skills`.
    block_m
        Side of the blocks in m.
    """
    found: list[BlockSkill] = []
    kpa = readings.layer_means(fits.layers)
    for name, model, values in zip(fits.layers.names, fits.variograms, kpa, strict=True):
        known = np.isfinite(values)
        left = block_out(model, readings.at[known], values[known], block_m)
        found.append(BlockSkill(float(left.rmse[0]), float(left.skill[0])))
        told(len(found), name)
    return tuple(found)


def unskilled(skills: Iterable[LayerSkill]) -> Iterator[str]:
    """Name the layers in which kriging predicts left-out readings no better than their mean."""
    return _no_better((each.layer, each.loo_skill) for each in skills)


def no_better_than_mean(
    names: Sequence[str], scores: Iterable[LeaveOneOut | None]
) -> Iterator[str]:
    """Name the layers in which kriging predicts left-out readings no better than their mean."""
    pairs = zip(names, scores, strict=True)
    return _no_better((name, float(score.skill[0])) for name, score in pairs if score is not None)


def _no_better(skills: Iterable[tuple[str, float]]) -> Iterator[str]:
    for name, skill in skills:
        if skill <= 0:
            yield (
                f"{name}: kriging does not beat the field's mean (leave-one-out skill "
                f"{skill:z.2f}); what the map shows there beyond the mean is not reliable."
            )
