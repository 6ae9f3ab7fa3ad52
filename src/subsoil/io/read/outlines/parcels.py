"""Parcels of a file: which of them are the field, and whether they are one."""

from __future__ import annotations

from collections.abc import Sequence
from typing import cast

import numpy as np
import scipy
import shapely

from subsoil.errors import BoundaryError, listed
from subsoil.findings import Finding
from subsoil.io.read.outlines.outlines import KEEP_OUT, Parcel
from subsoil.land.outline import Area

APART_M = 30.0
"""Distance in m, of a track, hedge or ditch, up to which parcels adjoin."""
_MOST_OVERLAP = 0.05
_ROLE = f'the property "role": "{KEEP_OUT}"'


def chosen(
    parcels: Sequence[Parcel], name: str, file: str
) -> tuple[tuple[Parcel, ...], tuple[Finding, ...]]:
    """Parcels of a name, or all without one; and a word on the others.

    Raises
    ------
    BoundaryError
        If there is none, or none is called that, in whatever letters; the message lists the names.
    """
    if not parcels:
        raise BoundaryError(
            "it holds 0 outlines, not one", where=file, remedy="draw the field as a polygon"
        )
    if not name:
        return tuple(parcels), ()
    same = [each for each in parcels if each.name == name]
    same = same or [each for each in parcels if each.name.casefold() == name.strip().casefold()]
    if not same:
        names = list(dict.fromkeys(each.name for each in parcels if each.name))
        raise BoundaryError(
            f"no outline is called {name[:40]!r}",
            where=file,
            remedy=f"--name one of: {listed(names, 20)}" if names else "its outlines have no names",
        )
    ids = {id(each) for each in same}
    others = [_called(each, file) for each in parcels if id(each) not in ids]
    said = (Finding(f"outlines not asked for: {listed(others)}", file=file),) if others else ()
    return tuple(same), said


def joined(parcels: Sequence[Parcel], file: str) -> tuple[Area, tuple[Finding, ...]]:
    """Area of parcels, in m, that adjoin, and a word on it if there are several.

    Raises
    ------
    BoundaryError
        If one lies in another, or they lie apart; the message lists the names.
    """
    different = _different(parcels)
    if len(different) == 1:
        return different[0].area, _repeated(parcels, different, file)
    _check_apart(different, file)
    _check_overlap(different, file)
    names = [_called(each, file) for each in different]
    seen = f"{len(different)} outlines that adjoin: {listed(names)}"
    note = Finding(seen, "joined into one field; --name chooses one", file=file)
    whole = cast("Area", shapely.union_all([each.area for each in different]))
    return whole, (*_repeated(parcels, different, file), note)


def _different(parcels: Sequence[Parcel]) -> list[Parcel]:
    kept: dict[bytes, Parcel] = {}
    for each in parcels:
        kept.setdefault(shapely.to_wkb(shapely.normalize(each.area)), each)
    return list(kept.values())


def _repeated(
    parcels: Sequence[Parcel], different: Sequence[Parcel], file: str
) -> tuple[Finding, ...]:
    more = len(parcels) - len(different)
    return (Finding(f"{more} of its outlines repeat another", file=file),) if more else ()


def _check_apart(parcels: Sequence[Parcel], file: str) -> None:
    areas = np.array([each.area for each in parcels], dtype=object)
    tree = shapely.STRtree(areas)
    one, other = tree.query(areas, predicate="dwithin", distance=APART_M)
    links = scipy.sparse.coo_array(
        (np.ones(len(one)), (one, other)), shape=(len(areas), len(areas))
    )
    groups, _ = scipy.sparse.csgraph.connected_components(links, directed=False)
    if groups == 1:
        return
    names = [_called(each, file) for each in parcels]
    named = any(each.name for each in parcels)
    raise BoundaryError(
        f"it holds {len(areas)} outlines, not one, that lie apart: {listed(names, 20)}",
        where=file,
        remedy="choose one with --name" if named else f"leave one, and give keep-outs {_ROLE}",
    )


def _check_overlap(parcels: Sequence[Parcel], file: str) -> None:
    areas = np.array([each.area for each in parcels], dtype=object)
    pairs = shapely.STRtree(areas).query(areas, predicate="intersects").T
    for pair in pairs[pairs[:, 0] < pairs[:, 1]]:
        one, other = sorted(pair, key=lambda k: parcels[k].area.area)
        shared = areas[one].intersection(areas[other]).area
        if shared <= _MOST_OVERLAP * areas[one].area:
            continue
        within = shared > 0.99 * areas[one].area
        how = "lies inside" if within else f"shares {shared / 10_000:.2f} ha with"
        names = _called(parcels[one], file), _called(parcels[other], file)
        raise BoundaryError(
            f"it holds {len(areas)} outlines, not one: {names[0]} {how} {names[1]}",
            where=file,
            remedy=f"give areas not to probe {_ROLE}, or choose one with --name",
        )


def _called(parcel: Parcel, file: str) -> str:
    return parcel.name or parcel.where.removeprefix(f"{file}, ")
