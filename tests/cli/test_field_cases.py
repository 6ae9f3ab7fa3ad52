"""Files as they come from the field, each with the right answer written beside it by hand.

Case by case the answers of the READMEs in the folder that ``SUBSOIL_CASES`` names: what must come
out, which words must be said, and whether something was left out.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

FOLDER = os.environ.get("SUBSOIL_CASES")
pytestmark = pytest.mark.skipif(not FOLDER, reason="SUBSOIL_CASES names no folder of cases")

SOIL = (314, 829, 1278, 1585, 1793, 2036, 2256, 2445)
"""Layer means in kPa of the 40 readings that most cases are made from."""
MAP = ("map", "readings.csv", "--boundary", "field.geojson", "--out", "out")
CV = ("cv", "readings.csv")
INIT = ("init", "survey.gpkg", "--boundary", "field.geojson")


@dataclass(frozen=True)
class Case:
    """A command in a case's folder, and what must come of it."""

    folder: str
    command: tuple[str, ...]
    code: int = 0
    samples: int = 40
    means: tuple[int, ...] = SOIL
    counts: tuple[int, ...] = (40,) * 8
    area_ha: float = 3.08
    says: str = ""
    """Words among the findings; none may be needed."""

    def check(self, found: dict[str, Any]) -> None:
        """Compare with what the command line said."""
        if self.command[0] in ("map", "init"):
            assert found["area_ha"] == pytest.approx(self.area_ha, abs=0.005)
        if self.command[0] in ("map", "cv"):
            assert found["samples"] == self.samples
            means = [layer["mean_kpa"] for layer in found["layers"]]
            assert means == pytest.approx(self.means, abs=0.6)
            assert tuple(layer["samples"] for layer in found["layers"]) == self.counts
        said = " | ".join(
            f"{f['file']} {f['row']} {f['seen']} {f['done']}" for f in found["findings"]
        )
        assert self.says in said


REACHED = (40,) * 5 + (30,) * 3
WHERE_NA = (314, 829, 1278, 1585, 1793, 2047, 2282, 2481)
CASES = [
    Case("01-web-mercator-boundary", MAP, says="EPSG:3857"),
    Case("02-inch-depths", CV, means=(151, 451, 751, 1051, 1351, 1651, 1951, 2251)),
    Case("03-na-below-refusal", CV, means=WHERE_NA, counts=REACHED),
    Case("06-mpa-named-kpa", MAP, means=(0, 1, 1, 2, 2, 2, 2, 2), says="MPa would be"),
    Case(
        "07-stray-fix-no-boundary", CV, code=1, samples=39, counts=(39,) * 8,
        means=(315, 837, 1286, 1590, 1795, 2040, 2260, 2455), says="readings.csv 9 ",
    ),
    Case("08-frozen-gps", MAP, says="16 pushes"),
    Case("09-moisture-column", MAP, says="vwc_10cm"),
    Case("10-lat-long", MAP),
    Case("10b-depth-then-unit", MAP),
    Case("12-tidy-long-table", MAP),
    Case("13-points-gpkg", ("map", "readings.gpkg", *MAP[2:])),
    Case("14-degrees-minutes", MAP),
    Case("15-kml-bare-ring", (*INIT[:3], "field.kml")),
    Case("16-boundary-etrs89-degrees", (*INIT[:3], "field.gpkg"), says="ETRS89"),
    Case("17-polygon-and-pin-geojson", INIT, says="gate"),
    Case("18-two-parcels-two-features", INIT, area_ha=2.912),
    Case("19-excel-sep-line", MAP),
    Case("21-two-depths-eight-layers", MAP, means=(1278,) * 3 + (2445,) * 5, says="finer than"),
    Case("22-fence-line-readings", MAP, says="outside"),
    Case(
        "23-hard-spots-stop-the-push", MAP, counts=(40, 40, 40, 40, 40, 39, 36, 30),
        means=(314, 829, 1278, 1585, 1793, 2022, 2193, 2316), says="too soft",
    ),
    Case("30-pass-pond", INIT, area_ha=2.72),
    Case("31-pass-constant-layer", MAP, means=(35, *SOIL[1:])),
]  # fmt: skip


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[str], Path]:
    """Stand in a copy of a case's folder."""

    def stand(name: str) -> Path:
        folder = tmp_path / name
        shutil.copytree(Path(FOLDER or "") / name, folder)
        monkeypatch.chdir(folder)
        return folder

    return stand


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.folder)
def test_a_file_from_the_field_gives_what_is_right(
    case: Case, here: Callable[[str], Path], cli: Any
) -> None:
    here(case.folder)
    outcome = cli(*case.command, "--json")
    assert outcome.code == case.code, outcome.err
    case.check(outcome.json)


def test_every_case_of_the_folder_is_tried_here() -> None:
    beside = {"04-variogram-silent-about-rows", "05-thousands-dot", "11-sc900-export",
              "20-covariate-sentinel"}  # fmt: skip
    there = {path.name for path in Path(FOLDER or "").iterdir() if path.is_dir()}
    assert there == {case.folder for case in CASES} | beside


def test_a_layer_that_is_the_same_everywhere_has_no_skill(here: Any, cli: Any) -> None:
    here("31-pass-constant-layer")
    assert cli(*MAP, "--json").json["layers"][0]["loo_skill"] is None


def test_a_stray_fix_does_not_stretch_the_range_to_kilometres(here: Any, cli: Any) -> None:
    here("07-stray-fix-no-boundary")
    ranges = [layer["range_m"] for layer in cli(*CV, "--json").json["layers"]]
    assert all(90 < reach < 150 for reach in ranges)


def test_a_distorted_frame_does_not_stretch_the_range(here: Any, cli: Any) -> None:
    here("01-web-mercator-boundary")
    ranges = [layer["range_m"] for layer in cli(*MAP, "--json").json["layers"]]
    assert all(110 < reach < 140 for reach in ranges)


@pytest.mark.parametrize("verb", ["variogram", "cv"])
def test_rows_left_out_are_named_by_every_verb(verb: str, here: Any, cli: Any) -> None:
    here("04-variogram-silent-about-rows")
    outcome = cli(verb, "readings.csv", "--json")
    assert (outcome.code, outcome.json["samples"]) == (1, 37)
    left_out = [f for f in outcome.json["findings"] if f["severity"] == "left out"]
    assert [f["row"] for f in left_out] == [6, 13, 25]
    assert {f["column"] for f in left_out} == {"kpa_15cm"}
    assert "rows 6, 13, 25, column kpa_15cm" in cli(verb, "readings.csv").out


def test_thousands_marks_are_read_right_or_refused(here: Any, cli: Any) -> None:
    here("05-thousands-dot")
    outcome = cli(*MAP, "--json")
    if outcome.code == 2:
        assert "1.119" in outcome.err
    else:
        Case("05-thousands-dot", MAP).check(outcome.json)


def test_an_instrument_file_is_read_as_it_was_written(here: Any, cli: Any) -> None:
    file = here("11-sc900-export") / "readings.txt"
    pushes = [
        [float(kpa) for kpa in line.split(",")[3:-1]]
        for line in file.read_text().splitlines()
        if line[:1].isdigit()
    ]
    assert len(pushes) == 40
    outcome = cli("map", "readings.txt", *MAP[2:], "--json")
    assert outcome.code == 0, outcome.err
    found = outcome.json
    assert found["samples"] == 40
    assert [layer["samples"] for layer in found["layers"]] == [40] * 6 + [36] * 2
    # Readings every 2.5 cm: two in a layer of 5 cm, each for the soil since the one above.
    expected = [
        sum(p[2 * k + 1] + p[2 * k + 2] for p in pushes if len(p) > 2 * k + 2 and p[2 * k + 2] > 0)
        / (2 * layer["samples"])
        for k, layer in enumerate(found["layers"])
    ]
    assert [layer["mean_kpa"] for layer in found["layers"]] == pytest.approx(expected, abs=0.1)


def test_a_sentinel_in_a_covariate_is_named_and_not_followed(here: Any, cli: Any) -> None:
    here("20-covariate-sentinel")
    outcome = cli(*MAP, "--covariate", "ec.tif", "--drift", "always", "--json")
    assert outcome.code in (1, 2)
    assert "-9999" in outcome.out + outcome.err
    if outcome.code == 1:
        assert outcome.json["std_dev_kpa"] == pytest.approx(87, abs=8)
