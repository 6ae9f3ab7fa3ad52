"""The command line.

Exit codes: 0 all is well, 1 there are findings, 2 something given is wrong, 3 the survey cannot go
on. Anything subsoil knows to be wrong is one line on standard error; ``--json`` puts the result,
and nothing else, on standard output. Linear algebra runs on one thread: a survey's systems are
small, and its results must not depend on how many cores a machine has.
"""

from __future__ import annotations

import sys

import typer
from threadpoolctl import threadpool_limits

from subsoil.cli import (
    bench,
    corrections,
    demo,
    doctor,
    inspect,
    readings,
    survey,
)
from subsoil.errors import SubsoilError, printable

_INTERRUPTED = 130
"""What typer makes of Ctrl-C."""

app = typer.Typer(
    help="Adaptive soil-compaction surveying: krige while you probe, re-plan after every reading.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
app.command()(demo.demo)
app.command()(survey.init)
app.command()(inspect.plan)
app.command()(survey.run)
app.command()(survey.resume)
app.command()(inspect.status)
app.command()(corrections.withdraw)
app.command(name="map")(readings.make_map)
app.command()(readings.variogram)
app.command()(readings.cv)
app.command()(inspect.replay)
app.command()(inspect.verify)
app.command()(doctor.doctor)
app.add_typer(bench.app, name="bench")


def run(arguments: list[str]) -> int:
    """Run the command line; returns the exit code."""
    try:
        with threadpool_limits(1, user_api="blas"):
            code = app(arguments, standalone_mode=False)
    except SubsoilError as error:
        return _say(str(error), error.exit_code)
    except typer.TyperException as error:
        return _say(error.format_message(), 2)
    except (typer.Abort, KeyboardInterrupt):
        code = _INTERRUPTED
    except OSError as error:
        return _say(f"{error.filename or 'disk'}: {error.strerror or error}", 3)
    if code == _INTERRUPTED:
        return _say("stopped; nothing recorded is lost, go on with `subsoil resume`", 3)
    return code if isinstance(code, int) else 0


def _say(line: str, code: int) -> int:
    print("error: " + printable(line), file=sys.stderr)
    return code
