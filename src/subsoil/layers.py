"""Depth layers, and what a push says about each of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import IntEnum
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from subsoil.arrays import Floats
from subsoil.errors import ParameterError
from subsoil.penetrometer import Profile

_THINNEST_M = 0.001
_TOUCH_M = 1e-9
"""Less soil than this is none."""


class LayerState(IntEnum):
    """What a sample knows of a layer.

    A layer that was not reached is neither missing at random nor zero: the push ended above it.
    """

    MEASURED = 0
    """The push went through the whole layer; its value is the mean resistance."""
    AT_LEAST = 1
    """The force limit ended the push inside the layer; its value is a lower bound."""
    UNREACHED = 2
    """The push ended above the layer; it has no value (NaN)."""


@dataclass(frozen=True)
class Sample:
    """Soil strength by layer at one place.

    Attributes
    ----------
    at
        Easting and northing in m.
    kpa
        (m,) layer means in kPa; a lower bound where the state says so, NaN where unreached.
    state
        (m,) :class:`LayerState` of each layer.
    error_variance
        Variance of the reading around the soil's own value in kPa2, beyond the nugget.
    """

    at: tuple[float, float]
    kpa: Floats
    state: NDArray[np.int8]
    error_variance: float = 0.0

    def __post_init__(self) -> None:
        for array in (self.kpa, self.state):
            array.setflags(write=False)

    @cached_property
    def measured_kpa(self) -> Floats:
        """(m,) layer means, NaN for every layer that was not measured through."""
        measured = np.where(self.state == LayerState.MEASURED, self.kpa, np.nan)
        measured.setflags(write=False)
        return measured


@dataclass(frozen=True)
class Layers:
    """Bands of depth, top first.

    Parameters
    ----------
    edges_m
        (m + 1,) increasing depths in m of the bands' edges. Default: eight bands of 5 cm down to
        0.40 m, as in the paper.
    weights
        (m,) importance of each layer in the field's mean kriging variance; they are scaled to sum
        to one. Default: all the same, as in the paper.

    Raises
    ------
    ParameterError
        If edges do not increase from 0 or deeper by a millimetre or more, or weights are negative,
        all zero or of another number than the layers.

    Examples
    --------
    >>> Layers((0.0, 0.1, 0.3)).names
    ('0.00-0.10 m', '0.10-0.30 m')
    """

    edges_m: tuple[float, ...] = tuple(round(0.05 * k, 2) for k in range(9))
    weights: tuple[float, ...] = field(default=())

    def __post_init__(self) -> None:
        edges = np.asarray(self.edges_m, dtype=float)
        if edges.size < 2 or not np.all(np.isfinite(edges)) or edges[0] < 0:
            raise ParameterError(
                "layers need at least two finite edges, from the surface down",
                where="layer edges",
                remedy="for instance 0, 0.1, 0.2, 0.4 (metres)",
            )
        thickness = np.diff(edges)
        if np.any(thickness <= 0):
            k = int(np.argmax(thickness <= 0))
            raise ParameterError(
                f"edges do not increase: {edges[k + 1]:g} m comes after {edges[k]:g} m",
                where="layer edges",
                remedy="give them in metres, positive down, shallowest first",
            )
        if np.any(thickness < _THINNEST_M - _TOUCH_M):
            raise ParameterError(
                f"a layer is {thickness.min():.3g} m thick, thinner than any reading can tell",
                where="layer edges",
                remedy="give edges in metres, a millimetre or more apart",
            )
        if edges[-1] > 3:
            raise ParameterError(
                f"the deepest edge is {edges[-1]:g} m",
                where="layer edges",
                remedy="edges are in metres, not centimetres",
            )
        object.__setattr__(self, "edges_m", tuple(edges.tolist()))
        weights = np.asarray(self.weights or (1.0,) * (edges.size - 1), dtype=float)
        usable = np.all(np.isfinite(weights) & (weights >= 0)) and weights.sum() > 0
        if weights.size != edges.size - 1 or not usable:
            raise ParameterError(
                f"{edges.size - 1} layers need as many finite weights, none negative, not all zero",
                where="layer weights",
            )
        object.__setattr__(self, "weights", tuple((weights / weights.sum()).tolist()))

    def __len__(self) -> int:
        return len(self.edges_m) - 1

    @property
    def top_m(self) -> Floats:
        """(m,) upper edges in m."""
        return np.array(self.edges_m[:-1])

    @property
    def bottom_m(self) -> Floats:
        """(m,) lower edges in m."""
        return np.array(self.edges_m[1:])

    @property
    def centre_m(self) -> Floats:
        """(m,) centres in m."""
        return (self.top_m + self.bottom_m) / 2

    @property
    def names(self) -> tuple[str, ...]:
        """One name a layer, such as ``"0.15-0.20 m"``."""
        digits = 2 if np.allclose(self.edges_m, np.round(self.edges_m, 2), atol=1e-9) else 3
        pairs = zip(self.edges_m[:-1], self.edges_m[1:], strict=True)
        return tuple(f"{top:.{digits}f}-{bottom:.{digits}f} m" for top, bottom in pairs)

    def sample(
        self, profile: Profile, at: Sequence[float], *, error_variance: float = 0.0
    ) -> Sample:
        """Mean of a profile over each layer.

        A reading stands for the soil since its top, which is the reading above it as a rule, and
        weighs in a layer by how much of the layer that is. A layer is measured when the readings
        reach its lower edge to within half their spacing, a rest below them does not count, and
        no more than half of it lies in gaps between them. Where the force limit ended the push
        inside a layer, the rest of that layer counts with the last reading and the mean is a lower
        bound.

        Parameters
        ----------
        profile
            Soil strength by depth.
        at
            Easting and northing in m.
        error_variance
            Variance of the reading beyond the nugget, in kPa2.
        """
        depth, kpa = profile.depth_m, profile.kpa
        spacing = float(np.median(np.diff(depth))) if depth.size > 1 else 0.0
        end = depth[-1] if depth.size else 0.0
        share = self._shares(profile)
        covered = share.sum(axis=1)
        reached = covered > _TOUCH_M
        gaps = np.minimum(self.bottom_m, end) - self.top_m - covered
        reached &= gaps <= (self.bottom_m - self.top_m) / 2 + _TOUCH_M
        through = reached & (end >= self.bottom_m - spacing / 2 - _TOUCH_M)
        bound = reached & ~through & (profile.ending == "force")
        share[bound, -1:] += (self.bottom_m - end)[bound, None]
        known = through | bound
        values = np.full(len(self), np.nan)
        values[known] = share[known] @ kpa / share[known].sum(axis=1)
        state = np.full(len(self), LayerState.UNREACHED, dtype=np.int8)
        state[through], state[bound] = LayerState.MEASURED, LayerState.AT_LEAST
        return Sample((float(at[0]), float(at[1])), values, state, error_variance)

    def _shares(self, profile: Profile) -> Floats:
        """(m, k) metres of every layer that k readings stand for."""
        lower = np.minimum(self.bottom_m[:, None], profile.depth_m)
        upper = np.maximum(self.top_m[:, None], profile.top_m)
        shares: Floats = np.maximum(lower - upper, 0.0)
        return shares
