"""What is foretold of the error comes true on fields drawn anew, as often as was said."""

from __future__ import annotations

from dataclasses import replace
from math import sqrt

import numpy as np
import pytest
from scipy.spatial.distance import cdist
from scipy.stats import norm

from subsoil.arrays import Floats
from subsoil.land.field import Field
from subsoil.layers import Layers, LayerState, Sample
from subsoil.mapping.scores import rmse
from subsoil.mapping.soilmap import SoilMap
from subsoil.mapping.uncertainty import predicted_rmse, subsample
from subsoil.stopping import SureRmse, forecast, further
from subsoil.variogram import Exponential, Spherical

FIELD = Field.from_metres([(0, 0), (60, 0), (60, 45), (0, 45)])
CELLS = FIELD.cells
LAYERS = Layers((0.0, 0.2, 0.4))
NUGGET, RANGE, SILL = 2500.0, 15.0, 10_000.0
FIRST, MORE = 12, 8
REPEATS = 300


def correlation(at: Floats, to: Floats) -> Floats:
    """Of an exponential soil of practical range RANGE, written down apart from the product."""
    return np.asarray(np.exp(-3.0 * cdist(at, to) / RANGE))


@pytest.fixture(scope="module")
def design() -> tuple[list[int], list[int]]:
    """Cells probed first, and those that are said to tell most after them."""
    first = np.linspace(3, len(CELLS) - 4, FIRST).astype(int).tolist()
    return first, further(surveyed(first, np.zeros((2, FIRST))), first, (), MORE)


def surveyed(cells: list[int], kpa: Floats, sills: Floats | None = None) -> SoilMap:
    """Map of readings (2, n) in cells."""
    told = np.full(2, SILL) if sills is None else sills
    models = tuple(Exponential(NUGGET / SILL * sill, RANGE, sill) for sill in told.tolist())
    measured = np.zeros(2, np.int8)
    samples = tuple(
        Sample((east, north), z, measured)
        for (east, north), z in zip(CELLS[cells].tolist(), kpa.T, strict=True)
    )
    return SoilMap(FIELD, LAYERS, models, samples)


@pytest.fixture(scope="module")
def fresh(design: tuple[list[int], list[int]]) -> list[tuple[Floats, Floats]]:
    """Soils (2, N) of independent layers, and what is read of each in all cells of the design."""
    rng = np.random.default_rng(20)
    cells = [*design[0], *design[1]]
    root = np.linalg.cholesky(SILL * correlation(CELLS, CELLS))
    soils = [1500.0 + rng.standard_normal((2, len(CELLS))) @ root.T for _ in range(REPEATS)]
    return [
        (soil, soil[:, cells] + sqrt(NUGGET) * rng.standard_normal((2, len(cells))))
        for soil in soils
    ]


def error_covariance(cells: list[int]) -> Floats:
    """(N, N) covariance of the errors of ordinary kriging of the soil, in plain numpy."""
    n = len(cells)
    at = CELLS[cells]
    system = np.ones((n + 1, n + 1))
    system[:n, :n] = SILL * correlation(at, at) + NUGGET * np.eye(n)
    system[n, n] = 0.0
    right = np.vstack([SILL * correlation(at, CELLS), np.ones((1, len(CELLS)))])
    weights = np.linalg.solve(system, right)[:n]
    cross = weights.T @ right[:n]
    own = weights.T @ system[:n, :n] @ weights
    return np.asarray(SILL * correlation(CELLS, CELLS) - cross - cross.T + own)


def test_the_mean_square_error_after_the_foretold_stops_is_on_average_as_foretold(
    design: tuple[list[int], list[int]], fresh: list[tuple[Floats, Floats]]
) -> None:
    """Of one layer it has the variance 2 tr(PP) / N2; two layers and all fields are independent."""
    first, then = design
    for k in (1, MORE):
        made = [*first, *then[:k]]
        said = forecast(surveyed(first, fresh[0][1][:, :FIRST]), then)[k - 1]
        errors = error_covariance(made)
        assert said**2 == pytest.approx(np.diag(errors).mean(), rel=1e-9)
        squares = [
            rmse(surveyed(made, read[:, : FIRST + k]).mean, soil) ** 2 for soil, read in fresh
        ]
        spread = sqrt(2 * float((errors**2).sum()) / len(CELLS) ** 2 / (2 * REPEATS))
        assert np.mean(squares) == pytest.approx(said**2, abs=4.5 * spread)


def told_sills(cells: list[int], kpa: Floats) -> Floats:
    """Restricted maximum-likelihood sills of readings whose correlation is known."""
    at = CELLS[cells]
    shape = correlation(at, at) + NUGGET / SILL * np.eye(len(cells))
    inverse = np.linalg.inv(shape)
    one = inverse.sum(axis=1)
    contrasts = inverse - np.outer(one, one) / one.sum()
    return np.asarray(np.einsum("mi,ij,mj->m", kpa, contrasts, kpa) / (len(cells) - 1))


def test_what_is_said_to_be_sure_is_true_as_often_as_it_is_sure(
    design: tuple[list[int], list[int]], fresh: list[tuple[Floats, Floats]]
) -> None:
    """The probability said of the error that then is has a uniform distribution.

    Its normal scores then have the mean 0 and the mean square 1, with standard errors of
    sqrt(1 / n) and sqrt(2 / n); 0.1 more is for an F distribution of the right two moments in the
    place of the true one.
    """
    made = [*design[0], *design[1]]
    said = []
    for soil, read in fresh:
        soil_map = surveyed(made, read, told_sills(made, read))
        error = rmse(soil_map.mean, soil)
        said.append(SureRmse(error, 0.8).measure(soil_map, ()))
    scores = np.asarray(norm.ppf(said))
    assert scores.mean() == pytest.approx(0.0, abs=4.5 * sqrt(1 / REPEATS) + 0.1)
    assert np.mean(scores**2) == pytest.approx(1.0, abs=4.5 * sqrt(2 / REPEATS) + 0.1)


def test_the_first_cell_to_probe_further_lowers_the_mean_variance_most_of_all() -> None:
    """By trying each cell, on a field of more than 300, of which 300 are looked at."""
    field = Field.from_metres([(0, 0), (120, 0), (120, 80), (0, 80)])
    rng = np.random.default_rng(3)
    start = rng.choice(len(field.cells), 9, replace=False)
    samples = tuple(
        Sample((e, n), rng.normal(1000, 100, 2), np.zeros(2, np.int8))
        for e, n in field.cells[start].tolist()
    )
    models = (Spherical(300.0, 50.0, 4000.0), Exponential(300.0, 25.0, 3000.0))
    soil_map = SoilMap(field, LAYERS, models, samples)
    looked_at = subsample(len(field.cells))
    assert len(looked_at) == 300 < len(field.cells)
    coarse = replace(soil_map, subset=tuple(looked_at.tolist()))
    after = [
        coarse.append(Sample((e, n), np.array([900.0, 900.0]), np.zeros(2, np.int8))).field_kv
        for e, n in field.cells[looked_at].tolist()
    ]
    (best,) = further(soil_map, start.tolist(), (), 1)
    free = ~np.isin(looked_at, start)
    order = np.argsort(np.where(free, after, np.inf))
    assert best == looked_at[order[0]]
    (second,) = further(soil_map, [*start.tolist(), best], (), 1)
    assert second == looked_at[order[1]]


def test_a_forecast_takes_pushes_to_go_as_deep_as_some_push_did_and_no_deeper() -> None:
    at = CELLS[[5, 40, 77, 100]].tolist()
    state = np.array([LayerState.MEASURED, LayerState.UNREACHED], np.int8)
    samples = tuple(Sample((e, n), np.array([900.0 + 9 * e, np.nan]), state) for e, n in at)
    models = (Exponential(0.2, RANGE, 0.8),) * 2
    shallow = SoilMap(FIELD, LAYERS, models, samples)
    said = forecast(shallow, [60])
    east, north = CELLS[60].tolist()
    known = shallow.append(Sample((east, north), np.array([1.0, np.nan]), state))
    assert said[0] == pytest.approx(predicted_rmse(known), rel=1e-12)
    assert forecast(shallow, []).shape == (0,)
    assert further(shallow, (), (), 0) == []
