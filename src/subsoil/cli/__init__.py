"""The command line.

Exit codes: 0 all is well, 1 there are findings, 2 something given is wrong, 3 the survey cannot go
on. Anything subsoil knows to be wrong is one line on standard error; ``--json`` puts the result,
and nothing else, on standard output. Linear algebra runs on one thread: a survey's systems are
small, and its results must not depend on how many cores a machine has.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Annotated

import typer
from threadpoolctl import threadpool_limits

import subsoil
from subsoil.cli import (
    bench,
    corrections,
    demo,
    doctor,
    hand,
    ingest,
    inspect,
    methods,
    readings,
    survey,
)
from subsoil.cli.examples import epilog
from subsoil.cli.parsing import Verb, Verbs
from subsoil.errors import SubsoilError, printable

_INTERRUPTED = 130
"""What typer makes of Ctrl-C."""

app = typer.Typer(
    cls=Verbs,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
)
VERBS: dict[str, Callable[..., None]] = {
    "demo": demo.demo,
    "init": survey.init,
    "plan": inspect.plan,
    "run": survey.run,
    "resume": survey.resume,
    "next": hand.next_stop,
    "add": hand.add,
    "stone": hand.stone,
    "skip": hand.skip,
    "ingest": ingest.ingest,
    "status": inspect.status,
    "amend": corrections.amend,
    "withdraw": corrections.withdraw,
    "map": readings.make_map,
    "variogram": readings.variogram,
    "cv": readings.cv,
    "replay": inspect.replay,
    "verify": inspect.verify,
    "strategies": methods.strategies,
    "doctor": doctor.doctor,
}
"""Verbs, as help lists them."""

for _name, _verb in VERBS.items():
    app.command(_name, cls=Verb, epilog=epilog(_name))(_verb)
app.add_typer(bench.app, name="bench")


def _version(asked: bool) -> None:
    if asked:
        print(f"subsoil {subsoil.__version__}")
        raise typer.Exit


@app.callback()
def main(
    version: Annotated[
        bool,
        typer.Option(
            "--version",
            callback=_version,
            is_eager=True,
            help="Show the version and exit.",
        ),
    ] = False,
) -> None:
    """Adaptive soil-compaction surveying: krige while you probe, re-plan after every reading."""


def run(arguments: list[str]) -> int:
    """Run the command line; returns the exit code."""
    try:
        with threadpool_limits(1, user_api="blas"):
            code = app(arguments, prog_name="subsoil", standalone_mode=False)
    except SubsoilError as error:
        return _say(str(error), error.exit_code)
    except typer.TyperException as error:
        return _say(error.format_message(), 2) if error.format_message() else 2
    except (typer.Abort, KeyboardInterrupt):
        code = _INTERRUPTED
    except OSError as error:
        return _say(f"{error.filename or 'disk'}: {error.strerror or error}", 3)
    if code == _INTERRUPTED:
        return _say("stopped", 3)
    return code if isinstance(code, int) else 0


def _say(line: str, code: int) -> int:
    print("error: " + printable(line), file=sys.stderr)
    return code
