"""Libraries that are not installed are said before the work starts, with what installs them."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

import subsoil

Without = Callable[..., subprocess.CompletedProcess[str]]
OUTLINE = "easting,northing\n0,0\n60,0\n60,40\n0,40\n"


@pytest.fixture
def without(tmp_path: Path) -> Without:
    """Run the command line in a folder, on a Python that lacks some libraries."""
    home = tmp_path / "libraries"
    home.mkdir()
    (tmp_path / "plot.csv").write_text(OUTLINE)

    def run(libraries: str, *words: str) -> subprocess.CompletedProcess[str]:
        hidden = tuple(libraries.split())
        for folder in [Path(each) for each in sys.path if each.endswith("site-packages")]:
            for entry in folder.iterdir():
                link = home / entry.name
                if not entry.name.lower().startswith(hidden) and not link.exists():
                    link.symlink_to(entry)
        path = os.pathsep.join([str(Path(subsoil.__file__).parents[1]), str(home)])
        return subprocess.run(
            [sys.executable, "-S", "-m", "subsoil", *words],
            cwd=tmp_path, capture_output=True, text=True, check=False,
            env={**os.environ, "PYTHONPATH": path},
        )  # fmt: skip

    return run


def test_the_demonstration_names_all_that_it_lacks_before_it_surveys(
    without: Without, tmp_path: Path
) -> None:
    done = without("rasterio matplotlib jinja2", "demo")
    assert done.returncode == 2
    assert done.stderr == (
        "error: a GeoTIFF needs rasterio, drawing figures needs matplotlib, a report needs jinja2, "
        "which are not installed (remedy: pip install 'subsoil[geo,plot]')\n"
    )
    assert not (tmp_path / "demo").exists()


@pytest.mark.parametrize(("library", "extra"), [("matplotlib", "plot"), ("rasterio", "geo")])
def test_a_map_writes_nothing_where_a_library_is_missing(
    without: Without, tmp_path: Path, readings: Path, library: str, extra: str
) -> None:
    call = ("map", str(readings), "--boundary", "plot.csv", "--out", "m")
    done = without(library, *call)
    assert done.returncode == 2
    assert f"needs {library}, which is not installed" in done.stderr
    assert f"pip install 'subsoil[{extra}]'" in done.stderr
    assert not (tmp_path / "m").exists()


def test_a_report_of_a_benchmark_and_a_picture_of_the_outlook_ask_for_matplotlib_first(
    without: Without,
) -> None:
    for call in (("bench", "report", "compare"), ("status", "s.gpkg", "--out", "pictures")):
        done = without("matplotlib", *call)
        assert done.returncode == 2
        assert "drawing figures needs matplotlib" in done.stderr


def test_a_file_of_a_library_that_is_missing_may_come_in_another_format(
    without: Without, tmp_path: Path
) -> None:
    (tmp_path / "f.shp").write_bytes(b"x")
    done = without("pyogrio", "init", "s.gpkg", "--boundary", "f.shp")
    assert "pip install 'subsoil[geo]', or save it as GeoJSON" in done.stderr


def test_doctor_says_what_installs_a_missing_extra_and_is_content(without: Without) -> None:
    done = without("rasterio", "doctor")
    assert done.returncode == 0
    assert "rasterio\tnot installed\tpip install 'subsoil[geo]'\n" in done.stdout
    found = json.loads(without("rasterio", "doctor", "--json").stdout)
    assert found["remedies"] == {"rasterio": "pip install 'subsoil[geo]'"}
    assert found["missing"] == []


def test_doctor_is_not_content_where_something_needed_is_missing(without: Without) -> None:
    done = without("pyyaml", "doctor", "--json")
    assert done.returncode == 1
    found = json.loads(done.stdout)
    assert found["missing"] == ["pyyaml"]
    assert found["remedies"]["pyyaml"] == "pip install pyyaml"
    assert without("pyyaml", "doctor").returncode == 1


def test_doctor_shows_the_extra_in_its_brackets_on_a_terminal(
    without: Without, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("COLUMNS", "80")
    assert "pip install 'subsoil[geo]'" in without("rasterio", "doctor").stdout


def test_a_folder_used_before_says_how_to_replace_what_is_there_and_keeps_it_till_then(
    tmp_path: Path, without: Without
) -> None:
    (tmp_path / "demo").mkdir()
    before = tmp_path / "demo" / "survey.gpkg"
    before.write_text("mine")
    done = without("none", "demo")
    assert done.returncode == 3
    assert "earlier demonstration (remedy: give --overwrite" in done.stderr
    assert without("none", "demo", "--overwrite", "--samples", "90000").returncode == 2
    assert before.read_text() == "mine"
