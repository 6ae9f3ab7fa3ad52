"""Where the soil varies more than elsewhere, and whether that is more than chance.

Kriging takes the sill for the same all over the field. Where it is not, readings are predicted
worse than the map thinks in one part and better in another, and a plan should look closer at the
first (:func:`local_sills`): if the errors say so (:func:`evidence`).

Errors are leave-one-out residuals over their SD. A constant sill makes them normal with a known
correlation: residuals are B z over the diagonal of B (Dubrule 1983, Math. Geol. 15, 687), and B z
has the covariance B. So what chance alone does to any statistic of theirs can be drawn exactly, for
the correlogram that is held: a Monte Carlo test (Barnard 1963, J. R. Stat. Soc. B 25, 294; Besag &
Clifford 1989, Biometrika 76, 633).

On 150 simulated soils of a constant sill, with pooled correlograms, 2 % were rejected at 15 samples
and 1 % at 40; with an SD that doubles in one half, 57 % and 99 %. On 24 ``signal`` fields of the
test bed surveyed with 30 samples the weights changed one plan, for the worse (+1.8 % RMSE).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.distance import cdist

from subsoil.kriging import OrdinaryKriging
from subsoil.scores import leave_one_out
from subsoil.soilmap import SoilMap
from subsoil.strategies.view import View

Floats = NDArray[np.float64]

FEWEST_PLACES = 12
"""Places below which a constant sill is not questioned."""
SIGNIFICANCE = 0.05
"""Probability by chance below which a constant sill is rejected."""

_DRAWS = 399
_REACH = 0.2
"""SD of the kernel that smooths errors, as a share of the samples' extent."""
_SHRINKING = 0.9
"""Weight of the layers' correlation against none."""


@dataclass(frozen=True)
class Evidence:
    """What leave-one-out errors say of a constant sill.

    Attributes
    ----------
    at
        (n, 2) places of the readings in m.
    squares
        (n,) squared standardised errors, averaged over layers; one on average.
    probability
        Probability that a constant sill makes the local sills vary as much.
    shrinkage
        Share of their variation that is not chance, from 0 to 1.
    """

    at: Floats
    squares: Floats
    probability: float
    shrinkage: float


def local_sills(view: View) -> Floats:
    """(N,) sill of each cell by the field's mean one; all one unless a constant sill is rejected.

    Squared errors are smoothed with a normal kernel and drawn towards one by as much of their
    variation as chance makes (James & Stein 1961, by moments).

    Parameters
    ----------
    view
        The survey so far; its generator draws what chance does.
    """
    cells = view.field.cells
    if (found := evidence(view.soil_map, view.rng)).probability >= SIGNIFICANCE:
        return np.ones(len(cells))
    smooth = _kernel(cells, found.at) @ found.squares
    sills = 1.0 + found.shrinkage * (smooth - 1.0)
    return np.asarray(sills / sills.mean())


def evidence(soil_map: SoilMap, rng: np.random.Generator) -> Evidence:
    """Test a constant sill on the leave-one-out errors of a map.

    The statistic is the variance over the places of the smoothed squares. Of the layers those
    count that the same samples reached, the most there are of them.

    Parameters
    ----------
    soil_map
        The map.
    rng
        Draws what chance does.

    Returns
    -------
    Evidence
        With a probability of one where there are fewer than twelve places, or nothing varies.
    """
    stacks = soil_map.stacks
    ok = max(stacks, key=lambda stack: len(stack.layers)).estimate.kriging if stacks else None
    if ok is None or len(ok.at) < FEWEST_PLACES or not np.ptp(ok.z, axis=1).all():
        return Evidence(np.empty((0, 2)), np.empty(0), 1.0, 0.0)
    found = leave_one_out(ok)
    errors = found.residual / np.sqrt(found.variance)
    kernel = _kernel(ok.at, ok.at)
    squares = _squares(errors)
    chance = np.var(_squares(_by_chance(ok, errors, rng)) @ kernel.T, axis=-1)
    seen = float(np.var(kernel @ squares))
    probability = (1.0 + float((chance >= seen).sum())) / (1.0 + len(chance))
    return Evidence(ok.at, squares, probability, max(0.0, 1.0 - float(chance.mean()) / seen))


def _by_chance(ok: OrdinaryKriging, errors: Floats, rng: np.random.Generator) -> Floats:
    """(draws, m, n) standardised errors under a constant sill, layers correlated as they are."""
    w = ok.system.inverse.array[:, :, : len(ok.at) - 1]
    differences = np.concatenate([-w.sum(axis=2, keepdims=True), w], axis=2)
    differences /= np.sqrt((differences**2).sum(axis=1, keepdims=True))
    shrunk = _SHRINKING * _correlation(errors) + (1.0 - _SHRINKING) * np.eye(len(errors))
    white = rng.standard_normal((_DRAWS, len(errors), w.shape[1]))
    mixed = np.linalg.cholesky(shrunk) @ white
    return np.asarray(np.matmul(mixed[:, :, None], differences)[:, :, 0])


def _correlation(errors: Floats) -> Floats:
    scaled = errors / np.sqrt((errors**2).sum(axis=1, keepdims=True))
    return np.asarray(scaled @ scaled.T)


def _squares(errors: Floats) -> Floats:
    """(..., n) squares of (..., m, n) errors, each layer's one on average, over the layers."""
    squares = errors**2
    return np.asarray((squares / squares.mean(axis=-1, keepdims=True)).mean(axis=-2))


def _kernel(at: Floats, readings: Floats) -> Floats:
    """(k, n) weights that smooth values of n readings to k places."""
    reach = _REACH * float(np.hypot(*np.ptp(readings, axis=0)))
    weights = np.exp(-0.5 * (cdist(at, readings) / reach) ** 2)
    return np.asarray(weights / weights.sum(axis=1, keepdims=True))
