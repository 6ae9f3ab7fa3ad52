"""Options that say when a survey has had enough."""

from __future__ import annotations

from typing import Annotated

import typer

from subsoil.errors import ParameterError
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


def _alone(option: str, needed: str) -> ParameterError:
    return ParameterError("says nothing by itself", where=option, remedy=f"give {needed} too")
