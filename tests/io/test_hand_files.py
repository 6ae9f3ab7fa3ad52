"""Tables that people really write wrong: the right reading or refusal of each, stated by hand."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from pathlib import Path

import pytest

from subsoil.errors import InputError
from subsoil.findings import left_out
from subsoil.io.read.readings import read_readings

PLAIN = [[500, 900, 1500], [600, 950, 1600]]
NO_FIX = "latitude 0, longitude 0 means"
WORDS = "is not a number"
PAIRS = "cells do not pair"
MISSED = "nothing was read at"
EITHER = "may be 1500 or 1.500"
DEPTH_LIKE = "looks? like a depth"
TWICE = "two columns have the same depth"

READ: dict[str, tuple[Sequence[Sequence[float]], Sequence[tuple[int, str]]]] = {
    "-9999_everywhere_first.csv": ([[900, 1500]], [(2, MISSED)]),
    "-999_no_data.csv": ([[500, 900], [600, 950, 1600]], []),
    "0,0_fix.csv": ([[600]], [(2, NO_FIX)]),
    "9999_no_data.csv": ([[500, 900]], []),
    "BOM.csv": (PLAIN, []),
    "CRLF.csv": (PLAIN, []),
    "CR_only.csv": (PLAIN, []),
    "Ctrl-Z_end.csv": (PLAIN, []),
    "DMS.csv": ([[500]], []),
    "MPa_column_holds_kPa_values.csv": ([[20_000, 30_000]], [(2, "500000 kPa .* wrong unit")]),
    "NA_text_in_last_col.csv": ([[500, 900], [600, 950, 1600]], []),
    "NMEA_ddmm_small.csv": ([[500]], []),  # decimal degrees of a place that is on land too
    "NUL_row.csv": (PLAIN, [(2, PAIRS)]),
    "NaN_text.csv": ([[900, 1500]], [(2, MISSED)]),
    "UTF-16-BE_no_BOM.csv": (PLAIN, []),
    "UTF-16-LE_no_BOM.csv": (PLAIN, []),
    "UTF-16_with_BOM.csv": (PLAIN, []),
    "UTF-32_BOM.csv": (PLAIN, []),
    "UTM_across_zones.csv": ([[500], [600], [700]], []),
    "arabic_digits.csv": ([[500, 900, 1500]], []),
    "blank_easting.csv": (PLAIN, [(2, "a number is missing")]),
    "both_lat_lon_and_easting_northing_differing.csv": ([[500]], []),
    "comment_line_first.csv": (PLAIN, []),
    "decimal_comma_but_one_point.csv": ([[600.5, 950.5]], [(2, "decimal point where others")]),
    "decimal_comma_with_semicolons.csv": ([[500.5, 900.5]], []),
    "degrees_as_easting_northing_wide.csv": ([[500], [600]], []),  # with a doubt: see below
    "depth_0.csv": ([[500, 900]], []),
    "depth_2.5m_as_meant_cm.csv": ([[500, 900, 1200]], []),
    "depths_not_in_order.csv": ([[500, 900, 1500]], []),
    "duplicate_place_other_values.csv": ([[500, 900, 1500], [800, 1200, 1900]], []),
    "duplicates.csv": ([*PLAIN, *PLAIN], []),
    "first_blank.csv": ([[900, 1500]], [(2, MISSED)]),
    "footer_row.csv": (PLAIN, [(4, "'mean' is a summary")]),
    "footer_total_numeric.csv": (PLAIN, [(4, "mean or the sum of all rows above")]),
    "fullwidth_digits.csv": ([[500, 900, 1500]], []),
    "header_capital.csv": ([[500, 900]], []),
    "header_kPa(10_cm).csv": ([[500, 900]], []),
    "header_with_units_easting_(m).csv": ([[500]], []),
    "heading_lng.csv": ([[500]], []),
    "headings_X,Y.csv": ([[500]], []),  # metres: no latitude is 100
    "in_column_4in.csv": ([[2068.4271, 2757.9028]], []),
    "kPa_column_holds_MPa_values.csv": ([[0.5, 0.9, 1.5], [0.6, 0.95, 1.6]], []),
    "kPa_header_but_--units_psi.csv": (PLAIN, []),
    "kpa_2,5cm_in_semicolons.csv": ([[500, 600]], []),
    "kpa_column_holds_psi_values.csv": ([[72, 130, 217]], []),
    "latin-1_degree.csv": ([[500]], []),
    "long_row.csv": (PLAIN, [(2, PAIRS)]),
    "negative_depth.csv": ([[500, 900]], []),
    "one_unreadable_depth_column_(kPa_10_cm_depth).csv": ([[500, 900, 1500]], []),
    "p_as_point_kpa_2p5cm.csv": ([[500]], []),
    "plain.csv": (PLAIN, []),
    "points_1000_km_apart.csv": ([[500], [600], [600]], []),
    "psi_column_holds_kPa_values.csv": ([[3447.3785, 6205.2813], [4136.8542, 6550.01915]], []),
    "quoted_'1,500.0'.csv": ([[1500, 2900]], []),
    "same_id_differing_by_1_ulp.csv": ([[500, 900, 1500], [500, 900, 1500]], []),
    "sep=;_line.csv": (PLAIN, []),
    "short_row.csv": (PLAIN, [(2, PAIRS)]),
    "swapped_in_Ethiopia_(9,39).csv": ([[500], [600]], []),  # only a field can tell
    "swapped_in_India_(28,77).csv": ([[500], [600]], []),
    "swapped_in_Kenya_(lat_-1,_lon_37).csv": ([[500], [600]], []),
    "thousands_point_and_decimal_comma_mixed.csv": ([[1500.5, 2900.5]], []),
    "title_row_first.csv": (PLAIN, []),
    "two_header_rows.csv": (PLAIN, []),
    "underscore.csv": ([[1500, 900, 1500]], []),
    "unquoted_decimal_commas,_even_count.csv": ([[100, 5], [120, 5]], []),  # four numbers a row
    "zero_in_the_middle.csv": ([[500, 1500]], [(2, MISSED)]),
    "zeros_at_end.csv": ([[500]], []),
}

REFUSED = {
    "easting_in_km.csv": "all readings lie within 0.1 m: these look like kilometres",
    "1e5_kPa.csv": "row 2: 100000 kPa at 0.05 m is no soil strength",
    "NUL_bytes_in_a_cell.csv": f"row 2, column kpa_5cm: .* {WORDS}",
    "altitude_column_10_(bare_number_heading).csv": f"column 10 {DEPTH_LIKE}.*--map '10=",
    "column_'1_m'_(not_depth)_and_kpa_cols.csv": "columns mix the units none, kpa.*--map",
    "column_n_5cm_meaning_nitrogen_+_kpa.csv": f"{TWICE}: kpa_5cm, n_5cm.*--map",
    "column_named_2019.csv": f"column 2019 {DEPTH_LIKE}.*--map",
    "comma_thousands_with_semicolons_(1,500_=_1500).csv": EITHER,
    "comma_thousands_with_tabs_(1,500_=_1500).csv": EITHER,
    "degrees_as_easting_northing.csv": "look like degrees, not metres",
    "degrees_minutes_5315.6.csv": "no place on Earth.*degrees and minutes",
    "depth_in_m_vs_cm:_kpa_5.csv": f"columns kpa_5, kpa_10 {DEPTH_LIKE}",
    "depth_in_m_vs_cm:_kpa_5m.csv": "column kpa_5m: '5m' is deeper than 3 m",
    "duplicate_depth_10cm_and_0.1m.csv": TWICE,
    "duplicate_depth_column.csv": TWICE,
    "duplicate_lat.csv": "two columns hold the same coordinate; headings seen: lat, lon, lat",
    "empty.csv": "the file is empty",
    "header_only.csv": "it holds no readings",
    "hex.csv": f"row 2, column kpa_5cm: '0x1F4' {WORDS}",
    "inf.csv": "row 2, column kpa_5cm: 'inf' is not a finite number",
    "lat_lon_swapped_values_UK.csv": "look swapped",
    "lon_0..360.csv": "longitude 359.473 is no place on Earth",
    "n_column_with_--units_kpa.csv": "no cone area",
    "negative_value.csv": "-5 kPa at 0.05 m is no soil strength",
    "no_header.csv": "no columns say where .*headings seen: 100, 100, 500, 900",
    "one_negative_depth_among_good.csv": "some depths have a minus and others do not",
    "only_spaces.csv": "the file is empty",
    "quote_never_closed.csv": "row 2: .*a quotation mark is never closed",
    "quoted_thousands_'1,500'_with_commas.csv": EITHER,
    "thousands_point_with_semicolons.csv": EITHER,
    "typo_kpa_1Ocm_(letter_O).csv": f"column kpa_1Ocm {DEPTH_LIKE}",
    "unicode_minus.csv": "-5 kPa at 0.05 m is no soil strength",
}

DOUBTS = {
    "MPa_column_holds_kPa_values.csv": "harder than almost any soil",
    "degrees_as_easting_northing_wide.csv": "all readings lie within 0.13 m",
    "kPa_column_holds_MPa_values.csv": "a small part of any soil's strength",
    "duplicates.csv": "it repeats row 2: same place, same values",
    "latin-1_degree.csv": "read as Windows-1252",
    "-999_no_data.csv": "-999 is taken for 'not read'",
    "9999_no_data.csv": "9999 is taken for 'not read'",
    "negative_depth.csv": "taken as below the ground",
    "both_lat_lon_and_easting_northing_differing.csv": "left alone: easting, northing",
}


@pytest.fixture
def hand() -> Path:
    folder = os.environ.get("SUBSOIL_BREAKAGE")
    if not folder:
        pytest.skip("SUBSOIL_BREAKAGE names no folder of broken files")
    return Path(folder) / "hand"


def test_every_table_of_the_folder_has_its_right_answer_here(hand: Path) -> None:
    tables = {path.name for path in hand.iterdir() if path.suffix == ".csv"}
    assert tables == READ.keys() | REFUSED.keys()
    assert not READ.keys() & REFUSED.keys()


@pytest.mark.parametrize("name", READ)
def test_a_table_is_read_as_its_owner_meant_it(hand: Path, name: str) -> None:
    kpa, refused = READ[name]
    readings = read_readings(hand / name)
    assert [p.kpa.tolist() for p in readings.profiles] == [pytest.approx(k, abs=1e-3) for k in kpa]
    left = left_out(readings.findings)
    assert [finding.row for finding in left] == [row for row, _ in refused]
    for finding, (_, words) in zip(left, refused, strict=True):
        assert re.search(words, str(finding))


@pytest.mark.parametrize("name", REFUSED)
def test_a_table_that_cannot_be_read_is_refused_with_the_reason(hand: Path, name: str) -> None:
    with pytest.raises(InputError, match=REFUSED[name]) as caught:
        read_readings(hand / name)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", DOUBTS)
def test_what_is_odd_about_a_table_is_said(hand: Path, name: str) -> None:
    said = "\n".join(map(str, read_readings(hand / name).findings))
    assert re.search(DOUBTS[name], said), said
