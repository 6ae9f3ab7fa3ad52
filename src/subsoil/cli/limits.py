"""Options that say when a survey has had enough."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated, Any

import typer

from subsoil.cli.parsing import LIMITS
from subsoil.errors import ParameterError
from subsoil.stopping import DecidedShare, Goal, LeastGain, Rates, SureRmse, TargetRmse

_DECIDED, _CONFIDENCE = 0.9, 0.8
"""Share of a field to decide, and probability that decides a cell, where nothing else is said."""


def _limit(help_: str, metavar: str, default: str | bool = False, **more: Any) -> Any:
    return typer.Option(
        help=help_, metavar=metavar, show_default=default, rich_help_panel=LIMITS, **more
    )


Metres = Annotated[float | None, _limit("Do not go further; inf for any way.", "M")]
Minutes = Annotated[float | None, _limit("Do not take longer; inf for any time.", "MIN")]
Money = Annotated[float | None, _limit("Do not cost more; needs a rate.", "MONEY")]


@dataclass(frozen=True)
class LimitOptions:
    """When a survey has had enough, as the command line says it; ``None`` where it does not.

    Attributes
    ----------
    samples, metres, minutes, money, kv
        Limits of :class:`subsoil.stopping.Limits`.
    target_rmse, probability, threshold_kpa, decided, confidence, min_gain
        What the map has to show: see :attr:`goals`.
    rate_hour, rate_km, rate_sample, call_out, currency
        What it is charged for: :class:`subsoil.stopping.Rates`.
    """

    samples: Annotated[
        int | None, _limit("Readings to take.", "N", "as before, else 30", min=1)
    ] = None
    metres: Metres = None
    minutes: Minutes = None
    money: Money = None
    target_rmse: Annotated[
        float | None, _limit("Stop when the map expects this RMSE of itself.", "KPA")
    ] = None
    probability: Annotated[
        float | None,
        _limit("Ask for --target-rmse with this probability; see --estimator pmc.", "P"),
    ] = None
    threshold_kpa: Annotated[
        float | None,
        _limit("Stop when most of the field is known to be above or below this.", "KPA"),
    ] = None
    decided: Annotated[
        float | None, _limit("Share of the field to decide so.", "SHARE", f"{_DECIDED:g}")
    ] = None
    confidence: Annotated[
        float | None, _limit("Probability that decides a cell.", "P", f"{_CONFIDENCE:g}")
    ] = None
    min_gain: Annotated[
        float | None, _limit("Stop when the next sample would lower the RMSE by less.", "KPA")
    ] = None
    kv: Annotated[float | None, _limit("Stop at this mean kriging variance.", "KPA2")] = None
    rate_hour: Annotated[float | None, _limit("Money for an hour in the field.", "MONEY")] = None
    rate_km: Annotated[float | None, _limit("Money for a km of way.", "MONEY")] = None
    rate_sample: Annotated[float | None, _limit("Money for a reading.", "MONEY")] = None
    call_out: Annotated[float | None, _limit("Money for coming at all.", "MONEY")] = None
    currency: Annotated[
        str | None, _limit("Currency of all money.", "CODE", "as before, else EUR")
    ] = None

    def given(self, before: Rates) -> dict[str, object]:
        """Fields of the settings that are given; goals together, rates one by one.

        Raises
        ------
        ParameterError
            If a rate is negative or not finite, the currency is none, or a goal cannot be.
        """
        rates = only_given(
            hour=self.rate_hour,
            km=self.rate_km,
            sample=self.rate_sample,
            call_out=self.call_out,
            currency=self.currency,
        )
        return only_given(
            samples=self.samples,
            metres=self.metres,
            minutes=self.minutes,
            money=self.money,
            mean_kv=self.kv,
            rates=replace(before, **rates) if rates else None,  # type: ignore[arg-type]
            goals=self.goals or None,
        )

    @property
    def goals(self) -> tuple[Goal, ...]:
        """What the map has to show.

        Raises
        ------
        ParameterError
            If a number is outside what it may be, or says nothing without one that is not given.
        """
        return (*self._error(), *self._decision(), *self._gain())

    def _error(self) -> tuple[Goal, ...]:
        if self.target_rmse is None:
            if self.probability is not None:
                raise _alone("--probability", "--target-rmse")
            return ()
        if self.probability is None:
            return (TargetRmse(self.target_rmse),)
        return (SureRmse(self.target_rmse, self.probability),)

    def _decision(self) -> tuple[Goal, ...]:
        if self.threshold_kpa is None:
            if self.confidence is not None:
                raise _alone("--confidence", "--threshold-kpa")
            if self.decided is not None:
                raise _alone("--decided", "--threshold-kpa")
            return ()
        share = _DECIDED if self.decided is None else self.decided
        sure = _CONFIDENCE if self.confidence is None else self.confidence
        return (DecidedShare(self.threshold_kpa, share, sure),)

    def _gain(self) -> tuple[Goal, ...]:
        return () if self.min_gain is None else (LeastGain(self.min_gain),)


def _alone(option: str, needed: str) -> ParameterError:
    return ParameterError("says nothing by itself", where=option, remedy=f"give {needed} too")


def only_given(**fields: object) -> dict[str, object]:
    """Fields that are not ``None``.

    Examples
    --------
    >>> only_given(samples=30, metres=None)
    {'samples': 30}
    """
    return {name: value for name, value in fields.items() if value is not None}
