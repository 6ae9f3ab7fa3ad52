"""Random fields to try surveys on: the test bed of every comparison, and any other outline."""

from __future__ import annotations

from dataclasses import replace
from math import ceil, sqrt
from typing import Literal, get_args

import numpy as np
import shapely

from subsoil.arrays import Floats, Integers
from subsoil.errors import ParameterError
from subsoil.land.field import Field, centres
from subsoil.layers import Layers
from subsoil.simulation.soil import Soil, draw_soil, floored, grow
from subsoil.simulation.surrogate import krige_layers
from subsoil.simulation.truth import Truth
from subsoil.variogram import paper_10

Scheme = Literal["surrogate", "signal"]
"""What counts as the truth: the kriged map of 286 samples read without noise, or the soil itself
read with its push-to-push deviation."""

MOST_CELLS = 8_000
"""Most cells a soil is grown in: that takes about ten seconds and a GB of memory, and with the
samples of a surrogate half a minute and two GB."""

PAPER_LAYERS = Layers()
"""Eight bands of 5 cm."""

TEST_BED = Field.from_metres([(0, 0), (180, 0), (180, 130), (0, 130)], name="test bed")
"""The field of the test bed: 936 cells of 5 m."""

_SPACING_M, _OVERLAP_M = 10.0, 20.0
"""Of the samples behind a surrogate: their distance, and how far they reach beyond the field."""
_POOLED_SD_KPA = 65.0
_PAPER_FIT = replace(paper_10, nugget_floor=0.0)


def draw_field(
    rng: np.random.Generator,
    protocol: Scheme = "surrogate",
    field: Field | None = None,
) -> Truth:
    """Draw a field of the test bed: 180 x 130 m, 936 cells of 5 m, eight layers of 5 cm.

    A soil is drawn and grown (:func:`subsoil.simulation.soil.grow`), and sampled with noise on a
    10 m grid over the field's extent that overlaps it by 20 m west and east: on the test bed at
    286 places, 22 x 13. Ordinary kriging of the samples, layer by layer with the bounded linear
    model fitted by least squares, is the paper's surrogate. All deviations from the layers' field
    means are scaled by the factor that brings the surrogate's to a pooled SD of 65 kPa.

    Parameters
    ----------
    rng
        Source of the field. The same state gives the same soil under both protocols.
    protocol
        ``"surrogate"``, the paper's: the surrogate is the truth and is read without noise. It is
        smooth and flatters every method. ``"signal"``: the soil is the truth and every reading
        carries its deviation.
    field
        Another field to draw in the same manner. Places of the sample grid that lie farther than
        20 m from its outline are left out.

    Raises
    ------
    ParameterError
        If there is no such protocol, or the field has more than 8000 cells.

    Examples
    --------
    >>> truth = draw_field(np.random.default_rng(1))
    >>> truth.kpa.shape
    (8, 936)
    """
    _check_protocol(protocol)
    field = field or TEST_BED
    _check_size(field)
    layers = PAPER_LAYERS
    samples = _sample_places(field)
    soil = draw_soil(rng)
    places, sampled = _united(field.cells, samples)
    signal, noise = grow(soil, field, places, layers.centre_m, rng)
    n = len(field.cells)
    readings = signal[:, sampled] + noise[:, sampled]
    kriged, _ = krige_layers(_PAPER_FIT, samples, readings, field.cells, layers)
    soil = replace(soil, scale=_POOLED_SD_KPA / float(np.sqrt(kriged.var(axis=1).mean())))
    if protocol == "surrogate":
        return Truth(field, layers, _scaled(kriged, soil), np.zeros_like(kriged), soil)
    kpa, deviation = floored(_scaled(signal[:, :n], soil), soil.scale * noise[:, :n])
    return Truth(field, layers, kpa, deviation, soil)


# pytest takes functions called test_* for tests wherever they are imported.


def draw_truth(field: Field, rng: np.random.Generator, layers: Layers = PAPER_LAYERS) -> Truth:
    """Draw a soil for any field, as in the test bed under the ``"signal"`` protocol, unscaled.

    Below 10 cm readings vary by about 0.3 of their mean, as in real grassland. The drift spans the
    field's extent, the headland follows its outline and tramlines its long side. Resistances are
    20 kPa at least; see :func:`subsoil.simulation.soil.floored`.

    Parameters
    ----------
    field
        The land.
    rng
        Source of the soil.
    layers
        Depth bands.

    Raises
    ------
    ParameterError
        If the field has more than 8000 cells.
    """
    _check_size(field)
    soil = draw_soil(rng)
    kpa, noise = floored(*grow(soil, field, field.cells, layers.centre_m, rng))
    return Truth(field, layers, kpa, noise, soil)


def _check_protocol(protocol: str) -> None:
    if protocol not in get_args(Scheme):
        raise ParameterError(
            f"there is no protocol {protocol!r}",
            where="test bed",
            remedy=f"one of {', '.join(get_args(Scheme))}",
        )


def _check_size(field: Field) -> None:
    n = len(field.cells)
    if n > MOST_CELLS:
        side = ceil(field.cell_size * sqrt(n / MOST_CELLS) * 10) / 10
        raise ParameterError(
            f"{n} cells are more than the {MOST_CELLS} a soil is simulated for",
            where=field.name,
            remedy=f"use cells of {side:g} m or larger",
        )


def _sample_places(field: Field) -> Floats:
    """(n, 2) places in m of the samples behind a field's surrogate: centres of 10 m squares."""
    west, south, east, north = field.boundary.bounds
    easting = centres(west - _OVERLAP_M, east + _OVERLAP_M, _SPACING_M)
    grid = np.meshgrid(easting, centres(south, north, _SPACING_M))
    places = np.column_stack([coordinate.ravel() for coordinate in grid])
    near = shapely.dwithin(field.boundary, shapely.points(places), _OVERLAP_M)
    return np.asarray(places[near])


def _united(cells: Floats, samples: Floats) -> tuple[Floats, Integers]:
    """Distinct places (n, 2), cells first, and the index of each sample among them."""
    places = np.concatenate([cells, samples])
    _, first, inverse = np.unique(places, axis=0, return_index=True, return_inverse=True)
    kept = np.sort(first)
    where = np.searchsorted(kept, first[inverse.ravel()[len(cells) :]])
    return places[kept], where


def _scaled(kpa: Floats, soil: Soil) -> Floats:
    """Scale (m, N) deviations from the layers' means by the soil's factor."""
    mean = kpa.mean(axis=1, keepdims=True)
    return np.asarray(mean + soil.scale * (kpa - mean))
