"""Which layers follow a covariate: each reading is predicted from the others, with and without."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal, get_args

import numpy as np

from subsoil.arrays import Bools, Floats
from subsoil.errors import ParameterError
from subsoil.kriging.drift import Covariate, leave_one_out_with
from subsoil.kriging.leave_one_out import leave_one_out
from subsoil.kriging.ordinary import condition
from subsoil.variogram import Fit

DriftRule = Literal["auto", "always", "never"]
"""When a layer follows the covariate: where it predicts better, wherever it can, or nowhere."""

FEWEST_SAMPLES = 8
"""Samples of a layer below which it does not follow a covariate."""
LEAST_T = 1.0
"""Standard errors by which leave-one-out errors of all layers together have to be lower."""
LEAST_T_OF_LAYER = 0.5
"""The same of a layer, given that."""


@dataclass(frozen=True)
class Learnt:
    """Variograms of all layers, and which of them follow the covariate.

    Attributes
    ----------
    fits
        (m,) fit reports; those of layers that follow it are of what it leaves of them.
    drift
        Indices of the layers that do.
    """

    fits: tuple[Fit, ...]
    drift: tuple[int, ...]


def learn(
    at: Floats,
    z: Floats,
    covariate: Covariate,
    estimator: Callable[[Floats, Floats], tuple[Fit, ...]],
    rule: DriftRule = "auto",
) -> Learnt:
    """Estimate variograms, and find out which layers follow a covariate.

    Variograms with drift are estimated from residuals of ordinary least squares on the covariate
    (regression kriging; Hengl, Heuvelink & Rossiter 2007, Comput. Geosci. 33, 1301): their sill is
    a little low where samples are few. ``"auto"`` leaves readings out one by one, with and without
    drift, each under variograms of its own: see :func:`helped`. A layer needs eight samples, whose
    values differ, as do those of the covariate.

    Parameters
    ----------
    at
        (n, 2) places in m.
    z
        (m, n) values, NaN where a layer was not measured.
    covariate
        What the layers may follow; none do if it is empty.
    estimator
        An :data:`~subsoil.variogram.estimators.Estimator`.
    rule
        When to follow it.

    Raises
    ------
    ParameterError
        If there is no such rule.
    """
    if rule not in get_args(DriftRule):
        raise ParameterError(
            f"there is no rule {rule!r}", where="drift", remedy="one of auto, always, never"
        )
    fits = estimator(at, z)
    if rule == "never" or not len(covariate) or not len(at):
        return Learnt(fits, ())
    x = covariate(at)
    able = np.flatnonzero([_able(x, layer) for layer in z])
    if not able.size:
        return Learnt(fits, ())
    rest = z.copy()
    rest[able] = [residuals(x, layer) for layer in z[able]]
    with_drift = estimator(at, rest)
    squares = np.stack(
        [_left_out(at, z[k], covariate, fits[k], with_drift[k]) for k in able.tolist()], axis=1
    )
    joins = helped(*squares) | (rule == "always")
    followed = able[joins]
    without = np.setdiff1d(np.arange(len(z)), followed)
    rest[without] = z[without]
    learnt = list(estimator(at, rest))
    scores = np.sqrt(np.nanmean(squares, axis=2)).T[joins]
    for k, (before, after) in zip(followed.tolist(), scores.tolist(), strict=True):
        said = f"leave-one-out RMSE {after:.4g}, without it {before:.4g}"
        learnt[k] = replace(learnt[k], why=f"{learnt[k].why}; follows the covariate: {said}")
    return Learnt(tuple(learnt), tuple(followed.tolist()))


def helped(without: Floats, with_it: Floats) -> Bools:
    """(m,) layers whose leave-one-out errors a covariate lowers.

    None, unless it lowers them clearly in all layers together: the paired differences of squared
    errors, in units of each layer's mean square and averaged over the layers that a reading
    reached, have a mean above one standard error. A dozen or two readings of a single layer tell
    little, and several layers agree by chance less often. Then those with a gain of their own of
    half a standard error.

    Parameters
    ----------
    without, with_it
        (m, n) squared errors, NaN where a reading did not reach a layer; infinite where a reading
        cannot be left out, which no layer gains by.

    Examples
    --------
    >>> helped(np.array([[4.0, 5.0, 6.0], [2.0, 2.0, 2.0]]), np.array([[1.0, 3.0, 2.0], [2.5] * 3]))
    array([ True, False])
    >>> helped(np.array([[4.0, 5.0, 6.0]]), np.array([[1.0, 8.0, 5.0]]))
    array([False])
    """
    finite = ~np.isinf(with_it).any(axis=1)
    gain = (without[finite] - with_it[finite]) / np.nanmean(without[finite], axis=1, keepdims=True)
    lowers = np.zeros(len(without), dtype=bool)
    if finite.any():
        together = np.nanmean(gain[:, np.isfinite(gain).any(axis=0)], axis=0)
        clear = _in_errors(together) > LEAST_T
        lowers[finite] = [clear and _in_errors(layer) > LEAST_T_OF_LAYER for layer in gain]
    return lowers


def _in_errors(gain: Floats) -> float:
    """Mean of gains in units of its standard error, NaN left out; infinite if they are all one."""
    gain = gain[np.isfinite(gain)]
    error = float(gain.std(ddof=1)) / np.sqrt(len(gain))
    mean = float(gain.mean())
    return mean / error if error > 0 else float(np.sign(mean)) * np.inf


def _left_out(at: Floats, z: Floats, covariate: Covariate, without: Fit, with_it: Fit) -> Floats:
    """(2, n) squared leave-one-out errors of a layer without and with drift; NaN elsewhere.

    Without drift it may take either variogram, whichever predicts better: a pooled one that was
    estimated from other layers' residuals may suit a layer that has nothing to do with any drift.
    Readings at one place are left out together, and count once: at the first of them.
    """
    known = np.isfinite(z)
    plain, drifted = (condition(fit.variogram, at[known], z[known]) for fit in (without, with_it))
    better = min((plain, drifted), key=lambda ok: leave_one_out(ok).rmse[0])
    errors = leave_one_out(better), leave_one_out_with(covariate, drifted)
    squares = np.full((2, len(z)), np.nan)
    for row, ok, left_out in zip(squares, (better, drifted), errors, strict=True):
        first = [np.flatnonzero((at == place).all(axis=1))[0] for place in ok.at]
        row[first] = left_out.residual[0] ** 2
    return squares


def _able(x: Floats, z: Floats) -> bool:
    """Whether a layer with samples at these values of the covariate can follow it."""
    known = np.isfinite(z)
    return known.sum() >= FEWEST_SAMPLES and bool(np.ptp(x[known]) > 0 and np.ptp(z[known]) > 0)


def residuals(x: Floats, z: Floats) -> Floats:
    """(n,) what is left of values after ordinary least squares on a covariate; NaN stays."""
    known = np.isfinite(z)
    away = x - x[known].mean()
    slope = away[known] @ z[known] / (away[known] @ away[known])
    return np.asarray(z - z[known].mean() - slope * away)
