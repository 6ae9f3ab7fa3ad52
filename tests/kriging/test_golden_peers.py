"""Agreement with independent kriging codes on fixed models, to 1e-9."""

from __future__ import annotations

import shutil
import subprocess
from math import sqrt
from pathlib import Path

import gstools
import numpy as np
import pytest
from pykrige.ok import OrdinaryKriging as PyKrige

from subsoil import Exponential, Gaussian, Power, Spherical, Variogram, condition
from subsoil.arrays import Floats

NUGGET, RANGE, PSILL, SLOPE = 0.3, 60.0, 1.7, 0.04
CASES: dict[str, tuple[Variogram, str, dict[str, float]]] = {
    "spherical": (
        Spherical(NUGGET, RANGE, PSILL),
        "spherical",
        {"psill": PSILL, "range": RANGE, "nugget": NUGGET},
    ),
    "exponential": (
        Exponential(NUGGET, RANGE, PSILL),
        "exponential",
        {"psill": PSILL, "range": RANGE, "nugget": NUGGET},
    ),
    "gaussian": (
        Gaussian(NUGGET, RANGE, PSILL),
        "gaussian",
        {"psill": PSILL, "range": RANGE * 7 / 4 / sqrt(3), "nugget": NUGGET},
    ),
    "linear": (Power(NUGGET, SLOPE), "linear", {"slope": SLOPE, "nugget": NUGGET}),
}


@pytest.fixture(scope="module")
def data() -> tuple[Floats, Floats, Floats]:
    """Places and values of 60 readings, and 400 targets, some of them at readings."""
    rng = np.random.default_rng(42)
    at = rng.uniform(0, 150, (60, 2))
    z = 10 + np.sin(at[:, 0] / 25) + np.cos(at[:, 1] / 40) + rng.normal(0, 0.4, 60)
    targets = np.concatenate([at[:7], rng.uniform(-20, 170, (393, 2))])
    return at, z, targets


@pytest.mark.parametrize("exact", [True, False], ids=["exact", "filtered"])
@pytest.mark.parametrize("case", CASES)
def test_mean_and_variance_agree_with_pykrige(
    data: tuple[Floats, Floats, Floats], case: str, exact: bool
) -> None:
    at, z, targets = data
    model, name, parameters = CASES[case]
    peer = PyKrige(
        at[:, 0], at[:, 1], z, variogram_model=name, variogram_parameters=parameters,
        exact_values=exact,
    )  # fmt: skip
    mean, variance = peer.execute("points", targets[:, 0], targets[:, 1])
    ours = condition(model, at, z, exact=exact).predict(targets)
    # PyKrige's variance without exact values is that of a further noisy reading.
    beyond = 0.0 if exact else NUGGET
    np.testing.assert_allclose(ours.mean, np.asarray(mean), rtol=0, atol=1e-9)
    np.testing.assert_allclose(ours.variance + beyond, np.asarray(variance), rtol=0, atol=1e-9)


@pytest.mark.parametrize("exact", [True, False], ids=["exact", "filtered"])
@pytest.mark.parametrize("case", ["spherical", "exponential", "gaussian"])
def test_mean_and_variance_agree_with_gstools(
    data: tuple[Floats, Floats, Floats], case: str, exact: bool
) -> None:
    at, z, targets = data
    model = CASES[case][0]
    length = {"spherical": RANGE, "exponential": RANGE / 3, "gaussian": RANGE / sqrt(3)}[case]
    kind = {
        "spherical": gstools.Spherical,
        "exponential": gstools.Exponential,
        "gaussian": gstools.Gaussian,
    }[case]
    scale = {"rescale": 1.0} if case == "gaussian" else {}
    peer_model = kind(dim=2, var=PSILL, len_scale=length, nugget=NUGGET, **scale)
    peer = gstools.krige.Ordinary(peer_model, at.T, z, exact=exact, pseudo_inv=False)
    mean, variance = peer(targets.T, return_var=True, store=False)
    ours = condition(model, at, z, exact=exact).predict(targets)
    beyond = 0.0 if exact else NUGGET
    np.testing.assert_allclose(ours.mean, mean, rtol=0, atol=1e-9)
    np.testing.assert_allclose(ours.variance + beyond, variance, rtol=0, atol=1e-9)


@pytest.mark.skipif(shutil.which("Rscript") is None, reason="R is not installed")
@pytest.mark.parametrize("case", ["spherical", "exponential"])
def test_mean_and_variance_agree_with_gstat(
    data: tuple[Floats, Floats, Floats], case: str, tmp_path: Path
) -> None:
    at, z, targets = data
    np.savetxt(tmp_path / "data.csv", np.column_stack([at, z]), delimiter=",", fmt="%.17g")
    np.savetxt(tmp_path / "targets.csv", targets[7:], delimiter=",", fmt="%.17g")
    name, length = ("Sph", RANGE) if case == "spherical" else ("Exp", RANGE / 3)
    code = f"""
    if (!requireNamespace("gstat", quietly = TRUE)) quit(status = 77)
    d <- read.csv("data.csv", header = FALSE); names(d) <- c("x", "y", "z")
    t <- read.csv("targets.csv", header = FALSE); names(t) <- c("x", "y")
    v <- gstat::vgm({PSILL}, "{name}", {length}, {NUGGET})
    k <- gstat::krige(z ~ 1, ~ x + y, d, t, v, debug.level = 0)
    write.table(format(k[, 3:4], digits = 17), "out.csv", sep = ",",
                row.names = FALSE, col.names = FALSE, quote = FALSE)
    """
    done = subprocess.run(["Rscript", "-e", code], cwd=tmp_path, capture_output=True, check=False)
    if done.returncode == 77:
        pytest.skip("R has no gstat")
    assert done.returncode == 0, done.stderr
    mean, variance = np.loadtxt(tmp_path / "out.csv", delimiter=",").T
    ours = condition(CASES[case][0], at, z, exact=True).predict(targets[7:])
    np.testing.assert_allclose(ours.mean, mean, rtol=0, atol=1e-9)
    np.testing.assert_allclose(ours.variance, variance, rtol=0, atol=1e-9)
