"""Tables by their headings, their rows and what their owner says of them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from subsoil.errors import ReadingsError
from subsoil.findings import left_out, others
from subsoil.io.read.readings import read_readings
from subsoil.io.read.tables.clock import times_of
from subsoil.io.read.tables.degrees import angles
from subsoil.io.read.tables.headings import meaning_of
from subsoil.io.read.tables.sheet import Sheet
from subsoil.io.read.tables.table import recording_of
from subsoil.io.read.tables.tables import SHEETS
from subsoil.layers import Layers
from subsoil.penetrometer import SMALL_CONE
from subsoil.readings import Readings

Save = Callable[..., Path]
AT = "53.2615,-0.5250"


@pytest.fixture
def save(tmp_path: Path) -> Save:
    def write(*lines: str, name: str = "walk.csv") -> Path:
        path = tmp_path / name
        path.write_text("\n".join(lines) + "\n", "utf-8")
        return path

    return write


def profiles(readings: Readings) -> list[list[float]]:
    return [profile.kpa.round(3).tolist() for profile in readings.profiles]


# Headings


@pytest.mark.parametrize(
    ("heading", "kind"),
    [
        ("Lat", "latitude"), ("Latitude (°)", "latitude"), ("Latitud", "latitude"),
        ("Breite", "latitude"), ("lat_dd", "latitude"), ("GPS Latitude [deg]", "latitude"),
        ("Long", "longitude"), ("lng", "longitude"), ("Länge", "longitude"),
        ("Lon_WGS84", "longitude"), ("Longitud", "longitude"), ("Längengrad", "longitude"),
        ("Easting", "easting"), ("Rechtswert", "easting"), ("easting (m)", "easting"),
        ("Hochwert", "northing"), ("UTM Northing", "northing"), ("X", "x"), ("POINT_X", "x"),
        ("Este", "x"), ("Norte", "y"), ("y_coord", "y"), ("N/S", "north or south"),
        ("lon_dir", "east or west"), ("id", "number"), ("Probe No", "number"), ("n°", "number"),
        ("Datum", "time"), ("time_utc", "time"), ("Cone Size", "cone"), ("depth_cm", "depth"),
        ("Tiefe [cm]", "depth"), ("Profondeur (mm)", "depth"), ("depth in inches", "depth"),
        ("from (cm)", "top"), ("depth_to_cm", "depth"), ("unit", "unit"), ("kPa", "strength"),
        ("Cone index", "strength"), ("Resistencia (MPa)", "strength"), ("force_n", "strength"),
        ("easting_27700", "other"), ("max depth (cm)", "other"), ("cone index note", "other"),
    ],
)  # fmt: skip
def test_a_heading_means_what_people_mean_by_it(heading: str, kind: str) -> None:
    assert meaning_of(heading).kind == kind


@pytest.mark.parametrize(
    ("heading", "unit", "top", "depth"),
    [
        ("kpa_10cm", "kpa", np.nan, 0.1), ("10 cm (kPa)", "kpa", np.nan, 0.1),
        ("10cm_kPa", "kpa", np.nan, 0.1), ("10cmkPa", "kpa", np.nan, 0.1),
        ("0-10 cm", "", 0.0, 0.1), ("kPa 10 to 20 cm", "kpa", 0.1, 0.2),
        ("5 in", "", np.nan, 0.127),
        ('PSI 4"', "psi", np.nan, 0.1016), ("psi-4in", "psi", np.nan, 0.1016),
        ("kpa_2p5cm", "kpa", np.nan, 0.025), ("2,5cm", "", np.nan, 0.025),
        ("1.5 ft", "", np.nan, 0.4572), ("N/cm² 10 cm", "n/cm2", np.nan, 0.1),
        ("10 cm kgf/cm2", "kgf/cm2", np.nan, 0.1), ("kN/m2 10cm", "kpa", np.nan, 0.1),
        ("bar_15cm", "bar", np.nan, 0.15), ("lbf 4in", "lbf", np.nan, 0.1016),
        ("X10.cm..kPa.", "kpa", np.nan, 0.1), ("Druck 10 cm", "", np.nan, 0.1),
        ("kpa_cm10", "kpa", np.nan, 0.1), ("CI at 10 cm depth [MPa]", "mpa", np.nan, 0.1),
    ],
)  # fmt: skip
def test_a_heading_of_a_depth_gives_its_depth_and_unit(
    heading: str, unit: str, top: float, depth: float
) -> None:
    meaning = meaning_of(heading)
    assert (meaning.kind, meaning.unit) == ("layer", unit)
    np.testing.assert_allclose((meaning.top_m, meaning.depth_m), (top, depth))
    assert not meaning.above


@given(st.text(max_size=40))
def test_no_heading_whatever_makes_trouble(heading: str) -> None:
    try:
        assert meaning_of(heading).kind
    except ValueError as error:
        complaint = str(error)
    else:
        return
    assert "deeper than 3 m" in complaint or "is not above" in complaint


def test_intervals_stand_for_the_soil_that_they_name(save: Save) -> None:
    path = save("lat,lon,0-10 cm,10-20 cm,30-40 cm", f"{AT},500,900,1500")
    (profile,) = read_readings(path, units="kpa").profiles
    assert profile.top_m.tolist() == [0.0, 0.1, 0.3]
    means = read_readings(path, units="kpa").layer_means(Layers((0.0, 0.1, 0.2, 0.3, 0.4)))
    np.testing.assert_allclose(means[:, 0], [500, 900, np.nan, 1500])


def test_titles_units_and_groups_around_the_heading_belong_to_it(save: Save) -> None:
    path = save("Survey,,,", "lat,lon,10 cm,20 cm", "°,°,MPa,MPa", f"{AT},0.5,0.9")
    assert profiles(read_readings(path)) == [[500, 900]]
    path = save(",,Resistance (kPa) by depth (cm),,", "lat,lon,5,10,15", f"{AT},500,900,950")
    readings = read_readings(path)
    assert readings.profiles[0].depth_m.tolist() == [0.05, 0.1, 0.15]
    assert profiles(readings) == [[500, 900, 950]]


def test_x_and_y_are_degrees_or_metres_by_their_values(save: Save) -> None:
    degrees = read_readings(save("X,Y,kpa_5cm", "-0.525,53.2615,500", "-0.526,53.262,600"))
    assert degrees.crs == "EPSG:32630"
    metres = read_readings(save("X,Y,kpa_5cm", "10,20,500", "60,80,600"))
    assert metres.at.tolist() == [[10, 20], [60, 80]]
    with pytest.raises(ReadingsError, match=r"columns X, Y may be degrees or metres.*--map"):
        read_readings(save("X,Y,kpa_5cm", "10,20,500", "12,20.5,600"))


def test_what_the_owner_says_goes_before_what_a_heading_says(save: Save) -> None:
    path = save("where_n,where_e,p1,p2,id,kpa", f"{AT},500,900,a,7")
    meanings = {
        "where_n": "latitude", "WHERE_E": "longitude", "p1": "kpa at 10 cm", "p2": "kpa 10-20 cm",
        "kpa": "ignore",
    }  # fmt: skip
    readings = read_readings(path, meanings=meanings)
    assert profiles(readings) == [[500, 900]]
    assert readings.profiles[0].depth_m.tolist() == [0.1, 0.2]
    assert others(readings.findings) == ("walk.csv: columns left alone: kpa",)


def test_numbers_alone_are_depths_where_the_owner_says_in_which_unit(save: Save) -> None:
    path = save("lat,lon,1,2,3,2019", f"{AT},500,900,950,7")
    readings = read_readings(path, units="kpa", meanings={"1..3": "cm", "2019": "ignore"})
    assert readings.profiles[0].depth_m.tolist() == [0.01, 0.02, 0.03]
    stepped = read_readings(path, meanings={"1..3": "psi 0.5 in", "2019": "ignore"})
    assert stepped.profiles[0].depth_m.tolist() == [0.0127, 0.0254, 0.0381]
    assert stepped.profiles[0].kpa[0] == pytest.approx(500 * 6.894757)


@pytest.mark.parametrize(
    ("meanings", "message"),
    [
        ({"deep": "kpa at 10 cm"}, "no heading is 'deep'; headings seen: lat, lon, p1"),
        ({"p1": "banana"}, "nothing is meant by 'banana'.*kpa at 10 cm"),
        ({"p1": "kpa at 9 m"}, "deeper than 3 m"),
    ],
)
def test_a_meaning_that_is_none_is_refused(
    save: Save, meanings: dict[str, str], message: str
) -> None:
    with pytest.raises(ReadingsError, match=message):
        read_readings(save("lat,lon,p1", f"{AT},500"), meanings=meanings)


# Rows


@pytest.mark.parametrize("written", [">5000", "> 5000", ">=5000", "≥5000", "5000+"])
def test_a_value_that_is_that_or_more_ends_a_push_and_is_no_value(save: Save, written: str) -> None:
    (profile,) = (
        found := read_readings(save("lat,lon,kpa_5cm,kpa_10cm,kpa_15cm", f"{AT},500,{written},"))
    ).profiles
    assert (profile.kpa.tolist(), profile.ending) == ([500.0], "force")
    assert left_out(found.findings) == ()
    assert "row 2, column kpa_10cm: it says 5000 or more; taken as the end" in str(
        found.findings[0]
    )
    inside = read_readings(save("lat,lon,kpa_5cm,kpa_10cm,kpa_15cm", f"{AT},500,{written},900"))
    assert (profiles(inside), inside.profiles[0].ending) == ([[500, 900]], "stroke")
    assert len(left_out(inside.findings)) == 1


@pytest.mark.parametrize("word", ["mean", "Mean:", "Total", "Mittelwert", "moyenne", "SD"])
def test_rows_of_summaries_below_a_table_are_left_out_by_row(save: Save, word: str) -> None:
    path = save("id,lat,lon,kpa_5cm", f"1,{AT},500", f"2,{AT},700", f"{word},{AT},600")
    readings = read_readings(path)
    assert profiles(readings) == [[500], [700]]
    assert [finding.row for finding in left_out(readings.findings)] == [4]


def test_columns_without_heading_are_named_where_they_hold_anything(save: Save) -> None:
    readings = read_readings(save("lat,lon,,kpa_5cm,", f"{AT},x,500,"))
    assert others(readings.findings) == (
        "walk.csv: columns left alone: column 3 without a heading",
    )


def test_forces_are_pressures_by_the_cone_of_each_row(save: Save) -> None:
    path = save("lat,lon,cone,n_5cm", f"{AT},1/2 inch,130", f"{AT},323 mm2,646")
    assert profiles(read_readings(path)) == [[1000], [2000]]
    alone = read_readings(save("lat,lon,kN_5cm", f"{AT},0.13"), cone=SMALL_CONE)
    assert profiles(alone) == [[1000]]


# Tidy tables


def test_a_push_ends_where_its_number_or_its_place_changes_or_the_depth_starts_again(
    save: Save,
) -> None:
    rows = [f"{AT},5,500", f"{AT},10,900", f"{AT},5,510", f"{AT},10,910", "53.2616,-0.525,5,520"]
    readings = read_readings(save("lat,lon,depth_cm,kpa", *rows))
    assert profiles(readings) == [[500, 900], [510, 910], [520]]
    assert readings.rows.tolist() == [2, 4, 6]


def test_a_receiver_that_wanders_during_a_push_makes_one_push(save: Save) -> None:
    rows = ["7,53.26150,-0.52500,5,500", "7,53.26151,-0.52501,10,900", "8,53.2640,-0.525,5,520"]
    assert profiles(read_readings(save("push,lat,lon,depth_cm,kpa", *rows))) == [[500, 900], [520]]


def test_a_depth_that_comes_twice_out_of_order_is_left_out_and_named(save: Save) -> None:
    rows = [f"1,{AT},5,500", f"1,{AT},10,900", f"1,{AT},10,910", "2,53.2616,-0.525,5,520"]
    readings = read_readings(save("push,lat,lon,depth_cm,kpa", *rows))
    assert profiles(readings) == [[520]]
    (finding,) = left_out(readings.findings)
    assert "0.1 m is there twice for one push, first in row 3" in str(finding)
    assert "row 4" in str(finding)


def test_a_depth_that_others_have_and_a_push_has_not_is_a_gap(save: Save) -> None:
    rows = [f"{k},53.26{k}5,-0.525,{d},{100 * d}" for k in (1, 2, 3) for d in (5, 10, 15)]
    readings = read_readings(save("push,lat,lon,depth_cm,kpa", *rows[:4], *rows[5:]))
    assert readings.profiles[1].top_m.tolist() == [0.0, 0.1]
    (finding,) = left_out(readings.findings)
    assert str(finding) == "row 5: nothing was read at 0.1 m, yet below; that depth is left out"


def test_tidy_rows_may_say_their_unit_and_must_agree(save: Save) -> None:
    head = "lat,lon,depth_cm,strength,unit"
    assert profiles(read_readings(save(head, f"{AT},5,0.5,MPa", f"{AT},10,0.9,MPa"))) == [
        [500, 900]
    ]
    with pytest.raises(ReadingsError, match="rows mix the units kpa, mpa"):
        read_readings(save(head, f"{AT},5,0.5,MPa", f"{AT},10,900,kPa"))


def test_tidy_rows_may_say_from_where_to_where(save: Save) -> None:
    head = "lat,lon,depth_from_cm,depth_to_cm,kpa"
    (profile,) = read_readings(save(head, f"{AT},0,10,500", f"{AT},20,30,900")).profiles
    assert (profile.top_m.tolist(), profile.depth_m.tolist()) == ([0.0, 0.2], [0.1, 0.3])


@pytest.mark.parametrize(
    ("row", "message"),
    [
        (f"{AT},,500", "row 3, column depth_cm: a number is missing"),
        (f"{AT},500,500", "row 3, column depth_cm: 5 m is no depth"),
        (f"{AT},-10,500", "row 3, column depth_cm: -0.1 m is no depth"),
        (f"{AT},10,stone", "row 3, column kpa: 'stone' is not a number"),
        (f"{AT},ten,500", "row 3, column depth_cm: 'ten' is not a number"),
        ("53.26,,10,500", "row 3, column lon: a number is missing"),
    ],
)
def test_a_bad_row_of_a_tidy_table_is_named(save: Save, row: str, message: str) -> None:
    readings = read_readings(save("lat,lon,depth_cm,kpa", f"{AT},5,400", row))
    assert profiles(readings)[0] == [400]
    assert str(left_out(readings.findings)[0]).startswith(message)


def test_depths_with_a_minus_are_below_the_ground(save: Save) -> None:
    readings = read_readings(save("lat,lon,depth_cm,kpa", f"{AT},-5,400", f"{AT},-10,800"))
    assert readings.profiles[0].depth_m.tolist() == [0.05, 0.1]
    assert "taken as below the ground" in others(readings.findings)[0]


def test_a_table_without_places_is_read_where_they_come_from_elsewhere(save: Save) -> None:
    (sheet,) = SHEETS["table"].sheets(save("push,date,kpa_5cm", "7,13.5.2024,500"))
    recording = recording_of(sheet, placed=True)
    (record,) = recording.records
    assert (recording.frame, record.number, str(record.time)) == (
        "none",
        "7",
        "2024-05-13 00:00:00",
    )
    with pytest.raises(ReadingsError, match="headings seen: push, date, kpa_5cm"):
        recording_of(Sheet(sheet.file, sheet.rows))


# Angles and times


@pytest.mark.parametrize(
    "written",
    [
        "53°15'36\"S", "53° 15′ 36″ S", "S 53 15 36", "53:15:36S", "53°15.6'S", "S53 15.6",
        "53d15m36s S", "-53 15 36", "-53.26", "-53d15m36s", "53 15 36s", "53.26° S",
        "53°15,6'S", "53º 15' 36'' s",
    ],
)  # fmt: skip
def test_angles_are_read_in_any_usual_writing(written: str) -> None:
    found, wrong = angles([written], [""], "NS")
    assert wrong == {}
    np.testing.assert_allclose(found, [-53.26])


@pytest.mark.parametrize(
    ("written", "half", "words"),
    [
        ("53°75'N", "", "60 minutes"), ("53°15'E", "", "hemisphere E is not one of N and S"),
        ("53°15'O", "", "hemisphere O"), ("-53°15'N", "", "minus and a hemisphere"),
        ("53°15'N", "S", "hemisphere"), ("north", "", "nor an angle"), ("", "N", "missing"),
    ],
)  # fmt: skip
def test_an_angle_that_leaves_doubt_is_refused(written: str, half: str, words: str) -> None:
    assert words in angles([written], [half], "NS")[1][0]


@given(st.floats(-179.99, 179.99))
def test_angles_in_parts_and_as_receivers_pack_them_are_the_same(angle: float) -> None:
    whole, rest = divmod(abs(angle), 1.0)
    half = "EW"[int(angle < 0)]
    packed = f"{int(whole):03d}{rest * 60:010.7f}"
    if packed[3:5] == "60":
        return
    column = angles([packed], [half], "EW")[0]
    own = angles([packed + half], [""], "EW")[0]
    parts = angles([f"{int(whole)}°{rest * 60:.7f}'{half}"], [""], "EW")[0]
    np.testing.assert_allclose([*column, *own, *parts], angle, atol=1e-8)


@pytest.mark.parametrize(
    ("texts", "first"),
    [
        (["2024-05-13T08:15:00Z"], "2024-05-13 08:15:00"),
        (["2024-05-13T10:15:00+02:00"], "2024-05-13 08:15:00"),
        (["13/05/2024 08:15"], "2024-05-13 08:15:00"),
        (["5/13/2024 8:15 AM"], "2024-05-13 08:15:00"),
        (["45425.34375"], "2024-05-13 08:15:00"), (["1715588100"], "2024-05-13 08:15:00"),
        (["03/04/2024"], None), (["soon"], None),
        (["03/04/2024", "13/04/2024"], "2024-04-03 00:00:00"),
    ],
)  # fmt: skip
def test_times_are_told_by_the_whole_column(texts: list[str], first: str | None) -> None:
    found = times_of(texts)
    assert (str(found[0]) if found else None) == first


def test_a_number_without_end_is_no_number(save: Save) -> None:
    path = save("lat,lon,kpa_5cm", f"{AT},500", f"53.2616,-0.525,{'9' * 400}")
    readings = read_readings(path)
    assert profiles(readings) == [[500]]
    assert "is not a finite number" in str(left_out(readings.findings)[0])
