"""Adaptive soil-compaction surveying: krige while you probe, re-plan after every reading.

Names are loaded when they are first used: ``import subsoil.agent`` costs no mathematics.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from subsoil import plots
    from subsoil.errors import SubsoilError
    from subsoil.io.read.boundary import read_field
    from subsoil.io.read.readings import read_readings
    from subsoil.kriging import OrdinaryKriging, Prediction, condition
    from subsoil.land.field import Field
    from subsoil.layers import Layers, LayerState, Sample
    from subsoil.mapping.fit import Fits, fit
    from subsoil.mapping.krige import krige
    from subsoil.mapping.soilmap import SoilMap
    from subsoil.penetrometer import LARGE_CONE, SMALL_CONE, Cone, Insertion, Profile, profile
    from subsoil.readings import Readings
    from subsoil.strategies.planning import plan
    from subsoil.strategies.view import Plan, View
    from subsoil.survey.simulated import simulate
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
    "readings": ("Readings",),
    "io.read.boundary": ("read_field",),
    "io.read.readings": ("read_readings",),
    "mapping.fit": ("Fits", "fit",),
    "mapping.krige": ("krige",),
    "strategies.planning": ("plan",),
    "strategies.view": ("Plan", "View",),
    "survey.simulated": ("simulate",),
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
    if name == "plots":
        return import_module("subsoil.plots")
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
    "Fits",
    "Gaussian",
    "Insertion",
    "LayerState",
    "Layers",
    "Matern32",
    "Matern52",
    "OrdinaryKriging",
    "Plan",
    "Power",
    "Prediction",
    "Profile",
    "PureNugget",
    "Readings",
    "Sample",
    "SoilMap",
    "Spherical",
    "SubsoilError",
    "Variogram",
    "View",
    "condition",
    "fit",
    "krige",
    "plan",
    "plots",
    "profile",
    "read_field",
    "read_readings",
    "semivariance",
    "simulate",
]
