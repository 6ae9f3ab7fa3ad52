"""What is kept of a result, in JSON."""

from __future__ import annotations

import json
from dataclasses import asdict
from math import nan
from typing import Any

from subsoil.bench.task import Entrant, Result, Series, Setting, Snapshot, Task


def result_to_json(result: Result) -> str:
    """One line of JSON; floats survive bit for bit."""
    series = [
        {
            "budget": one.budget,
            "rows": [asdict(each) for each in one.snapshots],
            "decision_s": one.decision_s,
        }
        for one in result.series
    ]
    return json.dumps({"task": result.task.record, "series": series}, sort_keys=True)


def result_from_json(text: str) -> Result:
    """Result of one line of JSON; one of before there was a time of decisions has none.

    Raises
    ------
    ValueError, KeyError, TypeError
        If it is not a result.
    """
    record: dict[str, Any] = json.loads(text)
    task = record["task"]
    setting = setting_from(task["setting"])
    series = tuple(
        Series(
            one["budget"],
            tuple(Snapshot(**row) for row in one["rows"]),
            float(one.get("decision_s", nan)),
        )
        for one in record["series"]
    )
    return Result(Task(setting, task["field"], Entrant(**task["entrant"])), series)


def setting_from(record: dict[str, Any]) -> Setting:
    """Setting of its record in JSON."""
    return Setting(**{**record, "samples": tuple(record["samples"])})
