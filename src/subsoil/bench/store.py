"""A benchmark's folder: what it compares, one file a finished task, and the table of results.

::

    config.json      what all tasks share, the number of fields and the entrants
    tasks/*.json     a task and its result each, named by all that decides the result
    results.csv      a row for each task and number of samples, sorted
"""

from __future__ import annotations

import csv
import json
import os
import tempfile
from dataclasses import asdict, dataclass, fields
from importlib.metadata import version
from io import StringIO
from math import isnan
from pathlib import Path
from typing import Any

from subsoil.bench.records import result_from_json, result_to_json, setting_from
from subsoil.bench.task import (
    Entrant,
    Result,
    Setting,
    Task,
    tasks_of,
)
from subsoil.errors import ParameterError
from subsoil.io.write.whole import whole

COLUMNS = (
    "field", "protocol", "strategy", "estimator", "n",
    "rmse_kpa", "path_m", "minutes", "mean_kv", "predicted_rmse_kpa", "decision_s",
)  # fmt: skip
"""Columns of ``results.csv``."""
VARYING = "decision_s"
"""The column that differs from run to run: processor time of a decision in s."""

_CONFIG, _TASKS, _RESULTS = "config.json", "tasks", "results.csv"
_DECIMALS = 6


@dataclass(frozen=True)
class Benchmark:
    """What a folder compares.

    Attributes
    ----------
    setting
        What all tasks share.
    fields
        Number of fields.
    entrants
        Who surveys them.
    """

    setting: Setting
    fields: int
    entrants: tuple[Entrant, ...]

    def __post_init__(self) -> None:
        if self.fields < 1:
            raise ParameterError(
                f"there must be a field or more, not {self.fields}", where="--fields"
            )

    @property
    def tasks(self) -> tuple[Task, ...]:
        """Every entrant on every field, field by field."""
        return tasks_of(self.setting, self.fields, self.entrants)


def enter(folder: Path, benchmark: Benchmark) -> None:
    """Set a folder up for a benchmark, or add to the one that is there.

    More fields and more entrants are added; everything else must agree, the version of subsoil
    included.

    Raises
    ------
    ParameterError
        If the folder holds another benchmark; the message says what differs.
    """
    if (folder / _CONFIG).exists():
        before = config_of(folder)
        differences = _differences(folder, before.setting, benchmark.setting)
        if differences:
            raise ParameterError(
                f"it holds another benchmark: {'; '.join(differences)}",
                where=str(folder),
                remedy="give another folder, or the same settings",
            )
        entrants = tuple(sorted({*before.entrants, *benchmark.entrants}))
        benchmark = Benchmark(benchmark.setting, max(before.fields, benchmark.fields), entrants)
    (folder / _TASKS).mkdir(parents=True, exist_ok=True)
    record = {"subsoil": version("subsoil"), **asdict(benchmark)}
    _write(folder / _CONFIG, json.dumps(record, indent=2) + "\n")


def config_of(folder: Path) -> Benchmark:
    """What a folder compares.

    Raises
    ------
    ParameterError
        If it is not the folder of a benchmark.
    """
    record = _config(folder)
    try:
        entrants = tuple(Entrant(**entrant) for entrant in record["entrants"])
        return Benchmark(setting_from(record["setting"]), record["fields"], entrants)
    except (KeyError, TypeError) as error:
        raise _not_one(folder) from error


def keep(folder: Path, result: Result) -> None:
    """Keep a result; it is there as a whole or not at all."""
    _write(_path(folder, result.task), result_to_json(result) + "\n")


def kept(folder: Path, task: Task) -> bool:
    """Whether the result of a task is there."""
    return _path(folder, task).exists()


def results_of(folder: Path) -> tuple[Result, ...]:
    """Finished tasks of what a folder compares, in its order.

    Raises
    ------
    ParameterError
        If it is not the folder of a benchmark, or a file in it is not a result.
    """
    return tuple(_read(_path(folder, t)) for t in config_of(folder).tasks if kept(folder, t))


def write_results(folder: Path) -> Path:
    """Write ``results.csv`` from all results; returns its path.

    Rows are sorted and floats rounded to 6 decimals, so that equal results make equal files, but
    for their last column: see :func:`repeatable`.
    """
    rows = sorted(row for result in results_of(folder) for row in _rows(result))
    path = folder / _RESULTS
    with whole(path) as unfinished, unfinished.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(COLUMNS)
        writer.writerows([_text(value) for value in row] for row in rows)
    return path


def repeatable(results_csv: str | Path) -> str:
    """What a ``results.csv`` says without the column that varies: equal for equal results."""
    with Path(results_csv).open(newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    same = [k for k, name in enumerate(rows[0]) if name != VARYING]
    text = StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerows([row[k] for k in same] for row in rows)
    return text.getvalue()


def _rows(result: Result) -> list[tuple[int | str | float, ...]]:
    task, who = result.task, result.task.entrant
    return [
        (
            task.field_number, task.setting.protocol, who.strategy, who.estimator, at.n,
            at.rmse_kpa, at.path_m, at.minutes, at.mean_kv, at.predicted_rmse_kpa, decision_s,
        )
        for at, decision_s in zip(result.marks, result.decision_s, strict=True)
    ]  # fmt: skip


def _text(value: int | str | float) -> str:
    if not isinstance(value, float):
        return str(value)
    return "" if isnan(value) else repr(round(value, _DECIMALS))


def _differences(folder: Path, before: Setting, now: Setting) -> list[str]:
    """What differs between two settings, in words; and the version they were made with."""
    made, current = _config(folder).get("subsoil"), version("subsoil")
    found = [f"subsoil {made}, not {current}"] if made != current else []
    for name in (item.name for item in fields(Setting)):
        old, new = getattr(before, name), getattr(now, name)
        if old == new:
            continue
        short = name == "boundary_wkt"
        found.append("another boundary" if short else f"{name} {_said(old)}, not {_said(new)}")
    return found


def _said(value: object) -> str:
    return ",".join(map(str, value)) if isinstance(value, tuple) else str(value) or "none"


def _config(folder: Path) -> dict[str, Any]:
    try:
        record = json.loads((folder / _CONFIG).read_text(encoding="utf-8"))
    except (FileNotFoundError, ValueError) as error:
        raise _not_one(folder) from error
    if not isinstance(record, dict):
        raise _not_one(folder)
    return record


def _not_one(folder: Path) -> ParameterError:
    return ParameterError(
        f"there is no {_CONFIG} of a benchmark",
        where=str(folder),
        remedy="make one with `subsoil bench run`",
    )


def _path(folder: Path, task: Task) -> Path:
    return folder / _TASKS / f"{task.name}.json"


def _read(path: Path) -> Result:
    try:
        return result_from_json(path.read_text(encoding="utf-8"))
    except (ValueError, KeyError, TypeError) as error:
        raise ParameterError(
            "it is not a result", where=str(path), remedy="delete it and run the benchmark again"
        ) from error


def _write(path: Path, text: str) -> None:
    """Write a file that is there as a whole or not at all, even if the power is cut."""
    with tempfile.NamedTemporaryFile(
        "w", dir=path.parent, prefix=".", suffix=".part", delete=False, encoding="utf-8"
    ) as file:
        try:
            file.write(text)
            file.flush()
            os.fsync(file.fileno())
        except BaseException:
            Path(file.name).unlink(missing_ok=True)
            raise
    Path(file.name).replace(path)
