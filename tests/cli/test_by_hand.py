"""A survey by hand: where next, what was read, corrections, files taken in, and enough."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from subsoil.journal import read_events, read_survey
from subsoil.survey import Survey, fold

Cli = Callable[..., Any]
Typed = tuple[float, float, tuple[int, int]]

CORNER = (0.0, 52.0)
FIELD = "[[0.0,52.0],[0.0009,52.0],[0.0009,52.0005],[0.0,52.0005],[0.0,52.0]]"


@pytest.fixture
def survey(cli: Cli, outline: Path, tmp_path: Path) -> Path:
    """A survey of a 60 x 40 m field in a local frame, for twelve samples by hand."""
    return begun(cli, outline, tmp_path / "hand.gpkg")


@pytest.fixture
def on_earth(cli: Cli, tmp_path: Path) -> Path:
    """A survey of a field in longitude and latitude, some 62 x 56 m."""
    outline = tmp_path / "field.geojson"
    outline.write_text(f'{{"type":"Polygon","coordinates":[{FIELD}]}}')
    return begun(cli, outline, tmp_path / "earth.gpkg", "--start", "52.0,0.0")


def begun(cli: Cli, outline: Path, path: Path, *more: object) -> Path:
    made = cli(
        "init", path, "--boundary", outline, "--layers", "0,0.1,0.2", "--samples", 12,
        "--strategy", "area-split", "--speed", 1.2, "--stop-seconds", 90, *more,
    )  # fmt: skip
    assert made.code == 0, made.err
    return path


def state_of(path: Path) -> Survey:
    return fold(read_events(path))


def soil(east: float, north: float) -> tuple[int, int]:
    """What a push reads at a place: two depths in kPa."""
    return round(600 + 6 * east + 3 * north), round(1100 + 4 * east - 5 * north)


def table(path: Path, pushes: Sequence[Typed]) -> Path:
    rows = [f"{east!r},{north!r},{a},{b}" for east, north, (a, b) in pushes]
    path.write_text("easting,northing,kpa_10cm,kpa_20cm\n" + "\n".join(rows) + "\n")
    return path


def samples(survey: Survey) -> np.ndarray:
    """(n, 4) place and layer values of all samples, in an order of their own."""
    found = np.column_stack([survey.soil_map.at, survey.soil_map.kpa.T])
    return found[np.lexsort(found.T)]


class Hand:
    """Somebody with a penetrometer, who notes what holds of each push in the end."""

    def __init__(self, cli: Cli, path: Path) -> None:
        self.cli, self.path = cli, path
        self.pushes: dict[str, Typed] = {}

    def says(self, *words: object, code: int = 0) -> Any:
        outcome = self.cli(*words, "--json")
        assert outcome.code == code, outcome.err
        return outcome.json

    def add(self, read: tuple[int, int], at: tuple[float, float] | None = None) -> str:
        where = () if at is None else ("--at", f"{at[0]},{at[1]}")
        told = self.says(
            "add", self.path, "--kpa", f"{read[0]},{read[1]}", "--depths", "10,20", *where
        )
        self.pushes[told["report"]] = (told["easting_m"], told["northing_m"], read)
        return str(told["report"])

    def goes(self) -> dict[str, float] | None:
        """The next stop; None when there is enough."""
        told = self.says("next", self.path)
        return None if told["finished"] != "no" else dict(told["stop"])

    def surveys(self) -> str:
        """Go to the next stop and push there; returns the id of the reading."""
        stop = self.goes()
        assert stop is not None
        return self.add(soil(stop["easting_m"], stop["northing_m"]))


def surveyed_over_two_days(cli: Cli, path: Path, folder: Path) -> Hand:
    """Stops as planned and elsewhere, a stone, a skip, a batch, and two corrections."""
    hand = Hand(cli, path)
    hand.surveys()
    stop = hand.goes()
    assert stop is not None
    wrong = hand.add((5000, 10))
    right = soil(stop["easting_m"], stop["northing_m"])
    hand.says("amend", path, wrong[:8], "--kpa", f"{right[0]},{right[1]}", "--depths", "10,20",
              "--reason", "mistyped")  # fmt: skip
    hand.pushes[wrong] = (stop["easting_m"], stop["northing_m"], right)
    hand.add(soil(33.25, 21.5), at=(33.25, 21.5))
    bad = hand.surveys()
    hand.says("withdraw", path, bad, "--reason", "hit a root")
    del hand.pushes[bad]
    hand.goes()
    hand.says("stone", path, "--depth", 12)
    hand.goes()
    hand.says("skip", path, "--reason", "under water")
    batch = [(at[0], at[1], soil(*at)) for at in ((12.0, 31.5), (51.0, 9.25), (7.5, 7.75))]
    told = hand.says("ingest", path, table(folder / "batch.csv", batch))
    assert (told["accepted"], told["known"], told["refused"]) == (3, 0, [])
    hand.pushes |= {f"row {k}": push for k, push in enumerate(batch)}
    while hand.goes() is not None:
        hand.surveys()
    return hand


def test_a_survey_by_hand_over_two_days_equals_its_readings_taken_in_one_go(
    cli: Cli, survey: Path, outline: Path, tmp_path: Path
) -> None:
    hand = surveyed_over_two_days(cli, survey, tmp_path)
    assert len(hand.pushes) == 12
    assert cli("next", survey).out.startswith("There is enough: 12 samples taken.")
    at_once = begun(cli, outline, tmp_path / "at_once.gpkg")
    everything = table(tmp_path / "all.csv", list(hand.pushes.values()))
    assert cli("ingest", at_once, everything).code == 0
    by_hand, in_one_go = state_of(survey), state_of(at_once)
    expected = np.array(sorted((e, n, a, b) for e, n, (a, b) in hand.pushes.values()))
    np.testing.assert_allclose(samples(by_hand), samples(in_one_go), rtol=1e-12)
    found = samples(by_hand)
    np.testing.assert_allclose(found[np.lexsort(found.T[::-1])], expected, rtol=1e-12)
    np.testing.assert_allclose(by_hand.soil_map.mean, in_one_go.soil_map.mean, rtol=1e-6)
    np.testing.assert_allclose(by_hand.soil_map.variance, in_one_go.soil_map.variance, rtol=1e-6)
    assert in_one_go.finished == by_hand.finished == "12 samples taken"
    for path in (survey, at_once):
        assert cli("verify", path, "--json").json["findings"] == "none"


def test_a_stone_and_a_stop_left_out_are_not_planned_again(
    cli: Cli, survey: Path, tmp_path: Path
) -> None:
    surveyed_over_two_days(cli, survey, tmp_path)
    causes = [stop.refusal.cause for stop in state_of(survey).stops if stop.refusal]
    assert causes == ["soil", "skipped"]
    reasons = [stop.refusal.reason for stop in state_of(survey).stops if stop.refusal]
    assert reasons == ["a stone at 12 cm", "under water"]
    assert len({stop.cell for stop in state_of(survey).stops if stop.refusal}) == 2


def test_a_finished_survey_goes_on_when_told(cli: Cli, survey: Path, tmp_path: Path) -> None:
    hand = surveyed_over_two_days(cli, survey, tmp_path)
    assert hand.goes() is None
    told = hand.says("next", survey, "--samples", 13)
    assert told["finished"] == "no"
    hand.surveys()
    assert hand.goes() is None
    assert state_of(survey).finished == "13 samples taken"


def test_a_survey_by_hand_stops_where_its_map_is_good_enough(
    cli: Cli, outline: Path, tmp_path: Path
) -> None:
    path = begun(cli, outline, tmp_path / "enough.gpkg", "--samples", 40, "--target-rmse", 400)
    hand = Hand(cli, path)
    while hand.goes() is not None:
        hand.surveys()
    survey = state_of(path)
    assert 12 <= survey.taken < 40
    assert "400" in survey.finished
    assert "There is enough" in cli("next", path).out


def test_asking_twice_gives_the_same_stop_and_each_hand_its_own(cli: Cli, survey: Path) -> None:
    stops = [cli("next", survey, "--json").json["stop"] for _ in range(2)]
    assert stops[0] == stops[1]
    other = cli("next", survey, "--agent", "anna", "--json").json["stop"]
    assert other["cell"] != stops[0]["cell"]
    assert cli("next", survey, "--json").json["stop"] == stops[0]


def test_the_next_stop_is_said_in_words(cli: Cli, on_earth: Path) -> None:
    said = cli("next", on_earth, "--from", "52.0,0.0").out
    stop = cli("next", on_earth, "--json").json["stop"]
    assert f"latitude {stop['latitude']:.7f}, longitude {stop['longitude']:.7f}" in said
    assert " m to the " in said
    assert "°)" in said
    assert "Why there: nothing is known there yet" in said
    assert "Is it enough? 0 samples in 0 min: too few to say" in said


def test_distance_and_bearing_are_from_where_one_says_one_is(cli: Cli, survey: Path) -> None:
    stop = cli("next", survey, "--json").json["stop"]
    east, north = stop["easting_m"], stop["northing_m"]
    told = cli("next", survey, "--from", f"{east - 30},{north - 40}", "--json").json
    assert told["metres"] == pytest.approx(50.0)
    assert told["bearing_deg"] == pytest.approx(np.degrees(np.arctan2(30, 40)))
    assert (
        "50 m to the north-east (37°)"
        in cli("next", survey, "--from", f"{east - 30},{north - 40}").out
    )


def test_time_and_way_are_reckoned_by_the_pace_of_the_survey(cli: Cli, survey: Path) -> None:
    hand = Hand(cli, survey)
    first = hand.goes()
    assert first is not None
    hand.surveys()
    status = cli("status", survey, "--json").json
    way = np.hypot(first["easting_m"], first["northing_m"])
    assert status["metres"] == pytest.approx(way)
    assert status["minutes"] == pytest.approx((way / 1.2 + 90) / 60)


def test_a_survey_goes_by_the_settings_it_was_started_with(
    cli: Cli, outline: Path, tmp_path: Path
) -> None:
    path = begun(cli, outline, tmp_path / "set.gpkg", "--minutes", 45, "--start", "60,40")
    settings = state_of(path).settings
    assert (settings.samples, settings.minutes, settings.strategy) == (12, 45.0, "area-split")
    assert (settings.pace.speed_mps, settings.pace.stop_s) == (1.2, 90.0)
    assert settings.start == (60.0, 40.0)
    assert cli("plan", path, "--json").json["stops"] == 12
    assert cli("plan", path, "--samples", 3, "--json").json["stops"] == 3
    cli("next", path, "--samples", 5)
    again = state_of(path).settings
    assert again.samples == 5
    assert again.model_copy(update={"samples": 12}) == settings
    far = cli("next", path, "--from", "0,0", "--json").json
    assert far["stop"]["easting_m"] > 30 or far["stop"]["northing_m"] > 20


def test_a_robot_goes_by_the_settings_that_the_survey_was_started_with(
    cli: Cli, outline: Path, tmp_path: Path
) -> None:
    path = begun(cli, outline, tmp_path / "robot.gpkg")
    assert cli("run", path, "--samples", 4, "--json").json["samples"] == 4
    settings = state_of(path).settings
    assert (settings.samples, settings.strategy) == (4, "area-split")


def test_a_reading_far_from_the_planned_stop_counts_where_it_is_and_the_stop_stays(
    cli: Cli, survey: Path
) -> None:
    hand = Hand(cli, survey)
    stop = hand.goes()
    assert stop is not None
    away = (60 - stop["easting_m"], 40 - stop["northing_m"])
    hand.add(soil(*away), at=away)
    assert state_of(survey).readings[0].at == away
    assert hand.goes() == stop


def test_a_reading_beside_the_planned_stop_is_of_that_stop(cli: Cli, survey: Path) -> None:
    hand = Hand(cli, survey)
    stop = hand.goes()
    assert stop is not None
    hand.add((700, 900), at=(stop["easting_m"] + 2.0, stop["northing_m"] + 1.0))
    (made,) = state_of(survey).stops
    assert made.cell == stop["cell"]
    assert made.readings[0].at == (stop["easting_m"] + 2.0, stop["northing_m"] + 1.0)
    assert hand.goes() != stop


def test_forces_inches_and_gaps_are_typed_in_as_they_were_read(cli: Cli, survey: Path) -> None:
    def layers(*words: object) -> list[float | None]:
        told = cli("add", survey, "--at", "30,20", *words, "--json")
        assert told.code == 0, told.err
        return list(told.json["kpa"])

    force = layers("--values", "65,130", "--unit", "N", "--cone-area", 130, "--depths", "10,20")
    assert force == pytest.approx([500.0, 1000.0])
    psi = layers("--values", "100 200", "--unit", "psi", "--depths", "100mm 0.2m")
    assert psi == pytest.approx([689.4757, 1378.9514])
    gap = layers("--kpa", "500,-,900", "--depths", "10,15,20")
    assert gap[0] == pytest.approx(500.0)
    assert state_of(survey).readings[-1].reading.top_m == (0.0, 0.15)
    noted = cli(
        "add", survey, "--at", "30,20", "--kpa", 500, "--depths", 10, "--note", "wheel track"
    )
    assert "wheel track" in noted.out


def test_amending_keeps_what_is_not_given(cli: Cli, survey: Path) -> None:
    hand = Hand(cli, survey)
    report = hand.add((700, 900), at=(20.0, 20.0))
    moved = cli("amend", survey, report, "--at", "22,21", "--reason", "misread", "--json").json
    assert (moved["easting_m"], moved["northing_m"], moved["kpa"]) == (22.0, 21.0, [700.0, 900.0])
    cli("amend", survey, report[:8], "--kpa", 800, "--depths", 10, "--reason", "misread")
    (reading,) = state_of(survey).readings
    assert (reading.at, reading.reading.kpa) == ((22.0, 21.0), (800.0,))


WRONG: dict[str, tuple[tuple[object, ...], str, str]] = {
    "depths do not pair": (("add", "--kpa", "5,9,14", "--depths", "10,20"), "do not pair", "-"),
    "no unit": (("add", "--values", "500,900", "--depths", "10,20"), "have no unit", "kpa mpa psi"),
    "force without a cone": (
        ("add", "--values", "65,130", "--unit", "N", "--depths", "10,20"), "no cone area", "130"
    ),
    "two units": (("add", "--kpa", "65", "--unit", "psi", "--depths", "10"), "you say psi", "out"),
    "no values": (("add", "--depths", "10"), "there are none", "--kpa"),
    "no depths": (("add", "--kpa", "500"), "there are none", "--depths"),
    "no number": (("add", "--kpa", "5oo", "--depths", "10"), "not a number", "decimal points"),
    "no depth": (("add", "--kpa", "500", "--depths", "10ells"), "no depth", "cm"),
    "depths that rise": (("add", "--kpa", "5,6", "--depths", "20,10"), "do not increase", "first"),
    "too hard": (("add", "--kpa", "5e8", "--depths", "10", "--at", "30,20"), "load cell", "unit"),
    "nothing read": (("add", "--kpa", "-,-", "--depths", "10,20"), "no depth was read", "stone"),
    "no stop": (("add", "--kpa", "500", "--depths", "10"), "no stop is handed out", "next"),
    "a place outside": (
        ("add", "--kpa", "500", "--depths", "10", "--at", "30,60"), "20 m outside", "correct"
    ),
    "no place": (("add", "--kpa", "5", "--depths", "10", "--at", "here"), "two numbers", "easting"),
    "a place that is infinite": (
        ("add", "--kpa", "500", "--depths", "10", "--at", "inf,0"), "nowhere near", "easting"
    ),
    "no report": (
        ("amend", "nobody", "--kpa", "5", "--depths", "10", "--reason", "x"), "no reading", "id"
    ),
    "no report to withdraw": (("withdraw", "nobody", "--reason", "x"), "no reading", "id"),
    "no stone": (("stone",), "no stop is handed out", "next"),
    "no depth of a stone": (("stone", "--depth", "deep"), "no depth", "cm"),
    "nothing to skip": (("skip", "--reason", "wet"), "no stop is handed out", "next"),
    "no such strategy": (("next", "--strategy", "dowsing"), "dowsing", "area-split"),
    "too fast": (("next", "--speed", "0"), "greater than zero", ""),
    "far away": (("next", "--start", "9e6,9e6"), "nowhere near", "easting"),
    "no such format": (("next", "--write", "stops.doc"), "nothing here writes", ".gpx"),
    "a receiver in a local frame": (("next", "--write", "stops.gpx"), "local frame", ".csv"),
    "an agent without a name": (("next", "--agent", ""), "is empty", "letters"),
    "no such file": (("ingest", "gone.csv"), "", ""),
}  # fmt: skip


@pytest.mark.parametrize("case", WRONG)
def test_what_cannot_be_is_refused_in_one_line_and_nothing_is_written(
    cli: Cli, survey: Path, case: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    before = read_survey(survey).fingerprint
    (verb, *words), what, remedy = WRONG[case]
    outcome = cli(verb, survey, *words)
    assert outcome.code == 2, outcome.out
    assert outcome.out == ""
    assert outcome.err.startswith("error: ")
    assert outcome.err.count("\n") == 1
    assert what in outcome.err
    assert "remedy: " in outcome.err or not remedy
    assert remedy in outcome.err
    assert read_survey(survey).fingerprint == before


def test_swapped_latitude_and_longitude_are_named(cli: Cli, on_earth: Path) -> None:
    outcome = cli("add", on_earth, "--kpa", 5, "--depths", 10, "--at", "0.0003,52.0002")
    assert outcome.code == 2
    assert "look swapped" in outcome.err


def test_hands_and_simulated_robots_do_not_work_on_one_survey(
    cli: Cli, survey: Path, outline: Path, readings: Path, tmp_path: Path
) -> None:
    simulated = begun(cli, outline, tmp_path / "sim.gpkg")
    assert cli("run", simulated, "--samples", 3).code == 0
    report = state_of(simulated).readings[0].id
    before = read_survey(simulated).fingerprint
    value = ("--kpa", "500", "--depths", "10")
    for words in (
        ("next", simulated, "--samples", 9), ("add", simulated, *value, "--at", "30,20"),
        ("ingest", simulated, readings), ("ingest", simulated, readings, "--preview"),
        ("amend", simulated, report, *value, "--reason", "x"),
    ):  # fmt: skip
        outcome = cli(*words)
        assert outcome.code == 2, words
        assert "simulated" in outcome.err
    assert read_survey(simulated).fingerprint == before
    assert cli("next", survey).code == 0
    before = read_survey(survey).fingerprint
    for verb in ("run", "resume"):
        outcome = cli(verb, survey)
        assert outcome.code == 3
        assert "real land" in outcome.err
    outcome = cli("ingest", survey, simulated)
    assert outcome.code == 2
    assert "survey of its own" in outcome.err
    assert read_survey(survey).fingerprint == before


def test_status_says_who_took_what_and_speaks_of_no_robot(
    cli: Cli, survey: Path, tmp_path: Path
) -> None:
    surveyed_over_two_days(cli, survey, tmp_path)
    cli("next", survey, "--samples", 14, "--agent", "anna")
    said = cli("status", survey).out
    assert "hand (person), 12 samples, 3 of them from batch.csv" in said
    assert "anna (person), on the way to stop" in said
    assert "robot" not in said
    last = cli("status", survey, "--json").json["last_reading"]
    assert state_of(survey).readings[-1].id.startswith(last[:8])


def test_a_survey_is_mapped_in_its_own_field(cli: Cli, survey: Path, tmp_path: Path) -> None:
    surveyed_over_two_days(cli, survey, tmp_path)
    told = cli("map", survey, "--out", tmp_path / "maps", "--json").json
    assert told["area_ha"] == pytest.approx(0.24)
    assert told["samples"] == 12
    assert (tmp_path / "maps" / "mean_kpa.tif").exists()


def test_a_map_of_a_table_needs_an_outline(cli: Cli, readings: Path, tmp_path: Path) -> None:
    outcome = cli("map", readings, "--out", tmp_path / "maps")
    assert outcome.code == 2
    assert "--boundary" in outcome.err


def test_a_value_that_looks_mistyped_is_taken_and_doubted(cli: Cli, survey: Path) -> None:
    place = ("--at", "30,20", "--depths", "10,20", "--json")
    told = cli("add", survey, "--kpa", "640,11500", *place).json
    (finding,) = told["findings"]
    assert finding["severity"] == "doubt"
    assert "11500 kPa at 0.2 m" in finding["seen"]
    assert "subsoil amend" in told["notes"][0]
    assert cli("add", survey, "--kpa", "640,1150", *place).json["findings"] == []
    megapascals = cli("add", survey, "--kpa", "0.64,1.15", *place).json
    assert "check the unit" in megapascals["notes"][0]


def test_where_every_stop_is_left_out_there_is_nothing_left_to_do(cli: Cli, tmp_path: Path) -> None:
    outline = tmp_path / "small.csv"
    outline.write_text("easting,northing\n0,0\n10,0\n10,10\n0,10\n")
    path = tmp_path / "small.gpkg"
    assert cli("init", path, "--boundary", outline, "--strategy", "greedy").code == 0
    while cli("next", path, "--json").json["finished"] == "no":
        assert cli("skip", path, "--reason", "wet").code == 0
    assert len(state_of(path).refused) == 4
    assert cli("next", path).out.startswith("There is nothing left to do: ")
    told = cli("next", path, "--write", tmp_path / "none.csv")
    assert told.code == 0
    assert not (tmp_path / "none.csv").exists()
    assert cli("verify", path).code == 0


def test_a_reading_within_the_fence_counts_where_it_is_and_is_flagged(
    cli: Cli, survey: Path
) -> None:
    told = cli("add", survey, "--kpa", "700,900", "--depths", "10,20", "--at", "63,20", "--json")
    assert told.json["flags"] == ["outside-the-field"]
    assert state_of(survey).soil_map.at.tolist() == [[63.0, 20.0]]


def test_the_next_stop_and_those_after_it_are_written_for_a_receiver(
    cli: Cli, on_earth: Path, tmp_path: Path
) -> None:
    told = cli("next", on_earth, "--write", tmp_path / "way.csv", "--json").json
    rows = (tmp_path / "way.csv").read_text().splitlines()
    stop = told["stop"]
    assert rows[1] == f"1,{stop['latitude']:.7f},{stop['longitude']:.7f}"
    plan = cli("plan", on_earth, "--write", tmp_path / "plan.csv", "--json").json["plan"]
    assert (tmp_path / "plan.csv").read_text().splitlines() == rows
    assert len(rows) == 1 + len(plan) == 13
