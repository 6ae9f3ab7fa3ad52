"""Land with bays, holes and spits, drawn at random."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
import shapely

from subsoil.land.field import Field

RuggedField = Callable[..., Field]


def _star(rng: np.random.Generator, centre: tuple[float, float], size: float) -> shapely.Polygon:
    """A polygon whose corners go in and out around a centre."""
    corners = int(rng.integers(6, 12))
    turn = np.sort(rng.uniform(0, 2 * np.pi, corners)) + rng.uniform(0, 0.1)
    away = size * rng.uniform(0.35, 1.0, corners)
    at = np.asarray(centre) + away[:, None] * np.column_stack([np.cos(turn), np.sin(turn)])
    return shapely.Polygon(at)


@pytest.fixture(scope="session")
def rugged_field() -> RuggedField:
    """Draw a connected field of about a hectare, with keep-outs inside and over its edge."""

    def draw(seed: int, keep_outs: int = 3) -> Field:
        rng = np.random.default_rng(seed)
        while True:
            outline = _star(rng, (100.0, 100.0), 100.0)
            barred = [_star(rng, tuple(rng.uniform(40, 160, 2)), 22.0) for _ in range(keep_outs)]
            if not all(each.is_valid for each in (outline, *barred)):
                continue
            free = outline.difference(shapely.union_all(barred))
            one_part = isinstance(free, shapely.Polygon)
            if one_part and 3000.0 < free.area < 0.6 * free.convex_hull.area:
                touching = tuple(each for each in barred if each.intersects(outline))
                return Field(outline, "", touching, 5.0, f"rugged {seed}")

    return draw
