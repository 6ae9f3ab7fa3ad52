"""Further pushes are planned where they are worth their time, and only there."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from subsoil.errors import ParameterError
from subsoil.kriging import at_targets, condition
from subsoil.kriging.designs import Designs
from subsoil.land.field import Field
from subsoil.strategies import View, strategy_named
from subsoil.strategies.joint.plans import joint, joint_adaptive
from subsoil.strategies.joint.replicates import push_gains, replicates
from subsoil.variogram import Exponential, Nested, Structure
from subsoil.ways.routing import length

Look = Callable[..., View]

FIELD = Field.from_metres([(0, 0), (90, 0), (90, 60), (0, 60)])


def _shape(nugget: float, range_m: float = 50.0) -> Nested:
    return Nested(1.0, (Structure(1.0 - nugget, Exponential, range_m),))


def _designs(nugget: float, field: Field = FIELD) -> Designs:
    return Designs(field, _shape(nugget), np.ones(len(field.cells)))


@given(
    nugget=st.floats(0.001, 0.95),
    cells=st.lists(st.integers(0, len(FIELD.cells) - 1), min_size=2, max_size=8, unique=True),
    again=st.lists(st.integers(0, 7), max_size=4),
)
def test_the_gain_of_a_push_is_the_fall_of_the_mean_variance(
    nugget: float, cells: list[int], again: list[int]
) -> None:
    designs = _designs(nugget)
    readings = [*cells, *(cells[k % len(cells)] for k in again)]
    before = designs.mean_variance(readings)
    after = [designs.mean_variance([*readings, cell]) for cell in cells]
    assert push_gains(designs, readings, cells) == pytest.approx(before - np.array(after), abs=1e-8)


def test_a_cell_read_thrice_is_kriged_as_one_reading_with_a_third_of_the_noise() -> None:
    at = FIELD.cells[[10, 10, 10, 100]]
    kriged = at_targets(condition(_shape(0.4), at, np.array([1.0, 2.0, 6.0, 5.0])), FIELD.cells)
    assert _designs(0.4).mean_variance([10, 10, 10, 100]) == pytest.approx(
        kriged.prediction.variance.mean(), rel=1e-9
    )


def test_without_noise_no_push_is_worth_the_time_of_a_stop() -> None:
    readings, stops = (0, 17, 210), (60, 100, 150)
    assert replicates(_designs(1e-6), readings, stops, 3, 28.0, worth=1e-6) == (1, 1, 1)
    assert replicates(_designs(0.8), readings, stops, 3, 28.0, worth=1e-6) == (3, 3, 3)


def test_pushes_keep_to_the_time_and_to_the_most_there_may_be() -> None:
    stops = (60, 100, 150)
    pushes = replicates(_designs(0.7), (), stops, 3, 28.0, seconds=4 * 28.0 + 27.0)
    assert sum(pushes) == len(stops) + 4
    assert max(pushes) <= 3
    assert replicates(_designs(0.7), (), stops, 3, 28.0, seconds=27.0) == (1, 1, 1)


@pytest.mark.parametrize("nugget", [0.01, 0.9])
def test_a_plan_trades_stops_for_pushes_where_noise_dominates(look: Look, nugget: float) -> None:
    visited, plan, minutes = (0, 40, 90, 130, 180, 200), (20, 110), 25.0
    models = (_shape(nugget),) * 2
    view = look(FIELD, visited=visited, plan=plan, budget=200, variograms=models)
    view = replace(view, minutes_left=minutes)
    plain = joint_adaptive(view)
    pushed = joint_adaptive(replace(view, rng=np.random.default_rng(0)), most_pushes=3)
    if nugget < 0.5:
        assert pushed == plain
        return
    assert len(pushed.cells) < len(plain.cells)
    designs = _designs(nugget)
    again = [c for c, k in zip(pushed.cells, pushed.pushes, strict=True) for _ in range(k)]
    before = designs.mean_variance([*visited, *plain.cells])
    assert designs.mean_variance([*visited, *again]) < 0.995 * before
    metres = length(view.access, view.position, FIELD.cells[list(pushed.cells)])
    further = sum(pushed.pushes) - len(pushed.cells)
    assert view.pace.minutes(metres, len(pushed.cells), further) <= minutes


def test_plans_have_one_push_a_stop_unless_more_are_asked_for(
    look: Look, fields: dict[str, Field]
) -> None:
    view = look(fields["L"], budget=6, fresh=True)
    assert joint(view, sweeps=2).pushes == ()
    with pytest.raises(ParameterError, match="0 pushes read nothing"):
        joint(replace(view, rng=np.random.default_rng(0)), sweeps=2, most_pushes=0)
    assert strategy_named("joint-adaptive", {"most_pushes": 3.0}) is not joint_adaptive
