"""Tables that could be read in more than one way: refused with the reason, never guessed."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from subsoil.errors import BoundaryError, ReadingsError
from subsoil.findings import left_out, others
from subsoil.io.read.boundary import read_field
from subsoil.io.read.missing import is_missing
from subsoil.io.read.readings import read_readings
from subsoil.io.read.tables.marks import check_marks, writing_of

PLACES = [("53.2615", "-0.5250"), ("53.2616", "-0.5251"), ("53.2617", "-0.5252")]

Table = Callable[..., Path]


@pytest.fixture
def table(tmp_path: Path) -> Table:
    """Write readings at three places: headings of the depths, then a list of cells a place."""

    def write(headings: list[str], *rows: list[str], delimiter: str = ",") -> Path:
        places = [list(place) for place in PLACES[: len(rows)]]
        lines = [
            ["lat", "lon", *headings],
            *([*p, *r] for p, r in zip(places, rows, strict=True)),
        ]
        path = tmp_path / "walk.csv"
        path.write_text("\n".join(delimiter.join(line) for line in lines) + "\n", "utf-8")
        return path

    return write


# Thousands marks

TWO = ["kpa_5cm", "kpa_10cm"]
DOUBTFUL = {
    "point beside smaller ones without": (",", [["834", "1.119"], ["811", "1.074"]]),
    "point everywhere, semicolons": (";", [["1.500", "2.250"], ["1.400", "2.100"]]),
    "comma everywhere, semicolons": (";", [["1,500", "2,250"], ["1,400", "2,100"]]),
    "comma everywhere, tabs": ("\t", [["1,500", "2,250"], ["1,400", "2,100"]]),
    "comma in some, tabs": ("\t", [["834", "1,119"], ["811", "1,074"]]),
    "quoted comma": (",", [["834", '"1,119"'], ["811", '"1,074"']]),
    "only one cell": (",", [["834", "1.119"], ["811", "974"]]),
    "beside missing codes": (",", [["834", "1.119"], ["811", "NA"]]),
}


@pytest.mark.parametrize("case", DOUBTFUL)
def test_a_mark_that_may_be_either_stops_the_file_and_is_never_read_as_a_decimal(
    table: Table, case: str
) -> None:
    delimiter, rows = DOUBTFUL[case]
    with pytest.raises(ReadingsError, match=r"^walk\.csv: .*1.*without thousands marks") as caught:
        read_readings(table(TWO, *rows, delimiter=delimiter))
    assert "\n" not in str(caught.value)


THOUSANDS = {
    "blank": (",", [["834", "1 119"], ["811", "1 074"]]),
    "narrow blank": (",", [["834", "1\u202f119"], ["811", "1\u202f074"]]),
    "unbreakable blank": (";", [["834", "1\u00a0119"], ["811", "1\u00a0074"]]),
    "apostrophe": (",", [["834", "1'119"], ["811", "1'074"]]),
    "Swiss apostrophe": (",", [["834", "1’119"], ["811", "1’074"]]),
    "underscore": (",", [["834", "1_119"], ["811", "1_074"]]),
    "point and decimal comma": (";", [["834,0", "1.119,0"], ["811,0", "1.074,0"]]),
    "comma and decimal point": ("\t", [["834.0", "1,119.0"], ["811.0", "1,074.0"]]),
    "point, where one ends in zero": (",", [["834", "1.119"], ["810", "1.074"], ["790", "1.350"]]),
    "quoted comma, where one ends in zero": (
        ",",
        [["834", '"1,119"'], ["810", '"1,074"'], ["790", '"1,350"']],
    ),
}


@pytest.mark.parametrize("case", THOUSANDS)
def test_a_mark_that_can_only_be_a_thousands_mark_is_read_as_such(table: Table, case: str) -> None:
    delimiter, rows = THOUSANDS[case]
    readings = read_readings(table(TWO, *rows, delimiter=delimiter))
    assert readings.profiles[0].kpa.tolist() == [834.0, 1119.0]
    assert readings.profiles[1].kpa[1] == 1074.0


def test_a_decimal_comma_in_places_makes_points_thousands_marks(tmp_path: Path) -> None:
    path = tmp_path / "walk.csv"
    path.write_text("lat;lon;kpa_5cm\n53,2615;-0,5250;1.119\n53,2616;-0,5251;2.206\n")
    assert [p.kpa[0] for p in read_readings(path).profiles] == [1119.0, 2206.0]


DECIMALS = {
    "three decimals that are too hard as thousands": (",", [["483.125", "823.250"]], 483.125),
    "three decimals below one": (",", [["0.834", "1.119"]], 0.834),
    "other numbers of decimals": (",", [["1.5", "1.119"]], 1.5),
    "commas of other numbers": ("\t", [["834,5", "1119,25"]], None),
}


@pytest.mark.parametrize("case", DECIMALS)
def test_three_decimals_that_cannot_be_thousands_are_decimals(table: Table, case: str) -> None:
    delimiter, rows, first = DECIMALS[case]
    path = table(TWO, *rows, delimiter=delimiter)
    if first is None:
        path.write_text(path.read_text().replace(".", ","))
        first = 834.5
    assert read_readings(path).profiles[0].kpa[0] == first


def test_megapascals_with_three_decimals_are_no_thousands(table: Table) -> None:
    readings = read_readings(table(["mpa_5cm", "mpa_10cm"], ["1.119", "2.206"], ["1.350", "1.910"]))
    np.testing.assert_allclose(readings.profiles[0].kpa, [1119.0, 2206.0])


@pytest.mark.parametrize("place", ["1.500,900", '"1,500",900'])
def test_a_thousands_mark_in_a_place_stops_the_file(tmp_path: Path, place: str) -> None:
    path = tmp_path / "walk.csv"
    path.write_text(f"easting,northing,kpa_5cm\n{place},500\n10,20,600\n")
    with pytest.raises(ReadingsError, match=r"walk\.csv: .*thousands"):
        read_readings(path)


def test_places_with_three_decimals_throughout_are_millimetres(tmp_path: Path) -> None:
    path = tmp_path / "walk.csv"
    path.write_text("easting,northing,kpa_5cm\n10.125,20.250,500\n30.000,10.500,600\n")
    assert read_readings(path).at[0].tolist() == [10.125, 20.25]


@pytest.mark.parametrize(
    "corners", ["500;1.500\n700;1.500\n700;1.900\n", "1.000.500;5\n1.000.700;5\n1.000.700;90\n"]
)
def test_a_thousands_mark_in_a_corner_stops_the_outline(tmp_path: Path, corners: str) -> None:
    path = tmp_path / "home.csv"
    path.write_text("easting;northing\n" + corners)
    with pytest.raises(BoundaryError, match=r"home\.csv: .*1.*thousands"):
        read_field(path)


@given(st.lists(st.floats(0.1, 49_000.0), min_size=2, max_size=20))
def test_numbers_as_programs_write_them_shortest_are_never_doubted_if_one_shows_decimals(
    values: list[float],
) -> None:
    check_marks([repr(value) for value in [*values, 0.25]], most=50_000.0)


def read_or_refused(cells: list[str]) -> list[float] | None:
    """Numbers of cells as they are read; ``None`` if they are refused for what they may be."""
    try:
        writing = writing_of(cells, most=50_000.0)
    except ValueError as error:
        return None if "may be" in str(error) or "do not agree" in str(error) else [float("nan")]
    return [float(writing.plain(cell)) for cell in cells]


@given(st.lists(st.integers(0, 49_000), min_size=1, max_size=20), st.sampled_from([".", ",", "'"]))
def test_whole_numbers_with_thousands_marks_are_read_as_such_or_refused(
    values: list[int], mark: str
) -> None:
    cells = [f"{value:,}".replace(",", mark) for value in values]
    assert read_or_refused(cells) in (values, None)


@given(
    st.lists(st.integers(1, 499_999), min_size=1, max_size=20),
    st.sampled_from([(".", ""), (",", ""), (",", "."), (".", ","), (".", " "), (",", "'")]),
    st.integers(0, 4),
)
def test_numbers_of_one_writing_are_read_as_written_or_refused(
    values: list[int], marks: tuple[str, str], digits: int
) -> None:
    decimal, thousands = marks
    numbers = [value / 10 for value in values]
    cells = [f"{number:,.{digits}f}".translate({44: thousands, 46: decimal}) for number in numbers]
    assert read_or_refused(cells) in ([float(f"{n:.{digits}f}") for n in numbers], None)


# Headings


@pytest.mark.parametrize(
    "heading",
    [
        "kpa_1Ocm", "kpa_lOcm", "1Ocm", "kpa_10", "10", "2019", "hPa_10cm", "kpa_sd_10cm",
        "tension_10cm_kPa", "kpa_2_5cm", "CI_10", "kpa 10 cm (before tillage)", "kPa_cm",
    ],
)  # fmt: skip
def test_a_heading_that_looks_like_a_depth_and_is_not_understood_is_named(
    table: Table, heading: str
) -> None:
    path = table(["kpa_5cm", heading, "kpa_15cm"], ["1", "2", "3"], delimiter=";")
    with pytest.raises(ReadingsError, match=r"walk\.csv, row 1: column .*--map") as caught:
        read_readings(path)
    assert f"{heading}=ignore" in str(caught.value)
    kept = read_readings(path, meanings={heading: "ignore"})
    assert kept.profiles[0].depth_m.tolist() == [0.05, 0.15]
    meant = read_readings(path, meanings={heading: "kpa at 10 cm"})
    assert meant.profiles[0].depth_m.tolist() == [0.05, 0.1, 0.15]


def test_all_headings_that_are_not_understood_are_named_together(table: Table) -> None:
    headings = ["kpa_5cm", *(f"kpa {k} cm sd" for k in range(10, 18))]
    path = table(headings, ["1"] * 9)
    with pytest.raises(ReadingsError, match=r"columns kpa 10 cm sd, .* and 2 more look like"):
        read_readings(path)


@pytest.mark.parametrize(
    "heading",
    [
        "vwc_10cm", "VWC 10 cm (%)", "ec_20cm", "moisture_0-10cm", "temp_5cm", "crop", "notes",
        "sensor height 2 m", "sample_2", "easting_27700", "altitude_m", "yield_2019", "kpa_mean",
        "max_kpa", "n_pushes", "pH 10cm", "clay_30cm", "buffer_5m",
    ],
)  # fmt: skip
def test_other_columns_are_left_alone_and_listed(table: Table, heading: str) -> None:
    readings = read_readings(table(["kpa_5cm", heading], ["500", "x"], ["600", "y"]))
    assert len(readings) == 2
    assert readings.profiles[0].kpa.tolist() == [500.0]
    assert f"walk.csv: columns left alone: {heading}" in others(readings.findings)


def test_places_given_twice_are_said(tmp_path: Path) -> None:
    path = tmp_path / "walk.csv"
    path.write_text("lat,lon,easting,northing,kpa_5cm\n53.2,-0.5,1,2,500\n")
    assert "walk.csv: columns left alone: easting, northing" in others(read_readings(path).findings)


# Missing codes

CODES = [
    "NA", "N/A", "na", "-", "--", "nan", "NaN", "null", "NULL", "None", "", " ", "?", "nd",
    "#N/A", "–", "-1", "-999", "-9999", "-99", "-999.0", "9999", "99999", "0",
]  # fmt: skip


@pytest.mark.parametrize("code", CODES)
def test_a_missing_code_below_the_last_reading_was_not_reached(table: Table, code: str) -> None:
    three = ["kpa_5cm", "kpa_10cm", "kpa_15cm"]
    readings = read_readings(table(three, ["500", "900", code], ["600", code, code]))
    assert [profile.kpa.tolist() for profile in readings.profiles] == [[500.0, 900.0], [600.0]]
    assert left_out(readings.findings) == ()


@pytest.mark.parametrize("code", CODES)
def test_a_missing_code_above_a_reading_costs_that_depth_only_and_is_named(
    table: Table, code: str
) -> None:
    three = ["kpa_5cm", "kpa_10cm", "kpa_15cm"]
    readings = read_readings(table(three, ["500", code, "900"], ["600", "700", "800"]))
    assert [str(f) for f in left_out(readings.findings)] == [
        "row 2: nothing was read at 0.1 m, yet below; that depth is left out"
    ]
    assert [profile.kpa.tolist() for profile in readings.profiles] == [
        [500.0, 900.0],
        [600.0, 700.0, 800.0],
    ]
    assert readings.profiles[0].top_m.tolist() == [0.0, 0.1], "nobody knows the soil between"


def test_minus_one_among_other_values_below_zero_is_no_code(table: Table) -> None:
    readings = read_readings(table(TWO, ["-5", "-1"], ["600", "700"]))
    assert [str(f) for f in left_out(readings.findings)] == [
        "row 2: -5 kPa at 0.05 m is no soil strength: a bad reading, or the wrong unit; left out"
    ]


@pytest.mark.parametrize("code", ["-999", "9999"])
def test_a_number_taken_for_missing_is_said(table: Table, code: str) -> None:
    readings = read_readings(table(TWO, ["500", code], ["600", "700"]))
    assert others(readings.findings) == (f"walk.csv: {code} is taken for 'not read', in 1 numbers",)


def test_a_strength_among_others_like_it_is_no_code(table: Table) -> None:
    readings = read_readings(table(TWO, ["7200", "9999"], ["8100", "9450"]))
    assert readings.profiles[0].kpa.tolist() == [7200.0, 9999.0]
    soft = read_readings(table(TWO, ["999", "99"], ["998", "997"]))
    assert soft.profiles[0].kpa.tolist() == [999.0, 99.0]


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_no_number_is_a_missing_word(value: float) -> None:
    assert not is_missing(repr(value))


# Strengths of no soil


@pytest.mark.parametrize(
    ("values", "words"),
    [
        (["0.5", "0.9", "1.5"], "a small part of any soil's strength.*MPa"),
        (["70", "150", "240"], "softer than almost any soil.*psi"),
        (["9000", "14000", "19000"], "harder than almost any soil"),
    ],
)
def test_a_typical_strength_that_no_soil_has_is_said(
    table: Table, values: list[str], words: str
) -> None:
    readings = read_readings(
        table(["kpa_5cm", "kpa_20cm", "kpa_40cm"], values, [*values[:2], "99"])
    )
    assert any(re.search(words, note) for note in others(readings.findings)), others(
        readings.findings
    )


def test_tilled_topsoil_and_ordinary_soil_are_no_finding(table: Table) -> None:
    assert others(read_readings(table(TWO, ["90", "150"], ["100", "180"])).findings) == ()
    assert others(read_readings(table(["kpa_5cm", "kpa_40cm"], ["400", "2500"])).findings) == ()


# Robots' logs and outlines in JSON


def robot_log(value: str, *, names: str = "[5 cm]", head: str = "") -> str:
    return f"{head}names: {names}\ndata:\n- position: {{lat: 53.2, lon: -0.5}}\n  data: [{value}]\n"


BOMB = "a: &a [x, x, x, x, x, x, x, x, x]\n" + "".join(
    f"{name}: &{name} [{', '.join(['*' + before] * 9)}]\n"
    for before, name in zip("abcdefgh", "bcdefghi", strict=True)
)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (robot_log("0750"), r"line 4: .*'0750' is no plain whole number"),
        (robot_log("1:30"), r"line 4: .*'1:30' is no plain"),
        (robot_log("1:30.5"), r"line 4: .*'1:30\.5' is no plain"),
        (robot_log("1_500"), r"line 4: .*'1_500' is no plain"),
        (robot_log("0x1F4"), r"line 4: .*'0x1F4' is no plain"),
        (robot_log("0b101"), r"line 4: .*'0b101' is no plain"),
        (robot_log("9" * 400), r"line 4: .*'9{40}\.\.\.' is no plain"),
        (robot_log("9" * 5000), r"line 4: .*is no plain"),
        (robot_log("500") + robot_log("600"), r"line 5: .*'names' is there twice"),
        (robot_log("500") + "  data: [600]\n", r"line 5: .*'data' is there twice"),
        (robot_log("*i", head=BOMB), r"row 1: a list at 0\.05 m is not a number"),
        (robot_log("1", names="*i", head=BOMB), r"names: 'a list' is not a depth"),
        (robot_log("1", names=f"['{'x' * 5000}']"), r"names: 'x{40}\.\.\.' is not a depth"),
        ("names: &a [*a]\ndata: []", r"names: 'a list' is not a depth"),
        ("names: " + "[" * 100_000, r"nest"),
        (f"names: *{'x' * 5000}", r"line 1: .*found undefined alias"),
        (f"names: !!{'x' * 5000} 1", r"line 1: .*could not determine a constructor"),
    ],
)
def test_a_log_that_yaml_reads_otherwise_than_people_is_one_short_line(
    tmp_path: Path, text: str, message: str
) -> None:
    path = tmp_path / "robot.yaml"
    path.write_text(text)
    with pytest.raises(ReadingsError, match=rf"^robot\.yaml.*{message}") as caught:
        read_readings(path)
    assert len(str(caught.value)) < 300


@pytest.mark.parametrize("code", ["null", "~", ".nan", "NA", "-999", "0", "'-'"])
def test_a_missing_code_at_the_end_of_a_log_was_not_reached(tmp_path: Path, code: str) -> None:
    path = tmp_path / "robot.yaml"
    path.write_text(robot_log(f"500, {code}", names="[5 cm, 10 cm]"))
    assert read_readings(path).profiles[0].kpa.tolist() == [500.0]


def test_a_json_object_that_says_a_thing_twice_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "home.geojson"
    ring = "[[[-0.5,53],[-0.498,53],[-0.498,53.002],[-0.5,53]]]"
    path.write_text(f'{{"type":"Polygon","coordinates":{ring},"coordinates":{ring}}}')
    with pytest.raises(BoundaryError, match=r"home\.geojson: 'coordinates' is there twice"):
        read_field(path)


@pytest.mark.parametrize("cell", [1e-300, 5e-324, 1e-9, 1e300])
def test_a_cell_of_no_use_is_refused_in_one_line(tmp_path: Path, cell: float) -> None:
    path = tmp_path / "home.csv"
    path.write_text("easting,northing\n0,0\n60,0\n60,40\n0,40\n")
    with pytest.raises(BoundaryError, match=r"^home\.csv: .*cells?") as caught:
        read_field(path, cell_size=cell)
    assert "\n" not in str(caught.value)
