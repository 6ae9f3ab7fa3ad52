"""Variogram models: conventions against peers, validity, and bad parameters."""

from __future__ import annotations

from math import inf, pi, sqrt

import gstools
import numpy as np
import pykrige.variogram_models as pykrige
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.spatial.distance import cdist

from subsoil.errors import ParameterError
from subsoil.variogram import (
    MODELS,
    Bounded,
    BoundedLinear,
    Circular,
    Exponential,
    Gaussian,
    Matern32,
    Matern52,
    Power,
    PureNugget,
    Spherical,
    Variogram,
    model_named,
    name_of,
    semivariance,
)

NUGGET, RANGE, PSILL = 1.5, 42.0, 6.0
LAG = np.linspace(0.25, 120.0, 480)
GSTOOLS = {
    BoundedLinear: gstools.Linear(dim=1, var=PSILL, len_scale=RANGE, nugget=NUGGET),
    Circular: gstools.Circular(dim=2, var=PSILL, len_scale=RANGE, nugget=NUGGET),
    Spherical: gstools.Spherical(dim=2, var=PSILL, len_scale=RANGE, nugget=NUGGET),
    Exponential: gstools.Exponential(dim=2, var=PSILL, len_scale=RANGE / 3, nugget=NUGGET),
    Gaussian: gstools.Gaussian(
        dim=2, var=PSILL, len_scale=RANGE / sqrt(3), nugget=NUGGET, rescale=1.0
    ),
    Matern32: gstools.Matern(
        dim=2, var=PSILL, len_scale=RANGE * sqrt(1.5) / 4.743864518390585, nugget=NUGGET, nu=1.5
    ),
    Matern52: gstools.Matern(
        dim=2, var=PSILL, len_scale=RANGE * sqrt(2.5) / 5.918361182842417, nugget=NUGGET, nu=2.5
    ),
}


def smallest_eigenvalue(model: type[Bounded], at: NDArray[np.floating], reach: float) -> float:
    return float(np.linalg.eigvalsh(model.correlation(cdist(at, at) / reach))[0])


every_model = pytest.mark.parametrize("model", MODELS.values(), ids=MODELS)


@pytest.mark.parametrize("model", GSTOOLS, ids=lambda model: model.__name__)
def test_semivariance_is_that_of_gstools(model: type[Bounded]) -> None:
    ours = semivariance(model(NUGGET, RANGE, PSILL), LAG)
    np.testing.assert_allclose(ours, GSTOOLS[model].variogram(LAG), rtol=1e-9)


def test_every_bounded_model_has_a_peer_in_gstools() -> None:
    assert set(GSTOOLS) == set(MODELS.values())


def test_exponential_and_spherical_are_those_of_pykrige_at_the_same_range() -> None:
    parameters = [PSILL, RANGE, NUGGET]
    np.testing.assert_allclose(
        semivariance(Exponential(NUGGET, RANGE, PSILL), LAG),
        pykrige.exponential_variogram_model(parameters, LAG),
        rtol=1e-12,
    )
    np.testing.assert_allclose(
        semivariance(Spherical(NUGGET, RANGE, PSILL), LAG),
        pykrige.spherical_variogram_model(parameters, LAG),
        rtol=1e-12,
    )


def test_gaussian_is_that_of_pykrige_at_7_over_4_root_3_of_the_range() -> None:
    np.testing.assert_allclose(
        semivariance(Gaussian(NUGGET, RANGE, PSILL), LAG),
        pykrige.gaussian_variogram_model([PSILL, RANGE * 7 / (4 * sqrt(3)), NUGGET], LAG),
        rtol=1e-12,
    )


def test_power_is_that_of_pykrige_and_exponent_one_its_linear() -> None:
    np.testing.assert_allclose(
        semivariance(Power(NUGGET, 0.3, 1.4), LAG),
        pykrige.power_variogram_model([0.3, 1.4, NUGGET], LAG),
        rtol=1e-12,
    )
    np.testing.assert_allclose(
        semivariance(Power(NUGGET, 0.3), LAG),
        pykrige.linear_variogram_model([0.3, NUGGET], LAG),
        rtol=1e-12,
    )


@every_model
def test_range_is_where_95_percent_of_the_rise_is_made_or_all_of_it(model: type[Bounded]) -> None:
    left = float(model.correlation(np.array([1.0]))[0])
    if model.breaks:
        assert left == pytest.approx(0.0, abs=1e-12)
        assert np.all(model.correlation(np.array([1.0 + 1e-9, 2.0, 1e6])) == 0)
    else:
        assert left == pytest.approx(0.05, abs=3e-4)


@every_model
def test_correlation_is_one_at_zero_and_its_fall_is_continuous(model: type[Bounded]) -> None:
    assert float(model.correlation(np.array([0.0]))[0]) == pytest.approx(1.0, abs=1e-15)
    steps = np.diff(model.correlation(np.linspace(0, 3, 30001)))
    assert np.abs(steps).max() < 4e-4


@every_model
def test_correlation_is_not_negative_by_rounding_just_inside_the_range(
    model: type[Bounded],
) -> None:
    assert model.correlation(1.0 - np.geomspace(1e-16, 1e-9, 3000)).min() >= 0


@every_model
@given(distance=st.lists(st.floats(0, 1e4), min_size=2, max_size=40))
def test_correlation_never_increases_and_stays_between_0_and_1(
    model: type[Bounded], distance: list[float]
) -> None:
    correlation = model.correlation(np.sort(np.array(distance)))
    assert np.all(np.diff(correlation) <= 1e-15)
    assert np.all((correlation >= 0) & (correlation <= 1 + 1e-15))


@pytest.mark.parametrize("model", [model for model in MODELS.values() if model.valid_dims >= 2])
@settings(max_examples=40, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    n=st.integers(2, 40),
    extent=st.floats(0.5, 20.0),
    on_grid=st.booleans(),
)
def test_models_valid_in_the_plane_have_covariances_without_negative_eigenvalues(
    model: type[Bounded], seed: int, n: int, extent: float, on_grid: bool
) -> None:
    at = np.random.default_rng(seed).uniform(0, extent, (n, 2))
    if on_grid:
        at = np.floor(at)
    assert smallest_eigenvalue(model, at, 1.0) > -1e-12


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), n=st.integers(2, 40), extent=st.floats(0.5, 20.0))
def test_every_model_is_valid_on_a_line(seed: int, n: int, extent: float) -> None:
    at = np.random.default_rng(seed).uniform(0, extent, (n, 1)) @ np.array([[0.6, 0.8]])
    assert all(smallest_eigenvalue(model, at, 1.0) > -1e-12 for model in MODELS.values())


def test_bounded_linear_is_invalid_in_the_plane_where_the_circular_of_its_slope_is_not() -> None:
    """A chequerboard of weights on a square grid, the range its diagonal (weights sum to 0)."""
    linear = BoundedLinear(nugget=0.0, range=10 * sqrt(2), psill=1.0)
    column, row = np.meshgrid(np.arange(6), np.arange(6))
    at = 10.0 * np.column_stack([column.ravel(), row.ravel()])
    chequers = (-1.0) ** (column + row).ravel()
    covariance = linear.correlation(cdist(at, at) / linear.range)
    assert linear.valid_dims == 1
    assert chequers.sum() == 0
    # 36 places of variance 1; 60 pairs of neighbours of opposite sign, covariance 1 - 1/sqrt 2
    assert chequers @ covariance @ chequers == pytest.approx(36 - 120 * (1 - sqrt(0.5)))
    assert smallest_eigenvalue(BoundedLinear, at, linear.range) < -0.05
    circular = linear.circular()
    assert circular.valid_dims == 2
    assert smallest_eigenvalue(Circular, at, circular.range) > 0.1


def test_circular_of_a_linear_model_keeps_nugget_sill_and_slope_at_the_origin() -> None:
    linear = BoundedLinear(NUGGET, RANGE, PSILL)
    circular = linear.circular()
    assert (circular.nugget, circular.psill) == (NUGGET, PSILL)
    assert circular.range == pytest.approx(4 / pi * RANGE)
    step = np.array([1e-6 * RANGE])
    np.testing.assert_allclose(circular.rise(step), linear.rise(step), rtol=1e-9)


def test_semivariance_jumps_by_the_nugget_off_zero_only() -> None:
    for model in (PureNugget(2.0), Power(2.0, 0.5), Exponential(2.0, 30.0, 5.0)):
        assert isinstance(model, Variogram)
        at_zero, just_off = semivariance(model, [0.0, 1e-12])
        assert at_zero == 0
        assert just_off == pytest.approx(2.0)


def test_sill_is_nugget_plus_partial_sill_and_infinite_without_bound() -> None:
    assert Spherical(NUGGET, RANGE, PSILL).sill == NUGGET + PSILL
    assert PureNugget(NUGGET).sill == NUGGET
    assert Power(NUGGET, 1.0).sill == inf


@pytest.mark.parametrize(
    ("nugget", "reach", "psill", "name"),
    [
        (-1.0, 10.0, 1.0, "nugget"),
        (np.nan, 10.0, 1.0, "nugget"),
        (inf, 10.0, 1.0, "nugget"),
        (1.0, 0.0, 1.0, "range"),
        (1.0, np.nan, 1.0, "range"),
        (1.0, 10.0, -1e-9, "psill"),
        (1.0, 10.0, inf, "psill"),
    ],
)
def test_bounded_models_refuse_impossible_parameters(
    nugget: float, reach: float, psill: float, name: str
) -> None:
    with pytest.raises(ParameterError, match=f"variogram {name}"):
        Spherical(nugget, reach, psill)


def test_unbounded_models_refuse_impossible_parameters() -> None:
    with pytest.raises(ParameterError, match="nugget"):
        PureNugget(-1.0)
    with pytest.raises(ParameterError, match="scale"):
        Power(1.0, -1.0)
    for exponent in (0.0, 2.0, np.nan):
        with pytest.raises(ParameterError, match="exponent"):
            Power(1.0, 1.0, exponent)


@pytest.mark.parametrize("name", MODELS)
def test_a_model_is_found_by_its_name_and_knows_it(name: str) -> None:
    assert name_of(model_named(name)(1.0, 2.0, 3.0)) == name


def test_an_unknown_name_is_answered_with_the_known_ones() -> None:
    with pytest.raises(ParameterError, match="spherical") as raised:
        model_named("cubic")
    assert "\n" not in str(raised.value)
