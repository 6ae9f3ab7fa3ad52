"""How names and values of a result are written for people: with units, and no digit too many."""

from __future__ import annotations

import math
from collections.abc import Mapping

from subsoil.errors import printable
from subsoil.units import METRIC, Unit, Units

_NAMES = {"metres": "way", "minutes": "time", "mean_kv": "mean KV"}
_PLAIN = {
    "min": Unit("min"),
    "minutes": Unit("min"),
    "mm2": Unit("mm²"),
    "gib": Unit("GiB", 1.0, 1),
    "easting_m": Unit("m", 1.0, 2),
    "northing_m": Unit("m", 1.0, 2),
    "longitude": Unit("", 1.0, 7),
    "latitude": Unit("", 1.0, 7),
    "share": Unit("", 1.0, 2),
    "skill": Unit("", 1.0, 2),
    "calibration": Unit("", 1.0, 2),
    "money": Unit("", 1.0, 2),
}
"""Units that are the same everywhere, by a name or its last word."""


def label(name: str, units: Units = METRIC) -> str:
    """Name of a quantity with its unit.

    Examples
    --------
    >>> label("loo_rmse_kpa"), label("metres"), label("samples")
    ('loo rmse (kPa)', 'way (m)', 'samples')
    """
    unit = _unit(name, units)
    words = _NAMES.get(name) or printable(name).replace("_", " ")
    if unit is None or not unit.name:
        return words
    return f"{words if name in _NAMES else words.rpartition(' ')[0]} ({unit.name})"


def text(name: str, value: object, units: Units = METRIC) -> str:
    """Value of a name, without its unit; numbers that are not finite are a dash.

    Examples
    --------
    >>> text("mean_kpa", 1234.567), text("latitude", 53.27112349), text("r2", 0.5)
    ('1235', '53.2711235', '0.5')
    """
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return _number(name, value, units)
    if isinstance(value, Mapping):
        return ", ".join(_clause(str(key), item, units) for key, item in value.items())
    if isinstance(value, list | tuple):
        return ", ".join(text(name, item, units) for item in value)
    return printable(str(value))


def _clause(name: str, value: object, units: Units) -> str:
    """Name, value and unit in running text: ``northing 5910.25 m``."""
    unit = _unit(name, units)
    words = label(name, units).removesuffix(f" ({unit.name})" if unit else "")
    return f"{words} {text(name, value, units)} {unit.name if unit else ''}".rstrip()


def _number(name: str, value: float, units: Units) -> str:
    if not math.isfinite(value):
        return "-"
    unit = _unit(name, units)
    return unit.number(value) if unit else f"{value:.3f}".rstrip("0").rstrip(".")


def _unit(name: str, units: Units) -> Unit | None:
    last = name.rpartition("_")[2]
    own = {
        "kpa": units.pressure,
        "kpa2": units.variance,
        "kv": units.variance,
        "m": units.length,
        "metres": units.length,
        "ha": units.area,
    }
    return _PLAIN.get(name) or _PLAIN.get(last) or own.get(last)
