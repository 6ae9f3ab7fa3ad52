"""Rules that every strategy keeps, on every field, with every robot."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from subsoil.arrays import Floats
from subsoil.bench.conformance.courses import (
    Course,
    Ground,
    driven,
    fields,
    how,
    laid_down,
    waves,
)
from subsoil.bench.conformance.rule import Rule, Subject
from subsoil.errors import brief
from subsoil.land.field import Field
from subsoil.strategies import Plan, View, planned, strategy_named
from subsoil.survey import view

_EVERY = tuple(fields())
_WITH_CORNER = ("L", "keep-out", "thin")


def plans_free_cells(subject: Subject, case: str) -> str:
    """Plans of whole surveys: cells in the field that are free, each once, and a reason."""
    for samples in (5, 14):
        course = _surveyed(subject, fields()[case], samples)
        for before, event in course.plans:
            cells = laid_down(before, event)
            if len(set(cells)) < len(cells):
                return f"it plans a cell twice: {brief(str(cells))}"
            if gone := {*before.visited, *before.refused} & {*cells}:
                return f"it plans cell {min(gone)}, which was tried before"
            if not event.reason:
                return f"it gives no reason for its plan after {before.taken} samples"
    return ""


def takes_its_samples(subject: Subject, case: str) -> str:
    """Surveys end with their samples taken, or with every cell tried."""
    for samples in range(1, 9) if case == "tiny" else (1, 2, 24):
        if seen := end_of(_surveyed(subject, fields()[case], samples)):
            return seen
    return ""


def copes_with_a_last_cell(subject: Subject, case: str) -> str:
    """The last free cell is planned, and nothing where there is none."""
    cells = range(len(fields()[case].cells))
    state = driven(fields()[case], how("area-split", 3)).state
    seen = replace(view(state), budget=len(cells), plan=())
    left = [cell for cell in cells if cell not in state.visited]
    none = replace(seen, refused=tuple(left))
    one = replace(seen, refused=tuple(left[:-1]))
    if plan := _plan(subject, none).cells:
        return f"it plans {brief(str(plan))} where no cell is free"
    if _plan(subject, one).cells != (left[-1],):
        return "it does not plan the last free cell, with samples still to take"
    return ""


def goes_around_stones(subject: Subject, case: str) -> str:
    """Cells that refuse are left behind; where all do, each is tried once."""
    field = fields()[case]
    if case == "tiny":
        tried = [(range(6 - stones, 6), 6) for stones in (2, 5, 6)]
    else:
        away = np.hypot(*(field.cells - field.cells.max(axis=0)).T)
        corner, scattered = np.argsort(away)[: len(away) // 4].tolist(), range(0, len(away), 4)
        tried = [(corner, 10), (scattered, 10)]
    for stony, samples in tried:
        if seen := end_of(_surveyed(subject, field, samples, stony=set(stony)), stony):
            return seen
    return ""


def goes_on_without_knowledge(subject: Subject, case: str) -> str:
    """A survey goes on while no push tells anything."""
    return end_of(_surveyed(subject, fields()[case], 6, ground="hard"))


def goes_on_with_more_samples(subject: Subject, case: str) -> str:
    """A larger budget goes on from what was done."""
    field = fields()[case]
    first, second = how(subject.name, 4, seed=1), how(subject.name, 9, seed=2)
    course = driven(field, first, second, allowed=subject.allowed)
    if seen := end_of(course):
        return seen
    before = driven(field, first, allowed=subject.allowed).state.visited
    if course.state.visited[: len(before)] != before:
        return "the same first survey went another way"
    return ""


def takes_over(subject: Subject, case: str) -> str:
    """It goes on half way with what another strategy planned."""
    for other in ("greedy", "area-split", "adaptive-greedy"):
        configured = how(other, 3), how(subject.name, 7)
        if seen := end_of(driven(fields()[case], *configured, allowed=subject.allowed)):
            return f"after {other}, {seen}"
    return ""


def repeats_itself(subject: Subject, case: str) -> str:
    """The same seed gives the same survey."""
    courses = [_surveyed(subject, fields()[case], 9) for _ in range(2)]
    one, other = ([laid_down(*each) for each in course.plans] for course in courses)
    for k, (first, second) in enumerate(zip(one, other, strict=False)):
        if first != second:
            return f"plan {k + 1} is {brief(str(first))} at first, then {brief(str(second))}"
    return ""


def looks_and_leaves_alone(subject: Subject, case: str) -> str:
    """A plan is a function of the view, which is the same after it as before."""
    field = fields()[case]
    for before, event in _surveyed(subject, field, 8, stony=range(0, len(field.cells), 3)).plans:
        seen, kv = view(before), before.soil_map.kv.copy()
        plan = _plan(subject, seen)
        if not plan.cells == _plan(subject, view(before)).cells == laid_down(before, event):
            return f"it answers the same view in two ways, after {before.taken} samples"
        now = view(before)
        same = all(
            getattr(seen, name) == getattr(now, name)
            for name in ("plan", "visited", "refused", "leased", "position", "budget")
        )
        if not (same and np.array_equal(before.soil_map.kv, kv, equal_nan=True)):
            return f"it changes the view, after {before.taken} samples"
    return ""


def knows_no_truth(subject: Subject, case: str) -> str:
    """Where the soil differs in cells that were not probed, the survey is the same."""
    field = fields()[case]
    first = _surveyed(subject, field, 8).state.visited

    def elsewhere(east: float, north: float) -> Floats:
        known = field.nearest_cell((east, north)) in first
        return waves(east, north) * (1.0 if known else 1.5)

    configured = how(subject.name, 8)
    then = driven(field, configured, allowed=subject.allowed, soil=elsewhere).state.visited
    if then == first:
        return ""
    return "it goes another way where the soil differs in cells that it has not probed"


def end_of(course: Course, stony: Iterable[int] = ()) -> str:
    """What is wrong with the end of a survey; empty if nothing is.

    It is to be over with its samples taken, or with every cell tried, and only stony cells refused.
    """
    end, stones = course.state, set(stony)
    samples, cells = end.settings.samples, len(end.field.cells)
    tried = len(end.visited) + len(end.refused)
    if len({*end.visited, *end.refused}) < tried:
        return "it sends an agent twice to a cell"
    if wrong := set(end.refused) - stones:
        return f"cell {min(wrong)} was refused, which holds no stone"
    if not end.finished:
        return f"the survey did not end: {end.taken} of {samples} samples are taken"
    if len(end.visited) < samples and tried < cells:
        return f"it ended after {len(end.visited)} of {samples} samples: {brief(end.finished, 80)}"
    if len(end.visited) > samples:
        return f"it took {len(end.visited)} samples, and was given {samples}"
    return ""


def decision_s(subject: Subject) -> float:
    """Mean processor time of a decision in s, on the test bed with 14 samples."""
    return _surveyed(subject, fields()["test bed"], 14).decision_s


def _surveyed(
    subject: Subject,
    field: Field,
    samples: int,
    *,
    stony: Iterable[int] = (),
    ground: Ground = "soft",
) -> Course:
    configured = how(subject.name, samples)
    return driven(field, configured, allowed=subject.allowed, stony=set(stony), ground=ground)


def _plan(subject: Subject, seen: View) -> Plan:
    strategy = strategy_named(subject.name, allowed=subject.allowed)
    return planned(strategy, seen, f"strategy {brief(subject.name)}")


RULES = (
    Rule(
        "it plans free cells of the field, each once, and says why",
        "plan cells of View.free or of View.plan, with a reason",
        _EVERY,
        plans_free_cells,
    ),
    Rule(
        "a survey takes the samples it was given, or tries every cell",
        "plan a stop while View.remaining is above zero",
        _EVERY,
        takes_its_samples,
    ),
    Rule(
        "the last free cell is planned, and nothing where there is none",
        "plan of View.free: its last cell where there is one, no cell where there is none",
        ("L",),
        copes_with_a_last_cell,
    ),
    Rule(
        "it goes around cells that refuse",
        "leave View.refused alone and replace those stops",
        ("tiny", *_WITH_CORNER),
        goes_around_stones,
    ),
    Rule(
        "it goes on while no push tells anything",
        "look at View.informed before the map",
        ("L",),
        goes_on_without_knowledge,
    ),
    Rule(
        "it goes on from what was done when there are more samples to take",
        "plan what View.remaining asks for, whatever was planned before",
        ("L", "tiny"),
        goes_on_with_more_samples,
    ),
    Rule(
        "it takes over from another strategy half way",
        "take View.plan as it comes, or plan anew",
        ("keep-out",),
        takes_over,
    ),
    Rule(
        "the same seed gives the same survey",
        "draw chance from View.rng alone, and keep nothing between calls",
        ("L",),
        repeats_itself,
    ),
    Rule(
        "a plan is a function of the view, and leaves that as it is",
        "keep nothing between calls, and copy arrays before changing them",
        ("keep-out",),
        looks_and_leaves_alone,
    ),
    Rule(
        "it decides by what was measured, and never by the truth",
        "look at the view alone",
        ("L",),
        knows_no_truth,
    ),
)
"""Rules in the order in which they are tried."""
