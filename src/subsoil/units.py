"""Units that people read: metric ones, or those of the United States. What is kept is metric."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

from subsoil.layers import Layers

System = Literal["metric", "us"]


@dataclass(frozen=True)
class Unit:
    """A unit that a quantity is shown in.

    Attributes
    ----------
    name
        As it is written; empty for a number without one.
    factor
        How many of it are one of the metric unit that is kept.
    decimals
        Digits behind the point that are worth showing.
    """

    name: str = ""
    factor: float = 1.0
    decimals: int = 0

    def number(self, value: float) -> str:
        """Kept value in this unit, without its name."""
        return f"{self.factor * value:z.{self.decimals}f}"

    def text(self, value: float) -> str:
        """Kept value in this unit, with its name."""
        return f"{self.number(value)} {self.name}".rstrip()


@dataclass(frozen=True)
class Units:
    """Units of everything that a survey shows.

    Attributes
    ----------
    pressure
        Of penetration resistance, which is kept in kPa.
    length
        Of ways on the ground, which are kept in m.
    area
        Of fields, which is kept in ha.
    depth
        Of layers, which is kept in m.

    Examples
    --------
    >>> METRIC.pressure.text(2068.4), US.pressure.text(2068.4)
    ('2068 kPa', '300.0 psi')
    >>> US.length.text(100.0), US.area.text(15.0)
    ('328 ft', '37.1 acres')
    """

    pressure: Unit
    length: Unit
    area: Unit
    depth: Unit

    @property
    def variance(self) -> Unit:
        """Of a pressure, squared; kept in kPa2."""
        unit = self.pressure
        return Unit(f"{unit.name}²", unit.factor**2)

    def layers(self, layers: Layers) -> tuple[str, ...]:
        """Names of depth layers.

        Examples
        --------
        >>> US.layers(Layers((0.0, 0.1, 0.3)))
        ('0.0-3.9 in', '3.9-11.8 in')
        """
        if self is METRIC:
            return layers.names
        edges = [self.depth.number(edge) for edge in layers.edges_m]
        return tuple(f"{top}-{bottom} {self.depth.name}" for top, bottom in pairwise(edges))


METRIC = Units(Unit("kPa"), Unit("m"), Unit("ha", 1.0, 2), Unit("m", 1.0, 2))
US = Units(
    Unit("psi", 0.1450377, 1),
    Unit("ft", 1 / 0.3048),
    Unit("acres", 2.4710538, 1),
    Unit("in", 1 / 0.0254, 1),
)
SYSTEMS: dict[System, Units] = {"metric": METRIC, "us": US}
"""Units by name."""
