"""What kriging says where it has no answer: which model, which layer, which readings."""

from __future__ import annotations

import re
import resource
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.distance import pdist, squareform

from subsoil.errors import ParameterError, ReadingsError, SingularSystemError
from subsoil.kriging import block_out, condition, leave_one_out
from subsoil.kriging.drift import Covariate, leave_one_out_with
from subsoil.kriging.memory import available_gib, check_memory, needed_gib
from subsoil.kriging.readings import Readings
from subsoil.kriging.validity import circular_note, ill_conditioned, not_determined, singular
from subsoil.variogram import BoundedLinear, Gaussian, Spherical

ROUGH, SMOOTH = Spherical(0.1, 20.0, 1.0), Gaussian(0.0, 300.0, 1.0)


@given(st.integers(0, 2**31), st.integers(2, 12))
def test_the_closest_two_readings_are_named_with_their_distance(seed: int, n: int) -> None:
    at = np.random.default_rng(seed).uniform(0, 100, (n, 2)).round(2)
    readings = Readings(at, np.zeros((1, n)), np.zeros((1, n)), np.ones((1, n)))
    error = singular(readings, (ROUGH,), 0)
    numbers = [float(x) for x in re.findall(r"[\d.]+(?:e-?\d+)?", error.remedy)]
    one, other, apart = numbers[:2], numbers[2:4], numbers[4]
    nearest = squareform(pdist(at)) + np.diag(np.full(n, np.inf))
    assert apart == pytest.approx(nearest.min(), rel=5e-3)
    assert np.hypot(*np.subtract(one, other)) == pytest.approx(nearest.min(), rel=5e-3, abs=1e-2)


def test_the_layer_is_named_where_each_has_a_model_of_its_own() -> None:
    at = np.random.default_rng(5).uniform(0, 30, (40, 2))
    with pytest.raises(SingularSystemError) as raised:
        condition([ROUGH, SMOOTH, ROUGH], at, np.zeros((3, 40)), exact=True)
    assert raised.value.where == f"layer 2, {SMOOTH}"
    with pytest.raises(SingularSystemError) as raised:
        condition(SMOOTH, at, np.zeros((3, 40)), exact=True)
    assert raised.value.where == str(SMOOTH)
    readings = Readings(at, np.zeros((2, 40)), np.zeros((2, 40)), np.ones((2, 40)))
    said = not_determined(readings, (ROUGH, SMOOTH), 1, np.array([1.5, 2.0]))
    assert said.where == f"layer 2, {SMOOTH}"
    assert "(1.5, 2) is not determined to 1e-6 by 40 readings" in said.what
    assert ill_conditioned(-0.25, (ROUGH,), 0).remedy == "add a nugget or choose a rougher model"


@pytest.mark.parametrize(
    ("models", "said"),
    [([True], "these readings: kriged"), ([False, True, True], "these readings in layer 2, 3: ")],
)
def test_a_note_names_the_layers_whose_model_was_replaced(models: list[bool], said: str) -> None:
    assert said in circular_note(np.array(models))


def test_only_the_linear_model_that_is_invalid_is_replaced() -> None:
    cells = np.stack(np.meshgrid(np.arange(6.0), np.arange(6.0)), -1).reshape(-1, 2) * 10.0
    z = np.random.default_rng(0).normal(size=(3, 36))
    bad, good = BoundedLinear(0.0, 10 * np.sqrt(2), 1.0), BoundedLinear(0.9, 25.0, 0.1)
    models = [ROUGH, bad, good]
    mean, _ = (ok := condition(models, cells, z)).predict(cells + 3.0)
    assert ok.variograms == (ROUGH, bad.circular(), good)
    assert "in layer 2:" in ok.notes[0]
    for k, model in enumerate(ok.variograms):
        alone = condition(model, cells, z[k]).predict(cells + 3.0).mean
        assert mean[k] == pytest.approx(alone, rel=1e-9, abs=1e-9)


def test_a_covariate_that_is_the_same_everywhere_cannot_be_followed_and_says_what_to_do() -> None:
    at = np.random.default_rng(1).uniform(0, 50, (5, 2))
    with pytest.raises(SingularSystemError) as raised:
        leave_one_out_with(Covariate(at, np.full(5, 3.0)), condition(ROUGH, at, np.arange(5.0)))
    assert raised.value.where == "external drift"
    assert raised.value.remedy == "sample where it differs, or leave it out"


def test_leaving_out_from_too_little_is_refused_in_one_line() -> None:
    at = np.array([[0.0, 0.0], [9.0, 0.0]])
    with pytest.raises(ReadingsError, match="three readings or more, not 2"):
        leave_one_out_with(Covariate(at, np.arange(2.0)), condition(ROUGH, at, np.arange(2.0)))
    with pytest.raises(ReadingsError, match="three readings or more, not 1"):
        leave_one_out(condition(ROUGH, np.repeat(at[:1], 4, axis=0), np.arange(4.0)))
    with pytest.raises(ReadingsError, match="use smaller blocks"):
        block_out(ROUGH, at, np.arange(2.0), 10.0)


@pytest.mark.parametrize(
    "axis", [[], [[0.0, 1.0]], [0.0, np.inf], [1.0, 1.0], [2.0, 1.0], [0.0, 1.0, 2.1]]
)
@pytest.mark.parametrize("which", ["easting", "northing"])
def test_an_axis_of_a_dense_map_is_named_where_it_is_not_even(
    axis: list[float], which: str
) -> None:
    ok = condition(ROUGH, [[0.0, 0.0], [9.0, 9.0]], [1.0, 2.0])
    axes = {"easting": [0.0, 1.0], "northing": [0.0, 1.0], which: axis}
    with pytest.raises(ParameterError) as raised:
        ok.predict_grid(**axes)
    assert raised.value.where == which


# --- memory ---------------------------------------------------------------------------------------


@given(
    st.integers(1, 30_000), st.lists(st.integers(1, 30_000), max_size=4), st.integers(0, 10**7),
    st.integers(1, 40),
)  # fmt: skip
def test_more_of_anything_never_takes_less_memory(
    readings: int, systems: list[int], cells: int, layers: int
) -> None:
    needed = needed_gib(readings, systems=systems, cells=cells, layers=layers)
    assert needed > 0.2
    assert needed_gib(readings + 1, systems=systems, cells=cells, layers=layers) >= needed
    assert needed_gib(readings, systems=[*systems, 1], cells=cells, layers=layers) >= needed
    assert needed_gib(readings, systems=systems, cells=cells + 1, layers=layers) >= needed
    assert needed_gib(readings, systems=systems, cells=cells, layers=layers + 1) >= needed


def test_what_does_not_fit_is_refused_with_what_would() -> None:
    needed = needed_gib(10**7)
    with pytest.raises(ReadingsError) as raised:
        check_memory(10**7)
    assert raised.value.what.startswith(f"10000000 readings take about {needed:.1f} GiB")
    assert (raised.value.where, raised.value.remedy) == ("kriging", "thin the readings")
    with pytest.raises(ReadingsError) as raised:
        check_memory(10, systems=[10**7], cells=4_000, layers=8)
    assert "10 readings mapped on 4000 cells take" in raised.value.what
    assert "larger cells" in raised.value.remedy


def test_a_limit_set_on_the_process_is_what_there_is() -> None:
    assert 0 < available_gib() < 1e6
    code = "from subsoil.kriging.memory import available_gib; print(available_gib())"
    limit = 3 << 29

    def limited() -> None:
        resource.setrlimit(resource.RLIMIT_AS, (limit, limit))

    done = subprocess.run(
        [sys.executable, "-c", code], preexec_fn=limited, capture_output=True, text=True, check=True
    )
    assert 0 < float(done.stdout) <= 1.5
