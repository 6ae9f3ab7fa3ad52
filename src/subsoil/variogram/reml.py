"""Restricted maximum likelihood: the correlogram of each layer that its readings fit best.

A maximum and not a mean: with a dozen or two samples it is mostly chance, so the outcome says how
far the range could be from it, and :class:`~subsoil.variogram.pooled.Pooled` is the better guess.
With a hundred it is the classic answer (Patterson & Thompson 1971, Biometrika 58, 545; Diggle &
Ribeiro, *Model-based Geostatistics*, 2007, sec. 5.4), and needs no bins.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import exp, inf, isclose, log

import numpy as np
import scipy
from threadpoolctl import threadpool_limits

from subsoil.arrays import Floats
from subsoil.errors import ParameterError
from subsoil.variogram.empirical import EmpiricalVariogram, empirical_layers
from subsoil.variogram.fitting import Fit
from subsoil.variogram.likelihood import blocks, lags_of, restricted
from subsoil.variogram.models import Bounded, Exponential
from subsoil.variogram.pooled import Pooled
from subsoil.variogram.reach import by_reach

FEWEST_SAMPLES = 8
"""Samples of a layer below which two parameters are not fitted."""
_FEWEST_PLACES = 3
_RANGES, _SHARES = 20, 9
"""Of the grid that is searched before the polish."""
_LEAST_SHARE, _MOST_SHARE = 1e-3, 1.0 - 1e-3
"""Of the nugget in the sill: with none, a smooth model of close readings is singular."""
_HALF_CHI2 = 1.920729410347062
"""Half the 95 % point of chi-square with one degree of freedom: how far the profile falls."""


@dataclass(frozen=True)
class Reml:
    """An :data:`~subsoil.variogram.estimators.Estimator`: restricted maximum likelihood.

    Range and share of the nugget maximise the likelihood of each layer's samples, with mean and
    sill profiled out; the range lies between the shortest and the longest distance of two samples.
    Above a hundred samples the likelihood is taken by compact blocks of at most a hundred. A layer
    with fewer than eight samples, at fewer than three places, or whose values do not differ, gets
    the pooled correlogram of all layers instead.

    Parameters
    ----------
    model
        Kind of model.
    median_range, log_sd
        Log-normal prior of the range, in m; flat by default.
    nugget_beta
        Parameters of a beta prior of the nugget's share in the sill; flat by default.

    Raises
    ------
    ParameterError
        If a setting is outside what it may be.

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> at = rng.uniform(0, 150, (60, 2))
    >>> (fit,) = Reml()(at, 900 + 90 * np.sin(at[:, 0] / 25)[None] + rng.normal(0, 20, (1, 60)))
    >>> fit.is_prior, fit.variogram.range > 50
    (False, True)
    >>> fit.why.split(";")[0]
    'restricted maximum likelihood of 60 samples, log -74.9'
    """

    model: type[Bounded] = Exponential
    median_range: float = 45.0
    log_sd: float = inf
    nugget_beta: tuple[float, float] = (1.0, 1.0)

    def __post_init__(self) -> None:
        for ok, what in (
            (self.model.valid_dims >= 2, "a model that is not valid in the plane"),
            (0 < self.median_range < inf, f"a prior range of {self.median_range:g} m"),
            (self.log_sd > 0, f"a log SD of {self.log_sd:g}"),
            (
                len(self.nugget_beta) == 2 and all(1 <= b < inf for b in self.nugget_beta),
                f"a beta prior of {self.nugget_beta}, which has no bounded density",
            ),
        ):
            if not ok:
                raise ParameterError(
                    f"restricted maximum likelihood has {what}",
                    where="estimator reml",
                    remedy="see subsoil.variogram.reml.Reml for what each setting may be",
                )

    def __call__(self, at: Floats, z: Floats) -> tuple[Fit, ...]:
        """Fit each layer of values (m, n) at places (n, 2), NaN where not measured."""
        lacks = [_lack(at, layer) for layer in z]
        pooled = Pooled()(at, z) if any(lacks) else ()
        telling = np.flatnonzero([not lack for lack in lacks])
        found: dict[int, _Maximum] = {}
        with threadpool_limits(1, user_api="blas"):
            for reached, alike in by_reach(z[telling]):
                layers = telling[alike]
                maxima = self._maxima(at[reached], z[np.ix_(layers, reached)])
                found.update(zip(layers.tolist(), maxima, strict=True))
        return tuple(
            self._fit(found[k], curve)
            if k in found
            else replace(pooled[k], why=f"{lacks[k]}: {pooled[k].why}")
            for k, curve in enumerate(empirical_layers(at, z))
        )

    def _fit(self, found: _Maximum, curve: EmpiricalVariogram) -> Fit:
        nugget = found.share * found.sill
        return Fit(
            variogram=self.model(nugget, found.range, found.sill - nugget),
            empirical=curve,
            is_prior=False,
            why=str(found),
            at_bound=found.at_bound,
        )

    def _maxima(self, at: Floats, z: Floats) -> list[_Maximum]:
        """Maxima of (m, n) values that are all known, one a layer."""
        parts = [(lags_of(at[block]), z[:, block]) for block in blocks(at)]
        ranges = np.geomspace(*_reach(at), _RANGES)
        shares = np.tile(np.linspace(_LEAST_SHARE, _MOST_SHARE, _SHARES), (_RANGES, 1))
        grid = self._on(parts, np.repeat(ranges, _SHARES), shares.ravel())
        return [
            self._maximum(
                [(lag, values[k : k + 1]) for lag, values in parts],
                (at, z[k : k + 1]),
                ranges,
                grid[:, k].reshape(_RANGES, _SHARES),
            )
            for k in range(len(z))
        ]

    def _maximum(self, parts: list[Part], whole: Samples, ranges: Floats, grid: Floats) -> _Maximum:
        """Polish the peaks of the grid of one layer, and follow the profile of its range."""
        from scipy.optimize import minimize  # slow to import, and rarely needed

        shares = np.linspace(_LEAST_SHARE, _MOST_SHARE, _SHARES)[grid.argmax(axis=1)]
        bounds = [(log(ranges[0]), log(ranges[-1])), (_LEAST_SHARE, _MOST_SHARE)]

        def loss(at: Floats) -> float:
            return -float(self._on(parts, np.exp(at[:1]), at[1:])[0, 0])

        done = min(
            (
                minimize(loss, [log(ranges[k]), shares[k]], method="L-BFGS-B", bounds=bounds)
                for k in _peaks(grid.max(axis=1))
            ),
            key=lambda result: float(result.fun),
        )
        reach, share = float(np.clip(exp(done.x[0]), ranges[0], ranges[-1])), float(done.x[1])
        at, z = whole
        correlation = _correlation(self.model, lags_of(at), np.array([reach]), np.array([share]))
        squares = restricted(correlation, z).squares[0, 0]
        profile = self._profile(parts, ranges, shares)
        return _Maximum(
            samples=len(at),
            range=reach,
            share=share,
            sill=float(squares) / (len(at) - 1),
            log=-float(done.fun),
            interval=_interval(ranges, profile, reach, -float(done.fun)),
            bounds=(float(ranges[0]), float(ranges[-1])),
        )

    def _profile(self, parts: list[Part], ranges: Floats, shares: Floats) -> Floats:
        """(b,) greatest log likelihood of each range, its (b,) best share on the grid refined."""
        step = (_MOST_SHARE - _LEAST_SHARE) / (_SHARES - 1)
        finer = shares[:, None] + np.linspace(-step, step, _SHARES)
        finer = np.clip(finer, _LEAST_SHARE, _MOST_SHARE)
        log_likelihood = self._on(parts, np.repeat(ranges, _SHARES), finer.ravel())
        return np.asarray(log_likelihood.reshape(len(ranges), _SHARES).max(axis=1))

    def _on(self, parts: list[Part], ranges: Floats, shares: Floats) -> Floats:
        """(k, m) log likelihood of k ranges with their nugget shares, prior included."""
        away = (np.log(ranges) - log(self.median_range)) / self.log_sd
        first, second = self.nugget_beta
        prior = (
            -0.5 * away**2
            + scipy.special.xlogy(first - 1.0, shares)
            + scipy.special.xlog1py(second - 1.0, -shares)
        )
        total = np.repeat(prior[:, None], len(parts[0][1]), axis=1)
        for lag, z in parts:
            differ = np.ptp(z, axis=1) > 0
            if differ.any():
                correlation = _correlation(self.model, lag, ranges, shares)
                total[:, differ] += restricted(correlation, z[differ]).log
        return total


Part = tuple[Floats, Floats]
"""Distances (n, n) in m between some readings, and their values (m, n)."""
Samples = tuple[Floats, Floats]
"""Places (n, 2) in m of readings, and their values (m, n)."""


@dataclass(frozen=True)
class _Maximum:
    """What a layer's readings fit best."""

    samples: int
    range: float
    share: float
    sill: float
    log: float
    interval: tuple[float, float]
    bounds: tuple[float, float]

    @property
    def at_bound(self) -> tuple[str, ...]:
        on = {
            "nugget": isclose(self.share, _LEAST_SHARE, rel_tol=1e-3),
            "range": any(isclose(self.range, bound, rel_tol=1e-3) for bound in self.bounds),
            "psill": isclose(self.share, _MOST_SHARE, rel_tol=1e-6),
        }
        return tuple(name for name, hit in on.items() if hit)

    def __str__(self) -> str:
        low, high = self.interval
        known = {
            (False, False): f"95 % between {low:.0f} and {high:.0f} m",
            (True, False): f"95 % up to {high:.0f} m",
            (False, True): f"95 % from {low:.0f} m",
            (True, True): "95 % anywhere",
        }[low == 0, high == inf]
        hit = f"; on the bound of {' and '.join(self.at_bound)}" if self.at_bound else ""
        return (
            f"restricted maximum likelihood of {self.samples} samples, log {self.log:.1f}; "
            f"range {self.range:.0f} m, {known}{hit}"
        )


def _reach(at: Floats) -> tuple[float, float]:
    """Shortest distance in m of two of (n, 2) places that differ, and the longest."""
    lag = lags_of(at)
    return float(lag.min(where=lag > 0, initial=inf)), float(lag.max())


def _peaks(profile: Floats) -> list[int]:
    """Where a profile is no lower than beside, the three highest of these."""
    padded = np.concatenate([[-inf], profile, [-inf]])
    peaks = np.flatnonzero((profile >= padded[:-2]) & (profile >= padded[2:]))
    return sorted(peaks.tolist(), key=lambda k: -float(profile[k]))[:3]


def _correlation(model: type[Bounded], lag: Floats, ranges: Floats, shares: Floats) -> Floats:
    """(k, n, n) correlations of readings, nugget included, at (n, n) lags."""
    rho = model.correlation(lag / ranges[:, None, None])
    rho *= 1.0 - shares[:, None, None]
    np.einsum("kii->ki", rho)[:] += shares[:, None]
    return rho


def _interval(ranges: Floats, profile: Floats, best: float, top: float) -> tuple[float, float]:
    """Ranges around the best at which the profile is not clearly lower, by interpolation.

    0 below and infinity above where it never falls that far within the bounds.
    """
    order = np.argsort([*ranges, best], kind="stable")
    reach = np.log([*ranges, best])[order]
    below = top - _HALF_CHI2 - np.array([*profile, top])[order]
    middle = int(np.flatnonzero(order == len(ranges))[0])
    ends = []
    for side, open_end in ((slice(middle, None, -1), 0.0), (slice(middle, None), inf)):
        depth, places = below[side], reach[side]
        out = np.flatnonzero(depth > 0)
        if not out.size:
            ends.append(open_end)
            continue
        k = int(out[0])
        part = depth[k - 1] / (depth[k - 1] - depth[k])
        ends.append(exp(places[k - 1] + part * (places[k] - places[k - 1])))
    return ends[0], ends[1]


def _lack(at: Floats, z: Floats) -> str:
    """Why a layer is not fitted; empty if it is."""
    known = np.isfinite(z)
    if known.sum() < FEWEST_SAMPLES:
        return f"{known.sum()} sample{'' if known.sum() == 1 else 's'} only"
    if len(np.unique(at[known], axis=0)) < _FEWEST_PLACES:
        return f"fewer than {_FEWEST_PLACES} places"
    return "" if np.ptp(z[known]) > 0 else "no pair of values differs"
