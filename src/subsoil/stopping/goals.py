"""Goals: what the map has to show for a survey to be over.

A goal measures the map after every sample and says whether the measure meets it. The survey is
over when one goal was met by three updates running, the twelfth sample or a later one included:
a single fit may be lucky, and variograms of fewer samples say little.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite, nan
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from subsoil.errors import ParameterError
from subsoil.mapping.soilmap import SoilMap
from subsoil.mapping.uncertainty import (
    decided,
    mean_square_error,
    predicted_rmse,
    probability_above,
    standard_deviation,
)
from subsoil.stopping.limits import FEWEST

RUNNING = 3
"""Updates running by which a goal has to be met."""


@dataclass(frozen=True)
class TargetRmse:
    """The predicted RMSE, the root of the mean kriging variance, is at or below a target in kPa.

    About as often as not the error itself is then below the target; :class:`SureRmse` asks for
    more.

    Raises
    ------
    ParameterError
        If the target is not a positive number.
    """

    kpa: float
    kind: Literal["target-rmse"] = "target-rmse"

    def __post_init__(self) -> None:
        _require_positive(self.kpa, "target RMSE")

    def measure(self, soil_map: SoilMap, plan: Sequence[int]) -> float:  # noqa: ARG002 - a Goal
        """Predicted RMSE in kPa."""
        return predicted_rmse(soil_map)

    def met(self, measure: float) -> bool:
        """Whether a measure is good enough."""
        return measure <= self.kpa

    def words(self, measure: float) -> str:
        """Say what a measure is, beside what is asked for."""
        return f"predicted RMSE {measure:.1f} kPa, {self.kpa:g} kPa asked for"


@dataclass(frozen=True)
class SureRmse:
    """The RMSE is at or below a target in kPa with a probability.

    See :func:`subsoil.mapping.uncertainty.mean_square_error` for how that is known.

    Raises
    ------
    ParameterError
        If the target is not a positive number or the probability not between 0 and 1.
    """

    kpa: float
    probability: float
    kind: Literal["sure-rmse"] = "sure-rmse"

    def __post_init__(self) -> None:
        _require_positive(self.kpa, "target RMSE")
        _require_share(self.probability, "probability")

    def measure(self, soil_map: SoilMap, plan: Sequence[int]) -> float:  # noqa: ARG002 - a Goal
        """Probability that the RMSE is at or below the target."""
        return mean_square_error(soil_map).probability(self.kpa)

    def met(self, measure: float) -> bool:
        """Whether a measure is good enough."""
        return measure >= self.probability

    def words(self, measure: float) -> str:
        """Say what a measure is, beside what is asked for."""
        return (
            f"{100 * measure:.0f} % sure of an RMSE at or below {self.kpa:g} kPa, "
            f"{100 * self.probability:g} % asked for"
        )


@dataclass(frozen=True)
class DecidedShare:
    """Most of the field is known to be above or below a threshold.

    A place is above it where some layer is: roots that meet one pan are stopped. Layers without
    weight do not count. See :func:`subsoil.mapping.uncertainty.decided`.

    Parameters
    ----------
    threshold_kpa
        Soil strength in kPa; roots hardly grow beyond 2000.
    share
        Share of the cells that has to be decided.
    confidence
        Probability from which on a cell is.

    Raises
    ------
    ParameterError
        If the threshold is not a positive number, the share not in (0, 1], or the confidence not
        in (0.5, 1).
    """

    threshold_kpa: float
    share: float = 0.9
    confidence: float = 0.8
    kind: Literal["decided-share"] = "decided-share"

    def __post_init__(self) -> None:
        _require_positive(self.threshold_kpa, "threshold")
        if self.share != 1.0:
            _require_share(self.share, "decided")
        _require_share(self.confidence, "confidence")
        if self.confidence <= 0.5:
            raise ParameterError(
                f"a coin decides with {self.confidence:g}",
                where="confidence",
                remedy="more than 0.5",
            )

    def measure(self, soil_map: SoilMap, plan: Sequence[int]) -> float:  # noqa: ARG002 - a Goal
        """Share of the cells that is decided."""
        counts = np.asarray(soil_map.layers.weights) > 0
        above = probability_above(
            soil_map.mean[counts], standard_deviation(soil_map.variance[counts]), self.threshold_kpa
        )
        return float(decided(above, self.confidence).mean())

    def met(self, measure: float) -> bool:
        """Whether a measure is good enough."""
        return measure >= self.share

    def words(self, measure: float) -> str:
        """Say what a measure is, beside what is asked for."""
        return (
            f"{100 * measure:.0f} % of the area decided at {self.threshold_kpa:g} kPa with "
            f"{100 * self.confidence:g} % confidence, {100 * self.share:g} % asked for"
        )


@dataclass(frozen=True)
class LeastGain:
    """The next stop is not worth it: it would lower the predicted RMSE by less than this, in kPa.

    The gain is that of the next planned stop under the present variograms, exactly, and not what
    the last samples brought: that jumps with every fit.

    Raises
    ------
    ParameterError
        If the least gain is not a positive number.
    """

    kpa: float
    kind: Literal["least-gain"] = "least-gain"

    def __post_init__(self) -> None:
        _require_positive(self.kpa, "least gain")

    def measure(self, soil_map: SoilMap, plan: Sequence[int]) -> float:
        """Gain of the next planned stop in kPa; NaN if none is planned."""
        if not plan:
            return nan
        after = soil_map.field_kv - float(soil_map.kv_drop(plan[:1]).mean())
        return predicted_rmse(soil_map) - float(standard_deviation(after))

    def met(self, measure: float) -> bool:
        """Whether a measure is small enough to stop."""
        return measure < self.kpa

    def words(self, measure: float) -> str:
        """Say what a measure is, beside what is asked for."""
        return (
            f"the next sample would lower the predicted RMSE by {measure:.2g} kPa, "
            f"less than {self.kpa:g} kPa is not worth it"
        )


Goal = TargetRmse | SureRmse | DecidedShare | LeastGain


@dataclass(frozen=True)
class GoalProgress:
    """How goals stand: their last measures, and how many updates running each was met.

    Attributes
    ----------
    samples
        Samples behind the measures; 0 while there are none.
    measures
        One a goal.
    running
        (goals,) updates running that met each.

    Examples
    --------
    >>> goals, progress = (TargetRmse(40.0),), GoalProgress()
    >>> for samples, rmse in ((10, 39.0), (11, 38.0), (12, 36.0)):
    ...     progress = progress.updated(goals, samples, (rmse,))
    >>> progress.reached(goals)
    'predicted RMSE 36.0 kPa, 40 kPa asked for, 3 updates running'
    """

    samples: int = 0
    measures: tuple[float, ...] = ()
    running: tuple[int, ...] = ()

    def updated(
        self, goals: Sequence[Goal], samples: int, measures: tuple[float, ...]
    ) -> GoalProgress:
        """Progress after an update; a second look at the same samples changes nothing."""
        if samples == self.samples or len(measures) != len(goals):
            return self
        before = self.running or (0,) * len(goals)
        running = tuple(
            count + 1 if goal.met(measure) else 0
            for goal, measure, count in zip(goals, measures, before, strict=True)
        )
        return GoalProgress(samples, measures, running)

    def reached(self, goals: Sequence[Goal]) -> str:
        """Why to stop now; empty to go on. Of several goals met the first says why."""
        if self.samples < FEWEST:
            return ""
        for goal, measure, running in zip(goals, self.measures, self.running, strict=False):
            if running >= RUNNING:
                return f"{goal.words(measure)}, {RUNNING} updates running"
        return ""


def first_stop(predicted: ArrayLike, samples: ArrayLike, target: float) -> int:
    """Update at which :class:`TargetRmse` ends a survey of so many samples at each update.

    Parameters
    ----------
    predicted
        (k,) predicted RMSE in kPa at each update; NaN is not good enough.
    samples
        (k,) samples at each update.
    target
        Target in kPa.

    Returns
    -------
    int
        Index into the updates; k if the target is not reached by then.

    Examples
    --------
    >>> first_stop([50, 39, 41, 38, 37, 36], samples=[11, 12, 13, 14, 15, 16], target=40.0)
    5
    """
    goals, progress = (TargetRmse(target),), GoalProgress()
    rmse, count = np.asarray(predicted, dtype=float), np.asarray(samples, dtype=np.int64)
    for update, (error, n) in enumerate(zip(rmse.tolist(), count.tolist(), strict=True)):
        progress = progress.updated(goals, n, (error,))
        if progress.reached(goals):
            return update
    return len(rmse)


def _require_positive(value: float, where: str) -> None:
    if not (isfinite(value) and value > 0):
        raise ParameterError(f"must be greater than zero, not {value:g}", where=where)


def _require_share(value: float, where: str) -> None:
    if not 0 < value < 1:
        raise ParameterError(f"must be between 0 and 1, not {value:g}", where=where)
