"""The report of a benchmark: tables as CSV and LaTeX, figures, and a page that says what they are.

::

    report.md       the page, with the figures and tables
    results.csv     all results
    tables/         each table as .csv and .tex
    figures/        each figure as .png, .svg or .pdf
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from subsoil.bench import figures, tables
from subsoil.bench.comparison import ResultTable, result_table
from subsoil.bench.hand_survey import HandSurveys, hand_surveys
from subsoil.bench.scoring import Scorer, surveyed
from subsoil.bench.store import config_of, results_of, write_results
from subsoil.bench.task import Entrant, Setting, Task
from subsoil.bench.truths import truth_of
from subsoil.errors import NotAllowedError, ParameterError
from subsoil.io.write.whole import whole
from subsoil.optional import FIGURES, require
from subsoil.plots import draw_survey, save_all
from subsoil.plots.saving import Format
from subsoil.survey import fits_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_EXAMPLE = ("joint-adaptive", "adaptive-monte-carlo", "adaptive-greedy", "area-split")
"""Strategies of which one survey is drawn: the first of them that there is."""
_MOST_HAND_FIELDS = 20
"""Fields that are surveyed by hand at most."""


def write_report(folder: Path, form: Format = "png") -> dict[str, object]:
    """Write everything of a report into the folder of a benchmark.

    One survey is made anew for its maps, and up to 20 fields are surveyed as if by hand.

    Returns
    -------
    dict
        Path of the page, numbers of results and of tasks without one, and paths of all figures.

    Raises
    ------
    ParameterError
        If the folder is not a benchmark's, or has no result yet.
    MissingExtraError
        If matplotlib is not installed.
    """
    require(FIGURES)
    benchmark, results = config_of(folder), results_of(folder)
    if not results:
        raise ParameterError(
            "no task is finished", where=str(folder), remedy="run the benchmark first"
        )
    found = result_table(results)
    missing = len(benchmark.tasks) - len(results)
    hand = hand_surveys(benchmark.setting, min(benchmark.fields, _MOST_HAND_FIELDS))
    room = folder / "figures"
    room.mkdir(exist_ok=True)
    drawn = _pictures(found, benchmark.setting, hand)
    pictures = dict(zip(drawn, save_all(drawn, room, form), strict=True))
    contents = _tables(found, hand)
    _write_tables(contents, folder / "tables")
    page = folder / "report.md"
    text = _page(found, benchmark.setting, benchmark.fields, missing, contents, pictures)
    with whole(page) as unfinished:
        unfinished.write_text(text, encoding="utf-8")
    return {
        "report": page,
        "results": write_results(folder),
        "finished tasks": len(results),
        "missing tasks": missing,
        "tables": folder / "tables",
        "figures": tuple(pictures.values()),
    }


def _tables(found: ResultTable, hand: HandSurveys) -> tuple[tables.Table, ...]:
    return (
        tables.layer_table(hand),
        tables.correlation_table(found),
        tables.rmse_table(found),
        tables.path_table(found),
        tables.time_table(found),
        tables.calibration_table(found),
        tables.decision_table(found),
        tables.paired_table("paired_rmse", "RMSE (kPa)", found, lambda row: row.rmse_kpa, 1),
        tables.paired_table("paired_path", "Way (m)", found, lambda row: row.path_m, 0),
    )


def _pictures(found: ResultTable, setting: Setting, hand: HandSurveys) -> dict[str, Figure]:
    """All figures by name."""
    number = max(len(results) for results in found.by_entrant.values())
    what = f"{number} fields, protocol {setting.protocol}, seed {setting.seed}"
    caption = f"{what}; means with 95 % intervals over fields"
    drawn = {
        "learning": figures.learning(found, f"{caption}; open marks: as the paper prints"),
        "time_quality": figures.time_quality(found, f"{what}; means over fields"),
        "variance_and_error": figures.variance_and_error(found, caption),
        "calibration": figures.calibrations(found, caption),
        "layers": figures.by_layer(
            hand, f"{len(hand.readings)} fields, about {hand.readings[0]} readings each"
        ),
    }
    if found.references and len(found.entrants) > 1:
        drawn["differences"] = figures.differences(found, caption)
    return {**drawn, **_example(found, setting)}


def _example(found: ResultTable, setting: Setting) -> dict[str, Figure]:
    """Maps with the way, and variograms, of one survey of the first field.

    None where its strategy is code that a folder only names.
    """
    entrant = _exemplary(found)
    task = Task(setting, min(found.by_entrant[entrant]), entrant)
    truth = truth_of(setting, task.field_number)
    try:
        survey, _ = surveyed(task, setting.samples[-1], truth, Scorer(truth))
    except NotAllowedError:
        return {}
    fits = fits_of(survey)
    drawn = draw_survey(survey, (), fits)
    return {f"example_{name}": drawn[name] for name in ("depth_slices", "std_dev", "variograms")}


def _exemplary(found: ResultTable) -> Entrant:
    named = (e for name in _EXAMPLE for e in found.entrants if e.strategy == name)
    return next(named, found.entrants[0])


def _write_tables(contents: tuple[tables.Table, ...], folder: Path) -> None:
    folder.mkdir(exist_ok=True)
    for table in contents:
        tables.write_csv(table, folder / f"{table.name}.csv")
        with whole(folder / f"{table.name}.tex") as unfinished:
            unfinished.write_text(tables.latex(table), encoding="utf-8")


_CAPTIONS = {
    "table1_layers": ("layers", "A survey by hand has about 49 readings on a loose grid, as the "
        "paper's had; they are read like the robot's. The paper's came from another instrument "
        "in another season."),
    "table2_correlation": ("variance_and_error", "Over samples: mean kriging variance against mean "
        "squared error through a survey, from its second sample on. Over cells: variance against "
        "squared error of each cell of one map. The figure begins at five samples."),
    "table3_rmse": ("learning", "Over all layers and cells."),
    "table4_path": ("", "Legs between the stops, from the corner where the robot starts."),
    "time_quality": ("time_quality", "Linear between the numbers of samples compared; a survey "
        "that is over by then keeps its last map, and its share is given."),
    "calibration": ("calibration", ""),
    "decision_time": ("", "Variograms, map and plan, on one core. It depends on the machine and "
        "varies from run to run, as nothing else here does."),
    "paired_rmse": ("differences", "Fields won: on which the strategy's value is lower; a tie "
        "counts half."),
    "paired_path": ("", ""),
}  # fmt: skip
"""Of each table: the figure beside it, and what to know of it."""


def _page(
    found: ResultTable,
    setting: Setting,
    fields: int,
    missing: int,
    contents: tuple[tables.Table, ...],
    pictures: Mapping[str, Path],
) -> str:
    entrants = ", ".join(f"{e.strategy} ({e.estimator})" for e in found.entrants)
    place = "the given boundary" if setting.boundary_wkt else "the protocol's own field"
    parts = [
        "# Strategies compared\n",
        f"Protocol {setting.protocol}, {fields} fields on {place}, seed {setting.seed}, maps at "
        f"{', '.join(map(str, setting.samples))} samples. Entrants: {entrants}.\n",
        "All entrants survey the same fields. ± is half a 95 % interval over fields by Student's "
        "t. Columns named paper are as printed by Fentanes et al. (2018, arXiv:1803.08069): "
        "another soil, which is not public, and one to five runs. They show the scale, and equal "
        "numbers are not to be expected. Time is 1 m/s and 50 s a sample.\n",
    ]
    if missing:
        parts.append(
            f"**{missing} tasks have no result.** Means are over the fields an entrant has, "
            "differences over those both have.\n"
        )
    for table in contents:
        picture, words = _CAPTIONS[table.name]
        parts.append(f"## {table.title}\n")
        parts += [words + "\n"] if words else []
        parts += [_image(table.title, pictures[picture])] if picture in pictures else []
        parts += [tables.markdown(table)] if table.rows else ["There is nothing to compare.\n"]
    if examples := [name for name in pictures if name[:7] == "example"]:
        entrant = _exemplary(found)
        parts.append("## One survey\n")
        parts.append(
            f"{entrant.strategy} with {entrant.estimator} on field "
            f"{min(found.by_entrant[entrant])}, {setting.samples[-1]} samples.\n"
        )
        parts += [_image(name, pictures[name]) for name in examples]
    return "\n".join(parts)


def _image(name: str, path: Path) -> str:
    """A figure on the page."""
    return f"![{name}]({path.parent.name}/{path.name})\n"
