"""The public face: what ``import subsoil`` offers, and what it costs."""

from __future__ import annotations

import subprocess
import sys

import subsoil

EXPORTED = {
    "LARGE_CONE", "SMALL_CONE", "BoundedLinear", "Circular", "Cone", "Exponential", "Field",
    "Gaussian", "Insertion", "LayerState", "Layers", "Matern32", "Matern52", "OrdinaryKriging",
    "Power", "Prediction", "Profile", "PureNugget", "Sample", "SoilMap", "Spherical",
    "SubsoilError", "Variogram", "condition", "profile", "semivariance",
}  # fmt: skip


def test_the_package_exports_exactly_these_names() -> None:
    assert set(subsoil.__all__) == EXPORTED
    assert all(hasattr(subsoil, name) for name in EXPORTED)


def test_importing_the_package_loads_none_of_the_edges() -> None:
    edges = "{'typer', 'rich', 'matplotlib', 'rasterio', 'xarray', 'pydantic', 'pandas', 'yaml'}"
    code = f"import sys, subsoil; print(*({edges} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == []
