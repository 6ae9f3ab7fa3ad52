"""Figures are files that print well and are the same each time."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import get_args
from xml.etree import ElementTree

import pytest

import subsoil as ss
from subsoil.plots.saving import Format
from subsoil.survey import Survey
from subsoil.variogram import Fit

FORMATS: tuple[Format, ...] = get_args(Format)


@pytest.mark.parametrize("form", FORMATS)
def test_the_same_survey_gives_the_same_bytes(
    survey: Survey, fits: tuple[Fit, ...], tmp_path: Path, form: Format
) -> None:
    files = []
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        paths = ss.plots.save_all(ss.plots.draw_survey(survey, (), fits), tmp_path / name, form)
        assert [path.name for path in paths] == [
            f"{each}.{form}" for each in ("depth_slices", "std_dev", "variograms", "profiles")
        ]
        files.append([path.read_bytes() for path in paths])
    assert files[0] == files[1]


def test_text_of_an_svg_stays_text_and_names_no_date(survey: Survey, tmp_path: Path) -> None:
    path = ss.plots.save(ss.plots.depth_slices(survey), tmp_path / "a.svg")
    root = ElementTree.parse(path).getroot()
    assert root.tag == "{http://www.w3.org/2000/svg}svg"
    words = {"".join(each.itertext()).strip() for each in root.iter(f"{root.tag[:-3]}text")}
    assert {*survey.layers.names, "kriged mean (kPa)"} <= words
    assert "dc:date" not in path.read_text(encoding="utf-8")


def test_a_pdf_holds_its_fonts_and_no_date(survey: Survey, tmp_path: Path) -> None:
    content = ss.plots.save(ss.plots.profiles(survey), tmp_path / "a.pdf").read_bytes()
    assert content.startswith(b"%PDF-")
    assert content.rstrip().endswith(b"%%EOF")
    assert b"/FontFile2" in content
    assert b"CreationDate" not in content


def test_saving_leaves_the_settings_of_matplotlib_as_they_were(
    survey: Survey, tmp_path: Path
) -> None:
    import matplotlib

    before = dict(matplotlib.rcParams)
    ss.plots.save(ss.plots.profiles(survey), tmp_path / "a.svg")
    assert dict(matplotlib.rcParams) == before


def test_the_pictures_are_there_without_a_further_import_and_load_no_pyplot() -> None:
    code = (
        "import sys, subsoil as ss; assert 'subsoil.plots' not in sys.modules; "
        "field = ss.Field.from_metres([(0, 0), (60, 0), (60, 40), (0, 40)]); "
        "run = ss.simulate(field, 'area-split', samples=4); "
        "assert 'matplotlib' not in sys.modules; "
        "ss.plots.depth_slices(run.soil_map); ss.plots.route(run); "
        "assert 'matplotlib' in sys.modules; print('matplotlib.pyplot' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"
