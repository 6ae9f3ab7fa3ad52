"""Fields to try strategies on, and surveys as a strategy sees them half way."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from subsoil.bench.conformance import courses
from subsoil.land.field import Field
from subsoil.layers import Layers, Sample
from subsoil.mapping.soilmap import SoilMap
from subsoil.strategies import View
from subsoil.variogram import Spherical, Variogram
from subsoil.ways.open_land import OpenLand

Look = Callable[..., View]


@pytest.fixture(scope="session")
def fields() -> dict[str, Field]:
    """Fields of several shapes by name."""
    return dict(courses.fields())


@pytest.fixture(scope="session")
def look() -> Look:
    """Make a view of a survey that probed some cells and has a plan."""
    layers = Layers((0.0, 0.2, 0.4))
    models = (Spherical(400.0, 60.0, 3600.0), Spherical(900.0, 35.0, 8100.0))

    def view(
        field: Field,
        visited: tuple[int, ...] = (),
        plan: tuple[int, ...] = (),
        *,
        refused: tuple[int, ...] = (),
        budget: int = 20,
        fresh: bool = False,
        seed: int = 0,
        variograms: tuple[Variogram, ...] = models,
    ) -> View:
        kpa = np.random.default_rng(7).normal((900.0, 1700.0), (60.0, 95.0), (len(field.cells), 2))
        state = np.zeros(2, dtype=np.int8)
        at = [(float(x), float(y)) for x, y in field.cells]
        samples = tuple(Sample(at[cell], kpa[cell], state) for cell in visited)
        return View(
            field=field,
            access=OpenLand(field),
            soil_map=SoilMap(field, layers, variograms, samples),
            position=at[visited[-1]] if visited else (0.0, 0.0),
            plan=plan,
            visited=visited,
            refused=refused,
            budget=budget,
            fresh=fresh,
            rng=np.random.default_rng(seed),
        )

    return view
