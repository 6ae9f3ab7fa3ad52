"""--map on the command line: what headings mean, where they do not say."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

Cli = Callable[..., Any]
LAYERS = ("--layers", "0,0.05,0.1")


@pytest.fixture
def unclear(readings: Path) -> Path:
    """Twelve readings under headings that nobody understands."""
    _, *rows = readings.read_text().splitlines()
    readings.write_text("\n".join(["right,up,pen1,pen2", *rows]) + "\n")
    return readings


def test_headings_mean_what_the_options_say(cli: Cli, unclear: Path) -> None:
    said = ("right=easting", "up=northing", "pen1=kpa at 5 cm", "pen2=kpa at 10 cm")
    options = [word for each in said for word in ("--map", each)]
    found = cli("cv", unclear, *LAYERS, *options, "--json")
    assert (found.code, found.json["samples"]) == (0, 12)


def test_an_error_about_headings_lists_them_and_names_the_option(cli: Cli, unclear: Path) -> None:
    found = cli("cv", unclear, *LAYERS)
    assert found.code == 2
    assert "headings seen: right, up, pen1, pen2" in found.err
    assert "--map" in found.err


@pytest.mark.parametrize("given", ["pen1", "=kpa", "pen1="])
def test_a_meaning_without_its_heading_is_a_wrong_option(
    cli: Cli, unclear: Path, given: str
) -> None:
    found = cli("cv", unclear, *LAYERS, "--map", given)
    assert found.code == 2
    assert "is not heading=meaning" in found.err
