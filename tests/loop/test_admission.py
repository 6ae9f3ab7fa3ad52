"""Every number of a report is looked at where it enters; what cannot be true is refused."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta
from math import dist, inf, nan
from typing import Any

import numpy as np
import pytest

from subsoil.agent import Arrival, Assignment, Push, Refusal, drive
from subsoil.errors import ReportError
from subsoil.land.field import Field
from subsoil.layers import Layers
from subsoil.penetrometer import SMALL_CONE
from subsoil.reports import LONLAT, Quantity, Reading, Refused, Sampled, Source, Tip
from subsoil.survey import LocalDispatch, Memory, Settings, fold, opened, opening
from subsoil.survey.events import Configured, from_json, to_json

EARTH = Field.from_metres(
    [(675_000, 5_904_000), (675_060, 5_904_000), (675_060, 5_904_040), (675_000, 5_904_040)],
    crs="EPSG:32630",
)
CENTRE = (675_030.0, 5_904_020.0)
NOW = datetime(2026, 5, 1, 12, tzinfo=UTC)
GOOD = Reading(depth_m=(0.1, 0.2, 0.3, 0.4), force_n=(100.0, 200.0, 300.0, 250.0))


def begun(memory: Memory | None = None, field: Field = EARTH, samples: int = 5) -> LocalDispatch:
    dispatch = LocalDispatch(
        opened(opening(field, Layers((0.0, 0.2, 0.4)), SMALL_CONE)),
        memory or Memory(),
        now=lambda: NOW,
    )
    settings = Settings(start=field.entrance, strategy="area-split", samples=samples)
    dispatch.record(Configured(settings=settings))
    dispatch.join("anna", "person")
    return dispatch


def report(**changes: Any) -> Sampled:
    said: dict[str, Any] = {
        "agent": "anna", "source": Source(kind="person"), "at": CENTRE, "metres": 5.0,
        "seconds": 60.0, "reading": GOOD, **changes,
    }  # fmt: skip
    return Sampled(**said)


def reading(**changes: Any) -> dict[str, Reading]:
    return {"reading": GOOD.model_copy(update=changes)}


def moisture(**changes: Any) -> Quantity:
    said = {"name": "moisture", "unit": "%", "depth_m": (0.1, 0.3), "values": (21.0, 18.0)}
    return Quantity.model_validate({**said, **changes})


CANNOT_BE: list[tuple[dict[str, Any], str]] = [
    ({"at": (nan, 5_904_020.0)}, r"place \(nan, .*\) is not finite"),
    ({"at": (675_030.0, inf)}, "is not finite"),
    ({"at": (200.0, 53.0), "frame": LONLAT}, "longitude 200, latitude 53 is no place"),
    ({"at": (-0.3, 95.0), "frame": LONLAT}, "is no place"),
    ({"at": (200.0, 53.0), "frame": "WGS84"}, "longitude 200, latitude 53 is no place"),
    ({"at": (1e300, 1e300)}, r"place \(1e\+300, 1e\+300\) is not on Earth"),
    ({"frame": "EPSG:999999"}, "no CRS"),
    ({"frame": "http://example.org/crs"}, "no CRS"),
    ({"metres": -1.0}, "a way of -1 m cannot be"),
    ({"metres": nan}, "a way of nan m cannot be"),
    ({"metres": 1e300}, "a way of 1e"),
    ({"seconds": -500.0}, "a time of -500 s cannot be"),
    ({"seconds": inf}, "a time of inf s cannot be"),
    ({"seconds": 1e9}, "a time of 1e"),
    ({"tries": -1}, "a number of tries of -1 cannot be"),
    ({"tries": 10**400}, "a number of tries of inf cannot be"),
    ({"accuracy_m": -2.0}, "an accuracy of -2 m cannot be"),
    ({"accuracy_m": 1e300}, "an accuracy of 1e"),
    ({"accuracy_m": nan}, "accuracy of nan"),
    (reading(force_n=(1.0, 1e300, 3.0, 4.0)), r"force is 1e\+300 N at 0.200 m"),
    (reading(force_n=(1.0, nan, 3.0, 4.0)), "force is nan N at 0.200 m"),
    (reading(force_n=(1.0, -60.0, 3.0, 4.0)), "force is -60 N at 0.200 m"),
    (reading(force_n=(1.0, 2.0)), "4 depths do not pair with 2 readings"),
    (reading(kpa=(1.0, 2.0, 3.0, 4.0)), "it gives both"),
    (reading(depth_m=(10.0, 20.0, 30.0, 40.0)), "they are in m, positive down"),
    (reading(depth_m=(0.1, nan, 0.3, 0.4)), "they are in m, positive down"),
    (reading(depth_m=(-0.1, -0.2, -0.3, -0.4)), "they are in m, positive down"),
    (reading(tip=Tip(area_mm2=nan)), "a cone of nan mm2 is none"),
    (reading(tip=Tip(area_mm2=1e300)), r"a cone of 1e\+300 mm2 is none: they have 10 to 10000"),
    (reading(tip=Tip(area_mm2=130.0, angle_deg=-30.0)), "an apex angle of -30 degrees"),
    (reading(further=(moisture(values=(21.0, nan)),)), "moisture are not all finite"),
    (reading(further=(moisture(depth_m=(0.1, inf)),)), "moisture are not all finite"),
    (reading(further=(moisture(values=(21.0,)),)), "1 values of moisture do not pair with 2"),
    (reading(further=(moisture(name=""),)), "name '' of a quantity beside resistance is empty"),
    (reading(further=(moisture(name="a\x1b[31m"),)), "signs that cannot be printed"),
    ({"id": ""}, "it has no id"),
    ({"id": "a\x1b[31m"}, r"its id 'a\\x1b\[31m' has signs that cannot be printed"),
    ({"id": "a\nb"}, "its id .* has signs that cannot be printed"),
    ({"id": "a "}, "blanks that cannot be seen"),
    ({"id": "a" * 5000}, r"its id 'a{40}\.\.\.' has 5000 letters, more than 100"),
    ({"assignment": "a\x00b"}, "its assignment .* has signs that cannot be printed"),
    ({"agent": "b" * 5000}, r"agent 'b{40}\.\.\.' never joined the survey"),
    ({"frame": "x" * 5000}, r"there is no CRS 'x{40}\.\.\.' "),
    ({"agent": "bert"}, "agent 'bert' never joined the survey"),
    ({"source": Source(kind="simulator")}, "simulated and real readings do not go into one"),
]


@pytest.mark.parametrize(("changes", "words"), CANNOT_BE)
def test_a_report_that_cannot_be_true_is_refused_with_the_reason_and_leaves_nothing(
    changes: dict[str, Any], words: str
) -> None:
    memory = Memory()
    dispatch = begun(memory)
    before, events = dispatch.survey, len(memory.events)
    with pytest.raises(ReportError, match=words):
        dispatch.report(report(**changes))
    assert dispatch.survey is before
    assert len(memory.events) == events


class Odd:
    """A robot with something wrong about every other report."""

    def __init__(self, changes: dict[str, Any]) -> None:
        self.changes, self.at, self.pushes = changes, (0.0, 0.0), 0

    def go_to(self, stop: Assignment) -> Arrival:
        metres, self.at = dist(self.at, stop.at), stop.at
        wrong = self.changes if self.pushes % 2 else {}
        return Arrival(
            stop.at, wrong.get("metres", metres), wrong.get("seconds", metres),
            accuracy_m=wrong.get("accuracy_m"),
        )  # fmt: skip

    def probe(self) -> Push | Refusal:
        self.pushes += 1
        wrong = {} if self.pushes % 2 else self.changes
        return Push(
            wrong.get("at", self.at), wrong.get("reading", GOOD), 50.0, wrong.get("tries", 1)
        )

    def stop(self) -> None:
        pass


@pytest.mark.parametrize(
    "changes",
    [
        *(
            c
            for c, _ in CANNOT_BE
            if not {"agent", "source", "frame", "id", "assignment"} & c.keys()
        ),
        {"at": ("here", "there")},
        {"reading": "a reading"},
    ],
)
def test_a_survey_goes_on_to_its_end_with_a_robot_that_says_what_cannot_be(
    changes: dict[str, Any],
) -> None:
    dispatch = begun()
    dispatch.leave("anna")
    dispatch.join("odd")
    assert drive("odd", Odd(changes), dispatch) == "5 samples taken"
    refusals = [stop.refusal for stop in dispatch.survey.stops if stop.refusal]
    assert refusals
    assert all(refusal.cause == "report" for refusal in refusals)
    assert np.isfinite(dispatch.survey.soil_map.mean).all()
    assert np.isfinite(dispatch.survey.metres)


def test_a_place_in_longitude_and_latitude_comes_into_the_fields_frame() -> None:
    dispatch = begun()
    (lonlat,) = EARTH.to_lonlat(CENTRE).tolist()
    dispatch.report(report(at=tuple(lonlat), frame=LONLAT, accuracy_m=0.5))
    (kept,) = dispatch.survey.readings
    assert kept.at == pytest.approx(CENTRE, abs=1e-4)
    assert (kept.frame, kept.accuracy_m) == ("", 0.5)


def test_an_assignment_says_where_it_is_on_earth_too() -> None:
    stop = begun().assign("anna")
    assert isinstance(stop, Assignment)
    assert stop.frame == "EPSG:32630"
    assert stop.lonlat is not None
    (back,) = EARTH.to_metres([stop.lonlat[0]], [stop.lonlat[1]]).tolist()
    assert back == pytest.approx(stop.at, abs=1e-4)


def test_a_local_field_has_no_place_on_earth() -> None:
    local = Field.from_metres([(0, 0), (60, 0), (60, 40), (0, 40)])
    dispatch = begun(field=local)
    stop = dispatch.assign("anna")
    assert isinstance(stop, Assignment)
    assert stop.lonlat is None
    with pytest.raises(ReportError, match="nothing leads from"):
        dispatch.report(report(at=(-0.3, 53.2), frame=LONLAT))


def test_a_bouncing_rod_and_a_force_below_zero_are_kept_flagged_and_mapped() -> None:
    dispatch = begun()
    odd = Reading(depth_m=(0.1, 0.2, 0.15, 0.3, 0.4), force_n=(-2.0, 200.0, 0.0, 300.0, 250.0))
    dispatch.report(report(reading=odd))
    (kept,) = dispatch.survey.readings
    assert kept.reading.force_n == odd.force_n
    assert kept.reading.flags == ("bounced", "below-zero")
    (sample,) = dispatch.survey.soil_map.samples
    assert np.isfinite(sample.kpa).all()


def test_a_reading_of_pressure_and_what_else_was_measured_are_kept() -> None:
    dispatch = begun()
    further = (moisture(), moisture(name="temperature", unit="C", depth_m=(), values=(9.5,)))
    dispatch.report(
        report(reading=Reading(depth_m=(0.2, 0.4), kpa=(900.0, 1500.0), further=further))
    )
    (kept,) = dispatch.survey.readings
    back = from_json(to_json(kept))
    assert isinstance(back, Sampled)
    assert back.reading.further == further
    assert dispatch.survey.soil_map.samples[0].kpa.tolist() == [900.0, 1500.0]


@pytest.mark.parametrize("off", [timedelta(days=365), timedelta(days=-20 * 365)])
def test_a_clock_that_is_years_off_is_flagged_and_orders_nothing(off: timedelta) -> None:
    dispatch = begun()
    dispatch.report(report(time=NOW + off, clock="agent"))
    dispatch.report(report(at=(675_010.0, 5_904_010.0)))
    first, second = dispatch.survey.readings
    assert first.reading.flags == ("clock-off",)
    assert (second.time, second.clock, second.reading.flags) == (NOW, "host", ())


def test_a_reading_of_last_season_has_the_time_it_was_taken() -> None:
    dispatch = begun()
    taken = NOW - timedelta(days=300)
    source = Source(kind="file", file="a.csv", row=7)
    dispatch.report(report(time=taken, clock="file", source=source))
    (kept,) = dispatch.survey.readings
    assert (kept.time, kept.clock, kept.reading.flags) == (taken, "file", ())
    assert (kept.source.file, kept.source.row) == ("a.csv", 7)


def test_a_report_that_comes_twice_counts_once_whatever_it_says_then() -> None:
    memory = Memory()
    dispatch = begun(memory)
    once = report()
    dispatch.report(once)
    survey, events = dispatch.survey, len(memory.events)
    dispatch.report(once)
    dispatch.report(once.model_copy(update={"metres": 7.0}))
    assert dispatch.survey is survey
    assert len(memory.events) == events


def test_simulated_and_real_agents_do_not_work_on_one_survey() -> None:
    dispatch = begun()
    with pytest.raises(ReportError, match="simulated and real agents"):
        dispatch.join("robot", "simulator")
    with pytest.raises(ReportError, match="another kind of agent"):
        dispatch.join("anna", "robot")
    assert [agent.name for agent in dispatch.survey.agents] == ["anna"]
    assert not dispatch.survey.simulated


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("", "the name '' of an agent is empty"),
        (" ", "blanks that cannot be seen"),
        ("anna ", "blanks that cannot be seen"),
        ("an  na", "blanks that cannot be seen"),
        ("an\nna", r"the name 'an\\nna' of an agent has signs that cannot be printed"),
        ("an\x1b[31mna", "signs that cannot be printed"),
        ("an\u202ena", "signs that cannot be printed"),
        ("an\x00na", "signs that cannot be printed"),
        ("a" * 5000, r"'a{40}\.\.\.' of an agent has 5000 letters, more than 100"),
    ],
)
def test_an_agent_joins_under_a_name_that_can_be_read_and_told_from_others(
    name: str, words: str
) -> None:
    memory = Memory()
    dispatch = begun(memory)
    events = len(memory.events)
    with pytest.raises(ReportError, match=rf"{words}.*letters, digits, signs and single blanks"):
        dispatch.join(name, "person")
    assert len(memory.events) == events


@pytest.mark.parametrize("name", ["Änne Müller", "机器人 2", "robot-1 (north)", "a" * 100])
def test_names_of_all_languages_are_names(name: str) -> None:
    dispatch = begun()
    dispatch.join(name, "person")
    dispatch.report(report(agent=name))
    assert dispatch.survey.readings[0].agent == name


def test_the_reason_of_a_refusal_is_kept_on_one_line_without_what_a_terminal_obeys() -> None:
    dispatch = begun()
    stop = dispatch.assign("anna")
    assert isinstance(stop, Assignment)
    dispatch.report(
        Refused(
            agent="anna", assignment=stop.id, source=Source(kind="person"), at=CENTRE,
            reason="a\x1b[2J stone,\n  two\u202e",
        )
    )  # fmt: skip
    (refusal,) = [each.refusal for each in dispatch.survey.stops if each.refusal]
    assert refusal.reason == "a?[2J stone, two?"


def test_flags_of_an_instrument_are_kept_so_too() -> None:
    dispatch = begun()
    dispatch.report(report(**reading(flags=("wet\x07", "slow"))))
    assert dispatch.survey.readings[0].reading.flags == ("wet?", "slow")


def test_who_never_joined_or_left_is_told_so() -> None:
    dispatch = begun()
    dispatch.leave("anna")
    for name in ("anna", "bert"):
        with pytest.raises(ReportError, match="not at work on the survey"):
            dispatch.assign(name)


def test_only_who_holds_a_stop_gives_it_back_or_leaves_it_out() -> None:
    dispatch = begun()
    dispatch.join("bert", "person")
    stop = dispatch.assign("anna")
    assert isinstance(stop, Assignment)
    for control in (dispatch.release, dispatch.skip):
        with pytest.raises(ReportError, match="'bert' does not hold the assignment"):
            control("bert", stop.id, "too far")
    dispatch.release("anna", stop.id, "lunch")
    again = dispatch.assign("bert")
    assert isinstance(again, Assignment)
    assert again.cell == stop.cell
    dispatch.skip("bert", again.id, "a puddle")
    assert dispatch.survey.refused == (stop.cell,)
    (skipped,) = [each.refusal for each in dispatch.survey.stops if each.refusal]
    assert isinstance(skipped, Refused)
    assert (skipped.cause, skipped.reason, skipped.agent) == ("skipped", "a puddle", "bert")


def test_what_was_refused_is_not_in_the_file_and_what_was_kept_folds_back() -> None:
    memory = Memory()
    dispatch = begun(memory)
    dispatch.report(report())
    with pytest.raises(ReportError):
        dispatch.report(report(metres=nan))
    opened_ = opening(EARTH, Layers((0.0, 0.2, 0.4)), SMALL_CONE)
    again = fold([opened_, *memory.events])
    assert again.readings == dispatch.survey.readings
