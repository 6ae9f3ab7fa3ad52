"""The Riseholme survey: what is in it, and what happens where it is not at hand."""

from __future__ import annotations

import os
import shutil
import sys
from collections.abc import Iterator
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread

import numpy as np
import pytest
import shapely

from subsoil.datasets import RiseholmeSurvey, half_field, riseholme
from subsoil.errors import DataUnavailableError, MissingExtraError
from subsoil.findings import left_out
from subsoil.io.read.readings import read_readings
from subsoil.layers import Layers
from subsoil.penetrometer import Profile

DATA = os.environ.get("SUBSOIL_DATA", "")
needs_data = pytest.mark.skipif(
    not DATA, reason="SUBSOIL_DATA does not name a folder with the real data"
)
NINE_LAYERS = Layers(tuple(round(0.05 * k, 2) for k in range(10)))
NOWHERE = "http://127.0.0.1:9"


@pytest.fixture(scope="module")
def survey() -> RiseholmeSurvey:
    return riseholme()


@pytest.fixture
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """No data folder, and an empty cache."""
    monkeypatch.delenv("SUBSOIL_DATA", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return tmp_path


# What is in it


@needs_data
def test_the_whole_field_has_7_ha_and_2809_cells_of_5_m(survey: RiseholmeSurvey) -> None:
    assert survey.field.area_ha == pytest.approx(7.01, abs=0.01)
    assert len(survey.field.cells) == 2809
    assert survey.field.crs == "EPSG:32630"


@needs_data
def test_177_pushes_at_18_depths_all_in_the_field(survey: RiseholmeSurvey) -> None:
    assert len(survey.readings) == 177
    assert left_out(survey.readings.findings) == ()
    assert survey.field.contains(survey.readings.at).all()
    longest = max(survey.readings.profiles, key=lambda profile: profile.depth_m.size)
    np.testing.assert_allclose(longest.depth_m, np.arange(1, 19) * 0.025)


@needs_data
def test_5_pushes_end_early_and_43_exceed_3_mpa(survey: RiseholmeSurvey) -> None:
    profiles = survey.readings.profiles
    assert sum(profile.depth_m.size < 18 for profile in profiles) == 5
    assert sum(profile.kpa.max() > 3000 for profile in profiles) == 43
    assert max(profile.kpa.max() for profile in profiles) == pytest.approx(5876.3, abs=0.1)


@needs_data
def test_65_pushes_lie_in_the_half_field(survey: RiseholmeSurvey) -> None:
    assert survey.half_field.contains(survey.readings.at).sum() == 65


@needs_data
def test_means_of_the_nine_layers_are_those_of_the_soil(survey: RiseholmeSurvey) -> None:
    means = survey.readings.layer_means(NINE_LAYERS)
    assert means.shape == (9, 177)
    assert np.isnan(means).sum(axis=1).tolist() == [0, 0, 0, 0, 0, 0, 0, 3, 5]
    np.testing.assert_allclose(
        np.nanmean(means, axis=1),
        [65, 838, 1404, 1614, 1651, 1682, 1730, 1852, 2076],
        atol=0.5,
    )


@needs_data
def test_layers_reached_in_part_add_to_the_deepest_means_as_lower_bounds(
    survey: RiseholmeSurvey,
) -> None:
    pushes = (Profile(p.depth_m, p.kpa, "force") for p in survey.readings.profiles)
    kpa = np.array([NINE_LAYERS.sample(push, (0.0, 0.0)).kpa for push in pushes])
    np.testing.assert_allclose(np.nanmean(kpa, axis=0)[-2:], [1861, 2089], atol=0.5)


@needs_data
def test_the_table_derived_from_the_robots_file_says_the_same(survey: RiseholmeSurvey) -> None:
    path = Path(DATA) / "riseholme" / "riseholme_cosmos_177.csv"
    if not path.exists():
        pytest.skip("the derived table is not in SUBSOIL_DATA")
    table = read_readings(path, field=survey.field)
    np.testing.assert_allclose(table.at, survey.readings.at, atol=1e-6)
    for one, other in zip(table.profiles, survey.readings.profiles, strict=True):
        np.testing.assert_allclose(one.kpa, other.kpa, atol=0.005 + 1e-9)


@needs_data
def test_the_half_field_shares_its_western_corners_with_the_whole(survey: RiseholmeSurvey) -> None:
    whole = shapely.get_coordinates(survey.field.boundary)[:2]
    half = shapely.get_coordinates(survey.half_field.boundary)[:2]
    assert np.hypot(*(whole - half).T).max() < 0.05


def test_the_half_field_needs_no_files_and_has_935_cells(elsewhere: Path) -> None:
    assert not any(elsewhere.iterdir())
    field = half_field()
    assert (len(field.cells), field.crs, field.cell_size) == (935, "EPSG:32630", 5.0)
    assert field.area_ha == pytest.approx(2.33, abs=0.01)
    np.testing.assert_allclose((field.cells - 2.5) % 5.0, 0.0, atol=1e-6)


# Where it is not at hand


def test_offline_and_without_a_folder_one_line_says_what_to_do(elsewhere: Path) -> None:
    with pytest.raises(DataUnavailableError) as caught:
        riseholme(url=NOWHERE)
    message = str(caught.value)
    assert message.startswith(f"{NOWHERE}/ddef22db")
    assert "cosmos.coords: it cannot be downloaded (ConnectionError)" in message
    assert "connect to the network, or set SUBSOIL_DATA" in message
    assert "\n" not in message
    assert not list((elsewhere / "cache").rglob("cosmos*"))


def test_without_pooch_the_way_to_install_it_is_said(
    elsewhere: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert elsewhere.exists()
    monkeypatch.setitem(sys.modules, "pooch", None)
    with pytest.raises(MissingExtraError, match=r"pip install 'subsoil\[data\]', or set SUBSOIL_"):
        riseholme()


def test_a_folder_without_the_files_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SUBSOIL_DATA", str(tmp_path))
    with pytest.raises(DataUnavailableError, match=r"cosmos\.coords: .*without this file.*unset"):
        riseholme()


def test_a_file_that_was_changed_is_not_used(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "riseholme").mkdir()
    (tmp_path / "riseholme" / "cosmos.coords").write_text("53.26, -0.52\n")
    monkeypatch.setenv("SUBSOIL_DATA", str(tmp_path))
    with pytest.raises(DataUnavailableError, match=r"cosmos\.coords: .*SHA-256 differs"):
        riseholme()


@needs_data
def test_what_was_downloaded_once_is_there_without_a_network(elsewhere: Path) -> None:
    kept = elsewhere / "cache" / "subsoil"
    kept.mkdir(parents=True)
    for name in ("cosmos.coords", "cosmos-gt.yaml"):
        shutil.copy(Path(DATA) / "riseholme" / name, kept)
    assert len(riseholme(url=NOWHERE).readings) == 177


@pytest.fixture
def published(tmp_path: Path) -> Iterator[str]:
    """Address of a server that publishes the real outline, and other readings than the real."""
    for commit, name, text in (
        ("ddef22db21452f1f7dc27af1daf6c2d58eabb447", "cosmos.coords", None),
        ("c44416baab603a313741f3fbd9318660dfa347bf", "cosmos-gt.yaml", "names: []"),
    ):
        folder = tmp_path / "published" / commit / "kriging_exploration" / "resources"
        folder.mkdir(parents=True)
        source = Path(DATA) / "riseholme" / name
        (folder / name).write_bytes(source.read_bytes() if text is None else text.encode())
    serve = partial(Quiet, directory=str(tmp_path / "published"))
    with ThreadingHTTPServer(("127.0.0.1", 0), serve) as server:
        Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}"
        server.shutdown()


class Quiet(SimpleHTTPRequestHandler):
    def log_message(self, *_: object) -> None:
        """Say nothing."""


@needs_data
def test_downloads_are_kept_if_they_are_what_was_published_and_refused_if_not(
    elsewhere: Path, published: str
) -> None:
    with pytest.raises(DataUnavailableError, match=r"cosmos-gt\.yaml: .*SHA-256 differs"):
        riseholme(url=published)
    kept = [path.name for path in (elsewhere / "cache").rglob("cosmos*")]
    assert kept == ["cosmos.coords"]
