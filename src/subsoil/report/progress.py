"""How a survey went on, sample by sample."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Progress:
    """Where a survey stood after one of its samples.

    Attributes
    ----------
    samples
        Readings taken.
    metres, minutes
        Way driven in m and time spent in min.
    mean_kv
        Field average of the kriging variance in kPa2.
    rmse
        Root mean square error of the map against the simulated truth in kPa; NaN without one.
    """

    samples: int
    metres: float
    minutes: float
    mean_kv: float
    rmse: float
