"""Readings from files: units, places, and the rows that are refused and why."""

from __future__ import annotations

import csv
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from shapely.geometry import Polygon, box

from subsoil.errors import BoundaryError, InputError, ParameterError, ReadingsError
from subsoil.findings import left_out
from subsoil.io.read.readings import READERS, read_readings
from subsoil.land.crs import project
from subsoil.land.field import Field
from subsoil.layers import Layers
from subsoil.penetrometer import SMALL_CONE
from subsoil.readings import Readings

HOME = Field.from_lonlat(
    Polygon([(-0.5278, 53.2624), (-0.5274, 53.2609), (-0.5231, 53.2607), (-0.5225, 53.2631)]),
    name="home.geojson",
)
YARD = Field.from_metres([(0, 0), (100, 0), (100, 100), (0, 100)], name="yard")
HEADER = "lat,lon,kpa_2.5cm,kpa_5.0cm,kpa_7.5cm"
GOOD = "53.2615,-0.5250,100,200,300"
LAYERS = Layers((0.0, 0.05, 0.075))

STRETCHED = ("EPSG:3857", "EPSG:3395", "ESRI:54034", "EPSG:6933", "EPSG:3034")

Save = Callable[..., Path]


@pytest.fixture
def save(tmp_path: Path) -> Save:
    def write(*lines: str, name: str = "walk.csv", encoding: str = "utf-8") -> Path:
        path = tmp_path / name
        path.write_text("\n".join(lines) + "\n", encoding=encoding)
        return path

    return write


def messages(readings: Readings) -> dict[int, str]:
    return {
        finding.row: f"{finding.seen} (column {finding.column})" if finding.column else finding.seen
        for finding in left_out(readings.findings)
    }


# Tables


def test_a_table_gives_places_in_the_frame_of_the_field_and_profiles_in_kpa(save: Save) -> None:
    path = save(HEADER, GOOD, "53.2616,-0.5251,150,250,350")
    readings = read_readings(path, field=HOME)
    np.testing.assert_allclose(readings.at, HOME.to_metres([-0.525, -0.5251], [53.2615, 53.2616]))
    assert readings.profiles[0].depth_m.tolist() == [0.025, 0.05, 0.075]
    assert readings.profiles[1].kpa.tolist() == [150.0, 250.0, 350.0]
    assert readings.rows.tolist() == [2, 3]
    assert (left_out(readings.findings), readings.crs, readings.source) == (
        (),
        "EPSG:32630",
        str(path),
    )
    np.testing.assert_allclose(readings.layer_means(LAYERS), [[150.0, 200.0], [300.0, 350.0]])
    with pytest.raises(ValueError, match="read-only"):
        readings.at[0] = 0


def test_without_a_field_the_utm_zone_of_the_readings_is_the_frame(save: Save) -> None:
    readings = read_readings(save(HEADER, "-33.5,151.0,1,2,3"))
    assert readings.crs == "EPSG:32756"


@pytest.mark.parametrize(
    "header",
    [
        "lat,lon,kpa_2.5cm,kpa_5.0cm,kpa_7.5cm",
        "Latitude,Longitude,kPa_2p5cm,KPA_5p0cm,kpa_7p5cm",
        "LAT,LON,kpa_25mm,kpa_50mm,kpa_75mm",
        "lat , lon , kpa 0.025 m , kpa 0.05 m , kpa_0.075m",
    ],
)
def test_depths_may_be_written_in_many_ways(save: Save, header: str) -> None:
    readings = read_readings(save(header, GOOD))
    np.testing.assert_allclose(readings.profiles[0].depth_m, [0.025, 0.05, 0.075])


def test_columns_go_by_their_names_not_their_order(save: Save) -> None:
    path = save("id,kpa_7.5cm,lon,when,kpa_2.5cm,lat,kpa_5cm", "a1,300,-0.525,noon,100,53.2615,200")
    readings = read_readings(path, field=HOME)
    assert readings.profiles[0].kpa.tolist() == [100.0, 200.0, 300.0]
    np.testing.assert_allclose(readings.at, HOME.to_metres([-0.525], [53.2615]))


def test_columns_that_are_no_readings_are_left_alone(save: Save) -> None:
    path = save("id,easting_27700,sample_2,lat,lon,kpa_5cm", "1,498346.21,x,53.2615,-0.525,200")
    assert read_readings(path).profiles[0].kpa.tolist() == [200.0]


@pytest.mark.parametrize(
    ("unit", "kpa"), [("kpa", 300.0), ("mpa", 300_00.0), ("psi", 2068.4271), ("n", 2307.6923)]
)
def test_every_unit_becomes_kpa(save: Save, unit: str, kpa: float) -> None:
    value = 30 if unit == "mpa" else 300
    path = save(f"easting,northing,{unit}_10cm", f"1,2,{value}")
    readings = read_readings(path, cone=SMALL_CONE)
    assert readings.profiles[0].kpa[0] == pytest.approx(kpa)


@pytest.mark.parametrize("units", ["psi", "PSI"])
def test_depths_alone_take_the_unit_that_the_caller_names(save: Save, units: str) -> None:
    path = save("lat,lon,0.05 m,10 cm,6in", "53.2,-0.5,1,10,100")
    readings = read_readings(path, units=units)
    np.testing.assert_allclose(readings.profiles[0].kpa, [6.894757, 68.94757, 689.4757])
    np.testing.assert_allclose(readings.profiles[0].depth_m, [0.05, 0.1, 0.1524])


def test_force_without_a_cone_is_refused_with_the_option_to_give(save: Save) -> None:
    path = save("lat,lon,n_5cm", "53.2,-0.5,100")
    with pytest.raises(InputError, match=r"walk\.csv: no cone area.*--cone-area 130"):
        read_readings(path)


@pytest.mark.parametrize(
    ("header", "units", "message"),
    [
        ("lat,lon,hpa_10cm", None, "row 1: column hpa_10cm looks like a depth.*kpa_10cm"),
        ("lat,lon,kpa_10", None, "row 1: column kpa_10 looks like a depth"),
        ("lat,lon,10,20", "kpa", r"row 1: columns 10, 20 look like a depth.*--map '1..80=cm'"),
        ("lat,lon,kpa_10m", None, "row 1, column kpa_10m: '10m' is deeper than 3 m"),
        ("lat,lon,10 cm", None, "it names no unit of pressure.*--reading-unit"),
        ("lat,lon,10 cm", "hpa", "unit 'hpa' is unknown.*--reading-unit"),
        ("lat,lon,kpa_10cm", "psi", "it says kpa, and you say psi"),
        ("lat,lon,kpa_5cm,psi_10cm", None, "row 1: columns mix the units kpa, psi"),
        ("lat,lon,kpa_5cm,10 cm", None, "row 1: columns mix the units none, kpa"),
        ("lat,lon,kpa_5cm,kpa_50mm", None, "row 1: two columns have the same depth: kpa_5cm"),
        ("lat,lon,0-10 cm,5-15 cm", "kpa", "row 1: two columns have the same depth: 0-10 cm"),
        ("lat,lon,kpa_10-5cm", None, "row 1, column kpa_10-5cm: the top .* is not above"),
        ("lat,lon,kpa_5cm,kpa_-10cm", None, "row 1: some depths have a minus"),
        ("lat,lon,depth,strength", None, "column depth does not say in which unit.*--map"),
        ("lat,lon,depth_cm,when", None, "no column names the strength; headings seen: lat, lon"),
        ("lat,lon,when,who", None, "no column names a depth; headings seen: lat, lon, when, who"),
        ("x,y,kpa_5cm,kpa_9cm", None, "columns x, y may be degrees or metres.*--map"),
        ("where,kpa_5cm", None, "no columns say where.*headings seen: where, kpa_5cm.*--map"),
        ("lat,northing,kpa_5cm", None, "row 1: no columns say where"),
        ("53.2,-0.5,100", None, "row 1: no columns say where.*start the table with a header"),
        ("lat,lat,lon,kpa_5cm", None, "row 1: two columns hold the same coordinate"),
    ],
)
def test_a_header_that_leaves_doubt_is_refused_by_column(
    save: Save, header: str, units: str | None, message: str
) -> None:
    with pytest.raises(ReadingsError, match=rf"^walk\.csv.*{message}"):
        read_readings(save(header, "53.2,-0.5,100,200"), units=units)


@pytest.mark.parametrize(
    ("row", "message"),
    [
        ("53.2615,-0.525,100,abc,300", "'abc' is not a number (column kpa_5.0cm)"),
        ("53.2615,NA,100,200,300", "'NA' is not a number (column lon)"),
        ("53.2615,-0.525,100,inf,300", "'inf' is not a finite number (column kpa_5.0cm)"),
        ("53.2615,-0.525,1_0,20,30", "'1_0' is not a number (column kpa_2.5cm)"),
        ("53.2615,-0.525,100,-5,300", "-5 kPa at 0.05 m is no soil strength"),
        ("53.2615,-0.525,100,2e6,300", "2e+06 kPa at 0.05 m is no soil strength"),
        ("53.2615,-0.525,,,", "no depth was reached"),
        ("53.2615,-0.525,0,0,0", "no depth was reached"),
        (",,100,200,300", "a number is missing (column lon)"),
        ("0,0,100,200,300", "the receiver had no fix"),
        ("153.2,-0.525,100,200,300", "latitude 153.2, longitude -0.525 is no place on Earth"),
        ("-133.9,-33.2,1,2,3", "latitude and longitude look swapped"),
        ("53.2615,-0.525,100,200", "4 cells do not pair with 5 columns"),
        ("53,2615,-0,525,100,200,300", "7 cells do not pair with 5 columns, as a decimal comma"),
        ('"53,2615","-0,525",1,2,3', "'-0,525' has a decimal comma: write -0.525 (column lon)"),
        ("53.2700,-0.525,100,200,300", "m outside the field"),
    ],
)
def test_a_bad_row_is_refused_by_its_number_and_the_others_are_used(
    save: Save, row: str, message: str
) -> None:
    first = "53.2612,-0.526,100,200,300"
    readings = read_readings(save(HEADER, first, "", row, GOOD), field=HOME)
    assert readings.rows.tolist() == [2, 5]
    assert list(messages(readings)) == [4]
    assert message in messages(readings)[4]
    assert str(left_out(readings.findings)[0]).startswith("row 4")


def test_every_row_is_used_or_refused_and_findings_stand_in_order(save: Save) -> None:
    rows = [GOOD, "x", "53.27,-0.525,1,2,3", GOOD, "53.2616,-0.525,1,2,3", "53.2616,-0.525,1,-2,3"]
    readings = read_readings(save(HEADER, *rows), field=HOME)
    assert readings.rows.tolist() == [2, 5, 6]
    assert list(messages(readings)) == [3, 4, 7]
    assert [f.row for f in readings.findings] == [3, 4, 5, 7]


@pytest.mark.parametrize(
    ("row", "kpa", "missed"),
    [
        ("53.2615,-0.525,100,nan,300", [100, 300], 0.05),
        ("53.2615,-0.525,100,-999,300", [100, 300], 0.05),
        ("53.2615,-0.525,-9999,200,NA", [200], 0.025),
        ("53.2615,-0.525,100,,300", [100, 300], 0.05),
        ("53.2615,-0.525,,200,300", [200, 300], 0.025),
        ("53.2615,-0.525,100,0,300", [100, 300], 0.05),
    ],
)
def test_a_depth_that_was_not_read_is_left_out_alone_and_named(
    save: Save, row: str, kpa: list[float], missed: float
) -> None:
    readings = read_readings(save(HEADER, row), field=HOME)
    assert readings.profiles[0].kpa.tolist() == kpa
    said = messages(readings)[2]
    assert said == f"nothing was read at {missed:g} m, yet below"


def test_a_row_that_repeats_another_is_kept_with_a_doubt(save: Save) -> None:
    readings = read_readings(save(HEADER, GOOD, GOOD), field=HOME)
    assert readings.rows.tolist() == [2, 3]
    assert [(f.row, f.severity, f.seen) for f in readings.findings] == [
        (3, "doubt", "it repeats row 2: same place, same values")
    ]


def test_blanks_and_zeros_at_the_end_were_not_reached(save: Save) -> None:
    path = save(HEADER, "53.2615,-0.525,100,200,", "53.2616,-0.525,100,0,0")
    readings = read_readings(path, field=HOME)
    assert [profile.kpa.tolist() for profile in readings.profiles] == [[100.0, 200.0], [100.0]]
    np.testing.assert_allclose(readings.layer_means(LAYERS), [[150.0, np.nan], [np.nan, np.nan]])


def test_zeros_at_the_top_of_a_table_are_a_loose_surface(save: Save) -> None:
    readings = read_readings(save(HEADER, "53.2615,-0.525,0,200,300"))
    assert readings.profiles[0].kpa.tolist() == [0.0, 200.0, 300.0]


def test_two_pushes_at_one_place_are_two_readings(save: Save) -> None:
    readings = read_readings(save(HEADER, GOOD, "53.2615,-0.5250,100,200,301"))
    assert len(readings) == 2


def test_a_byte_order_mark_and_windows_line_ends_do_not_matter(save: Save) -> None:
    path = save(HEADER + "\r", GOOD + "\r", encoding="utf-8-sig")
    assert len(read_readings(path, field=HOME)) == 1


def test_semicolons_and_decimal_commas_are_read_as_such(save: Save) -> None:
    path = save(HEADER.replace(",", ";"), "53,2615;-0,5250;100,5;200;300,25")
    readings = read_readings(path, field=HOME)
    assert readings.profiles[0].kpa.tolist() == [100.5, 200.0, 300.25]


def test_semicolons_with_decimal_points_stay_points(save: Save) -> None:
    path = save(HEADER.replace(",", ";"), GOOD.replace(",", ";"), "53.26;-0.52;1,5;2;3")
    profiles = read_readings(path).profiles
    assert [profile.kpa.tolist() for profile in profiles] == [[100, 200, 300], [1.5, 2, 3]]


# Places


def test_metres_are_in_the_frame_of_the_field(save: Save) -> None:
    readings = read_readings(save("easting,northing,kpa_5cm", "10,20,5"), field=YARD)
    assert (readings.at.tolist(), readings.crs) == ([[10.0, 20.0]], "")


def test_metres_in_another_frame_are_brought_to_that_of_the_field(save: Save) -> None:
    place = HOME.to_lonlat(HOME.cells[[100]])
    ((east, north),) = project("EPSG:4326", "EPSG:32631", place[:, 0], place[:, 1]).tolist()
    path = save("easting,northing,kpa_5cm", f"{east!r},{north!r},5")
    readings = read_readings(path, field=HOME, crs="EPSG:32631")
    np.testing.assert_allclose(readings.at, HOME.cells[[100]], atol=1e-3)


def test_metres_without_a_field_keep_their_frame(save: Save) -> None:
    path = save("easting,northing,kpa_5cm", "665000,5904000,5")
    assert read_readings(path).crs == ""
    assert read_readings(path, crs="EPSG:32630").crs == "EPSG:32630"


@pytest.mark.parametrize("frame", STRETCHED)
def test_readings_in_stretched_metres_are_brought_to_metres_on_the_ground(
    save: Save, frame: str
) -> None:
    inside = HOME.cells[[0, -1]]
    places = project(HOME.crs, frame, *inside.T)
    rows = [f"{east!r},{north!r},5{k}" for k, (east, north) in enumerate(places.tolist())]
    path = save("easting,northing,kpa_5cm", *rows)
    np.testing.assert_allclose(read_readings(path, field=HOME, crs=frame).at, inside, atol=1e-3)
    alone = read_readings(path, crs=frame)
    assert alone.crs == HOME.crs
    np.testing.assert_allclose(alone.at, inside, atol=1e-3)


def test_an_unknown_frame_is_refused(save: Save) -> None:
    path = save("easting,northing,kpa_5cm", "10,20,5")
    with pytest.raises(BoundaryError, match="there is no CRS 'EPSG:1'"):
        read_readings(path, field=HOME, crs="EPSG:1")


def test_degrees_do_not_fit_a_field_in_a_local_frame(save: Save) -> None:
    with pytest.raises(ParameterError, match=r"yard: .*local frame"):
        read_readings(save(HEADER, GOOD), field=YARD)


def test_a_reading_outside_the_field_is_refused_with_its_distance(save: Save) -> None:
    rows = ["50,50,1", "60,50,1", "112,50,1", "-6,50,1", "0,0,1"]
    readings = read_readings(save("easting,northing,kpa_5cm", *rows), field=YARD)
    assert messages(readings) == {4: "12 m outside the field", 5: "6 m outside the field"}
    assert readings.rows.tolist() == [2, 3, 6], "the edge belongs to the field"


def test_a_reading_in_a_keep_out_is_refused(save: Save) -> None:
    field = Field(YARD.boundary, keep_outs=(box(40, 40, 60, 60),))
    rows = ["50,50,1", "10,50,1"]
    readings = read_readings(save("easting,northing,kpa_5cm", *rows), field=field)
    assert messages(readings) == {2: "in a keep-out"}


def test_most_readings_outside_the_field_are_an_error_that_says_how_far(save: Save) -> None:
    rows = ["50,50,1", "1100,50,1", "1200,50,1"]
    with pytest.raises(
        ReadingsError,
        match=r"^walk\.csv: 2 of 3 readings lie outside yard, typically 1050 m away.*belong",
    ):
        read_readings(save("easting,northing,kpa_5cm", *rows), field=YARD)


def test_just_half_of_the_readings_outside_are_findings(save: Save) -> None:
    rows = ["50,50,1", "1100,50,1"]
    assert len(read_readings(save("easting,northing,kpa_5cm", *rows), field=YARD)) == 1


def test_swapped_latitude_and_longitude_are_noticed_by_the_field(save: Save) -> None:
    rows = ["-0.5250,53.2615,1,2,3", "-0.5251,53.2616,1,2,3"]
    with pytest.raises(
        ReadingsError,
        match=r"2 of 2 .* km away; swapping latitude and longitude puts them inside.*swap the",
    ):
        read_readings(save(HEADER, *rows), field=HOME)


def test_swapped_easting_and_northing_are_noticed_by_the_field(save: Save) -> None:
    flat = Field.from_metres([(0, 500), (100, 500), (100, 600), (0, 600)])
    rows = ["550,50,1", "560,50,1"]
    with pytest.raises(ReadingsError, match="swapping easting and northing puts them inside"):
        read_readings(save("easting,northing,kpa_5cm", *rows), field=flat)


def test_swapped_latitude_and_longitude_are_noticed_at_sea(save: Save) -> None:
    with pytest.raises(ReadingsError, match=r"walk\.csv: .*open sea: .*look swapped.*swap the"):
        read_readings(save(HEADER, "-0.525,53.2615,1,2,3"))


def test_degrees_under_the_names_of_metres_are_noticed(save: Save) -> None:
    rows = ["-0.5250,53.2615,1", "-0.5251,53.2616,1"]
    with pytest.raises(ReadingsError, match=r"walk\.csv: .*look like degrees.*columns lat,lon"):
        read_readings(save("easting,northing,kpa_5cm", *rows))


def test_readings_from_another_farm_are_refused_without_talk_of_swapping(save: Save) -> None:
    with pytest.raises(ReadingsError, match=r"2 of 2 .* typically \d+ km away \(") as caught:
        read_readings(save(HEADER, "52.1,-1.5,1,2,3", "52.2,-1.5,1,2,3"), field=HOME)
    assert "swap" not in str(caught.value)


# Files


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ([""], r"walk\.csv: the file is empty"),
        (["\ufeff"], r"walk\.csv: the file is empty"),
        ([",", " ,"], r"walk\.csv: all its cells are blank"),
        ([HEADER], r"walk\.csv: it holds no readings"),
        ([HEADER, "", " , ,,,"], r"walk\.csv: it holds no readings"),
        (
            [HEADER, "a,b,1,2,3", GOOD[:9]],
            r"none of 2 readings .*; row 2, column lon: 'b' is not",
        ),
        ([HEADER, '"' + "x" * 200_000], r"walk\.csv, row \d+: this is not a table"),
    ],
)
def test_a_file_without_a_usable_reading_is_refused(
    save: Save, lines: list[str], message: str
) -> None:
    with pytest.raises(ReadingsError, match=message):
        read_readings(save(*lines))


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(ReadingsError, match=r"walk\.csv: there is no such file.*check the path"):
        read_readings(tmp_path / "walk.csv")


def test_an_unknown_suffix_is_answered_with_the_known_ones(save: Save) -> None:
    with pytest.raises(ReadingsError, match=rf"walk\.jpeg: .*{', '.join(READERS)}"):
        read_readings(save("PK", name="walk.jpeg"))


@given(
    st.lists(
        st.tuples(
            st.floats(53.2612, 53.2622),
            st.floats(-0.5265, -0.5235),
            st.lists(st.floats(0.001, 50_000.0), min_size=1, max_size=4),
        ),
        min_size=1,
        max_size=8,
        unique_by=lambda reading: reading[:2],
    ),
    st.sampled_from([",", ";", "\t"]),
)
@settings(deadline=None, max_examples=60)
def test_what_is_written_as_a_table_is_read_back_unchanged(
    tmp_path_factory: pytest.TempPathFactory,
    pushes: list[tuple[float, float, list[float]]],
    delimiter: str,
) -> None:
    # A file all of whose numbers may have a thousands mark is refused, and tested elsewhere.
    numbers = [repr(value) for push in pushes for value in push[2]]
    assume(not all(re.fullmatch(r"\d{1,3}\.\d{3}", number) for number in numbers))
    path = tmp_path_factory.mktemp("trip") / "trip.csv"
    with path.open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, delimiter=delimiter)
        table.writerow(["lat", "lon", *(f"kpa_{5 * k + 5}cm" for k in range(4))])
        table.writerows([lat, lon, *kpa, *[""] * (4 - len(kpa))] for lat, lon, kpa in pushes)
    readings = read_readings(path, field=HOME)
    assert left_out(readings.findings) == ()
    assert [profile.kpa.tolist() for profile in readings.profiles] == [p[2] for p in pushes]
    np.testing.assert_allclose(
        HOME.to_lonlat(readings.at), [(lon, lat) for lat, lon, _ in pushes], atol=1e-9
    )


@given(st.text(), st.sampled_from(["", HEADER + "\n", HEADER + "\n" + GOOD + "\n"]))
@settings(deadline=None, max_examples=200)
def test_no_text_whatever_makes_anything_but_readings_or_a_readings_error(
    tmp_path_factory: pytest.TempPathFactory, text: str, start: str
) -> None:
    path = tmp_path_factory.mktemp("any") / "any.csv"
    path.write_bytes((start + text).encode("utf-8", "surrogatepass"))
    try:
        assert len(read_readings(path)) >= 1
    except ReadingsError as error:
        complaint = str(error)
    else:
        return
    assert "any.csv" in complaint


# The robot's YAML


def robot(*records: Any, names: Any = ("2.5 cm", "5.0 cm", "7.5 cm")) -> str:
    return yaml.safe_dump({"names": list(names), "data": list(records)})


def push(*values: Any, lat: Any = 53.2615, lon: Any = -0.525) -> dict[str, Any]:
    return {"position": {"lat": lat, "lon": lon}, "data": list(values)}


def test_a_robot_file_gives_kpa_and_ends_where_zeros_begin(save: Save) -> None:
    text = robot(push(10.5, 20.0, 30.0), push(11.0, 0.0, 0.0, lat=53.2616))
    readings = read_readings(save(text, name="robot.yaml"), field=HOME)
    assert [profile.kpa.tolist() for profile in readings.profiles] == [[10.5, 20.0, 30.0], [11.0]]
    assert readings.rows.tolist() == [1, 2]
    np.testing.assert_allclose(readings.at[0], HOME.to_metres([-0.525], [53.2615])[0])


@pytest.mark.parametrize(
    ("record", "message"),
    [
        (push(0.0, 0.0, 0.0), "no depth was reached"),
        (push(10.0, -2.0, 30.0), "-2 kPa at 0.05 m is no soil strength"),
        (push(10.0, "x", 30.0), "'x' at 0.05 m is not a number"),
        (push(10.0, True, 30.0), "True at 0.05 m is not a number"),
        (push(10.0, 20.0), "2 values do not pair with 3 depths"),
        (push(10.0, 20.0, 30.0, lat=None), "None at lat is not a number"),
        (push(10.0, 20.0, 30.0, lat=95.0), "no place on Earth"),
        ({"data": [1.0, 2.0, 3.0]}, "it needs a position and a list of data"),
        ("nothing", "it needs a position and a list of data"),
    ],
)
def test_a_bad_record_of_a_robot_is_refused_by_its_number(
    save: Save, record: Any, message: str
) -> None:
    path = save(robot(push(1.0, 2.0, 3.0), record), name="robot.yml")
    readings = read_readings(path, field=HOME)
    assert readings.rows.tolist() == [1]
    assert list(messages(readings)) == [2]
    assert message in messages(readings)[2]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a: [1,\nb: }", r"robot\.yaml, line \d: this is not YAML"),
        ("- 1\n- 2", r"robot\.yaml: this is YAML, but not a robot's readings"),
        ("!!python/object/apply:os.system ['true']", r"robot\.yaml, line 1: this is not YAML"),
        ("names: 5\ndata: []", r"robot\.yaml: it has no list 'names'"),
        ("names: [2.5 cm]\ndata: 5", r"robot\.yaml: it has no list 'data'"),
        ("names: [deep]\ndata: []", r"robot\.yaml, names: 'deep' is not a depth"),
        ("names: [5 cm, 2 cm]\ndata: []", r"robot\.yaml, names: depths do not increase"),
        ("names: [5 cm]\ndata: []", r"robot\.yaml: it holds no readings"),
    ],
)
def test_yaml_that_is_no_robots_is_refused_and_never_run(
    save: Save, text: str, message: str
) -> None:
    with pytest.raises(ReadingsError, match=message):
        read_readings(save(text, name="robot.yaml"))


def test_a_robot_speaks_kpa_and_nobody_may_say_otherwise(save: Save) -> None:
    path = save(robot(push(1.0, 2.0, 3.0)), name="robot.yaml")
    with pytest.raises(ReadingsError, match="it says kpa, and you say psi"):
        read_readings(path, units="psi")
