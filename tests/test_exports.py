"""The public face: what ``import subsoil`` offers, and what it costs."""

from __future__ import annotations

import subprocess
import sys

import pytest

import subsoil

EXPORTED = {
    "Fits", "Plan", "Readings", "View", "fit", "krige", "plan", "plots", "read_field",
    "read_readings", "simulate",
    "LARGE_CONE", "SMALL_CONE", "BoundedLinear", "Circular", "Cone", "Exponential", "Field",
    "Gaussian", "Insertion", "LayerState", "Layers", "Matern32", "Matern52", "OrdinaryKriging",
    "Power", "Prediction", "Profile", "PureNugget", "Sample", "SoilMap", "Spherical",
    "SubsoilError", "Variogram", "condition", "profile", "semivariance",
}  # fmt: skip


def test_the_package_exports_exactly_these_names() -> None:
    assert set(subsoil.__all__) == EXPORTED
    assert all(hasattr(subsoil, name) for name in EXPORTED)


def test_importing_the_package_loads_none_of_the_edges() -> None:
    everything = "[getattr(subsoil, name) for name in subsoil.__all__]"
    edges = "{'typer', 'rich', 'matplotlib', 'rasterio', 'xarray', 'pandas'}"
    code = f"import sys, subsoil; {everything}; print(*({edges} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == []


@pytest.mark.parametrize("module", ["subsoil", "subsoil.agent", "subsoil.reports"])
def test_what_runs_on_a_robot_loads_no_mathematics(module: str) -> None:
    heavy = "{'scipy', 'shapely', 'pyproj', 'numpy'}"
    code = f"import sys, {module}; print(*({heavy} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == []


def test_a_name_that_the_package_does_not_offer_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="no attribute 'krig'"):
        subsoil.krig  # noqa: B018
    assert set(subsoil.__all__) <= set(dir(subsoil))
