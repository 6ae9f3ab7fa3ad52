"""A truth fits its field and holds only resistances that soil can have."""

from __future__ import annotations

import numpy as np
import pytest

from subsoil.errors import ParameterError
from subsoil.land.field import Field
from subsoil.layers import Layers
from subsoil.simulation import Soil, Truth, draw_field

FIELD = Field.from_metres([(0, 0), (10, 0), (10, 10), (0, 10)])
LAYERS = Layers((0.0, 0.1, 0.2))
SOIL = Soil("spherical", 30.0, 0.2, 0.15, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0)
KPA = np.array([[100.0, 200.0, 300.0, 400.0], [500.0, 600.0, 700.0, 800.0]])


def test_a_reading_is_the_soil_plus_its_deviation() -> None:
    noise = np.zeros((2, 4))
    noise[:, 2] = (-10.0, 5.0)
    truth = Truth(FIELD, LAYERS, KPA.copy(), noise, SOIL)
    assert truth.reading(2).tolist() == [290.0, 705.0]
    assert truth.reading(3).tolist() == [400.0, 800.0]


def test_its_arrays_cannot_be_written() -> None:
    truth = Truth(FIELD, LAYERS, KPA.copy(), np.zeros((2, 4)), SOIL)
    with pytest.raises(ValueError, match="read-only"):
        truth.kpa[0, 0] = 1.0
    with pytest.raises(ValueError, match="read-only"):
        truth.noise[0, 0] = 1.0


def test_resistance_below_zero_is_an_error_that_names_the_layer() -> None:
    noise = np.zeros((2, 4))
    noise[1, 1] = -600.5
    with pytest.raises(ParameterError, match=r"0\.10-0\.20 m: .* falls to -0\.5 kPa"):
        Truth(FIELD, LAYERS, KPA.copy(), noise, SOIL)


def test_nan_is_no_resistance() -> None:
    kpa = KPA.copy()
    kpa[0, 0] = np.nan
    with pytest.raises(ParameterError, match=r"0\.00-0\.10 m"):
        Truth(FIELD, LAYERS, kpa, np.zeros((2, 4)), SOIL)


def test_arrays_must_fit_the_field() -> None:
    with pytest.raises(ParameterError, match=r"kpa is \(2, 3\), not \(2, 4\)"):
        Truth(FIELD, LAYERS, KPA[:, :3].copy(), np.zeros((2, 4)), SOIL)


def test_readings_of_a_truth_are_its_first_pushes_and_say_that_they_are_simulated() -> None:
    truth = draw_field(np.random.default_rng(1), "signal")
    cells = [5, 300, 17]
    readings = truth.readings(cells)
    expected = np.transpose([truth.reading(cell) for cell in cells])
    assert np.allclose(readings.layer_means(truth.layers), expected)
    assert (readings.at == truth.field.cells[cells]).all()
    assert readings.simulated
    assert readings.extent_m == truth.field.extent_m
