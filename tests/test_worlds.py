"""A simulated survey goes on in the soil it began in, or says why it does not."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from subsoil import worlds
from subsoil.errors import JournalError, MissingExtraError, ParameterError
from subsoil.land.field import Field
from subsoil.layers import Layers
from subsoil.notebook import table
from subsoil.optional import install, load, require
from subsoil.penetrometer import SMALL_CONE
from subsoil.simulation import Kriged
from subsoil.survey import LocalDispatch, Memory, Survey, opened, opening
from subsoil.survey.events import Simulation
from subsoil.survey.simulated import simulation_of
from subsoil.worlds import WORLDS, demo_field, soil_of, soil_to_survey, truth_of

FIELD = Field.from_metres([(0, 0), (60, 0), (60, 40), (0, 40)], name="plot")
LAYERS = Layers((0.0, 0.2, 0.4))


def joined(kind: str = "simulator", simulation: Simulation | None = None) -> Survey:
    """A survey that one agent has joined."""
    dispatch = LocalDispatch(opened(opening(FIELD, LAYERS, SMALL_CONE)), Memory())
    dispatch.join("rob", kind, simulation=simulation)  # type: ignore[arg-type]
    return dispatch.survey


def begun(seed: int = 4) -> Survey:
    truth = truth_of("simulated", FIELD, LAYERS, seed)
    return joined(simulation=simulation_of(truth, "simulated", seed))


def test_a_survey_goes_on_in_the_soil_that_it_began_in_whatever_seed_is_given() -> None:
    survey = begun()
    truth, record = soil_to_survey(survey, None, seed=99)
    assert np.array_equal(truth.kpa, truth_of("simulated", FIELD, LAYERS, 4).kpa)
    assert record == survey.simulation[0]
    named, _ = soil_to_survey(survey, "simulated", seed=99)
    assert np.array_equal(named.kpa, truth.kpa)


def test_a_survey_that_nobody_began_gets_the_soil_of_its_seed() -> None:
    new = opened(opening(FIELD, LAYERS, SMALL_CONE))
    truth, record = soil_to_survey(new, None, seed=7)
    assert (record.world, record.seed) == ("simulated", 7)
    assert np.array_equal(truth.kpa, truth_of("simulated", FIELD, LAYERS, 7).kpa)


def off(survey: Survey) -> Survey:
    record = survey.simulation[0]
    kpa = (record.check_kpa[0] * 1.001, *record.check_kpa[1:])
    return replace(survey, simulation=(record.model_copy(update={"check_kpa": kpa}),))


@pytest.mark.parametrize(
    ("ask", "said"),
    [
        (
            lambda: soil_of(joined("robot")),
            "plot: rob began it on real land, which is not simulated "
            "(remedy: a person goes on with `subsoil next`; simulate in a survey of its own)",
        ),
        (
            lambda: soil_of(opened(opening(FIELD, LAYERS, SMALL_CONE))),
            "plot: nobody has begun to survey (remedy: subsoil run SURVEY.gpkg)",
        ),
        (
            lambda: soil_of(off(begun())),
            "plot: the soil it was simulated in, simulated of seed 4, comes out differently here "
            "(remedy: go on with the version of subsoil and the data that began it)",
        ),
        (
            lambda: soil_to_survey(begun(), "riseholme", 1),
            "plot: it was begun in the soil 'simulated' and does not go on in 'riseholme' "
            "(remedy: give --world simulated, or start another survey)",
        ),
    ],
)
def test_a_soil_that_is_not_the_surveys_is_refused_with_what_to_do(
    ask: Callable[[], object], said: str
) -> None:
    with pytest.raises(JournalError) as caught:
        ask()
    assert str(caught.value) == said


def test_a_soil_without_values_to_check_is_taken_for_the_same() -> None:
    """Files of the first format hold none."""
    survey = joined(simulation=Simulation(world="simulated", seed=4))
    assert np.array_equal(soil_of(survey).kpa, truth_of("simulated", FIELD, LAYERS, 4).kpa)


def test_a_difference_of_rounding_is_none() -> None:
    survey = begun()
    record = survey.simulation[0]
    kpa = tuple(value * (1 + 1e-9) for value in record.check_kpa)
    near = replace(survey, simulation=(record.model_copy(update={"check_kpa": kpa}),))
    assert soil_of(near).kpa.shape == (2, 96)


def test_a_world_that_is_none_is_refused_with_those_there_are() -> None:
    with pytest.raises(ParameterError) as caught:
        truth_of("mars" * 20, FIELD, LAYERS, 1)
    assert str(caught.value) == (
        f"world: there is no world '{'mars' * 10}...' (remedy: one of simulated, riseholme)"
    )
    assert list(WORLDS) == ["simulated", "riseholme"]


@pytest.mark.usefixtures("real_data")
def test_riseholme_is_the_same_for_every_seed_and_kriged_from_its_readings() -> None:
    from subsoil.datasets import half_field

    half = half_field()
    one, other = (truth_of("riseholme", half, LAYERS, seed) for seed in (1, 2))
    assert np.array_equal(one.kpa, other.kpa)
    assert isinstance(one.origin, Kriged)
    assert one.origin.readings == (177, 174)
    assert not one.noise.any()


def test_the_field_of_the_demonstration_is_what_its_corners_enclose() -> None:
    """Its area by the shoelace formula."""
    x, y = np.array(worlds.DEMO_OUTLINE, dtype=float).T
    area = abs(float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))) / 2
    assert demo_field().area_ha == pytest.approx(area / 10_000.0)
    assert 2.0 < demo_field().area_ha < 2.4


# Libraries that may be missing, and tables in notebooks


def test_a_missing_library_is_named_with_where_how_to_install_it_and_what_else_to_do() -> None:
    with pytest.raises(MissingExtraError) as caught:
        load("no_such.part", "geo", "a GeoTIFF", where="ec.tif", instead="give points")
    assert str(caught.value) == (
        "ec.tif: a GeoTIFF needs no_such, which is not installed "
        "(remedy: pip install 'subsoil[geo]', or give points)"
    )
    assert isinstance(caught.value.__cause__, ImportError)


def test_all_missing_libraries_are_named_at_once_and_each_extra_once() -> None:
    need = [("json", "all", "JSON"), ("no_a", "geo", "maps"), ("no_b", "geo", "fields")]
    with pytest.raises(MissingExtraError) as caught:
        require(*need)
    assert str(caught.value) == (
        "maps needs no_a, fields needs no_b, which are not installed "
        "(remedy: pip install 'subsoil[geo]')"
    )
    require()
    assert install("plot", "geo", "plot") == "pip install 'subsoil[plot,geo]'"


def test_a_table_in_a_notebook_has_its_texts_and_runs_none_of_them() -> None:
    hostile = '<img src=x onerror=alert(1)> & "it\'s"'
    shown = table([hostile], [[hostile], [""]], caption=hostile)
    assert "<img" not in shown
    safe = "&lt;img src=x onerror=alert(1)&gt; &amp; &quot;it&#x27;s&quot;"
    assert shown == (
        f"<table><caption>{safe}</caption><tr><th>{safe}</th></tr>"
        f"<tr><td>{safe}</td></tr><tr><td></td></tr></table>"
    )
    assert "caption" not in table([], [])
