"""With ``--units us`` every number that a verb shows is the metric one, converted exactly once."""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable
from contextlib import redirect_stdout
from io import StringIO
from math import inf, nan
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from subsoil.cli import run
from subsoil.cli.words import label, text
from subsoil.layers import Layers
from subsoil.units import METRIC, SYSTEMS, US, Unit

Cli = Callable[..., Any]

PSI_KPA = 4.4482216152605 / 0.0254**2 / 1000.0
"""KPa of a pound-force on a square inch, by the definitions of the pound-force and the inch."""
FOOT_M, INCH_M = 0.3048, 0.0254
ACRE_HA = 4840 * 0.9144**2 / 10_000.0
"""Hectares of 4840 square yards."""
TURNED = {
    "kPa": ("psi", 1 / PSI_KPA),
    "kPa²": ("psi²", 1 / PSI_KPA**2),
    "m": ("ft", 1 / FOOT_M),
    "ha": ("acres", 1 / ACRE_HA),
}
UNITS = (*TURNED, "min")
NUMBER = re.compile(r"-?\d+(\.\d+)?")


def slack(number: str) -> float:
    """Half of the last digit that is shown."""
    return 0.5 * 10.0 ** -len(number.partition(".")[2])


def assert_converted(unit: str, metric: str, us: str) -> None:
    """Each number of a cell is the other in the other unit, as far as both are shown."""
    factor = TURNED[unit][1]
    before, after = (NUMBER.findall(each) for each in (metric, us))
    assert len(before) == len(after), (metric, us)
    for one, other in zip(NUMBER.finditer(metric), NUMBER.finditer(us), strict=True):
        off = factor * slack(one.group()) + slack(other.group())
        assert float(other.group()) == pytest.approx(factor * float(one.group()), abs=1.001 * off)


def unit_of(head: str) -> str:
    """Unit that the name of a column or a value ends with."""
    found = re.search(r" \(([^)]*)\)$", head)
    return found.group(1) if found else ""


def assert_same_but_for_units(metric: str, us: str) -> int:
    """Compare what a verb says line by line; returns how many cells were converted."""
    heads: tuple[list[str], list[str]] | None = None
    converted = 0
    for one, other in zip(metric.splitlines(), us.splitlines(), strict=True):
        a, b = one.split("\t"), other.split("\t")
        if any(unit_of(cell) in UNITS for cell in a[1:]):
            heads = (a, b)
            continue
        if not one:
            heads = None
        known, shown = heads or (a[:1] * len(a), b[:1] * len(b))
        start = 0 if heads else 1
        cells = list(zip(known, shown, a, b, strict=True))[start:]
        for head, turned, before, after in cells:
            unit = unit_of(head)
            if unit in TURNED and turned != head:
                assert turned == head.replace(f"({unit})", f"({TURNED[unit][0]})")
                assert_converted(unit, before, after)
                converted += 1
            elif head == "layer":
                assert_edges(before, after)
            else:
                assert (turned, after) == (head, before)
        if not (heads or cells):
            assert one == other
    return converted


def assert_edges(metric: str, us: str) -> None:
    """Edges of a layer in inches are those in metres."""
    assert metric.endswith(" m")
    assert us.endswith(" in")
    for edge, inches in zip(
        metric.removesuffix(" m").split("-"), us.removesuffix(" in").split("-"), strict=True
    ):
        assert float(inches) == pytest.approx(float(edge) / INCH_M, abs=0.05001)


@pytest.fixture(scope="module")
def surveyed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A survey of fourteen samples, which these tests leave as it is."""
    folder = tmp_path_factory.mktemp("surveyed")
    outline, path = folder / "plot.csv", folder / "survey.gpkg"
    outline.write_text("easting,northing\n0,0\n60,0\n60,40\n0,40\n")
    more = ["--samples", "14", "--strategy", "area-split", "--estimator", "paper-10"]
    with redirect_stdout(StringIO()):
        assert run(["init", str(path), "--boundary", str(outline)]) == 0
        assert run(["run", str(path), *more]) == 0
    return path


@pytest.mark.parametrize(
    ("words", "least"),
    [
        (("status",), 3 + 8),
        (("resume",), 3),
        (("replay", "--at", "30"), 3),
        (("plan", "--samples", "20", "--strategy", "area-split"), 1),
    ],
)
def test_a_survey_is_told_in_other_units_number_by_number(
    cli: Cli, surveyed: Path, words: tuple[str, ...], least: int
) -> None:
    verb, *more = words
    outcomes = [cli(verb, surveyed, *more, "--units", units) for units in ("metric", "us")]
    assert [outcome.code for outcome in outcomes] == [0, 0]
    metric, us = (outcome.out for outcome in outcomes)
    if verb == "status":  # its first line is a sentence, which other tests read
        metric, us = (said.partition("\n")[2] for said in (metric, us))
        assert "simulated robot (simulator), 14 samples, 170 m in" in metric
        assert "simulated robot (simulator), 14 samples, 559 ft in" in us
        metric, us = (re.sub(r"\d+ (m|ft) in", "way in", said) for said in (metric, us))
    assert assert_same_but_for_units(metric, us) >= least


def test_a_new_survey_and_one_that_runs_are_told_so_too(
    cli: Cli, outline: Path, tmp_path: Path
) -> None:
    said = []
    for units in ("metric", "us"):
        folder = tmp_path / units
        folder.mkdir()
        shutil.copy(outline, folder / outline.name)
        path = folder / "s.gpkg"
        told = cli("init", path, "--boundary", folder / outline.name, "--units", units).out
        told += cli("run", path, "--samples", 4, "--strategy", "area-split", "--units", units).out
        said.append(told.replace(str(folder), "folder"))
    assert assert_same_but_for_units(*said) >= 6


@pytest.mark.parametrize("verb", ["cv", pytest.param("map", marks=pytest.mark.slow)])
def test_readings_are_told_in_other_units_number_by_number(
    cli: Cli, readings: Path, outline: Path, tmp_path: Path, verb: str
) -> None:
    more = ["--layers", "0,0.05,0.1", "--estimator", "spherical"]
    if verb == "map":
        more += ["--boundary", str(outline), "--out", str(tmp_path / "maps")]
    metric, us = (cli(verb, readings, *more, "--units", each).out for each in ("metric", "us"))
    assert assert_same_but_for_units(metric, us) >= 2 * 4


def test_json_stays_metric_whatever_is_shown(cli: Cli, readings: Path, surveyed: Path) -> None:
    layers = ("--layers", "0,0.05,0.1", "--estimator", "spherical")
    for words in (
        ("status", surveyed),
        ("cv", readings, *layers),
        ("variogram", readings, *layers),
    ):
        metric, us = (cli(*words, "--units", each, "--json").out for each in ("metric", "us"))
        assert metric == us


# One number at a time


def test_factors_are_those_of_the_definitions_to_a_part_in_a_million() -> None:
    for unit, expected in (
        (US.pressure, 1 / PSI_KPA),
        (US.variance, 1 / PSI_KPA**2),
        (US.length, 1 / FOOT_M),
        (US.area, 1 / ACRE_HA),
        (US.depth, 1 / INCH_M),
    ):
        assert unit.factor == pytest.approx(expected, rel=1e-6)
    assert {unit.factor for unit in (METRIC.pressure, METRIC.variance, METRIC.length)} == {1.0}
    assert SYSTEMS == {"metric": METRIC, "us": US}


@given(st.floats(-1e7, 1e7), st.sampled_from([METRIC, US]))
def test_what_is_shown_is_the_kept_value_to_half_of_its_last_digit(
    value: float, units: Any
) -> None:
    for unit in (units.pressure, units.length, units.area, units.depth, units.variance):
        shown = unit.number(value)
        assert float(shown) == pytest.approx(unit.factor * value, abs=1.001 * slack(shown))
        assert not re.fullmatch(r"-0(\.0*)?", shown)
        assert unit.text(value) == f"{shown} {unit.name}"


def test_a_unit_without_a_name_leaves_no_blank() -> None:
    assert Unit("", 1.0, 2).text(0.456) == "0.46"


def test_layers_are_named_in_inches_from_their_edges() -> None:
    layers = Layers((0.0, 0.0254, 0.1, 0.4))
    assert US.layers(layers) == ("0.0-1.0 in", "1.0-3.9 in", "3.9-15.7 in")
    assert METRIC.layers(layers) == layers.names


@pytest.mark.parametrize(
    ("name", "value", "metric", "us"),
    [
        ("mean_kpa", 1000.0, ("mean (kPa)", "1000"), ("mean (psi)", "145.0")),
        ("mean_kv", 1000.0, ("mean KV (kPa²)", "1000"), ("mean KV (psi²)", "21")),
        ("semivariance_kpa2", 1e5, ("semivariance (kPa²)", "100000"), None),
        ("metres", 100.0, ("way (m)", "100"), ("way (ft)", "328")),
        ("range_m", -0.2, ("range (m)", "0"), ("range (ft)", "-1")),
        ("area_ha", 2.0, ("area (ha)", "2.00"), ("area (acres)", "4.9")),
        ("minutes", 59.6, ("time (min)", "60"), ("time (min)", "60")),
        ("cone_area_mm2", 130.0, ("cone area (mm²)", "130"), ("cone area (mm²)", "130")),
        ("memory_gib", 1.26, ("memory (GiB)", "1.3"), ("memory (GiB)", "1.3")),
        ("easting_m", 12.345, ("easting (m)", "12.35"), ("easting (m)", "12.35")),
        ("longitude", -0.53, ("longitude", "-0.5300000"), ("longitude", "-0.5300000")),
        ("money", 12.5, ("money", "12.50"), ("money", "12.50")),
        ("nugget_share", 0.126, ("nugget share", "0.13"), ("nugget share", "0.13")),
        ("r2", 0.5, ("r2", "0.5"), ("r2", "0.5")),
        ("r2", 2.0, ("r2", "2"), ("r2", "2")),
        ("samples", 7, ("samples", "7"), ("samples", "7")),
    ],
)
def test_a_value_has_the_unit_of_its_name_and_the_digits_that_are_worth_showing(
    name: str, value: float, metric: tuple[str, str], us: tuple[str, str] | None
) -> None:
    assert (label(name), text(name, value)) == metric
    if us is not None:
        assert (label(name, US), text(name, value, US)) == us


@pytest.mark.parametrize("value", [nan, inf, -inf])
def test_no_number_is_a_dash_in_any_unit(value: float) -> None:
    assert text("mean_kpa", value, US) == text("samples", value) == "-"


@pytest.mark.parametrize(
    ("value", "metric", "us"),
    [
        (True, "yes", "yes"),
        ([100.0, 200.0], "100, 200", "14.5, 29.0"),
        ((), "", ""),
        ("a\tb", "a b", "a b"),
        (Path("x/y.tif"), "x/y.tif", "x/y.tif"),
        (
            {"mean_kpa": 100.0, "cell": 7, "money": 2.0},
            "mean 100 kPa, cell 7, money 2.00",
            "mean 14.5 psi, cell 7, money 2.00",
        ),
    ],
)
def test_lists_and_mappings_are_told_item_by_item(value: object, metric: str, us: str) -> None:
    assert text("found_kpa", value) == metric
    assert text("found_kpa", value, US) == us
