"""The worlds a simulated robot can survey, by name."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from subsoil.errors import JournalError, ParameterError, brief, listed
from subsoil.land.field import Field
from subsoil.layers import Layers
from subsoil.simulation import Truth, surrogate
from subsoil.survey import Survey
from subsoil.survey.events import Simulation
from subsoil.survey.simulated import simulation_of, soil_drawn

DEMO_OUTLINE = [
    (4, 10), (60, 2), (126, 6), (178, 22), (186, 74), (172, 128), (118, 140), (52, 134), (12, 122),
    (2, 66),
]  # fmt: skip
"""Corners in m of the simulated field of the demonstration."""


def demo_field() -> Field:
    """Simulated field of the demonstration, 2.3 ha."""
    return Field.from_metres(DEMO_OUTLINE, name="simulated field")


def truth_of(world: str, field: Field, layers: Layers, seed: int) -> Truth:
    """Soil of a world.

    Raises
    ------
    ParameterError
        If there is no such world.
    """
    check_world(world)
    return WORLDS[world](field, layers, seed)


def check_world(world: str) -> None:
    """Check that there is such a world.

    Raises
    ------
    ParameterError
        If there is none.
    """
    if world not in WORLDS:
        raise ParameterError(
            f"there is no world {brief(world)!r}",
            where="world",
            remedy=f"one of {', '.join(WORLDS)}",
        )


def soil_of(survey: Survey) -> Truth:
    """The soil that a simulated survey began in, drawn again.

    Raises
    ------
    JournalError
        If real agents work on the survey, nobody has begun it, or the soil is not the same here.
    """
    real = [agent.name for agent in survey.agents if agent.kind != "simulator"]
    if real:
        raise JournalError(
            f"{listed(real)} began it on real land, which is not simulated",
            where=survey.name,
            remedy="a person goes on with `subsoil next`; simulate in a survey of its own",
        )
    if not survey.simulation:
        raise JournalError(
            "nobody has begun to survey", where=survey.name, remedy="subsoil run SURVEY.gpkg"
        )
    before = survey.simulation[0]
    truth = truth_of(before.world, survey.field, survey.layers, before.seed)
    again = simulation_of(truth, before.world, before.seed)
    if before.check_kpa and not np.allclose(before.check_kpa, again.check_kpa, rtol=1e-6):
        raise JournalError(
            f"the soil it was simulated in, {brief(before.world)} of seed {before.seed}, comes out "
            "differently here",
            where=survey.name,
            remedy="go on with the version of subsoil and the data that began it",
        )
    return truth


def soil_to_survey(survey: Survey, world: str | None, seed: int) -> tuple[Truth, Simulation]:
    """The soil to survey, and its record: its own for a survey that was begun.

    Parameters
    ----------
    survey
        The survey.
    world
        Name of the soil. Default: that it was begun in, or one drawn from the seed.
    seed
        Of the soil, if nobody has begun.

    Raises
    ------
    JournalError
        If the survey was begun in another one, or on real land.
    """
    if not survey.agents:
        world = world or "simulated"
        truth = truth_of(world, survey.field, survey.layers, seed)
        return truth, simulation_of(truth, world, seed)
    truth, begun = soil_of(survey), survey.simulation[0]
    if world not in (None, begun.world):
        raise JournalError(
            f"it was begun in the soil {brief(begun.world)!r} and does not go on in {world!r}",
            where=survey.name,
            remedy=f"give --world {brief(begun.world)}, or start another survey",
        )
    return truth, begun


def _riseholme(field: Field, layers: Layers, seed: int) -> Truth:  # noqa: ARG001 - real, not drawn
    from subsoil.datasets import riseholme

    readings = riseholme().readings
    return surrogate(field, readings.at, readings.layer_means(layers), layers)


WORLDS: dict[str, Callable[[Field, Layers, int], Truth]] = {
    "simulated": soil_drawn,
    "riseholme": _riseholme,
}
"""Worlds by name: a soil drawn from the seed, or one kriged from the real readings of Riseholme."""
