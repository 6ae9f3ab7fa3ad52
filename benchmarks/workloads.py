"""Workloads: the same job done by subsoil and by a peer, each returning what it computed."""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
import tracemalloc
from collections.abc import Callable
from dataclasses import dataclass
from statistics import median

import numpy as np

from subsoil import Exponential, Spherical, condition
from subsoil.arrays import Floats
from subsoil.kriging import at_targets
from subsoil.variogram import Bounded

LAYERS = 8
_LAYER = np.arange(LAYERS)


@dataclass(frozen=True)
class Result:
    """What a workload took, beside what its peer took in the same run.

    Attributes
    ----------
    ours_s, peer_s
        Time in s; NaN for a peer that is not there.
    goal
        What is to be reached, in words.
    error
        Largest difference of means and variances to direct kriging, in units of z; NaN if none.
    memory_mb
        Peak memory above the outputs in MB; NaN if not measured.
    note
        What else to know.
    """

    ours_s: float
    peer_s: float = float("nan")
    goal: str = ""
    error: float = float("nan")
    memory_mb: float = float("nan")
    note: str = ""


def models(kind: type[Bounded]) -> list[Bounded]:
    """Eight variograms of one kind, no two alike."""
    return [kind(0.05 + 0.02 * k, 40.0 + 10.0 * k, 0.6 + 0.1 * k) for k in range(LAYERS)]


def readings(n: int) -> tuple[Floats, Floats]:
    """Places (n, 2) on 150 x 155 m and values (8, n)."""
    rng = np.random.default_rng(7)
    at = rng.uniform(0, 1, (n, 2)) * [150.0, 155.0]
    waves = np.sin(at @ rng.normal(0, 0.05, (2, LAYERS)) + rng.uniform(0, 6, LAYERS))
    return at, (2.0 + waves + rng.normal(0, 0.2, (n, LAYERS))).T


def axes(nx: int, ny: int) -> tuple[Floats, Floats]:
    """Cell centres of a grid over 150 x 155 m."""
    return (np.arange(nx) + 0.5) * 150.0 / nx, (np.arange(ny) + 0.5) * 155.0 / ny


def best_of(runs: int, job: Callable[[], object]) -> float:
    """Median time in s of some runs after one that warms up."""
    job()
    return median(timed(job) for _ in range(runs))


def timed(job: Callable[[], object]) -> float:
    """Time in s of one run."""
    start = time.perf_counter()
    job()
    return time.perf_counter() - start


def pykrige(model: Bounded, at: Floats, z: Floats) -> object:
    """PyKrige's ordinary kriging of one layer under the same model."""
    from pykrige.ok import OrdinaryKriging

    return OrdinaryKriging(
        at[:, 0], at[:, 1], z,
        variogram_model=type(model).__name__.lower(),
        variogram_parameters={"psill": model.psill, "range": model.range, "nugget": model.nugget},
    )  # fmt: skip


def online() -> Result:
    """W1: 8 layers, 936 cells, samples 1 to 100 one by one, mean and variance after each."""
    at, z = readings(100)
    variograms = models(Exponential)
    easting, northing = axes(36, 26)
    x, y = (each.ravel() for each in np.meshgrid(easting, northing))
    cells = np.column_stack([x, y])

    def ours() -> None:
        estimate = at_targets(condition(variograms, at[:1], z[:, :1]), cells)
        for k in range(1, len(at)):
            estimate = estimate.append(at[k], z[:, k])
            assert estimate.prediction.mean.shape == (LAYERS, len(cells))

    def peer() -> None:
        for n in range(2, len(at) + 1):
            for layer, model in enumerate(variograms):
                pykrige(model, at[:n], z[layer, :n]).execute("points", x, y)  # type: ignore[attr-defined]

    followed = at_targets(condition(variograms, at[:1], z[:, :1]), cells).append(at[1:], z[:, 1:])
    direct = condition(variograms, at, z).predict(cells)
    error = max(
        float(np.abs(followed.prediction.mean - direct.mean).max()),
        float(np.abs(followed.prediction.variance - direct.variance).max()),
    )
    return Result(best_of(9, ours), timed(peer), ">= 50x, goal 100x PyKrige vectorized", error)


def dense(kind: type[Bounded], share: float) -> Result:
    """W2: a map of 8 layers x 1e6 cells from 286 samples, mean and variance."""
    at, z = readings(286)
    variograms = models(kind)
    easting, northing = axes(1000, 1000)
    ok = condition(variograms, at, z)
    ours_s = best_of(3, lambda: ok.predict_grid(easting, northing))
    tracemalloc.start()
    mean, variance = ok.predict_grid(easting, northing)
    over_outputs = tracemalloc.get_traced_memory()[1] - mean.nbytes - variance.nbytes
    tracemalloc.stop()
    rows, columns = np.random.default_rng(1).integers(0, 1000, (2, 2000))
    direct = ok.predict(np.column_stack([easting[columns], northing[rows]]))
    error = max(
        float(np.abs(mean[:, rows, columns] - direct.mean).max()),
        float(np.abs(variance[:, rows, columns] - direct.variance).max()),
    )
    some = northing[: max(1, round(share * len(northing)))]

    def peer() -> None:
        for layer, model in enumerate(variograms):
            pykrige(model, at, z[layer]).execute("grid", easting, some, backend="C")  # type: ignore[attr-defined]

    peer_s = timed(peer) / (len(some) / len(northing))
    note = "" if share == 1.0 else f"peer on {share:.0%} of the cells, its time is linear in them"
    goal = ">= 50x PyKrige C, error <= 1e-9, <= 200 MB"
    return Result(ours_s, peer_s, goal, error, over_outputs / 1e6, note)


def dense_gstools(share: float) -> Result:
    """W2 against GSTools, one layer of the eight."""
    import gstools

    at, z = readings(286)
    model = models(Exponential)[0]
    easting, northing = axes(1000, 1000)
    ok = condition(model, at, z[0])
    ours_s = best_of(3, lambda: ok.predict_grid(easting, northing))
    some = northing[: max(1, round(share * len(northing)))]
    theirs = gstools.Exponential(
        dim=2, var=model.psill, len_scale=model.range / 3, nugget=model.nugget
    )
    kriging = gstools.krige.Ordinary(theirs, at.T, z[0])
    peer_s = timed(lambda: kriging.structured([easting, some], return_var=True)) / (
        len(some) / len(northing)
    )
    return Result(ours_s, peer_s, note=f"one layer; peer on {share:.0%} of the cells")


def survey_step() -> Result:
    """One survey step at n = 30 on 936 cells: take a sample in, refit, krige, plan, route."""
    from subsoil.agent import Assignment, drive
    from subsoil.bench.truths import TruthReader
    from subsoil.penetrometer import LARGE_CONE
    from subsoil.simulation import draw_field
    from subsoil.survey import LocalDispatch, Memory, Settings, opened, opening
    from subsoil.survey.events import Configured

    truth = draw_field(np.random.default_rng(1000))
    settings = Settings(
        start=(0.0, 0.0), strategy="adaptive-monte-carlo", estimator="paper-10", seed=1, samples=31
    )
    times: list[float] = []

    class Watched(TruthReader):
        """Robot that notes when it is sent and when it is done."""

        def go_to(self, stop: Assignment):  # type: ignore[no-untyped-def]
            times.append(time.perf_counter())
            return super().go_to(stop)

        def probe(self):  # type: ignore[no-untyped-def]
            push = super().probe()
            times.append(time.perf_counter())
            return push

    dispatch = LocalDispatch(opened(opening(truth.field, truth.layers, LARGE_CONE)), Memory())
    dispatch.record(Configured(settings=settings))
    dispatch.join("reader")
    drive("reader", Watched(truth, dispatch.survey.access, (0.0, 0.0)), dispatch)
    steps = [after - before for before, after in zip(times[1::2], times[2::2], strict=False)]
    return Result(median(steps[-5:]), goal="<= 0.050 s", note="median of the last five of 31 steps")


def tour(n: int) -> Result:
    """Order n random places; the peer searches at random for the 2 s that it is given."""
    import fast_tsp
    from scipy.spatial.distance import cdist

    from subsoil.ways.tours import short_tour

    nodes = np.random.default_rng(0).uniform(0, 1000, (n + 1, 2))
    open_end = np.full((n + 2, n + 2), 4000)
    open_end[:-1, :-1] = np.round(cdist(nodes, nodes))
    open_end[-1, [0, -1]] = open_end[[0, -1], -1] = 0
    lengths = open_end.tolist()

    def ours() -> tuple[int, ...]:
        return (0, *short_tour(cdist(nodes, nodes)))

    def peer() -> list[int]:
        cycle: list[int] = fast_tsp.find_tour(lengths, duration_seconds=2.0)
        end = cycle.index(n + 1)
        return cycle[end + 1 :] + cycle[:end]

    mine, theirs = (
        np.hypot(*np.diff(nodes[list(way)], axis=0).T).sum() for way in (ours(), peer())
    )
    note = f"{mine / theirs - 1:+.2%} longer than fast-tsp's"
    return Result(
        best_of(3, ours), timed(peer), f"<= 2 s, <= {0.5 if n < 1000 else 2} % longer", note=note
    )


def demonstration() -> Result:
    """``subsoil demo``: survey, maps, figures, report."""
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "subsoil", "demo", "--out", f"{folder}/demo", "--json"]
        seconds = timed(lambda: subprocess.run(command, check=True, capture_output=True))
    return Result(seconds, goal="<= 60 s")


def importing() -> Result:
    """``import subsoil`` in a fresh Python, that of Python itself taken off."""
    bare = best_of(5, lambda: subprocess.run([sys.executable, "-c", ""], check=True))
    full = best_of(5, lambda: subprocess.run([sys.executable, "-c", "import subsoil"], check=True))
    return Result(full - bare, goal="<= 0.5 s")


def importing_agent() -> Result:
    """``import subsoil.agent`` in a fresh Python, that of Python itself taken off."""
    bare = best_of(5, lambda: subprocess.run([sys.executable, "-c", ""], check=True))
    call = [sys.executable, "-c", "import subsoil.agent"]
    return Result(best_of(5, lambda: subprocess.run(call, check=True)) - bare, goal="<= 0.12 s")


def workloads(share: float) -> dict[str, Callable[[], Result]]:
    """Every workload by name; share is how much of a dense map slow peers get to do."""
    from benchmarks import journal

    return {
        "W1 online": online,
        "W2 dense, exponential": lambda: dense(Exponential, share),
        "W2 dense, spherical": lambda: dense(Spherical, share),
        "W2 dense, GSTools": lambda: dense_gstools(share),
        "survey step": survey_step,
        "tour 50 stops": lambda: tour(50),
        "tour 200 stops": lambda: tour(200),
        "tour 1000 stops": lambda: tour(1000),
        "record 500 readings": lambda: journal.build(500),
        "record 2000 readings": lambda: journal.build(2000),
        "keep an event at 2000": lambda: journal.event(2000),
        "verify 500 readings": lambda: journal.check(500),
        "verify 2000 readings": lambda: journal.check(2000),
        "import subsoil": importing,
        "import subsoil.agent": importing_agent,
        "subsoil demo": demonstration,
    }
