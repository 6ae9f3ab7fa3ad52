"""Files as instruments write them: what is in them, told apart by content, cut, and saved again."""

from __future__ import annotations

import gzip
import re
from collections.abc import Callable
from datetime import datetime
from pathlib import Path

import numpy as np
import pytest

from subsoil.errors import ReadingsError
from subsoil.findings import left_out
from subsoil.io.read.instruments import INSTRUMENTS, gef, penetrologger, sc900
from subsoil.io.read.instruments.coordinates import degrees
from subsoil.io.read.instruments.probe_log import read_probe_log
from subsoil.io.read.readings import read_readings
from subsoil.io.read.recording import Recording
from subsoil.io.read.screening import screened
from subsoil.layers import Layers

Save = Callable[..., Path]
FIVE_CM = Layers()
SC900_FILES = ("raw2020_20200518_penetrom.txt", "rd_20190611-penet.txt")


@pytest.fixture
def save(tmp_path: Path) -> Save:
    def write(text: str, name: str = "walk.txt", encoding: str = "utf-8") -> Path:
        path = tmp_path / name
        path.write_bytes(text.encode(encoding))
        return path

    return write


def layer_means(recording: Recording, kpa_per_unit: float = 1.0) -> np.ndarray:
    """(m, n) layer means in kPa of all records, wherever they are."""
    pushes, _ = screened(recording.records, kpa_per_unit, "none", "walk")
    return np.array([FIVE_CM.sample(push.profile, (0, 0)).measured_kpa for push in pushes]).T


def words(recording: Recording) -> list[str]:
    return [str(finding) for finding in recording.findings]


# FieldScout SC 900

HEAD = "Name: Meter\nSerial #:  7 \nDatum: WGS 84\nSoil Compation In KPa\n"
HEADING = "Longitude,Latitude,Number,0.0 cm,2.5 cm,5.0 cm,7.5 cm,10.0 cm,Cone Size\n"
SC900 = (
    HEAD
    + HEADING
    + ",,Logger Started\n"
    + "5.642649,52.096060,N= 1 , 34 , 414 , 552 , 518 , 380 ,1/2 Inch\n"
    + "5.643063,52.096002,N= 2 , 69 , 138 , 242 , 586 , 0 ,1/2 Inch\n"
)


@pytest.mark.parametrize(
    ("name", "pushes", "means", "reached"),
    [
        (SC900_FILES[0], 21, [320.3, 642.3, 683.3, 777.8], [21] * 8),
        (SC900_FILES[1], 83, [528.9, 684.6, 757.6, 827.0], [83, 83, 83, 81, 80, 78, 72, 68]),
    ],
)
def test_the_real_files_of_an_sc_900_hold_what_numpy_finds_in_them(
    real_data: Path, name: str, pushes: int, means: list[float], reached: list[int]
) -> None:
    path = real_data / "sc900" / name
    numbers = [
        [float(cell) for cell in line.split(",")[3:-1]]
        for line in path.read_text().splitlines()
        if "N=" in line
    ]
    by_hand = np.array(numbers)[:, 1:17].reshape(-1, 8, 2)
    by_hand = np.where((by_hand == 0).any(axis=2), np.nan, by_hand.mean(axis=2)).T
    found = layer_means(sc900.read(path))
    assert found.shape == (8, pushes)
    assert np.nanmean(found[:4], axis=1).round(1).tolist() == means
    assert np.isfinite(found).sum(axis=1).tolist() == reached
    both = np.isfinite(by_hand)
    assert both.sum() >= np.isfinite(found).sum() - 1
    np.testing.assert_allclose(found[both], by_hand[both])


def test_an_inner_zero_of_an_sc_900_is_a_gap_and_a_last_one_was_not_reached(
    real_data: Path,
) -> None:
    recording = sc900.read(real_data / "sc900" / SC900_FILES[1])
    _, findings = screened(recording.records, 1.0, "none", "walk")
    assert [str(each) for each in findings] == [
        "row 31: nothing was read at 0.325 m, yet below; that depth is left out"
    ]


def test_pushes_are_numbered_by_order_where_the_instrument_counts_anew(real_data: Path) -> None:
    recording = sc900.read(real_data / "sc900" / SC900_FILES[0])
    assert [record.number for record in recording.records] == [str(k) for k in range(1, 22)]
    assert words(recording)[0].endswith(
        "pushes are numbered from 1 to 21 as they stand in the file"
    )


def test_numbers_of_an_sc_900_stay_where_none_is_there_twice(save: Save) -> None:
    recording = sc900.read(save(SC900.replace("N= 2", "N= 4")))
    assert [record.number for record in recording.records] == ["1", "4"]
    assert recording.findings == ()


def test_an_sc_900_gives_longitude_first_its_cone_and_kpa_below_the_surface(save: Save) -> None:
    recording = sc900.read(save(SC900))
    first, second = recording.records
    assert (first.x, first.y) == (5.642649, 52.09606)
    assert first.cone is not None
    assert first.cone.area_mm2 == 130
    assert first.depth_m.tolist() == [0.025, 0.05, 0.075, 0.1]
    assert first.values.tolist() == [414, 552, 518, 380]
    assert np.isnan(second.values[-1])
    assert (recording.frame, recording.unit) == ("lonlat", "kpa")


def in_german_excel(text: str) -> str:
    commas = re.sub(r"(\d)\.(\d)", r"\1,\2", text.replace(",", ";"))
    return "".join(f"{line}{';' * (9 - line.count(';'))}\n" for line in commas.splitlines())


def in_one_cell(text: str) -> str:
    return "".join(f'"{line}"\n' for line in text.splitlines())


def quoted(text: str) -> str:
    return "".join(
        ",".join(f'"{cell}"' for cell in line.split(",")) + "\n" for line in text.splitlines()
    )


@pytest.mark.parametrize("again", [in_german_excel, in_one_cell, quoted])
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
def test_an_sc_900_export_saved_again_by_a_spreadsheet_is_the_same(
    save: Save, again: Callable[[str], str], encoding: str
) -> None:
    saved = save(again(SC900).replace("\n", "\r\n"), "walk.csv", encoding)
    assert sc900.sniff(saved.read_bytes()[:4096], saved.name)
    one, other = sc900.read(save(SC900)), sc900.read(saved)
    assert other.findings == ()
    for a, b in zip(one.records, other.records, strict=True):
        assert (a.x, a.y, a.number, a.cone) == (b.x, b.y, b.number, b.cone)
        np.testing.assert_array_equal(a.values, b.values)
        np.testing.assert_array_equal(a.depth_m, b.depth_m)


def test_psi_and_inches_are_the_same_soil_as_kpa_and_cm(save: Save) -> None:
    text = SC900.replace("In KPa", "In PSI").replace(
        HEADING, "Longitude,Latitude,Number,0 in,1 in,2 in,3 in,4 in,Cone Size\n"
    )
    recording = sc900.read(save(text))
    assert recording.unit == "psi"
    assert recording.records[0].depth_m.tolist() == [0.0254, 0.0508, 0.0762, 0.1016]


def test_positions_in_degrees_and_minutes_are_read(save: Save) -> None:
    text = SC900.replace("5.642649,52.096060", "00538.5589 E,5205.7636 N")
    first = sc900.read(save(text)).records[0]
    assert (first.x, first.y) == (5.6426483, 52.0960600)


def test_pushes_without_a_fix_have_no_place(save: Save) -> None:
    text = SC900.replace("5.642649,52.096060", "").replace("5.643063,52.096002", "0.0,0.0")
    recording = sc900.read(save(text))
    assert recording.frame == "none"
    assert np.isnan([record.x for record in recording.records]).all()


@pytest.mark.parametrize("length", range(len(HEAD + HEADING) + 18, len(SC900) - 1))
def test_what_is_left_of_a_cut_sc_900_file_is_read_and_the_rest_is_named(
    save: Save, length: int
) -> None:
    whole = {record.row: record for record in sc900.read(save(SC900)).records}
    found = sc900.read(save(SC900[:length], "cut.txt"))
    for record in found.records:
        known = np.isfinite(record.values)
        np.testing.assert_array_equal(record.values[known], whole[record.row].values[known])
    ends_whole = SC900[:length].rstrip().endswith(("Inch", "Started"))
    assert len(left_out(found.findings)) == (0 if ends_whole else 1)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (" 552 ", " 1.552 ", "column 5.0 cm: '1.552' is no whole number.*thousands"),
        (" 552 ", " x ", "column 5.0 cm: 'x' is not a number"),
        (" 380 ,", " 380 , 1 , 2 ,", "7 values do not pair with 5 depths"),
        ("52.096060", "52.61.1", "'52.61.1' is no latitude or longitude"),
        (",,Logger Started", "hello", "'hello' is no reading of this instrument"),
    ],
)
def test_a_row_of_an_sc_900_that_is_not_understood_is_named(
    save: Save, old: str, new: str, message: str
) -> None:
    recording = sc900.read(save(SC900.replace(old, new)))
    (found,) = left_out(recording.findings)
    assert re.search(message, str(found))


def test_a_change_of_cones_is_a_doubt(save: Save) -> None:
    found = sc900.read(save(SC900.replace("1/2 Inch\n5.64", "3/4 Inch\n5.64"))).findings
    assert [each.severity for each in found] == ["doubt"]


@pytest.mark.parametrize(
    "text",
    [HEAD, SC900.replace("In KPa", "In bar"), SC900.replace("5.0 cm", "5.0 ell")],
)
def test_an_sc_900_file_without_unit_heading_or_depths_is_refused(save: Save, text: str) -> None:
    with pytest.raises(ReadingsError, match="export it again"):
        sc900.read(save(text))


def test_a_second_layout_in_one_file_is_refused(save: Save) -> None:
    with pytest.raises(ReadingsError, match=r"row 9: a second heading differs"):
        sc900.read(save(SC900 + HEADING.replace("2.5 cm,", "")))
    assert len(sc900.read(save(SC900 + SC900)).records) == 4


# Eijkelkamp Penetrologger


def test_the_real_file_of_a_penetrologger_holds_what_numpy_finds_in_it(real_data: Path) -> None:
    (path,) = (real_data / "penetrologger").glob("2*.txt")
    rows = [line.split("\t") for line in path.read_text().splitlines() if line.startswith("PLOT")]
    by_hand = np.array([[float(cell) for cell in row[3:]] for row in rows])[:, :40] * 1000
    recording = penetrologger.read(path)
    found = layer_means(recording, 1000.0)
    assert recording.findings == ()
    assert found.shape == (8, 16)
    np.testing.assert_allclose(found, by_hand.reshape(16, 8, 5).mean(axis=2).T)
    assert found.mean(axis=1).round().tolist() == [135, 415, 640, 799, 990, 1561, 2031, 2292]
    first = recording.records[0]
    assert (first.x, first.y) == (-2.4279667, 52.7669167)
    assert (first.number, recording.unit, first.depth_m[-1]) == ("PLOT-001.1", "mpa", 0.81)
    assert first.cone is not None
    assert (first.cone.area_mm2, first.cone.angle_deg) == (200.0, 60.0)
    assert np.isfinite(first.values).sum() == sum(cell.strip() != "-1" for cell in rows[0][3:])


@pytest.fixture
def penetro(real_data: Path) -> str:
    (path,) = (real_data / "penetrologger").glob("2*.txt")
    return path.read_bytes().decode()


def test_a_penetrologger_in_another_language_with_decimal_commas_is_the_same(
    save: Save, penetro: str
) -> None:
    other = re.sub(r"(\d)\.(\d)", r"\1,\2", penetro.replace("PENETRATION DATA", "METINGEN"))
    other = other.replace("Pressure meas unit", "Drukeenheid").replace("PLOT-001,", "PLOT-001.")
    a, b = penetrologger.read(save(penetro)), penetrologger.read(save(other))
    assert (a.unit, a.frame, b.findings) == (b.unit, b.frame, ())
    for one, two in zip(a.records, b.records, strict=True):
        np.testing.assert_array_equal(one.values, two.values)
        assert (one.x, one.y) == (two.x, two.y)


def test_a_penetrologger_file_cut_in_the_middle_names_what_is_lost(
    save: Save, penetro: str
) -> None:
    start = penetro.index("PLOT-001.9")
    recording = penetrologger.read(save(penetro[: start + 80]))
    whole = penetrologger.read(save(penetro))
    assert len(recording.records) == 9
    cut, same = recording.records[-1], whole.records[8]
    np.testing.assert_array_equal(cut.values, same.values[: cut.values.size])
    assert "ends in the middle of this push" in words(recording)[0]
    assert words(recording)[1].startswith("walk.txt: its head says 16 pushes, and it holds 9")


@pytest.mark.parametrize(
    ("old", "new", "unit"),
    [("MPascal", "kPascal", "kpa"), ("MPascal", "N/cm2", "n/cm2"), ("MPascal", "?", "")],
)
def test_the_unit_of_a_penetrologger_is_that_of_its_head(
    save: Save, penetro: str, old: str, new: str, unit: str
) -> None:
    assert penetrologger.read(save(penetro.replace(old, new))).unit == unit


def test_depths_of_a_penetrologger_in_other_units_are_refused(save: Save, penetro: str) -> None:
    with pytest.raises(ReadingsError, match="depths are in inch"):
        penetrologger.read(save(penetro.replace(":    cm", ":    inch")))


# Probe logs


def test_the_real_probe_logs_hold_87_pushes_of_motor_effort(real_data: Path) -> None:
    logs = sorted((real_data / "riseholme_probe_logs").glob("*.log.gz"))
    pushes = {path.name: read_probe_log(path) for path in logs}
    assert len(logs) == 95
    assert sum(map(len, pushes.values())) == 87
    assert sum(bool(each) for each in pushes.values()) == 84
    (first,) = pushes["Waypoint1.log.gz"]
    rows = np.loadtxt(logs[0].with_name("Waypoint1.log.gz"), delimiter=",")
    down = rows[rows[:, 2] == 480]
    seconds = down[-1, 0] - down[0, 0]
    by_hand = down[:, 3].mean() * seconds / 1000
    assert first.depth_m[-1] == 0.48
    assert by_hand == pytest.approx(0.48, rel=0.05)
    assert (np.diff(first.depth_m) >= 0).all()
    assert set(first.percent) <= set(down[:, 1])


def test_a_map_of_motor_effort_is_refused_with_the_reason(save: Save) -> None:
    lines = "".join(f"{1503665159 + k // 90}, 21, 480.0, 25\n" for k in range(1800))
    assert len(read_probe_log(save(lines))) == 1
    packed = save("", "w.log.gz")
    packed.write_bytes(gzip.compress(lines.encode()))
    for path in (save(lines), packed):
        with pytest.raises(ReadingsError, match=r"motor effort in percent \(1 pushes\).*no force"):
            read_readings(path)


def test_a_probe_log_cut_in_the_middle_gives_the_push_as_far_as_it_goes(save: Save) -> None:
    lines = "".join(f"{1503665159 + k // 90}, 21, 480.0, 25\n" for k in range(900))
    path = save("", "w.log.gz")
    path.write_bytes(gzip.compress(lines.encode())[:-20])
    (push,) = read_probe_log(path)
    assert 0.05 < push.depth_m[-1] <= 0.25


# GEF

GEF = """#GEFID= 1, 1, 0
#TESTID= S01
#STARTDATE= 2019, 5, 7
#STARTTIME= 10, 20, 30
#XYID= 31000, 174000.00, 444000.00
#COLUMN= 4
#COLUMNINFO= 1, m, Sondeerlengte, 1
#COLUMNINFO= 2, MPa, Conusweerstand, 2
#COLUMNINFO= 3, MPa, Wrijving, 3
#COLUMNINFO= 4, s, Tijd, 12
#COLUMNVOID= 2, -9999
#MEASUREMENTVAR= 1, 1000.0, mm2, Oppervlakte conuspunt
#LASTSCAN= 5
#EOH=
0.02 0.5 0.01 1
0.04 0.7 0.01 2
0.06 -9999 0.01 3
0.08 0.9 0.01 4
4.00 9.9 0.01 200
"""


def test_a_gef_file_gives_cone_resistance_at_points_in_depth(save: Save) -> None:
    recording = gef.read(save(GEF))
    (record,) = recording.records
    np.testing.assert_allclose(record.top_m, [0.01, 0.03, 0.05, 0.07])
    np.testing.assert_allclose(record.depth_m, [0.03, 0.05, 0.07, 0.09])
    np.testing.assert_allclose(record.values, [500, 700, np.nan, 900])
    assert (record.x, record.y, recording.crs) == (174000.0, 444000.0, "EPSG:28992")
    assert (record.number, record.time) == ("S01", datetime(2019, 5, 7, 10, 20, 30))
    assert record.seconds.tolist() == [1, 2, 3, 4]
    assert record.cone is not None
    assert record.cone.area_mm2 == 1000
    assert words(recording) == ["walk.txt: readings below 3 m are left alone"]


def test_separators_of_a_gef_file_are_those_of_its_head(save: Save) -> None:
    head, body = GEF.split("#EOH=\n")
    other = "".join(";".join(line.split()) + ";!\n" for line in body.splitlines())
    said = head + "#COLUMNSEPARATOR= ;\n#RECORDSEPARATOR= !\n#EOH=\n"
    a, b = gef.read(save(GEF)), gef.read(save(said + other))
    np.testing.assert_array_equal(a.records[0].values, b.records[0].values)
    np.testing.assert_array_equal(a.records[0].depth_m, b.records[0].depth_m)


def test_depth_of_a_gef_file_is_that_corrected_for_a_leaning_rod(save: Save) -> None:
    text = GEF.replace("4, s, Tijd, 12", "4, m, Diepte, 11").replace("0.01 4\n", "0.01 0.078\n")
    text = text.replace("0.01 1\n", "0.01 0.02\n").replace("0.01 2\n", "0.01 0.04\n")
    text = text.replace("0.01 3\n", "0.01 0.06\n").replace("0.01 200\n", "0.01 3.9\n")
    assert gef.read(save(text)).records[0].depth_m[-1] == pytest.approx(0.087)


def test_soil_dug_away_before_a_test_is_not_read(save: Save) -> None:
    dug = "#MEASUREMENTVAR= 13, 0.05, m, voorgeboorde diepte\n#EOH="
    recording = gef.read(save(GEF.replace("#EOH=", dug)))
    assert recording.records[0].depth_m.tolist() == pytest.approx([0.07, 0.09])
    assert "dug to 0.05 m" in " ".join(words(recording))


def test_a_gef_file_cut_in_the_middle_names_what_is_lost(save: Save) -> None:
    recording = gef.read(save(GEF[: GEF.index("0.08") + 7]))
    assert np.isfinite(recording.records[0].values).sum() == 2
    said = " ".join(words(recording))
    assert "line 4 after the head does not hold 4 numbers" in said
    assert "its head says 5 lines, and it holds 4" in said
    assert len(left_out(recording.findings)) == 2


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("#EOH=\n", "", "no end"),
        ("Sondeerlengte, 1", "Sondeerlengte, 99", "does not say which columns"),
        ("2, MPa", "2, ell", "unit 'ell' of column 2 is unknown"),
        ("0.0", "x", "holds no readings"),
    ],
)
def test_a_gef_file_that_leaves_doubt_is_refused(
    save: Save, old: str, new: str, message: str
) -> None:
    with pytest.raises(ReadingsError, match=message):
        gef.read(save(GEF.replace(old, new)))


def test_an_unknown_frame_of_a_gef_file_is_said(save: Save) -> None:
    recording = gef.read(save(GEF.replace("31000", "49000")))
    assert (recording.frame, recording.crs) == ("metres", "")
    assert "code 49000" in " ".join(words(recording))


# All


def test_each_instrument_knows_its_own_files_and_no_other(penetro: str, real_data: Path) -> None:
    heads = {
        "sc900": SC900.encode(),
        "penetrologger": penetro.encode(),
        "gef": GEF.encode(),
        "probe-log": b"1503665159, 30, 480.0, 1\n1503665159, 33, 480.0, 11\n",
        "robot-yaml": (real_data / "riseholme" / "cosmos-gt.yaml").read_bytes(),
        "": b"lat,lon,kpa_5cm\n53.2,-0.5,100\n",
    }
    for name, head in heads.items():
        claimed = [key for key, each in INSTRUMENTS.items() if each.sniff(head[:4096], "a.txt")]
        assert claimed == ([name] if name else [])


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("-93.65", -93.65),
        ("93.65 W", -93.65),
        ("S 30,5", -30.5),
        ("N52 46.015", 52.7669167),
        ("52°46.015'N", 52.7669167),
        ("5246.0150N", 52.7669167),
        ("00225.678W", -2.4279667),
    ],
)
def test_a_coordinate_is_read_in_all_its_forms(text: str, value: float) -> None:
    assert degrees(text) == value


@pytest.mark.parametrize("text", ["5246.0150", "N52 66.015", "52 46.015", "-52 N", "x", "N52S"])
def test_a_coordinate_that_leaves_doubt_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match="no latitude or longitude"):
        degrees(text)
