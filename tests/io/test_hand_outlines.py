"""Outlines and robot logs that were made by hand to be misread, each with the right answer.

The files are in the folders ``handb`` and ``hand`` of the one that ``SUBSOIL_BREAKAGE`` names.
"""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest

from subsoil.errors import BoundaryError, ReadingsError
from subsoil.findings import left_out
from subsoil.io.read.boundary import read_field
from subsoil.io.read.readings import read_readings

BROKEN = os.environ.get("SUBSOIL_BREAKAGE")
FOLDER, OF_LOGS = (Path(BROKEN or "") / name for name in ("handb", "hand"))
pytestmark = pytest.mark.skipif(not BROKEN, reason="SUBSOIL_BREAKAGE names no folder")

PLAIN_HA = 2.481
AREAS_HA = {
    "GeometryCollection.geojson": PLAIN_HA,
    "US_survey_feet_2264.geojson": 1.162,
    "UTF-16_geojson.geojson": PLAIN_HA,
    "antimeridian.geojson": 2.361,
    "crs_of_EPSG:27700_in_crs_member.geojson": 0.9,
    "csv_100_km_long_coordinates_4M_cells.csv": 10_000.0,
    "csv_metres_25_M_cells.csv": 40_000.0,
    "csv_swapped_columns_easting-northing.csv": 0.9,
    "csv_tiny_cells.csv": 0.04,
    "json_role_Keep-Out_(capitals).geojson": 2.406,
    "plain_geojson.geojson": PLAIN_HA,
    "string_numbers.geojson": PLAIN_HA,
    "swapped_Kenya.geojson": 1.975,
    "swapped_Ukraine_(49,32).geojson": 2.096,
    "web_mercator_3857.geojson": 1.286,
}
"""The two that are swapped lie on land either way: only readings can tell, and then do."""
NOTED = {
    "US_survey_feet_2264.geojson": "measures in US survey foot, so it is kept in EPSG:32617",
    "crs_of_EPSG:27700_in_crs_member.geojson": "brought to EPSG:27700 to within",
    "web_mercator_3857.geojson": "metres of EPSG:3857 are 40 % off here",
}
REFUSED = {
    "bow_tie.geojson": r"Self-intersection\[0.001 53.001\]",
    "coords_decimal_comma.coords": "row 1: .* has decimal commas.*write 53.26092, -0.52711",
    "coords_decimal_comma_spaces.coords": "row 1: .* has decimal commas",
    "coords_lon_first_UK.coords": "latitude and longitude look swapped",
    "coords_mixed_int_and_decimal_comma.coords": "row 1: .* is not two numbers",
    "csv_decimal_comma_header_semis.csv": "row 2: .* has decimal commas",
    "csv_easting_northing_thousands.csv": "'664,000' has a thousands mark",
    "csv_thin_diagonal_100_km.csv": "100 km wide, far more than 5 m cells cover",
    "deep_json_1e5.geojson": "nested too deeply",
    "hole_outside.geojson": "Hole lies outside shell",
    "json_400_digit_number.geojson": "not a pair of numbers",
    "json_5000_digit_number.geojson": "a number is too long",
    "json_NaN.geojson": "vertex 1: a vertex is not a number",
    "json_duplicate_coordinates_key.geojson": "'coordinates' is there twice",
    "metres_without_crs.geojson": "they look like metres: name their CRS",
    "pole.geojson": "the outline is not valid",
    "swapped_Brazil_(-15,-55).geojson": "latitude and longitude look swapped",
    "swapped_UK.geojson": "latitude and longitude look swapped",
    "swapped_US_(40,-95).geojson": "latitude and longitude look swapped",
}
LOGS = {
    "yaml_.inf.yaml": ([[600, 950]], "row 1: inf at 0.05 m is not a number"),
    "yaml_.nan.yaml": ([[900], [600, 950]], "row 1: nothing was read at 0.05 m, yet below"),
    "yaml_bomb_unused.yaml": ([[500, 900], [600, 950]], ""),
    "yaml_date.yaml": ([[600, 950]], "row 1: .* is not a number"),
    "yaml_decimal_comma_1,5_(list_splits).yaml": ([[1, 5]], ""),
    "yaml_plain.yaml": ([[500, 900], [600, 950]], ""),
    "yaml_record_bomb_10^6_same_dict.yaml": ([[500]] * 10, ""),
    "yaml_string_'500'.yaml": ([[600, 950]], "row 1: '500' at 0.05 m is not a number"),
    "yaml_true.yaml": ([[600, 950]], "row 1: True at 0.05 m is not a number"),
}
"""kPa of each push that is read, and what is said of those left out."""


def logs() -> set[str]:
    return {path.name for path in OF_LOGS.iterdir() if path.suffix == ".yaml"}


def test_every_file_of_the_folder_has_its_answer_here() -> None:
    assert {path.name for path in FOLDER.iterdir()} == AREAS_HA.keys() | REFUSED.keys()
    assert logs() >= LOGS.keys()


@pytest.mark.parametrize("name", AREAS_HA)
def test_an_outline_is_read_as_its_owner_meant_it(name: str) -> None:
    field = read_field(FOLDER / name)
    assert field.area_ha == pytest.approx(AREAS_HA[name], rel=1e-3)
    said = " ".join(str(finding) for finding in field.findings)
    assert NOTED.get(name, "") in said


@pytest.mark.parametrize("name", REFUSED)
def test_an_outline_that_leaves_doubt_is_refused_with_the_reason(name: str) -> None:
    with pytest.raises(BoundaryError) as caught:
        read_field(FOLDER / name)
    assert re.search(REFUSED[name], str(caught.value))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", LOGS)
def test_a_log_is_read_but_for_what_is_no_number(name: str) -> None:
    readings = read_readings(OF_LOGS / name)
    kpa, words = LOGS[name]
    assert [profile.kpa.tolist() for profile in readings.profiles] == kpa
    said = " ".join(str(finding) for finding in left_out(readings.findings))
    assert re.search(words, said) if words else not said


def test_a_list_that_a_decimal_comma_split_is_doubted() -> None:
    readings = read_readings(OF_LOGS / "yaml_decimal_comma_1,5_(list_splits).yaml")
    assert any("a small part of any soil's strength" in str(each) for each in readings.findings)


def test_every_other_log_is_refused_in_a_line() -> None:
    others = sorted(logs() - LOGS.keys())
    assert len(others) > 10
    for name in others:
        with pytest.raises(ReadingsError) as caught:
            read_readings(OF_LOGS / name)
        assert "\n" not in str(caught.value)
        assert len(str(caught.value)) < 600
