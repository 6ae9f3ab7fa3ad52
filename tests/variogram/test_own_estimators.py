"""An estimator of somebody's own: what it answers is looked at, and what it lacks is named."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pytest

from subsoil.arrays import Floats
from subsoil.errors import ParameterError, ReadingsError
from subsoil.registry import Allowed
from subsoil.variogram import (
    Bounded,
    Exponential,
    Fit,
    LeastSquares,
    Nested,
    Pooled,
    Power,
    Spherical,
    Structure,
    bins_of,
    empirical_layers,
    estimator_named,
)
from subsoil.variogram.own import Checked, Own

AT = np.random.default_rng(1).uniform(0, 100, (12, 2))
KPA = np.random.default_rng(2).normal(1500, 200, (3, 12))
MODEL = Spherical(100.0, 50.0, 900.0)


def checked(own: Own, name: str = "mine:own") -> tuple[Fit, ...]:
    return Checked(name, own)(AT, KPA)


def refusal(own: Own, name: str = "mine:own") -> ParameterError:
    with pytest.raises(ParameterError) as raised:
        checked(own, name)
    assert "\n" not in str(raised.value)
    return raised.value


def test_models_become_fits_with_the_bins_of_their_layer_and_the_estimators_name() -> None:
    nested = Nested(50.0, (Structure(0.5, Exponential, 30.0),))
    first, second, third = checked(lambda *_: [MODEL, nested, Exponential(0.0, 9.0, 1.0)])
    assert (first.variogram, second.variogram) == (MODEL, nested)
    assert (third.why, third.is_prior) == ("mine:own", False)
    for fit, bins in zip((first, second, third), empirical_layers(AT, KPA), strict=True):
        assert fit.empirical.semivariance.tolist() == bins.semivariance.tolist()


def test_fits_are_taken_as_they_are() -> None:
    given = LeastSquares(Spherical)(AT, KPA)
    assert checked(lambda *_: given) == given
    assert checked(lambda at, z: iter(LeastSquares(Spherical)(at, z)))[1].why == given[1].why  # type: ignore[arg-type, return-value]


@pytest.mark.parametrize(
    ("answer", "said"),
    [
        ([MODEL] * 2, "it gave 2 variograms for 3 layers"),
        ([], "it gave 0 variograms for 3 layers"),
        ([MODEL, Power(1.0, 2.0), MODEL], "for layer 2, which is no variogram"),
        ([MODEL, MODEL, Spherical], "for layer 3, which is no variogram"),
        (
            ["x" * 500, MODEL, MODEL],
            "it gave 'xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx... for layer",
        ),
    ],
)
def test_another_answer_than_a_model_a_layer_is_refused_with_what_to_do(
    answer: Sequence[Bounded], said: str
) -> None:
    error = refusal(lambda *_: answer)
    assert said in error.what
    assert error.where == "estimator mine:own"
    assert error.remedy.startswith("let it give")
    assert len(str(error)) < 300


def test_what_fails_in_one_layer_only_is_named_with_the_first_such_layer() -> None:
    def failing(at: Floats, z: Floats) -> list[Spherical]:  # noqa: ARG001 - as estimators are called
        if KPA[1, 0] in z[:, 0]:
            raise ZeroDivisionError("y" * 900)
        return [MODEL] * len(z)

    error = refusal(failing)
    assert error.what.startswith("it failed in layer 2: ZeroDivisionError: yyy")
    assert len(error.what) < 260
    assert isinstance(error.__cause__, ZeroDivisionError)
    assert "also one with few readings or none" in error.remedy


def test_what_fails_with_all_layers_together_only_names_none() -> None:
    def one_at_a_time(at: Floats, z: Floats) -> list[Spherical]:  # noqa: ARG001
        (_,) = z
        return [MODEL]

    assert refusal(one_at_a_time).what.startswith("it failed: ValueError: too many values")


def test_an_answer_that_is_nothing_at_all_is_a_failure_and_no_traceback() -> None:
    assert refusal(lambda *_: None).what.startswith("it failed: TypeError")  # type: ignore[arg-type]


def test_an_error_that_it_raises_on_purpose_comes_through_as_it_is() -> None:
    mine = ReadingsError("the cone was bent", where="row 3", remedy="leave it out")

    def refusing(at: Floats, z: Floats) -> list[Spherical]:  # noqa: ARG001
        raise mine

    with pytest.raises(ReadingsError) as raised:
        checked(refusing)
    assert raised.value is mine


def test_a_long_name_is_cut_short_in_its_errors() -> None:
    assert refusal(lambda *_: [], "m" * 400).where == f"estimator {'m' * 40}..."


# --- by name, with settings -----------------------------------------------------------------------


@dataclass(frozen=True)
class Mine:
    """An estimator with numbers to set, and one setting that is none."""

    reach: float = 40.0
    most: int = 3
    words: str = "so"

    def __call__(self, at: Floats, z: Floats) -> list[Spherical]:  # noqa: ARG002
        return [Spherical(0.0, self.reach, float(self.most)) for _ in z]


GIVEN = Allowed(given={"mine:Mine": Mine(), "mine:plain": lambda *_: [MODEL]})


def test_settings_reach_an_estimator_of_ones_own_and_whole_numbers_stay_whole() -> None:
    set_to = estimator_named("mine:Mine", settings={"reach": 70.0, "most": 5.0}, allowed=GIVEN)
    fits = set_to(AT, KPA)
    assert fits[0].variogram == Spherical(0.0, 70.0, 5.0)
    assert isinstance(set_to, Checked)
    assert isinstance(set_to.own, Mine)
    assert type(set_to.own.most) is int


@pytest.mark.parametrize(
    ("name", "key", "said", "remedy"),
    [
        ("mine:plain", "reach", "estimator mine:plain has no parameters", ""),
        ("mine:Mine", "words", "no parameter 'words' that is a number", "it has reach, most"),
        ("spherical", "model", "no parameter 'model' that is a number", "it has starts, polish"),
        ("pmc", "r" * 99, f"no parameter '{'r' * 40}...' that", "it has shortest_range"),
    ],
)
def test_a_setting_that_there_is_not_is_answered_with_those_there_are(
    name: str, key: str, said: str, remedy: str
) -> None:
    with pytest.raises(ParameterError) as raised:
        estimator_named(name, settings={key: 1.0}, allowed=GIVEN)
    assert said in raised.value.what
    assert raised.value.where == "estimator"
    assert raised.value.remedy.startswith(remedy)


def test_ranges_follow_the_field_for_the_pooled_one_alone_and_before_settings() -> None:
    pooled = estimator_named("pmc", 444.0, {"median_range": 100.0})
    assert isinstance(pooled, Pooled)
    assert (pooled.median_range, pooled.longest_range) == (100.0, 320.0)
    own = Allowed(given={"mine:pooled": Pooled()})
    assert estimator_named("mine:pooled", 444.0, allowed=own) == Pooled()
    assert estimator_named("spherical", 444.0) == estimator_named("spherical", 222.0)


def test_bins_are_those_the_estimator_looks_at() -> None:
    wide = LeastSquares(Spherical, bin_width=25.0, cutoff=75.0)
    assert [curve.lag.size for curve in bins_of(wide, AT, KPA)] == [3, 3, 3]
    usual = [curve.pairs.tolist() for curve in empirical_layers(AT, KPA)]
    assert [curve.pairs.tolist() for curve in bins_of(Pooled(), AT, KPA)] == usual
