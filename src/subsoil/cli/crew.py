"""Who works on a survey: what each took, and what each is on the way to."""

from __future__ import annotations

from collections.abc import Iterator

from subsoil.cli.places import in_words
from subsoil.errors import listed
from subsoil.survey import Agent, Survey
from subsoil.units import METRIC, Units


def crew(survey: Survey, units: Units = METRIC) -> tuple[str, ...]:
    """What each agent did, a line each, such as ``hand (person): 3 samples, 90 m, 12 min``."""
    return tuple(
        ", ".join([f"{agent.name} ({agent.kind})", *_work(survey, agent, units)])
        for agent in survey.agents
    )


def _work(survey: Survey, agent: Agent, units: Units) -> Iterator[str]:
    taken = [report for report in survey.readings if report.agent == agent.name]
    if taken:
        yield f"{len(taken)} {'sample' if len(taken) == 1 else 'samples'}"
    files = dict.fromkeys(report.source.file for report in taken if report.source.file)
    if files:
        read = sum(bool(report.source.file) for report in taken)
        yield f"{read} of them from {listed(list(files), 3)}"
    if agent.seconds:
        yield f"{units.length.text(agent.metres)} in {agent.seconds / 60:.0f} min"
    if agent.leases:
        numbers = [str(lease.number + 1) for lease in agent.leases]
        yield f"on the way to stop {listed(numbers, 3)}"
    if not agent.here:
        yield "left"


def last_reading(survey: Survey) -> str:
    """A reading of the last stop, by the first letters of its id; empty if there is none."""
    if not survey.readings:
        return ""
    last = survey.readings[-1]
    when = f", {last.time:%Y-%m-%d %H:%M}" if last.time else ""
    return f"{last.id[:8]} by {last.agent}{when}, {in_words(last.at, survey.field)}"
