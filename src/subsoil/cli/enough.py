"""Options that say when a survey has had enough."""

from __future__ import annotations

from typing import Annotated

import numpy as np
import typer

from subsoil.errors import ParameterError
from subsoil.events import Configured
from subsoil.field import Field
from subsoil.stopping import DecidedShare, Goal, LeastGain, SureRmse, TargetRmse

Metres = Annotated[float, typer.Option(help="Do not drive further than this in m.")]
Minutes = Annotated[float, typer.Option(help="Do not take longer than this in min.")]
Money = Annotated[float, typer.Option(help="Do not cost more than this; needs a rate.")]
MeanKv = Annotated[float, typer.Option(help="Stop at this mean kriging variance in kPa2.")]
RateHour = Annotated[float, typer.Option(help="Money for an hour in the field.")]
RateKm = Annotated[float, typer.Option(help="Money for a km driven.")]
RateSample = Annotated[float, typer.Option(help="Money for a reading.")]
CallOut = Annotated[float, typer.Option(help="Money for coming at all.")]
Currency = Annotated[str, typer.Option(help="Currency of all money, such as EUR.")]
Target = Annotated[
    float | None, typer.Option(help="Stop when the map expects this RMSE of itself, in kPa.")
]
Probability = Annotated[
    float | None,
    typer.Option(help="Ask for --target-rmse with this probability; see --estimator pmc."),
]
Threshold = Annotated[
    float | None,
    typer.Option(help="Stop when most of the field is known to be above or below this, in kPa."),
]
Decided = Annotated[
    float | None, typer.Option(help="Share of the field to decide so.", show_default="0.9")
]
Confidence = Annotated[
    float | None, typer.Option(help="Probability that decides a cell.", show_default="0.8")
]
MinGain = Annotated[
    float | None,
    typer.Option(help="Stop when the next sample would lower the RMSE by less, in kPa."),
]


def goals(
    target_rmse: float | None,
    probability: float | None,
    threshold_kpa: float | None,
    decided: float | None,
    confidence: float | None,
    min_gain: float | None,
) -> tuple[Goal, ...]:
    """What the map has to show.

    Raises
    ------
    ParameterError
        If a number is outside what it may be, or says nothing without one that is not given.
    """
    if target_rmse is None and probability is not None:
        raise _alone("--probability", "--target-rmse")
    if threshold_kpa is None and not (decided is None and confidence is None):
        raise _alone("--decided" if confidence is None else "--confidence", "--threshold-kpa")
    chosen: list[Goal] = []
    if target_rmse is not None and probability is None:
        chosen.append(TargetRmse(target_rmse))
    if target_rmse is not None and probability is not None:
        chosen.append(SureRmse(target_rmse, probability))
    if threshold_kpa is not None:
        share = 0.9 if decided is None else decided
        sure = 0.8 if confidence is None else confidence
        chosen.append(DecidedShare(threshold_kpa, share, sure))
    if min_gain is not None:
        chosen.append(LeastGain(min_gain))
    return tuple(chosen)


def checked(settings: Configured, field: Field) -> Configured:
    """Settings whose limits let a survey of a field begin.

    Raises
    ------
    ParameterError
        If a limit is impossible, or too little for the stop nearest to the start.
    """
    limits = settings.limits
    lags = np.hypot(*(field.cells - settings.start).T)
    nearest = float(lags.min())
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


def _alone(option: str, needed: str) -> ParameterError:
    return ParameterError("says nothing by itself", where=option, remedy=f"give {needed} too")
