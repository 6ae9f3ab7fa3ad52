"""What probing costs: time by pace, money by rates."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite

from subsoil.errors import ParameterError, brief


@dataclass(frozen=True)
class Pace:
    """How fast stops are made.

    Parameters
    ----------
    speed_mps
        Speed between stops in m/s.
    stop_s
        Time at a stop with one push in s. The defaults are those of the paper's robot (sec. IV-A).
    push_s
        Time of every further push at a stop in s.

    Raises
    ------
    ParameterError
        If the speed is not positive, or a stop or push takes less than no time.

    Examples
    --------
    >>> Pace().minutes(metres=300.0, stops=6)
    10.0
    """

    speed_mps: float = 1.0
    stop_s: float = 50.0
    push_s: float = 28.0

    def __post_init__(self) -> None:
        if not self.speed_mps > 0:
            raise ParameterError(
                f"must be greater than zero, not {self.speed_mps:g}", where="speed"
            )
        if not self.stop_s >= 0:
            raise ParameterError(f"must be zero or more, not {self.stop_s:g}", where="stop")
        if not self.push_s >= 0:
            raise ParameterError(f"must be zero or more, not {self.push_s:g}", where="push")

    def minutes(self, metres: float, stops: int, further: int = 0) -> float:
        """Time in min of a way, the stops on it and pushes beyond the first of a stop."""
        at_stops = stops * self.stop_s + further * self.push_s
        return (metres / self.speed_mps + at_stops) / 60.0


@dataclass(frozen=True)
class Rates:
    """What a survey is charged for.

    Parameters
    ----------
    hour, km, sample
        Money for an hour in the field, a km driven and a reading.
    call_out
        Money for coming at all.
    currency
        Three capital letters of ISO 4217, such as EUR.

    Raises
    ------
    ParameterError
        If a rate is negative or not finite, or the currency is not three capital letters.

    Examples
    --------
    >>> Rates(hour=60.0, sample=2.0, call_out=50.0).money(samples=30, metres=700.0, minutes=40.0)
    150.0
    """

    hour: float = 0.0
    km: float = 0.0
    sample: float = 0.0
    call_out: float = 0.0
    currency: str = "EUR"

    def __post_init__(self) -> None:
        for name in ("hour", "km", "sample", "call_out"):
            rate = getattr(self, name)
            if not (isfinite(rate) and rate >= 0):
                words = name.replace("_", "-")
                raise ParameterError(f"must be zero or more, not {rate:g}", where=f"rate {words}")
        code = self.currency
        if not (len(code) == 3 and code.isascii() and code.isalpha() and code.isupper()):
            raise ParameterError(
                f"{brief(code)!r} is no currency",
                where="currency",
                remedy="three letters, such as EUR",
            )

    @property
    def free(self) -> bool:
        """Whether nothing is charged."""
        return not (self.hour or self.km or self.sample or self.call_out)

    def money(self, samples: int, metres: float, minutes: float) -> float:
        """Price of a survey, call-out included."""
        return self.call_out + self.more(samples, metres, minutes)

    def more(self, samples: int, metres: float, minutes: float) -> float:
        """Price of more of a survey that is under way."""
        return self.hour * minutes / 60.0 + self.km * metres / 1000.0 + self.sample * samples


@dataclass(frozen=True)
class Spent:
    """What a survey has cost so far, and what it has to show.

    Attributes
    ----------
    samples
        Readings taken.
    metres
        Way driven in m.
    minutes
        Time in the field in min.
    mean_kv
        Field average of the kriging variance in kPa2; NaN before the second sample.
    money
        Price so far.
    """

    samples: int
    metres: float
    minutes: float
    mean_kv: float
    money: float = 0.0
