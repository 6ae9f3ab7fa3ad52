"""The notebook runs from top to bottom without a screen, and shows tables and pictures."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

nbformat = pytest.importorskip("nbformat")
nbclient = pytest.importorskip("nbclient")

NOTEBOOK = Path(__file__).parents[1] / "docs" / "tutorials" / "first_survey.ipynb"


def shown(notebook: Any) -> list[dict[str, str]]:
    """What cells show, by kind, in order."""
    outputs = (output for cell in notebook.cells for output in cell.get("outputs", ()))
    return [dict(output.data) for output in outputs if "data" in output]


def test_the_notebook_is_kept_without_its_outputs() -> None:
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    nbformat.validate(notebook)
    assert not shown(notebook)
    assert all(cell.execution_count is None for cell in notebook.cells if cell.cell_type == "code")


@pytest.mark.slow
@pytest.mark.filterwarnings("default")
def test_the_notebook_runs_and_shows_every_value_as_a_table_or_a_picture(tmp_path: Path) -> None:
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    resources = {"metadata": {"path": str(tmp_path)}}
    nbclient.NotebookClient(notebook, timeout=120, resources=resources).execute()
    seen = shown(notebook)
    tables = [data["text/html"] for data in seen if "text/html" in data]
    assert "<svg" in tables[0]
    starts = ("Soil map of Long Acre", "stops planned", "Survey of Long Acre")
    assert all(any(start in table for table in tables) for start in starts)
    assert len(tables) == 5
    assert sum("image/png" in data for data in seen) == 3
