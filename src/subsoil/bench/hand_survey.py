"""A survey by hand against the truth, layer by layer: the paper's table 1 on simulated fields."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from subsoil.arrays import Floats, Integers
from subsoil.bench.paper import HAND_READINGS
from subsoil.bench.task import Setting, hand_rng
from subsoil.bench.truths import truth_of
from subsoil.land.field import Field
from subsoil.simulation import surrogate


@dataclass(frozen=True)
class HandSurveys:
    """Surveys by hand of some fields.

    Attributes
    ----------
    layers
        (m,) names of the layers.
    mean_kpa
        (fields, m) mean of the truth.
    rmse_kpa
        (fields, m) error of the map kriged from the survey by hand.
    readings
        (fields,) readings of each.
    """

    layers: tuple[str, ...]
    mean_kpa: Floats
    rmse_kpa: Floats
    readings: tuple[int, ...]


def hand_surveys(setting: Setting, fields: int) -> HandSurveys:
    """Survey the first fields of a benchmark by hand, as the paper's was.

    About 49 readings on a loose square grid, each up to a quarter of the spacing off its node,
    kriged layer by layer with spherical models. They are read like those of a robot: no other
    instrument or season, in which the paper's differed.
    """
    truths = [truth_of(setting, k) for k in range(fields)]
    taken = [loose_grid(truth.field, hand_rng(setting.seed, k)) for k, truth in enumerate(truths)]
    rmse = []
    for truth, cells in zip(truths, taken, strict=True):
        kpa = np.column_stack([truth.reading(cell) for cell in cells.tolist()])
        by_hand = surrogate(truth.field, truth.field.cells[cells], kpa, truth.layers)
        rmse.append(np.sqrt(((by_hand.kpa - truth.kpa) ** 2).mean(axis=1)))
    return HandSurveys(
        tuple(truths[0].layers.names),
        np.array([truth.kpa.mean(axis=1) for truth in truths]),
        np.array(rmse),
        tuple(len(cells) for cells in taken),
    )


def loose_grid(field: Field, rng: np.random.Generator) -> Integers:
    """Cells of a square grid of about 49 nodes, each moved up to a quarter of the spacing."""
    west, south, east, north = field.boundary.bounds
    spacing = float(np.sqrt(field.boundary.area / HAND_READINGS))
    x, y = np.meshgrid(
        np.arange(west + spacing / 2, east, spacing), np.arange(south + spacing / 2, north, spacing)
    )
    nodes = np.column_stack([x.ravel(), y.ravel()])
    nodes += rng.uniform(-spacing / 4, spacing / 4, nodes.shape)
    inside = shapely.intersects_xy(field.boundary, *nodes.T)
    return np.unique([field.nearest_cell((float(a), float(b))) for a, b in nodes[inside]])
