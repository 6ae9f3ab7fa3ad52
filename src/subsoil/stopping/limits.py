"""Limits: what a survey may cost, and the mean kriging variance at which it is over."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import inf, isfinite, isnan

from subsoil.errors import ParameterError
from subsoil.stopping.costs import Rates, Spent

FEWEST = 12
"""Samples before which no figure about the map is a reason to stop."""


@dataclass(frozen=True)
class Limits:
    """The survey stops at whichever of these it comes to first.

    A stop is not begun where its drive and push would take the survey beyond a limit, so
    limits are not passed knowingly; further pushes beside a stone may still pass them.

    Parameters
    ----------
    samples
        Number of readings.
    metres, minutes, money
        Way in m, time in min, and price.
    mean_kv
        Mean kriging variance in kPa2 at or below which the map is good enough, from the twelfth
        sample on: variograms of fewer say little. It does not depend on how well the variograms
        fit the soil: a target, not a promise.
    rates
        What the price is made of.

    Raises
    ------
    ParameterError
        If a limit is not positive, the target for the variance is negative, or the money is for
        nothing that is charged or not enough for one sample.

    Examples
    --------
    >>> limits = Limits(samples=30, minutes=60)
    >>> limits.reached(Spent(12, 300.0, 61.5, 900.0))
    '60 minutes spent'
    >>> limits.passed(Spent(12, 300.0, 59.5, 900.0), after=Spent(13, 340.0, 61.0, 900.0))
    '59.5 minutes spent, the next stop would take it beyond 60'
    """

    samples: int = 30
    metres: float = inf
    minutes: float = inf
    mean_kv: float = 0.0
    money: float = inf
    rates: Rates = field(default_factory=Rates)

    def __post_init__(self) -> None:
        for name in ("samples", "metres", "minutes", "money"):
            value = getattr(self, name)
            if not value > 0:
                raise ParameterError(f"must be greater than zero, not {value:g}", where=name)
        if isnan(self.mean_kv) or self.mean_kv < 0:
            raise ParameterError(f"must be zero or more, not {self.mean_kv:g}", where="KV target")
        if isfinite(self.money):
            self._check_money()

    def _check_money(self) -> None:
        rates = self.rates
        if rates.free:
            raise ParameterError(
                "nothing is charged, so it is never spent", where="money", remedy="give a rate"
            )
        if (least := rates.money(1, 0.0, 0.0)) > self.money:
            raise ParameterError(
                f"{self.money:g} {rates.currency} do not pay for one sample, which is {least:g}",
                where="money",
            )

    def reached(self, spent: Spent) -> str:
        """Why to stop now; empty to go on."""
        if spent.samples >= self.samples:
            return f"{self.samples} samples taken"
        if spent.metres >= self.metres:
            return f"{self.metres:g} metres driven"
        if spent.minutes >= self.minutes:
            return f"{self.minutes:g} minutes spent"
        if spent.money >= self.money:
            return f"{self.money:g} {self.rates.currency} spent"
        if spent.samples >= FEWEST and spent.mean_kv <= self.mean_kv:
            return f"mean kriging variance at {self.mean_kv:g} kPa2"
        return ""

    def passed(self, spent: Spent, after: Spent) -> str:
        """Why not to begin a stop after which this would be spent; empty to begin it."""
        for now, then, limit, unit in (
            (spent.metres, after.metres, self.metres, "metres driven"),
            (spent.minutes, after.minutes, self.minutes, "minutes spent"),
            (spent.money, after.money, self.money, f"{self.rates.currency} spent"),
        ):
            if then > limit:
                return f"{now:.1f} {unit}, the next stop would take it beyond {limit:g}"
        return ""
