"""Files that are written: whole or not at all, and never through a link."""

from __future__ import annotations

from pathlib import Path

import pytest

from subsoil.io.write.rasters import write_geotiffs
from subsoil.io.write.whole import whole
from subsoil.land.field import Field
from subsoil.layers import Layers
from subsoil.mapping.soilmap import SoilMap


def test_a_file_takes_its_name_when_it_is_done(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    path.write_text("old")
    with whole(path) as unfinished:
        unfinished.write_text("new")
        assert path.read_text() == "old"
        assert unfinished.name == "a.txt"
    assert path.read_text() == "new"
    assert list(tmp_path.iterdir()) == [path]


def test_after_an_error_the_old_file_is_there_and_nothing_else(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    path.write_text("old")
    with pytest.raises(UnicodeEncodeError), whole(path) as unfinished:
        unfinished.write_text("half \udc80", encoding="utf-8")
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("there", [True, False], ids=["to a file", "to nothing"])
def test_a_planted_link_is_replaced_and_not_followed(tmp_path: Path, there: bool) -> None:
    out, victim = tmp_path / "out", tmp_path / "victim.txt"
    out.mkdir()
    if there:
        victim.write_text("mine")
    link = out / "report.html"
    link.symlink_to(victim)
    with whole(link) as unfinished:
        unfinished.write_text("new")
    assert not link.is_symlink()
    assert link.read_text() == "new"
    assert (victim.read_text() == "mine") if there else not victim.exists()


def test_a_name_as_long_as_names_may_be_is_written(tmp_path: Path) -> None:
    path = tmp_path / ("n" * 251 + ".txt")
    with whole(path) as unfinished:
        unfinished.write_text("new")
    assert path.read_text() == "new"


def test_rasters_do_not_follow_planted_links(tmp_path: Path) -> None:
    pytest.importorskip("rasterio")
    field = Field.from_metres([(0, 0), (40, 0), (40, 20), (0, 20)])
    out, victim = tmp_path / "out", tmp_path / "victim.txt"
    out.mkdir()
    victim.write_text("mine")
    for name in ("mean_kpa.tif", "std_dev_kpa.tif"):
        (out / name).symlink_to(victim)
    paths = write_geotiffs(SoilMap(field, Layers((0.0, 0.2))), out)
    assert victim.read_text() == "mine"
    assert sorted(out.iterdir()) == sorted(paths)
    assert not any(path.is_symlink() for path in paths)
    assert all(path.stat().st_size > 0 for path in paths)
