"""What every map is made of: readings kriged at fixed places, whatever the kriging."""

from __future__ import annotations

from typing import Protocol, Self

from numpy.typing import ArrayLike

from subsoil.arrays import Floats, Indices
from subsoil.kriging.leave_one_out import LeaveOneOut
from subsoil.kriging.prediction import Prediction
from subsoil.variogram import Variogram


class Kriged(Protocol):
    """Readings of m layers kriged at N targets: a value, closed under further readings.

    Every answer is of the same model: what the mean follows, and what a reading tells, is in all of
    them. Variances are of g models, one for all layers or one a layer.
    """

    @property
    def at(self) -> Floats:
        """(n, 2) distinct places of the readings in m."""

    @property
    def targets(self) -> Floats:
        """(N, 2) places kriged at in m."""

    @property
    def variograms(self) -> tuple[Variogram, ...]:
        """The g models kriged with."""

    @property
    def prediction(self) -> Prediction:
        """Mean and variance, (N,) or (m, N)."""

    def append(self, at: ArrayLike, z: ArrayLike, *, error_variance: ArrayLike = 0.0) -> Self:
        """Krige from further readings as well; the same as from all at once."""

    def at_targets(self, targets: ArrayLike) -> Self:
        """Krige from the same readings at (k, 2) other targets in m."""

    def error_covariance(self, rows: Indices, columns: Indices | slice = slice(None)) -> Floats:
        """(g, k, l) covariance of the kriging errors of k targets with those of l."""

    def variance_drop(self, candidates: ArrayLike) -> Floats:
        """By how much the variance falls everywhere if one of k targets were probed next.

        (k, N), or (m, k, N) for layers.
        """

    def leave_one_out(self) -> LeaveOneOut:
        """Each reading predicted from the others under the same models."""
