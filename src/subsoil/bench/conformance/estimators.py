"""Rules that every estimator of variograms keeps, whatever was read."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from math import isfinite
from time import process_time
from types import MappingProxyType

import numpy as np

from subsoil.arrays import Floats
from subsoil.bench.conformance.courses import driven, fields, how
from subsoil.bench.conformance.rule import Rule, Subject
from subsoil.bench.conformance.strategies import end_of
from subsoil.registry import handed_over
from subsoil.strategies import area_split
from subsoil.variogram import Fit, estimator_named, semivariance

Given = tuple[Floats, Floats]
"""Places (n, 2) in m and values (m, n) in kPa, NaN where a layer was not measured."""

_USUAL = "30 places, 3 layers"
_CLOSE = 1e-6
"""Difference of semivariances, in sills, that is none."""
_LAGS = np.array([0.0, 1.0, 5.0, 15.0, 40.0, 100.0, 250.0])


@cache
def readings() -> Mapping[str, Given]:
    """Readings by name: usual ones, few, and odd ones."""
    rng = np.random.default_rng(11)
    at = rng.uniform(0.0, (180.0, 130.0), (30, 2))
    waves = np.sin(at @ rng.normal(0.0, 0.04, (2, 3)) + rng.uniform(0.0, 6.0, 3)).T
    kpa = 1500.0 + 200.0 * waves + 80.0 * rng.standard_normal((3, 30))
    gaps, empty, alike = kpa.copy(), kpa.copy(), kpa.copy()
    gaps[1, ::3] = np.nan
    empty[2] = np.nan
    alike[0] = 1500.0
    line = np.column_stack([at[:, 0], np.full(30, 20.0)])
    twice = at.copy()
    twice[1] = twice[0]
    return MappingProxyType(
        {
            _USUAL: (at, kpa),
            "a layer with gaps": (at, gaps),
            "a layer that nothing reached": (at, empty),
            "a layer of equal values": (at, alike),
            "places on one line": (line, kpa),
            "two readings at one place": (twice, kpa),
            **{f"{n} samples": (at[:n], kpa[:, :n]) for n in (3, 2, 1, 0)},
        }
    )


def gives_one_a_layer(subject: Subject, case: str) -> str:
    """One variogram a layer, of any number of samples."""
    at, z = readings()[case]
    found = _fits(subject, at, z)
    return "" if len(found) == len(z) else f"it gives {len(found)} for {len(z)} layers"


def gives_finite_parameters(subject: Subject, case: str) -> str:
    """Nugget and sill are finite and not negative, the range is finite."""
    for k, fit in enumerate(_fits(subject, *readings()[case]), start=1):
        model = fit.variogram
        for name in ("nugget", "psill", "range"):
            value = getattr(model, name)
            if not (isfinite(value) and value >= 0.0):
                return f"layer {k} has a {name} of {value:g}"
    return ""


def knows_no_order(subject: Subject, case: str) -> str:
    """Readings in another order give the same."""
    at, z = readings()[case]
    order = np.random.default_rng(5).permutation(len(at))
    return _differs(_fits(subject, at, z), _fits(subject, at[order], z[:, order]))


def knows_no_origin(subject: Subject, case: str) -> str:
    """Places moved together give the same."""
    at, z = readings()[case]
    return _differs(_fits(subject, at, z), _fits(subject, at + np.array([4096.0, -512.0]), z))


def follows_the_unit(subject: Subject, case: str) -> str:
    """Values twice as large have four times the semivariance."""
    at, z = readings()[case]
    return _differs(_fits(subject, at, z), _fits(subject, at, 2.0 * z), times=4.0)


def repeats_itself(subject: Subject, case: str) -> str:
    """The same readings give the same, exactly."""
    one, other = (_fits(subject, *readings()[case]) for _ in range(2))
    for k, (first, second) in enumerate(zip(one, other, strict=True), start=1):
        if first.variogram != second.variogram:
            return f"layer {k} is {first.variogram} at first, then {second.variogram}"
    return ""


def leaves_readings_alone(subject: Subject, case: str) -> str:
    """Places and values are the same after as before."""
    at, z = (array.copy() for array in readings()[case])
    estimator_named(subject.name, allowed=subject.allowed)(at, z)
    before = readings()[case]
    for name, array, was in zip(("places", "values"), (at, z), before, strict=True):
        if not np.array_equal(array, was, equal_nan=True):
            return f"it changes the {name} that it is given"
    return ""


def serves_a_survey(subject: Subject, case: str) -> str:
    """A survey that estimates with it after every sample goes to its end."""
    name, allowed = handed_over(area_split)
    configured = how(name, 6, estimator=subject.name)
    return end_of(driven(fields()[case], configured, allowed=subject.allowed | allowed))


def estimate_s(subject: Subject) -> float:
    """Processor time in s of the variograms of 30 places and 3 layers."""
    begun = process_time()
    _fits(subject, *readings()[_USUAL])
    return process_time() - begun


def _fits(subject: Subject, at: Floats, z: Floats) -> tuple[Fit, ...]:
    return estimator_named(subject.name, allowed=subject.allowed)(at.copy(), z.copy())


def _differs(one: tuple[Fit, ...], other: tuple[Fit, ...], times: float = 1.0) -> str:
    """How the second curves differ from a multiple of the first; empty if they do not."""
    for k, (first, second) in enumerate(zip(one, other, strict=True), start=1):
        wanted = times * semivariance(first.variogram, _LAGS)
        found = semivariance(second.variogram, _LAGS)
        away = np.abs(found - wanted)
        if not away.max() <= _CLOSE * wanted.max():
            lag = int(np.argmax(away))
            return (
                f"layer {k} has a semivariance of {found[lag]:g} kPa2 at {_LAGS[lag]:g} m, "
                f"not {wanted[lag]:g}"
            )
    return ""


_EVERY = tuple(readings())
_ORDINARY = (_USUAL, "a layer with gaps", "places on one line", "two readings at one place")
RULES = (
    Rule(
        "it gives one variogram a layer, of any number of samples",
        "answer with a prior where there is too little to learn from",
        _EVERY,
        gives_one_a_layer,
    ),
    Rule(
        "nugget and sill are finite and not negative, the range is finite",
        "answer with a prior where there is too little to learn from",
        _EVERY,
        gives_finite_parameters,
    ),
    Rule(
        "the order of the readings does not matter",
        "treat all pairs of readings alike",
        _ORDINARY,
        knows_no_order,
    ),
    Rule(
        "the origin of the places does not matter",
        "look at distances between places alone",
        _ORDINARY,
        knows_no_origin,
    ),
    Rule(
        "values twice as large have four times the semivariance",
        "let every sill and nugget follow the variance of the values",
        _ORDINARY,
        follows_the_unit,
    ),
    Rule(
        "the same readings give the same variograms, exactly",
        "draw nothing by chance, and keep nothing between calls",
        _ORDINARY,
        repeats_itself,
    ),
    Rule(
        "it leaves places and values as they are",
        "copy arrays before changing them",
        _EVERY,
        leaves_readings_alone,
    ),
    Rule(
        "a survey that estimates with it after every sample goes to its end",
        "answer for any number of samples, also none",
        ("L", "tiny"),
        serves_a_survey,
    ),
)
"""Rules in the order in which they are tried."""
