"""Tables with a row a depth: rows of one number and place make a push."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from subsoil.arrays import Floats
from subsoil.errors import brief
from subsoil.findings import Finding
from subsoil.io.read.recording import METRES, Record
from subsoil.io.read.tables.grid import Grid, Said
from subsoil.io.read.tables.numbers import Numbers
from subsoil.penetrometer import DEEPEST_M

_SPOT = {"lonlat": 1e-4, "metres": 10.0, "none": np.inf}
"""How far the places of one push may lie apart, in degrees or m: a receiver wanders meanwhile."""


@dataclass(frozen=True)
class Depths:
    """Depths of the rows of a tidy table.

    Attributes
    ----------
    bottom_m, top_m
        (n,) depths in m to and from which each value stands; tops are NaN where nobody says.
    strength
        Numbers of strength.
    """

    bottom_m: Floats
    top_m: Floats
    strength: Numbers


def tidy_records(grid: Grid) -> tuple[list[Record], list[Finding]]:
    """Pushes of a table, and findings about the rows that belong to none."""
    said = Said(grid.file)
    depths = _depths(grid, said)
    usable = [i for i in range(len(grid.rows)) if not np.isnan(depths.bottom_m[i])]
    pushes = [
        push
        for rows in _together(grid, usable, depths.bottom_m)
        for push in _pushes(rows, depths, grid, said)
    ]
    usual = _usual_depths([depths.bottom_m[push] for push in pushes])
    cache: dict[bytes, Floats] = {}
    records = [_record(push, depths, grid, usual, cache, said) for push in pushes]
    return sorted(records, key=lambda record: record.row), said.found


def _depths(grid: Grid, said: Said) -> Depths:
    columns = grid.columns
    (depth,), (strength,) = columns.of("depth"), columns.of("strength")
    length = columns.meanings[depth].unit
    bottom = grid.numbers([depth], DEEPEST_M / METRES[length])[0]
    bottom_m = (bottom.values * METRES[length]).round(6)
    wrong = {
        **{
            int(i): (columns.names[depth], "a number is missing")
            for i in np.flatnonzero(np.isnan(bottom_m))
        },
        **{i: (columns.names[depth], why) for i, why in bottom.wrong.items()},
        **grid.positions.wrong,
    }
    top_m = np.full(len(bottom_m), np.nan)
    if (column := columns.first("top")) is not None:
        unit = METRES[columns.meanings[column].unit or length]
        top_m = (grid.numbers([column], DEEPEST_M / unit)[0].values * unit).round(6)
    if (bottom_m[np.isfinite(bottom_m)] <= 0).all() and (bottom_m < 0).any():
        bottom_m, top_m = np.abs(bottom_m), np.abs(top_m)
        said.found.append(
            Finding("depths with a minus are taken as below the ground", file=said.file)
        )
    for i in np.flatnonzero((bottom_m < 0) | (bottom_m > DEEPEST_M)).tolist():
        wrong[i] = columns.names[depth], f"{bottom_m[i]:g} m is no depth of a push"
    for i in np.flatnonzero(top_m >= bottom_m).tolist():
        wrong[i] = columns.names[depth], "it is not below its top"
    values = grid.numbers([strength], grid.hardest)[0]
    for i, (column_name, why) in sorted(wrong.items()):
        said.left_out(grid.rows[i], why, brief(column_name))
    for i, why in values.wrong.items():
        said.left_out(grid.rows[i], why, brief(columns.names[strength]))
    bottom_m[sorted(wrong)] = np.nan
    return Depths(bottom_m, top_m, values)


def _together(grid: Grid, rows: Sequence[int], bottom_m: Floats) -> Iterator[list[int]]:
    """Rows of one number, or of one place, that may be a push or several."""
    keys = [
        k for k in grid.labels if len(set(texts := grid.texts(k))) < len(texts) or len(texts) == 1
    ]
    named: dict[tuple[str, ...], list[int]] = {}
    for i in rows:
        named.setdefault(tuple(grid.cells[i][k].strip() for k in keys), []).append(i)
    for group in named.values():
        x, y = grid.positions.x[group], grid.positions.y[group]
        near = (
            max(np.ptp(x), np.ptp(y)) <= _SPOT[grid.positions.frame]
            if grid.positions.frame != "none"
            else True
        )
        if keys and near and len(set(bottom_m[group].tolist())) == len(group):
            yield group
            continue
        placed: dict[tuple[float, float], list[int]] = {}
        for i, place in zip(group, zip(x.tolist(), y.tolist(), strict=True), strict=True):
            placed.setdefault(place if grid.positions.frame != "none" else (0.0, 0.0), []).append(i)
        yield from placed.values()


def _pushes(rows: list[int], depths: Depths, grid: Grid, said: Said) -> list[list[int]]:
    """Pushes of rows of one number and place: each begins where the first depth comes again."""
    found: list[list[int]] = []
    seen: set[float] = set()
    for i in rows:
        depth = float(depths.bottom_m[i])
        if not found or depth in seen:
            if found and depth != depths.bottom_m[rows[0]]:
                other = next(j for j in found[-1] if depths.bottom_m[j] == depth)
                what = f"{depth:g} m is there twice for one push, first in row {grid.rows[other]}"
                said.left_out(grid.rows[rows[0]], f"{what} and again in row {grid.rows[i]}")
                return []
            found.append([])
            seen = set()
        found[-1].append(i)
        seen.add(depth)
    return found


def _usual_depths(pushes: Sequence[Floats]) -> Floats:
    """Depths that more than half of the pushes have that go so deep."""
    count = Counter(depth for push in pushes for depth in push.tolist())
    if not count:
        return np.empty(0)
    ends = np.sort([push.max() for push in pushes])
    deep = {depth: len(ends) - int(np.searchsorted(ends, depth)) for depth in count}
    return np.array(sorted(depth for depth, n in count.items() if 2 * n > deep[depth]))


def _record(
    push: list[int],
    depths: Depths,
    grid: Grid,
    usual: Floats,
    cache: dict[bytes, Floats],
    said: Said,
) -> Record:
    order = sorted(push, key=lambda i: depths.bottom_m[i])
    own = depths.bottom_m[order]
    tops = depths.top_m[order]
    depth_m = np.union1d(own, usual[usual < own[-1]]) if np.isnan(tops).all() else own
    values = np.full(depth_m.size, np.nan)
    at = np.searchsorted(depth_m, own)
    values[at] = depths.strength.values[order]
    bounds = [k for k, i in zip(at, order, strict=True) if i in depths.strength.at_least]
    ending = said.ending(values, np.array(bounds, dtype=int), grid.rows[push[0]])
    depth_m = cache.setdefault(depth_m.tobytes(), depth_m)
    above = np.concatenate([[0.0], depth_m[:-1]])
    top_m = (
        np.empty(0)
        if np.isnan(tops).all()
        else np.maximum(np.where(np.isnan(tops), above, tops), above)
    )
    first = min(push)
    keys = [k for k in grid.labels if len({grid.cells[i][k] for i in push}) == 1]
    return Record(
        grid.rows[first],
        float(np.median(grid.positions.x[push])),
        float(np.median(grid.positions.y[push])),
        depth_m,
        values,
        top_m,
        "/".join(grid.cells[first][k].strip() for k in keys),
        grid.times[first],
        grid.cones[first],
        ending,
    )
