"""A task done: surveys of its field, and how good their maps were after every sample."""

from __future__ import annotations

import numpy as np
from threadpoolctl import threadpool_limits

from subsoil.agent import drive
from subsoil.bench.task import Result, Series, Snapshot, Task, survey_seed
from subsoil.bench.timing import Stopwatch, TimedDispatch
from subsoil.bench.truths import TruthReader, truth_of
from subsoil.errors import SubsoilError
from subsoil.mapping.scores import rmse
from subsoil.mapping.soilmap import SoilMap
from subsoil.penetrometer import LARGE_CONE
from subsoil.registry import NOBODY, Allowed
from subsoil.reports import Source
from subsoil.simulation import Truth
from subsoil.survey import LocalDispatch, Settings, Survey, opened, opening
from subsoil.survey.events import Configured, Event, Finished, Planned, Simulation

STEP_BY_STEP = {"greedy", "monte-carlo"}
"""Strategies that do not know the budget: a survey of 50 samples begins with that of 15."""


class Scorer:
    """Recorder that keeps nothing but how the survey stands after each sample from the second."""

    def __init__(self, truth: Truth) -> None:
        self.truth = truth
        self.snapshots: list[Snapshot] = []
        self.watch = Stopwatch()

    def append(self, event: Event, survey: Survey) -> None:
        """Look once the variograms are up to date: then a plan or the end follows."""
        n = survey.taken
        if n > len(self.snapshots) + 1 and isinstance(event, Planned | Finished):
            with self.watch.running():
                self.snapshots.append(snapshot(survey, self.truth))


def snapshot(survey: Survey, truth: Truth) -> Snapshot:
    """How a survey stands."""
    return Snapshot(
        n=survey.taken,
        rmse_kpa=rmse(survey.soil_map.mean, truth.kpa),
        path_m=survey.metres,
        minutes=survey.minutes,
        mean_kv=survey.mean_kv,
        kv_error_correlation=kv_error_correlation(survey.soil_map, truth),
    )


def kv_error_correlation(soil_map: SoilMap, truth: Truth) -> float:
    """Correlation over cells of the kriging variance and the squared error, averaged over layers.

    NaN if either is the same everywhere.
    """
    squared_error = ((soil_map.mean - truth.kpa) ** 2).mean(axis=0)
    if np.ptp(soil_map.kv) == 0.0 or np.ptp(squared_error) == 0.0:
        return np.nan
    return float(np.corrcoef(soil_map.kv, squared_error)[0, 1])


def scored(task: Task) -> Result:
    """Do all surveys of a task on one thread; a pure function of the task, but for their time.

    A strategy that does not know its budget surveys once.

    Raises
    ------
    SubsoilError
        If a strategy ends before it has taken its samples.
    """
    samples = task.setting.samples
    budgets = samples[-1:] if task.entrant.strategy in STEP_BY_STEP else samples
    with threadpool_limits(1, user_api="blas"):
        truth = truth_of(task.setting, task.field_number)
        return Result(task, tuple(_series(task, budget, truth) for budget in budgets))


def surveyed(
    task: Task, samples: int, truth: Truth, scorer: Scorer, allowed: Allowed = NOBODY
) -> tuple[Survey, float]:
    """Survey a field with a number of samples.

    Returns
    -------
    survey, decision_s
        The state at its end, and the mean processor time of a decision in s.

    Parameters
    ----------
    task, samples, truth, scorer
        What to survey, how far, where, and what to keep of it.
    allowed
        Modules whose strategies may be run, beside the registered ones.

    Raises
    ------
    NotAllowedError
        If the task's strategy is of another module.
    """
    start = truth.field.entrance
    seed = survey_seed(task.setting.seed, task.field_number)
    settings = Settings(
        start=start,
        strategy=task.entrant.strategy,
        estimator=task.entrant.estimator,
        seed=seed,
        samples=samples,
    )
    dispatch = LocalDispatch(
        opened(opening(truth.field, truth.layers, LARGE_CONE)),
        scorer,
        allowed=allowed,
    )
    dispatch.record(Configured(settings=settings))
    simulation = Simulation(world=task.setting.protocol, seed=seed)
    dispatch.join("reader", "simulator", simulation=simulation)
    robot = TruthReader(truth, dispatch.survey.access, start)
    timed = TimedDispatch(dispatch, aside=scorer.watch)
    drive("reader", robot, timed, source=Source(kind="simulator"))
    return dispatch.survey, timed.decision_s


def _series(task: Task, samples: int, truth: Truth) -> Series:
    scorer = Scorer(truth)
    allowed = Allowed.by_name(task.entrant.strategy, task.entrant.estimator)
    survey, decision_s = surveyed(task, samples, truth, scorer, allowed)
    if survey.taken < samples:
        raise SubsoilError(
            f"it ended after {survey.taken} of {samples} samples: {survey.finished}",
            where=f"strategy {task.entrant.strategy}",
            remedy="fewer samples, or another strategy",
        )
    return Series(samples, tuple(scorer.snapshots), decision_s)
