"""Every example of the gallery runs by itself, and leaves a picture."""

from __future__ import annotations

import runpy
from pathlib import Path

import pytest

pytest.importorskip("matplotlib")
from matplotlib.figure import Figure

GALLERY = Path(__file__).parents[1] / "docs" / "gallery"
EXAMPLES = sorted(GALLERY.glob("plot_*.py"))


def test_there_are_examples_enough_to_look_through() -> None:
    assert len(EXAMPLES) >= 9
    assert (GALLERY / "GALLERY_HEADER.rst").exists()


@pytest.mark.slow
@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_runs_and_leaves_a_picture_with_something_in_it(
    path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    left = runpy.run_path(str(path))
    figures = [value for value in left.values() if isinstance(value, Figure)]
    assert figures
    for figure in figures:
        assert any(axes.has_data() for axes in figure.axes)
        figure.savefig(tmp_path / "figure.png", dpi=40)
    assert not [name for name in tmp_path.iterdir() if name.name != "figure.png"]
    assert "pyplot" not in path.read_text(encoding="utf-8")


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_has_a_title_that_is_underlined_and_says_for_whom_it_is(path: Path) -> None:
    _, title, rule, blank, reader, *_ = path.read_text(encoding="utf-8").splitlines()
    assert len(rule) == len(title)
    assert set(rule) == {"="}
    assert not blank
    assert reader.startswith("For somebody") or reader.startswith("For a ")
