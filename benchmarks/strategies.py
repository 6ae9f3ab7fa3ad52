"""Distances and errors of the paper's seven strategies on test-bed fields, beside its own.

Run as ``python -m benchmarks.strategies --fields 20``. Readings are the truth's layer means, without a robot's
physics, as in the paper's own simulation.
"""

from __future__ import annotations

import argparse
from concurrent.futures import ProcessPoolExecutor
from itertools import product

import numpy as np
from threadpoolctl import threadpool_limits

from subsoil.dispatch import LocalDispatch, drive
from subsoil.events import Configured, Event
from subsoil.penetrometer import LARGE_CONE, Insertion
from subsoil.robot import Arrival, Push
from subsoil.routing import length
from subsoil.scores import rmse
from subsoil.simulation import Truth, test_bed
from subsoil.strategies import STRATEGIES
from subsoil.survey import Survey, apply, opened, opening

SAMPLES = (15, 20, 30, 50)
PAPER = {
    "random": ((63.04, 53.93, 48.52, 50.13), (450, 633, 670, 944)),
    "area-split": ((59.58, 53.83, 51.02, 49.93), (484, 635, 820, 1054)),
    "w-shape": ((51.20, 50.41, 50.05, 51.06), (392, 391, 405, 408)),
    "greedy": ((47.90, 53.11, 51.19, 47.79), (1728, 1967, 3218, 4937)),
    "monte-carlo": ((57.97, 55.90, 53.17, 48.02), (1238, 1660, 2521, 3817)),
    "adaptive-monte-carlo": ((50.39, 48.93, 50.28, 45.42), (535, 574, 841, 1478)),
    "adaptive-greedy": ((49.51, 48.96, 46.79, 48.25), (502, 715, 900, 1317)),
}
"""RMSE in kPa and way in m at 15, 20, 30 and 50 samples, as the paper prints them."""


class TruthReader:
    """Robot that reads layer means straight from the truth and keeps nothing but its place."""

    def __init__(self, truth: Truth, position: tuple[float, float]) -> None:
        self.truth, self.position = truth, position

    def go_to(self, at: tuple[float, float]) -> Arrival:
        metres = length(self.position, [at])
        self.position = at
        return Arrival(at, metres, metres)

    def probe(self) -> Push:
        kpa = self.truth.reading(self.truth.field.nearest_cell(self.position))
        force = kpa * LARGE_CONE.area_mm2 / 1000.0
        return Push(self.position, Insertion(self.truth.layers.bottom_m, force), 50.0)

    def stop(self) -> None:
        pass


class Memory:
    """Recorder that keeps nothing."""

    def append(self, event: Event, survey: Survey) -> None:
        pass


def survey(seed: int, strategy: str, samples: int) -> Survey:
    """One survey of one test-bed field."""
    truth = test_bed(np.random.default_rng(seed))
    settings = Configured(
        strategy=strategy, estimator="paper-10", refit_every=1, seed=seed, start=(0.0, 0.0),
        world="test-bed", samples=samples, metres=np.inf, minutes=np.inf, mean_kv=0.0,
    )  # fmt: skip
    state = apply(opened(opening(truth.field, truth.layers, LARGE_CONE)), settings)
    dispatch = LocalDispatch(state, Memory())
    drive("reader", TruthReader(truth, (0.0, 0.0)), dispatch)
    return dispatch.survey


def task(key: tuple[str, int, int]) -> tuple[float, float]:
    strategy, samples, seed = key
    with threadpool_limits(1):
        done = survey(seed, strategy, samples)
        truth = test_bed(np.random.default_rng(seed))
    return rmse(done.soil_map.mean, truth.kpa), done.metres


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--fields", type=int, default=20)
    parser.add_argument("--first-seed", type=int, default=1000)
    arguments = parser.parse_args()
    seeds = range(arguments.first_seed, arguments.first_seed + arguments.fields)
    keys = list(product(STRATEGIES, SAMPLES, seeds))
    with ProcessPoolExecutor(2) as pool:
        results = np.array(list(pool.map(task, keys, chunksize=4)))
    table = results.reshape(len(STRATEGIES), len(SAMPLES), len(seeds), 2)
    half = 1.96 * table.std(axis=2, ddof=1) / np.sqrt(len(seeds))
    mean = table.mean(axis=2)
    print(f"{'':22}" + "".join(f"{n:>24}" for n in SAMPLES))
    for k, name in enumerate(STRATEGIES):
        for what in range(2):
            cells = "".join(
                f"{mean[k, n, what]:10.1f} ±{half[k, n, what]:5.1f} [{PAPER[name][what][n]:5.0f}]"
                for n in range(len(SAMPLES))
            )
            print(f"{name if not what else '':20}{'kPa' if not what else 'm':>3}{cells}")


if __name__ == "__main__":
    main()
