"""Answers that rounding decides are not given: against kriging with 50 digits."""

from __future__ import annotations

from collections.abc import Callable

import mpmath
import numpy as np
import pytest

from subsoil.arrays import Floats
from subsoil.errors import SingularSystemError
from subsoil.kriging import at_targets, condition
from subsoil.variogram import Bounded, Exponential, Gaussian, Matern32, Matern52

AT_95 = {Matern32: 4.743864518390585, Matern52: 5.918361182842417}


def correlation(kind: type[Bounded], h: mpmath.mpf) -> mpmath.mpf:
    if kind is Gaussian:
        return mpmath.e ** (-3 * h * h)
    if kind is Exponential:
        return mpmath.e ** (-3 * h)
    u = mpmath.mpf(AT_95[kind]) * h
    rise = 1 + u if kind is Matern32 else 1 + u + u * u / 3
    return rise * mpmath.e ** (-u)


def exact_mean(model: Bounded, at: Floats, z: Floats, target: Floats) -> float:
    """Ordinary kriging of a model without nugget, with 50 digits."""
    with mpmath.workdps(50):
        places = [[mpmath.mpf(x) for x in place] for place in (*at.tolist(), target.tolist())]
        n = len(at)

        def k(i: int, j: int) -> mpmath.mpf:
            away = [(a - b) ** 2 for a, b in zip(places[i], places[j], strict=True)]
            return correlation(type(model), mpmath.sqrt(sum(away)) / mpmath.mpf(model.range))

        left = mpmath.matrix(n + 1, n + 1)
        right = mpmath.matrix(n + 1, 1)
        for i in range(n):
            left[i, n] = left[n, i] = mpmath.mpf(1)
            right[i] = k(i, n)
            for j in range(n):
                left[i, j] = k(i, j)
        right[n] = mpmath.mpf(1)
        weights = mpmath.lu_solve(left, right)
        return float(sum(weights[i] * mpmath.mpf(float(z[i])) for i in range(n)))


def scattered(rng: np.random.Generator, n: int) -> Floats:
    return rng.uniform(0, 100, (n, 2))


def clustered(rng: np.random.Generator, n: int) -> Floats:
    middles = rng.uniform(0, 100, (max(1, n // 4), 2))
    return np.asarray(middles[rng.integers(len(middles), size=n)] + rng.normal(0, 0.01, (n, 2)))


def in_a_line(rng: np.random.Generator, n: int) -> Floats:
    along = rng.uniform(0, 100, n)
    return np.column_stack([along, 0.5 * along])


@pytest.mark.parametrize("design", [scattered, clustered, in_a_line])
@pytest.mark.parametrize("kind", [Gaussian, Matern52, Matern32, Exponential])
def test_what_is_answered_is_right_to_a_millionth(
    design: Callable[[np.random.Generator, int], Floats], kind: type[Bounded]
) -> None:
    rng = np.random.default_rng(11)
    answered = 0
    for _ in range(25):
        n = int(rng.integers(2, 14))
        at, z, target = design(rng, n), rng.normal(1000, 100, n), rng.uniform(-50, 150, 2)
        model = kind(0.0, float(10 ** rng.uniform(1, 3)), 900.0)
        try:
            ok = condition(model, at, z)
            mean, _ = ok.predict(target[None])
        except SingularSystemError:
            continue
        exact = exact_mean(model, ok.at, ok.z[0], target)
        assert abs(mean[0] - exact) <= 1e-6 * max(abs(exact), np.ptp(z))
        answered += 1
    assert answered >= 5


def test_a_mean_that_rounding_decides_is_not_given_however_it_is_asked_for() -> None:
    along = np.linspace(0.0, 100.0, 11)
    at, z = np.column_stack([along, along / 2]), np.random.default_rng(1).normal(1000, 100, 11)
    model, far = Gaussian(0.0, 120.0, 900.0), np.array([[-60.0, -60.0], [75.0, 75.0]])
    said = "is not determined to 1e-6 by 11 readings.*add a nugget.*closest readings"
    ok = condition(model, at, z)
    with pytest.raises(SingularSystemError, match=said):
        ok.predict(far)
    with pytest.raises(SingularSystemError, match=said):
        at_targets(ok, far)
    fewer = at_targets(condition(model, at[:5], z[:5]), far)
    with pytest.raises(SingularSystemError, match="is not determined"):
        fewer.append(at[5:], z[5:])
    mean, _ = ok.predict(at)
    assert mean == pytest.approx(z)


@pytest.mark.parametrize("kind", [Gaussian, Matern52, Matern32, Exponential])
def test_with_a_nugget_of_a_percent_everything_is_answered(kind: type[Bounded]) -> None:
    rng = np.random.default_rng(2)
    for design in (scattered, clustered, in_a_line):
        at, z = design(rng, 200), rng.normal(1000, 100, 200)
        mean, _ = condition(kind(9.0, 200.0, 900.0), at, z).predict(scattered(rng, 50))
        assert np.isfinite(mean).all()
