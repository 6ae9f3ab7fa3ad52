"""The main job in a minute: a simulated robot surveys a field and leaves maps."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from subsoil.cli.figures import FigureFormat
from subsoil.cli.inspect import summary, tell_survey
from subsoil.cli.limits import LimitOptions
from subsoil.cli.options import (
    EstimatorName,
    MethodOptions,
    Seed,
    StrategyName,
    World,
    allowed_by,
    settings_of,
)
from subsoil.cli.output import AsJson, Out, Shown, folder, progress, resumable
from subsoil.cli.parsing import FIELD, OUTPUT, grouped
from subsoil.errors import JournalError
from subsoil.io.write.rasters import write_geotiffs
from subsoil.journal import Journal, create, fingerprint, last_event
from subsoil.land.field import Field
from subsoil.layers import Layers
from subsoil.optional import FIGURES, GEOTIFF, REPORT, require
from subsoil.penetrometer import SMALL_CONE
from subsoil.report import Progress, write_report
from subsoil.report.wording import promise_kept
from subsoil.simulation import Truth
from subsoil.survey import (
    DEFAULT_ESTIMATOR,
    DEFAULT_STRATEGY,
    LocalDispatch,
    Settings,
    Survey,
    fits_of,
    fold,
    opening,
)
from subsoil.survey.events import Configured, Event, Planned, Simulation
from subsoil.survey.outlook import outlook
from subsoil.survey.progress import History
from subsoil.survey.simulated import SIMULATED, simulation_of, work
from subsoil.units import METRIC, SYSTEMS
from subsoil.worlds import demo_field, truth_of

DemoField = Annotated[
    World,
    typer.Option(
        help="A simulated field, or the surrogate of the paper's real one.",
        rich_help_panel=FIELD,
    ),
]
Overwrite = Annotated[
    bool,
    typer.Option(
        "--overwrite",
        help="Replace the survey of an earlier demonstration.",
        rich_help_panel=OUTPUT,
    ),
]
_FILE = "survey.gpkg"


@grouped
def demo(
    limits: LimitOptions,
    out: Out = Path("demo"),
    field: DemoField = "simulated",
    strategy: StrategyName = DEFAULT_STRATEGY,
    estimator: EstimatorName = DEFAULT_ESTIMATOR,
    seed: Seed = 0,
    overwrite: Overwrite = False,
    figures: FigureFormat = "png",
    units: Shown = "metric",
    as_json: AsJson = False,
) -> None:
    """Show a robot survey a field adaptively; leaves a survey file, maps, figures and a report."""
    require(GEOTIFF, FIGURES, REPORT)
    path = _file(out, overwrite)
    land, layers = _land(field), Layers()
    method = MethodOptions(strategy=strategy, estimator=estimator, seed=seed)
    settings = settings_of(Settings(start=land.entrance), land, method, limits)
    truth = truth_of(field, land, layers, seed)
    path.unlink(missing_ok=True)
    with create(path, opening(land, layers, SMALL_CONE)) as journal:
        survey, history = _survey(journal, settings, truth, simulation_of(truth, field, seed))
    fits = fits_of(survey)
    rasters = write_geotiffs(survey.soil_map, out)
    _, digest = last_event(path)
    report = write_report(
        survey, history, fits, out,
        fingerprint=fingerprint(digest), units=SYSTEMS[units], figures=figures,
    )  # fmt: skip
    result = {
        **summary(survey),
        "rmse_kpa": history[-1].rmse,
        "outlook": promise_kept(
            outlook(survey), history[-1].rmse, METRIC if as_json else SYSTEMS[units]
        ),
        "survey": path,
        "maps": rasters,
        "report": report,
    }
    tell_survey(result, as_json, units)


def _file(out: Path, overwrite: bool) -> Path:
    """Path of the survey file, which is not there or may be replaced."""
    path = folder(out) / _FILE
    if path.exists() and not overwrite:
        raise JournalError(
            "it is there from an earlier demonstration",
            where=str(path),
            remedy="give --overwrite to replace it, or another --out",
        )
    return path


def _survey(
    journal: Journal, settings: Settings, truth: Truth, simulation: Simulation
) -> tuple[Survey, tuple[Progress, ...]]:
    """Survey to the end, with progress on a terminal."""
    history = History(truth)
    with resumable(), progress("surveying", settings.samples, first="planning") as advance:

        def follow(survey: Survey, event: Event) -> None:
            history(survey, event)
            if isinstance(event, Planned):
                advance(survey.taken, _in_short(history.entries))

        allowed = allowed_by(None, settings.strategy, settings.estimator)
        dispatch = LocalDispatch(fold(journal.events()), journal, follow, allowed=allowed)
        dispatch.record(Configured(settings=settings))
        dispatch.join(SIMULATED, "simulator", simulation=simulation)
        work(dispatch, truth)
        history.look(dispatch.survey)
        advance(dispatch.survey.taken, _in_short(history.entries))
    return dispatch.survey, tuple(history.entries)


def _in_short(history: Sequence[Progress]) -> str:
    """Say how a survey stands on one line; nothing before its first sample."""
    if not history:
        return ""
    now = history[-1]
    spread = math.sqrt(now.mean_kv)
    return (
        f"√KV {spread:.0f} kPa  RMSE {now.rmse:.0f} kPa  {now.metres:.0f} m  {now.minutes:.0f} min"
    )


def _land(name: World) -> Field:
    if name == "simulated":
        return demo_field()
    from subsoil.datasets import riseholme

    return riseholme().half_field
