"""What more probing would buy: variances follow from where samples are, not from what they say."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from subsoil.arrays import Floats
from subsoil.layers import LayerState, Sample
from subsoil.mapping.soilmap import SoilMap
from subsoil.mapping.uncertainty import predicted_rmse, subsample


def forecast(soil_map: SoilMap, cells: Sequence[int]) -> Floats:
    """(k,) predicted RMSE in kPa after each of k further stops.

    Exact while the variograms hold and pushes go as deep as some push did before.

    Examples
    --------
    >>> from subsoil.land.field import Field
    >>> from subsoil.layers import Layers
    >>> from subsoil.variogram import Spherical
    >>> field, layers = Field.from_metres([(0, 0), (40, 0), (40, 30), (0, 30)]), Layers((0, 0.4))
    >>> model = Spherical(nugget=100.0, range=30.0, psill=900.0)
    >>> samples = [Sample(at, np.array([800.0]), np.zeros(1, np.int8)) for at in [(3, 3), (38, 28)]]
    >>> soil_map = SoilMap(field, layers, (model,), tuple(samples))
    >>> forecast(soil_map, [20, 5]).round(1)
    array([26.5, 25. ])
    """
    result = np.empty(len(cells))
    for k, cell in enumerate(cells):
        soil_map = _probed(soil_map, cell)
        result[k] = predicted_rmse(soil_map)
    return result


def further(soil_map: SoilMap, taken: Sequence[int], planned: Sequence[int], k: int) -> list[int]:
    """Up to k cells to probe after the planned ones, each the one that tells most.

    Of at most 300 cells spread over the field, each lowers the mean kriging variance over these
    most.

    Parameters
    ----------
    soil_map
        The map so far.
    taken
        Cells that are not to be probed again.
    planned
        Cells that will be probed before.
    """
    index = subsample(len(soil_map.cells))
    for cell in planned:
        soil_map = _probed(soil_map, cell)
    coarse = replace(soil_map, subset=tuple(index.tolist()))
    free = ~np.isin(index, [*taken, *planned])
    chosen: list[int] = []
    while len(chosen) < k and free.any():
        candidates = np.flatnonzero(free)
        best = int(candidates[np.argmax(coarse.kv_drop(candidates).mean(axis=1))])
        chosen.append(int(index[best]))
        free[best] = False
        coarse = _probed(coarse, best)
    return chosen


def _probed(soil_map: SoilMap, cell: int) -> SoilMap:
    """Map whose variances are those after probing a cell; its means are of no use."""
    reached = np.isin(range(len(soil_map.layers)), [k for s in soil_map.stacks for k in s.layers])
    state = np.where(reached, LayerState.MEASURED, LayerState.UNREACHED).astype(np.int8)
    east, north = soil_map.cells[cell].tolist()
    return soil_map.append(Sample((east, north), np.where(reached, 0.0, np.nan), state))
