"""How to survey a field: by which methods, and when it is enough."""

from __future__ import annotations

from math import inf
from typing import Annotated

import numpy as np
from pydantic import Field

from subsoil.errors import ParameterError
from subsoil.land.field import Field as Land
from subsoil.mapping.drift_choice import DriftRule
from subsoil.reports import Place, Plain
from subsoil.stopping import Goal, Limits, Pace, Rates

DEFAULT_STRATEGY = "joint-adaptive"
DEFAULT_ESTIMATOR = "pmc"


class Settings(Plain):
    """How to survey.

    Attributes
    ----------
    start
        Where agents enter the field, easting and northing in m.
    strategy, strategy_settings
        Where to probe: a strategy by name, and parameters of it.
    estimator, estimator_settings
        How variograms are estimated.
    refit_every
        Samples between estimates, once there are a dozen.
    seed
        Seed of the strategy's chance.
    samples, metres, minutes, mean_kv, money, rates
        What the survey may cost: see :class:`subsoil.stopping.Limits`.
    pace
        How fast stops are made.
    goals
        What the map has to show.
    drift
        When a layer follows the covariate.
    """

    start: Place
    strategy: str = DEFAULT_STRATEGY
    strategy_settings: dict[str, float | str] = Field(default_factory=dict)
    estimator: str = DEFAULT_ESTIMATOR
    estimator_settings: dict[str, float] = Field(default_factory=dict)
    refit_every: int = Field(default=1, ge=1)
    seed: int = Field(default=0, ge=0)
    samples: int = 30
    metres: float = inf
    minutes: float = inf
    mean_kv: float = 0.0
    money: float = inf
    rates: Rates = Field(default_factory=Rates)
    pace: Pace = Field(default_factory=Pace)
    goals: tuple[Annotated[Goal, Field(discriminator="kind")], ...] = ()
    drift: DriftRule = "auto"

    @property
    def limits(self) -> Limits:
        """What the survey may cost."""
        return Limits(self.samples, self.metres, self.minutes, self.mean_kv, self.money, self.rates)


def checked(settings: Settings, field: Land) -> Settings:
    """Settings that let a survey of a field begin.

    Raises
    ------
    ParameterError
        If there are fewer cells than samples, a limit is impossible, or too little for the stop
        nearest to the start.
    """
    if settings.samples > len(field.cells):
        raise ParameterError(
            f"{settings.samples} samples are more than the field's {len(field.cells)} cells",
            where="--samples",
            remedy="take fewer, or start a survey with smaller cells",
        )
    limits = settings.limits
    nearest = float(np.hypot(*(field.cells - settings.start).T).min())
    minutes = settings.pace.minutes(nearest, 1)
    if nearest > limits.metres:
        raise ParameterError(
            f"{limits.metres:g} m do not reach the nearest cell, {nearest:.1f} m away",
            where="--metres",
        )
    if minutes > limits.minutes:
        raise ParameterError(
            f"{limits.minutes:g} min are too few for one stop, which takes {minutes:.1f}",
            where="--minutes",
        )
    if (price := limits.rates.money(1, nearest, minutes)) > limits.money:
        raise ParameterError(
            f"{limits.money:g} {limits.rates.currency} do not pay for one stop: {price:.2f}",
            where="--money",
        )
    return settings
