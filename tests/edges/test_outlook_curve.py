"""The picture of what more samples would buy."""

from __future__ import annotations

from math import nan

import numpy as np
import pytest

from subsoil.errors import ReadingsError
from subsoil.mapping.uncertainty import MeanSquare
from subsoil.plots import outlook_curve
from subsoil.report import Progress
from subsoil.survey.outlook import Outlook, Prospect

HISTORY = tuple(Progress(n, 50.0 * n, 2.0 * n, 90000.0 / n, nan) for n in range(2, 13))
ERROR = MeanSquare(7000.0, 60.0, 40.0)
AHEAD = tuple(Prospect(k, 2.0 * k, 0.0, 80.0 - k) for k in range(1, 21))


def test_it_goes_on_from_the_samples_taken_through_the_planned_stops() -> None:
    (axes,) = outlook_curve(HISTORY, Outlook(13, 81.0, ERROR, AHEAD, 5)).axes
    past, ahead, planned = (np.asarray(line.get_xydata()) for line in axes.get_lines())
    assert past[-1].tolist() == [12.0, pytest.approx(np.sqrt(7500.0))]
    assert ahead[0].tolist() == planned[0].tolist() == [13.0, 81.0]
    assert ahead[-1].tolist() == [33.0, 60.0]
    assert planned[-1].tolist() == [18.0, 75.0]


def test_without_planned_stops_there_are_two_curves() -> None:
    (axes,) = outlook_curve(HISTORY, Outlook(12, 81.0, ERROR, AHEAD, 0)).axes
    assert len(axes.get_lines()) == 2


def test_with_nothing_ahead_there_is_nothing_to_draw() -> None:
    with pytest.raises(ReadingsError, match="nothing to foresee"):
        outlook_curve(HISTORY, Outlook(1, nan, ERROR, (), 0))
