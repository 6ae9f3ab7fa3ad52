"""The pooled posterior-mean correlogram: one shape for all layers, averaged and not fitted.

With a dozen or two samples the data single out no variogram: the best fit to them is mostly
chance. Here every correlogram of a grid is weighted by how likely it makes the readings of all
layers together and how plausible it is beforehand, and kriging takes the weighted mean of them
all (Bayesian kriging by model averaging; Handcock & Stein 1993, Technometrics 35, 403, and Diggle
& Ribeiro, *Model-based Geostatistics*, 2007, ch. 7, for sills and means that are integrated or
profiled out). A mixture of valid correlograms is valid. Layers keep a sill each.

Layers are not independent witnesses: their joint log likelihood counts for as many layers as the
eigenvalues of their correlation say there are.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from math import inf

import numpy as np
from threadpoolctl import threadpool_limits

from subsoil.arrays import Bools, Floats
from subsoil.errors import ParameterError
from subsoil.variogram.empirical import empirical_layers
from subsoil.variogram.fitting import Fit
from subsoil.variogram.layer_correlation import independent_layers
from subsoil.variogram.likelihood import blocks, lags_of, restricted
from subsoil.variogram.models import Bounded, Exponential, Gaussian, Matern32
from subsoil.variogram.nested import Nested
from subsoil.variogram.posterior import Posterior
from subsoil.variogram.reach import by_reach

FEWEST_SAMPLES = 3
"""Samples of a layer below which it says nothing of the correlogram."""
EXTENT_M = 222.0
"""Diagonal in m of the field that the ranges are those of as they stand, one of 2.3 ha."""


@dataclass(frozen=True)
class Pooled:
    """An :data:`~subsoil.variogram.estimators.Estimator`: the pooled posterior-mean correlogram.

    A layer's samples are those that reached it: a layer of fewer samples has a likelihood of its
    own samples, under the same correlograms. Above a hundred samples the likelihood is taken by
    compact blocks of at most a hundred.

    Parameters
    ----------
    kinds
        Kinds of model, equally plausible beforehand.
    shortest_range, longest_range, ranges
        Geometric grid of practical ranges in m.
    median_range, log_sd
        Prior of the range: log-normal with this median in m and this SD of its logarithm.
    nugget_shares, nugget_weights
        Grid of the nugget's share in the sill, and its prior.
    prior_sill
        Sill in squared units of the data where no layer tells one.

    Raises
    ------
    ParameterError
        If a setting is outside what it may be, or the prior range outside its grid.

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> at = rng.uniform(0, 150, (40, 2))
    >>> waves = np.stack([np.sin(at[:, 0] / 25), np.cos(at[:, 1] / 25)])
    >>> first, second = Pooled()(at, 1500 + 300 * waves)
    >>> first.variogram.structures == second.variogram.structures
    True
    >>> Pooled().posterior(at, waves).range_at(0.5) > 60
    True
    """

    kinds: tuple[type[Bounded], ...] = (Exponential, Matern32, Gaussian)
    shortest_range: float = 12.0
    longest_range: float = 160.0
    ranges: int = 12
    median_range: float = 45.0
    log_sd: float = 0.6
    nugget_shares: tuple[float, ...] = (0.001, 0.05, 0.15, 0.3, 0.5, 0.75)
    nugget_weights: tuple[float, ...] = (0.2, 0.2, 0.2, 0.2, 0.14, 0.06)
    prior_sill: float = 1.0

    def __post_init__(self) -> None:
        for ok, what in (
            (self.kinds, "no kind of model"),
            (all(k.valid_dims >= 2 for k in self.kinds), "a kind not valid in the plane"),
            (0 < self.shortest_range <= self.longest_range < inf, "a grid of ranges without any"),
            (self.ranges >= 1, f"{self.ranges} ranges"),
            (
                self.shortest_range <= self.median_range <= self.longest_range,
                f"a prior range of {self.median_range:g} m outside "
                f"{self.shortest_range:g}-{self.longest_range:g} m",
            ),
            (0 < self.log_sd < inf, f"a log SD of {self.log_sd:g}"),
            (all(0 < s < 1 for s in self.nugget_shares), "a nugget share not between 0 and 1"),
            (
                len(self.nugget_weights) == len(self.nugget_shares) > 0
                and min(self.nugget_weights) >= 0 < sum(self.nugget_weights),
                "not one weight a nugget share",
            ),
            (0 < self.prior_sill < inf, f"a prior sill of {self.prior_sill:g}"),
        ):
            if not ok:
                raise ParameterError(
                    f"the pooled correlogram has {what}",
                    where="estimator pmc",
                    remedy="see subsoil.variogram.Pooled for what each setting may be",
                )

    def scaled_to(self, extent_m: float) -> Pooled:
        """Return the same with ranges in proportion to a field's diagonal in m.

        As they stand they are those of a field of 2.3 ha, 222 m from corner to corner.
        """
        scale = extent_m / EXTENT_M
        return replace(
            self,
            shortest_range=self.shortest_range * scale,
            longest_range=self.longest_range * scale,
            median_range=self.median_range * scale,
        )

    def __call__(self, at: Floats, z: Floats) -> tuple[Fit, ...]:
        """Weight the correlograms by values (m, n) at places (n, 2); one fit a layer."""
        posterior = self.posterior(at, z)
        sills = self._sills(posterior, at, z)
        known = sills[np.isfinite(sills)]
        usual = float(known.mean()) if known.size else self.prior_sill
        curves = empirical_layers(at, z)
        return tuple(
            Fit(
                variogram=Nested(sill if np.isfinite(sill) else usual, posterior.structures),
                empirical=curve,
                is_prior=not (posterior.layers and np.isfinite(sill)),
                why=_why(posterior, int(np.isfinite(layer).sum()), sill, known.size),
            )
            for curve, layer, sill in zip(curves, z, sills.tolist(), strict=True)
        )

    def posterior(self, at: Floats, z: Floats) -> Posterior:
        """Probabilities of the correlograms, given values (m, n), NaN where not measured."""
        log, layers = self._log_prior, 0.0
        tells = _telling(z)
        if tells.any():
            layers = independent_layers(z[tells])
            with threadpool_limits(1, user_api="blas"):
                log = log + layers / tells.sum() * self._log_likelihood(at, z[tells])
        weights = np.exp(log - log.max())
        return Posterior(
            self.kinds, self._ranges, self.nugget_shares, weights / weights.sum(), layers
        )

    @cached_property
    def _ranges(self) -> tuple[float, ...]:
        ranges = np.geomspace(self.shortest_range, self.longest_range, self.ranges)
        return tuple(ranges.tolist())

    @cached_property
    def _log_prior(self) -> Floats:
        """(a, b, c) log prior of the grid."""
        away = (np.log(self._ranges) - np.log(self.median_range)) / self.log_sd
        nugget = np.array(self.nugget_weights) / sum(self.nugget_weights)
        with np.errstate(divide="ignore"):
            log: Floats = -0.5 * away[:, None] ** 2 + np.log(nugget)
        return np.tile(log, (len(self.kinds), 1, 1))

    def _log_likelihood(self, at: Floats, z: Floats) -> Floats:
        """(a, b, c) log likelihood of the grid, summed over layers."""
        total = np.zeros((len(self.kinds), self.ranges, len(self.nugget_shares)))
        for reached, layers in by_reach(z):
            here = np.flatnonzero(reached)
            for block in blocks(at[here]):
                members = here[block]
                total += self._of_block(at[members], z[np.ix_(layers, members)])
        return total

    def _of_block(self, at: Floats, z: Floats) -> Floats:
        """(a, b, c) log likelihood of readings that reached all of some layers."""
        z = z[np.ptp(z, axis=1) > 0]
        lag = lags_of(at)
        scaled = lag / np.array(self._ranges)[:, None, None]
        rho = np.stack([kind.correlation(scaled) for kind in self.kinds])
        share = np.array(self.nugget_shares)[:, None, None]
        correlation = (1.0 - share) * rho[:, :, None] + share * np.eye(len(at))
        found = restricted(correlation.reshape(-1, len(at), len(at)), z)
        shape = len(self.kinds), self.ranges, len(self.nugget_shares)
        return np.reshape(found.log.sum(axis=1), shape)

    def _sills(self, posterior: Posterior, at: Floats, z: Floats) -> Floats:
        """(m,) sill of each layer under the mean correlogram; NaN where samples tell none.

        SS / (n - 3), the mean of the sill's posterior with n - 1 degrees of freedom and the
        variance of the Student t that predictions then follow (Kitanidis 1986, Water Resour. Res.
        22, 499): not SS / (n - 1), its unbiased estimate, which knows nothing of its own error.
        With four samples or fewer there is no such mean, and SS stands for it.
        """
        sills = np.full(len(z), np.nan)
        shape = Nested(1.0, posterior.structures)
        for reached, layers in by_reach(z):
            values = z[np.ix_(layers, np.flatnonzero(reached))]
            differ = np.ptp(values, axis=1) > 0
            if differ.any():
                correlation = shape.correlation(lags_of(at[reached]))
                np.fill_diagonal(correlation, 1.0)
                squares = restricted(correlation[None], values[differ]).squares[0]
                sills[layers[differ]] = squares / max(values.shape[1] - 3, 1)
        return sills


def _telling(z: Floats) -> Bools:
    """(m,) layers whose samples say something of the correlogram: some, and they differ."""
    known = [layer[np.isfinite(layer)] for layer in z]
    return np.array([k.size >= FEWEST_SAMPLES and np.ptp(k) > 0 for k in known])


def _why(posterior: Posterior, samples: int, sill: float, known: int) -> str:
    """How a layer's model was come by, in a sentence."""
    base = "posterior mean" if posterior.layers else "prior mean"
    of = (
        ""
        if np.isfinite(sill)
        else f"; {samples} samples tell no sill: "
        + ("that of the other layers, a guess" if known else "an assumed one")
    )
    return f"pooled {base} of the correlogram: {posterior}{of}"
