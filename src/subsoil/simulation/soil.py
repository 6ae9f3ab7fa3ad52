"""The recipe of a random soil: what is drawn for a field, and the strength that follows.

Resistance is a mean that rises with depth plus deviations in units of each layer's SD: a random
field correlated along the ground and down the profile, a drift across the field and, on some
fields, a compacted headland and tramlines. A single push differs from it by a nugget.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from threadpoolctl import threadpool_limits

from subsoil.arrays import Bools, Floats
from subsoil.land.field import Field
from subsoil.simulation.gaussian import covariance_factor
from subsoil.variogram.models import Bounded, model_named

FLOOR_KPA = 20.0
"""Least resistance of a random soil, about that of loose dry topsoil, in kPa."""

_MODELS = ("exponential", "spherical", "matern-3/2")
_HEADLAND_M = 12.0
_TRAMLINE_SPACING_M, _TRAMLINE_WIDTH_M = 24.0, 3.0
_PAN_DEPTH_M, _PAN_SD_M = 0.22, 0.10


@dataclass(frozen=True)
class Soil:
    """What the soil of a field was drawn as. SDs are those of the layer concerned.

    Attributes
    ----------
    model, range_m
        Correlation along the ground: variogram model and its practical range in m.
    nugget_share
        Variance of single pushes around the soil, over nugget plus correlated variance.
    vertical_m
        Depth in m over which the correlation down the profile falls to 1/e.
    level
        Factor on the usual layer means.
    drift, drift_bearing
        Rise in SD from the centre to the edge, and its direction in radians from east.
    headland
        SDs by which the outer 12 m are harder at 0.22 m depth; 0 without a headland.
    tramlines, tramline_offset_m
        SDs by which strips of 3 m every 24 m are harder, 0 without, and where they start.
    scale
        Factor that the deviations of the finished soil were multiplied by.
    """

    model: str
    range_m: float
    nugget_share: float
    vertical_m: float
    level: float
    drift: float
    drift_bearing: float
    headland: float
    tramlines: float
    tramline_offset_m: float
    scale: float = 1.0

    def variogram(self) -> Bounded:
        """Variogram of single readings, before drift, headland and tramlines, in layer SDs."""
        nugget = self.nugget_share / (1.0 - self.nugget_share)
        return model_named(self.model)(nugget, self.range_m, 1.0)

    def mean_kpa(self, depth_m: Floats) -> Floats:
        """(m,) mean resistance in kPa at depths: 250 at the surface, about 2 100 at 0.40 m."""
        usual = np.interp(
            depth_m, [0.0, 0.05, 0.15, 0.25, 0.40], [250.0, 650.0, 1250.0, 1650.0, 2150.0]
        )
        return usual * self.level

    def sd_kpa(self, depth_m: Floats) -> Floats:
        """(m,) SD in kPa of the soil along the ground at depths, before scaling."""
        return 0.22 * self.mean_kpa(depth_m) + 40.0


def draw_soil(rng: np.random.Generator) -> Soil:
    """Draw the soil of a field: eleven draws, whatever they turn out to be.

    Practical range 20-60 m, nugget 10-40 %, vertical length 8-25 cm, drift up to 1 SD, a headland
    of 0.5-1.5 SD on every other field, tramlines of 0.5-1 SD on three fields in ten.
    """
    headland, tramlines = rng.random(2) < (0.5, 0.3)
    return Soil(
        model=_MODELS[rng.integers(len(_MODELS))],
        range_m=rng.uniform(20.0, 60.0),
        nugget_share=rng.uniform(0.10, 0.40),
        vertical_m=rng.uniform(0.08, 0.25),
        level=rng.uniform(0.8, 1.2),
        drift=rng.uniform(0.0, 1.0),
        drift_bearing=rng.uniform(0.0, 2.0 * np.pi),
        headland=rng.uniform(0.5, 1.5) * float(headland),
        tramlines=rng.uniform(0.5, 1.0) * float(tramlines),
        tramline_offset_m=rng.uniform(0.0, _TRAMLINE_SPACING_M),
    )


def grow(
    soil: Soil, field: Field, at: Floats, depth_m: Floats, rng: np.random.Generator
) -> tuple[Floats, Floats]:
    """Grow a soil at places: its resistance, and what a push there adds to it.

    Parameters
    ----------
    soil
        What to grow.
    field
        Where its drift, headland and tramlines lie.
    at
        (n, 2) distinct places in m, inside the field or around it.
    depth_m
        (m,) depths of the layers' centres in m.
    rng
        Source of randomness.

    Returns
    -------
    tuple
        (m, n) resistance and (m, n) push-to-push deviation in kPa; see :func:`floored`.

    Raises
    ------
    SingularSystemError
        If places lie too close together for the soil's correlation.
    """
    m, n = len(depth_m), len(at)
    down = np.exp(-np.abs(depth_m[:, None] - depth_m) / soil.vertical_m)
    half_shared = 0.5 * down + 0.5 * np.eye(m)
    with threadpool_limits(1, user_api="blas"):
        along = _factor_along(soil, at)
        signal = np.linalg.cholesky(down) @ rng.standard_normal((m, n)) @ along.T
        noise = np.linalg.cholesky(half_shared) @ rng.standard_normal((m, n))
    noise *= np.sqrt(soil.variogram().nugget)
    mean, sd = soil.mean_kpa(depth_m)[:, None], soil.sd_kpa(depth_m)[:, None]
    return mean + sd * (signal + _systematic(soil, field, at, depth_m)), sd * noise


def floored(kpa: Floats, noise: Floats) -> tuple[Floats, Floats]:
    """Cut deviations where they would take soil or reading below :data:`FLOOR_KPA`.

    The recipe's deviations are normal and know no zero; resistance does. On an unscaled
    field that is up to one reading in a hundred in the top 5 cm and fewer further down; on the
    test bed, none.
    """
    kpa = np.maximum(kpa, FLOOR_KPA)
    return kpa, np.maximum(noise, FLOOR_KPA - kpa)


def _factor_along(soil: Soil, at: Floats) -> Floats:
    """(n, n) lower Cholesky factor of the correlation between places."""
    model = soil.variogram()
    return covariance_factor(
        at,
        lambda lag: model.correlation(lag / soil.range_m),
        what=f"a {soil.model} soil with a range of {soil.range_m:.0f} m",
        where="simulation",
    )


def _systematic(soil: Soil, field: Field, at: Floats, depth_m: Floats) -> Floats:
    """(m, n) drift, headland and tramlines in layer SDs."""
    fading = np.interp(depth_m, [0.025, 0.375], [1.0, 0.5])[:, None]
    pan = np.exp(-0.5 * ((depth_m - _PAN_DEPTH_M) / _PAN_SD_M) ** 2)[:, None]
    drift = soil.drift * _drift(soil, field, at)
    headland = soil.headland * (_depth_inside(field, at) < _HEADLAND_M)
    tramlines = soil.tramlines * _on_tramline(soil, field, at)
    added: Floats = fading * drift + pan * (headland + tramlines)
    return added


def _drift(soil: Soil, field: Field, at: Floats) -> Floats:
    west, south, east, north = field.boundary.bounds
    centre = np.array([west + east, south + north]) / 2.0
    half = np.array([east - west, north - south]) / 2.0
    direction = np.array([np.cos(soil.drift_bearing), np.sin(soil.drift_bearing)])
    rise: Floats = (at - centre) / half @ direction
    return rise


def _depth_inside(field: Field, at: Floats) -> Floats:
    """(n,) distance in m to the outline, negative outside."""
    points = shapely.points(at)
    distance = shapely.distance(points, field.boundary.boundary)
    return np.where(shapely.intersects(field.boundary, points), distance, -distance)


def _on_tramline(soil: Soil, field: Field, at: Floats) -> Bools:
    """(n,) whether places lie on a strip along the field's long side."""
    corners = shapely.get_coordinates(shapely.oriented_envelope(field.boundary))
    sides = np.diff(corners[:3], axis=0)
    longest = sides[np.argmax(np.hypot(*sides.T))]
    normal = np.array([-longest[1], longest[0]]) / np.hypot(*longest)
    normal *= np.sign(normal.sum()) or 1.0
    across = at @ normal - (corners @ normal).min() - soil.tramline_offset_m
    spacing = _TRAMLINE_SPACING_M
    to_nearest: Floats = np.abs((across + spacing / 2) % spacing - spacing / 2)
    return to_nearest < _TRAMLINE_WIDTH_M / 2
