"""A plan for a field, or for what a map of it leaves open."""

from __future__ import annotations

import numpy as np

from subsoil.errors import ParameterError, SubsoilError, brief
from subsoil.land.field import Field
from subsoil.layers import Layers
from subsoil.mapping.soilmap import SoilMap
from subsoil.registry import handed_over
from subsoil.strategies.named import strategy_named
from subsoil.strategies.view import Plan, Strategy, View
from subsoil.ways.access import Access
from subsoil.ways.open_land import OpenLand


def plan(
    on: Field | SoilMap,
    strategy: str | Strategy = "joint-adaptive",
    *,
    samples: int = 30,
    start: tuple[float, float] | None = None,
    seed: int = 0,
    access: Access | None = None,
) -> Plan:
    """Plan where to take samples next.

    Parameters
    ----------
    on
        A field that nothing is known of, or a map to go on from: its samples count as taken.
    strategy
        Name of a strategy, ``module:attribute``, or a callable from :class:`View` to :class:`Plan`.
    samples
        Samples to take. Strategies that look one stop ahead plan one.
    start
        Where the way begins, in m. Default: where agents enter the field.
    seed
        Seed of what the strategy draws.
    access
        Where one may stop, and the ways between. Default: open land.

    Raises
    ------
    ParameterError
        If there is no such strategy, it fails, or it plans what cannot be.

    Examples
    --------
    >>> field = Field.from_metres([(0, 0), (60, 0), (60, 40), (0, 40)])
    >>> found = plan(field, "area-split", samples=4)
    >>> len(found.cells)
    4
    """
    soil_map = SoilMap(on, Layers()) if isinstance(on, Field) else on
    field = soil_map.field
    inside = [field.nearest_cell(at) for at in soil_map.at[field.contains(soil_map.at)]]
    name, allowed = handed_over(strategy)
    taken = len(soil_map.samples)
    view = View(
        field=field,
        access=OpenLand(field) if access is None else access,
        soil_map=soil_map,
        position=field.entrance if start is None else start,
        plan=(),
        visited=tuple(dict.fromkeys(inside)),
        refused=(),
        budget=taken + samples,
        fresh=True,
        rng=np.random.default_rng(seed),
        taken=taken,
    )
    return planned(strategy_named(name, allowed=allowed), view, f"strategy {brief(name)}")


def planned(strategy: Strategy, view: View, where: str) -> Plan:
    """What a strategy plans, once it was looked at.

    Parameters
    ----------
    strategy
        What plans.
    view
        The survey as it sees it.
    where
        What to call it in errors.

    Raises
    ------
    ParameterError
        If it fails, answers with something else than a plan, or plans stops that cannot be made.
    """
    try:
        plan = strategy(view)
    except SubsoilError:
        raise
    except Exception as error:
        raise ParameterError(
            f"it failed: {type(error).__name__}: {brief(str(error), 200)}",
            where=where,
            remedy="try it on one view: subsoil.plan(field, strategy)",
        ) from error
    if not isinstance(plan, Plan):
        raise ParameterError(
            f"it answered {brief(repr(plan))}, which is no plan",
            where=where,
            remedy="return a Plan(cells, reason)",
        )
    _check_cells(plan, view, where)
    return plan


def _check_cells(plan: Plan, view: View, where: str) -> None:
    if plan.pushes and (len(plan.pushes) != len(plan.cells) or min(plan.pushes) < 1):
        raise ParameterError(
            f"it plans {plan.pushes} pushes at {len(plan.cells)} stops",
            where=where,
            remedy="plan one or more at each, or none for one each",
        )
    gone = {*view.visited, *view.refused, *view.leased}
    for cell in plan.cells:
        if isinstance(cell, bool) or not isinstance(cell, int):
            raise ParameterError(
                f"it plans {brief(repr(cell))}, which is no number of a cell",
                where=where,
                remedy="give whole numbers: Plan(tuple(cells.tolist()), reason)",
            )
        if not 0 <= cell < len(view.field.cells):
            raise ParameterError(
                f"it plans cell {cell}, which is not in the field",
                where=where,
                remedy=f"plan cells from 0 to {len(view.field.cells) - 1}",
            )
        if not view.access.stops[cell]:
            raise ParameterError(
                f"it plans cell {cell}, at which one cannot stop",
                where=where,
                remedy="plan free cells only: View.free",
            )
        if cell in gone:
            raise ParameterError(
                f"it plans cell {cell}, which is visited, refused, assigned or planned already",
                where=where,
                remedy="plan free cells only, each once",
            )
        gone.add(cell)
