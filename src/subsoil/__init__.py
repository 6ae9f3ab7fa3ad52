"""Adaptive soil-compaction surveying: krige while you probe, re-plan after every reading."""

from subsoil.errors import SubsoilError
from subsoil.field import Field
from subsoil.kriging import OrdinaryKriging, Prediction, condition
from subsoil.layers import Layers, LayerState, Sample
from subsoil.penetrometer import LARGE_CONE, SMALL_CONE, Cone, Insertion, Profile, profile
from subsoil.soilmap import SoilMap
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
