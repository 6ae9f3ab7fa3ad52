"""The worlds a simulated robot can survey, by name."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from subsoil.errors import ParameterError
from subsoil.field import Field
from subsoil.layers import Layers
from subsoil.simulation import Machine, SimulatedRobot, Truth, simulate, surrogate
from subsoil.survey import Survey

_TRUTH_STREAM = 0

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
            f"there is no world {world!r}", where="world", remedy=f"one of {', '.join(WORLDS)}"
        )


def robot_of(survey: Survey, truth: Truth) -> SimulatedRobot:
    """Simulated robot that goes on where a survey stands."""
    machine = Machine(survey.cone)
    return SimulatedRobot(
        truth,
        machine,
        seed=survey.configured.seed,
        position=survey.position,
        stop=survey.step,
        pushed=survey.pushed,
        battery_s=machine.battery_s - (survey.seconds - survey.charged_at),
    )


def _simulated(field: Field, layers: Layers, seed: int) -> Truth:
    stream = np.random.SeedSequence(seed, spawn_key=(_TRUTH_STREAM,))
    return simulate(field, np.random.default_rng(stream), layers)


def _riseholme(field: Field, layers: Layers, seed: int) -> Truth:  # noqa: ARG001 - real, not drawn
    from subsoil.datasets import riseholme

    readings = riseholme().readings
    return surrogate(field, readings.at, readings.layer_means(layers), layers)


WORLDS: dict[str, Callable[[Field, Layers, int], Truth]] = {
    "simulated": _simulated,
    "riseholme": _riseholme,
}
"""Worlds by name: a soil drawn from the seed, or one kriged from the real readings of Riseholme."""
