"""Verbs that compare strategies: run a benchmark, report on it, check one's own."""

from __future__ import annotations

import sys
from dataclasses import asdict, dataclass
from math import isnan
from pathlib import Path
from typing import Annotated, Any, Literal, get_args

import typer

from subsoil.bench import Benchmark, Failed, Retried, Setting, conformance
from subsoil.bench.compare import Compared, compare, setting_on, waiting
from subsoil.bench.conformance import Kind
from subsoil.bench.conformance.rule import Verdict
from subsoil.bench.running import Outcome
from subsoil.bench.task import entrants_of
from subsoil.cli.examples import epilog
from subsoil.cli.figures import FigureFormat
from subsoil.cli.options import allowed_by
from subsoil.cli.output import AsJson, folder, progress, say, tell
from subsoil.cli.parsing import COMPARISON, OUTPUT, WORK, Verb, Verbs, grouped, some_of
from subsoil.errors import ParameterError, SubsoilError, printable
from subsoil.io.read.boundary import read_field
from subsoil.strategies import STRATEGIES
from subsoil.variogram import ESTIMATORS

app = typer.Typer(
    cls=Verbs,
    help="Compare strategies on the same fields, and report beside the paper's numbers.",
    no_args_is_help=True,
)

Protocol = Literal["surrogate", "signal", "riseholme"]

_CANNOT_GO_ON = 3
"""Exit code if a task has no result."""


def _option(help_: str, metavar: str, panel: str = COMPARISON, **more: Any) -> Any:
    return typer.Option(help=help_, metavar=metavar, rich_help_panel=panel, **more)


@dataclass(frozen=True)
class ComparisonOptions:
    """What to compare, as the command line says it.

    Attributes
    ----------
    protocol, fields, seed, boundary
        Which soils, and how they are read.
    strategies, estimator
        Who surveys them.
    samples
        Where they are compared.
    """

    protocol: Annotated[
        Protocol,
        typer.Option(
            metavar="NAME",
            help=f"How soils are drawn and read: {', '.join(get_args(Protocol))}.",
            rich_help_panel=COMPARISON,
        ),
    ] = "surrogate"
    fields: Annotated[int, _option("Number of fields.", "N")] = 20
    seed: Annotated[int, _option("Seed of all chance.", "N", min=0)] = 0
    strategies: Annotated[
        str,
        _option(
            f"Strategies, comma-separated, of {', '.join(STRATEGIES)}, or module:attribute.",
            "NAMES",
            show_default="all",
            autocompletion=some_of(STRATEGIES),
        ),
    ] = ",".join(STRATEGIES)
    samples: Annotated[
        str, _option("Numbers of samples to compare at, comma-separated.", "N,N,...")
    ] = "15,20,30,50"
    estimator: Annotated[
        str | None,
        _option(
            f"Estimators for all strategies, comma-separated, of {', '.join(ESTIMATORS)}.",
            "NAMES",
            show_default="paper-10 for the paper's, pmc for others",
            autocompletion=some_of(ESTIMATORS),
        ),
    ] = None
    boundary: Annotated[
        Path | None, _option("Outline of the field, instead of the protocol's own.", "FILE")
    ] = None

    @property
    def setting(self) -> Setting:
        """Setting of what was given; its field and real readings are there if it needs them."""
        field = read_field(self.boundary) if self.boundary else None
        return setting_on(field, self.protocol, self.seed, _numbers(self.samples))


@app.command(cls=Verb, epilog=epilog("bench run"))
@grouped
def run(
    out: Annotated[Path, _option("Folder of the benchmark; made if missing.", "DIR", OUTPUT)],
    comparison: ComparisonOptions,
    dask: Annotated[
        str | None, _option("Address of a Dask scheduler, or local.", "ADDRESS", WORK)
    ] = None,
    workers: Annotated[
        int | None,
        _option("Processes on this machine.", "N", WORK, show_default="one a core", min=1),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Survey the same fields with every strategy. Ctrl-C is safe: the same command goes on.

    A folder can be added to: with more fields, strategies or estimators and all else equal.
    """
    setting = comparison.setting
    names = _names(comparison.strategies), _names(comparison.estimator or "")
    allowed_by(None, *names[0], *names[1])
    benchmark = Benchmark(setting, comparison.fields, entrants_of(*names))
    try:
        done = _compared(benchmark, folder(out), workers, dask)
    except KeyboardInterrupt:
        raise SubsoilError(
            "stopped; finished tasks are kept", where=str(out), remedy="give the same command again"
        ) from None
    result = {
        "benchmark": out,
        "tasks": len(benchmark.tasks),
        "done before": done.before,
        "done now": done.now,
        "failed": [f"{each.task.name}: {each.why}" for each in done.failed],
        "results": done.results,
    }
    tell(result, as_json)
    if done.failed:
        raise typer.Exit(_CANNOT_GO_ON)


@app.command(cls=Verb, epilog=epilog("bench report"))
def report(
    benchmark: Annotated[Path, typer.Argument(help="Folder of a benchmark.", metavar="DIR")],
    figures: FigureFormat = "png",
    as_json: AsJson = False,
) -> None:
    """Write tables, figures and report.md of a benchmark into its folder."""
    from subsoil.bench.report import write_report

    tell(write_report(benchmark, figures), as_json)


@app.command(cls=Verb, epilog=epilog("bench check"))
def check(
    name: Annotated[
        str,
        typer.Argument(help="Strategy or estimator, module:attribute if your own.", metavar="NAME"),
    ],
    kind: Annotated[
        Kind | None,
        typer.Option(
            help="What it is.",
            show_default="by how it is called: view, or at and z",
            rich_help_panel=COMPARISON,
        ),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Try on a strategy or estimator what must hold of each; exit code 1 if a rule is broken."""
    allowed_by(None, name)
    found = conformance.check(name, kind, told=(lambda _: None) if as_json else _Teller())
    if as_json:
        rules = [{**asdict(verdict), "holds": verdict.holds} for verdict in found.verdicts]
        tell({**asdict(found), "verdicts": rules, "broken": len(found.broken)}, as_json)
    else:
        held = len(found.verdicts) - len(found.broken)
        each = "a decision" if found.kind == "strategy" else "for 30 readings of 3 layers"
        took = "" if isnan(found.seconds) else f"; {found.seconds:.3f} s of processor time {each}"
        say(f"{found.kind} {name}: {held} rules hold, {len(found.broken)} broken{took}")
    if found.broken:
        raise typer.Exit(1)


class _Teller:
    """Says verdicts as they come, and what breaks several rules once."""

    def __init__(self) -> None:
        self._said: set[str] = set()

    def __call__(self, verdict: Verdict) -> None:
        again = not verdict.holds and verdict.seen in self._said
        self._said.add(verdict.seen)
        say(f"BROKEN: {verdict.rule}: the same" if again else str(verdict))


def _compared(benchmark: Benchmark, out: Path, workers: int | None, dask: str | None) -> Compared:
    """Do the tasks, with progress."""
    with progress("surveying fields", len(waiting(out, benchmark))) as advance:
        done = failed = 0

        def told(outcome: Outcome) -> None:
            nonlocal done, failed
            if isinstance(outcome, Retried):
                again = f"worker died, trying again: {outcome.task.name}"
                print(printable(again), file=sys.stderr)
                return
            done, failed = done + 1, failed + isinstance(outcome, Failed)
            advance(done, f"{failed} failed" if failed else "")

        return compare(benchmark, out, workers=workers, dask=dask, told=told)


def _names(text: str) -> tuple[str, ...]:
    return tuple(name.strip() for name in text.split(",") if name.strip())


def _numbers(text: str) -> tuple[int, ...]:
    try:
        return tuple(int(number) for number in text.split(","))
    except ValueError:
        raise ParameterError(
            f"{text!r} is not a list of whole numbers",
            where="--samples",
            remedy="numbers such as 15,20,30,50",
        ) from None
