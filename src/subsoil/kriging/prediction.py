"""Kriged values."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from subsoil.arrays import Floats


@dataclass(frozen=True)
class Prediction:
    """Kriged values; unpacks as ``mean, variance``.

    Attributes
    ----------
    mean, variance
        (...) or (m, ...) kriged values and their variances; read-only.
    notes
        What happened on the way that the reader of a map should know.
    spot_check
        Largest difference to direct kriging at the cells compared, in standard deviations of the
        readings (means) or sills (variances); 0 where the solution was direct.
    """

    mean: Floats
    variance: Floats
    notes: tuple[str, ...] = ()
    spot_check: float = 0.0

    def __iter__(self) -> Iterator[Floats]:
        return iter((self.mean, self.variance))
