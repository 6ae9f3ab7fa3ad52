"""Adaptive soil-compaction surveying: krige while you probe, re-plan after every reading.

Names are loaded when they are first used: ``import subsoil.agent`` costs no mathematics.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from subsoil.errors import SubsoilError
    from subsoil.kriging import OrdinaryKriging, Prediction, condition
    from subsoil.land.field import Field
    from subsoil.layers import Layers, LayerState, Sample
    from subsoil.mapping.soilmap import SoilMap
    from subsoil.penetrometer import LARGE_CONE, SMALL_CONE, Cone, Insertion, Profile, profile
    from subsoil.variogram.models import (
        BoundedLinear,
        Circular,
        Exponential,
        Gaussian,
        Matern32,
        Matern52,
        Power,
        PureNugget,
        Spherical,
        Variogram,
        semivariance,
    )

    __version__: str

_HOMES = {
    "errors": ("SubsoilError",),
    "land.field": ("Field",),
    "kriging": ("OrdinaryKriging", "Prediction", "condition"),
    "layers": ("Layers", "LayerState", "Sample"),
    "penetrometer": ("LARGE_CONE", "SMALL_CONE", "Cone", "Insertion", "Profile", "profile"),
    "mapping.soilmap": ("SoilMap",),
    "variogram.models": (
        "BoundedLinear", "Circular", "Exponential", "Gaussian", "Matern32", "Matern52", "Power",
        "PureNugget", "Spherical", "Variogram", "semivariance",
    ),
}  # fmt: skip
"""Modules by the names that they offer here."""


def __getattr__(name: str) -> object:
    if name == "__version__":
        from importlib.metadata import version

        return version("subsoil")
    for home, names in _HOMES.items():
        if name in names:
            return getattr(import_module(f"subsoil.{home}"), name)
    raise AttributeError(f"module 'subsoil' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})


__all__ = [
    "LARGE_CONE",
    "SMALL_CONE",
    "BoundedLinear",
    "Circular",
    "Cone",
    "Exponential",
    "Field",
    "Gaussian",
    "Insertion",
    "LayerState",
    "Layers",
    "Matern32",
    "Matern52",
    "OrdinaryKriging",
    "Power",
    "Prediction",
    "Profile",
    "PureNugget",
    "Sample",
    "SoilMap",
    "Spherical",
    "SubsoilError",
    "Variogram",
    "condition",
    "profile",
    "semivariance",
]
